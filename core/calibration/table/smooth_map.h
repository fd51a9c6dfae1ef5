#pragma once
// The smooth map of lookup_table_calibration.h and its statistics. Private to core/calibration/table.

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/calibration/stripe/laser_plane.h"

namespace seamwright::lookup_table {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// One less its leverage is at least this, of a pair that alone says what the map is there.
inline constexpr double kLeastRest = 1e-9;

// The pairs in use.
struct Samples {
    std::vector<Eigen::Vector2d> pixel, laser;
};
Samples chosen(const std::vector<LaserPair>& pairs, const std::vector<char>& used);

Eigen::Vector2d through(const Eigen::Matrix3d& h, const Eigen::Vector2d& p);

// Samples of one x, and those of one z: a stage that goes there once errs for all of them alike.
using StageRows = std::array<std::vector<std::vector<std::size_t>>, 2>;

class SmoothMap {
  public:
    // Degrees to choose from. False: too few samples, or a horizon between them. Of `rows` it is kept how an error of each
    // moves the map: state_rows() says how large these are (x, z).
    bool fit(const Samples& s, int least_degree, int most_degree, const StageRows& rows = {});

    Eigen::Vector2d at(const Eigen::Vector2d& pixel) const {
        const Eigen::Vector3d q = h_ * corrected(pixel).homogeneous();
        if (!(q.z() * side_ > 0)) return {kNaN, kNaN};
        return q.hnormalized();
    }
    // d(x, z)/d(u, v), mm per px.
    Eigen::Matrix2d slope(const Eigen::Vector2d& p) const {
        constexpr double h = 0.5;
        Eigen::Matrix2d j;
        j.col(0) = (at(p + Eigen::Vector2d(h, 0)) - at(p - Eigen::Vector2d(h, 0))) / (2 * h);
        j.col(1) = (at(p + Eigen::Vector2d(0, h)) - at(p - Eigen::Vector2d(0, h))) / (2 * h);
        return j;
    }
    // d(x, z)/d(corrected pixel): carries noise() into the laser plane.
    Eigen::Matrix2d homography_slope(const Eigen::Vector2d& pixel) const {
        const Eigen::Vector3d q = h_ * corrected(pixel).homogeneous();
        const Eigen::Vector2d xz = q.hnormalized();
        return (h_.topLeftCorner<2, 2>() - xz * h_.block<1, 2>(2, 0)) / q.z();
    }
    // How far a pair lies from the map, in corrected px; NaN beyond the horizon.
    Eigen::Vector2d miss(const Eigen::Vector2d& pixel, const Eigen::Vector2d& laser) const {
        const Eigen::Vector3d q = inverse_ * laser.homogeneous();
        if (!(q.z() * inverse_side_ > 0)) return {kNaN, kNaN};
        return q.hnormalized() - corrected(pixel);
    }
    // What the map is known to at some places, each as seen through the candidates that were averaged: covariance of
    // the map (corrected px, px^2) between two places, noise and choice together.
    struct Known {
        // Products of two rows, in units of noise(); as wide as a normal one that holds 95 % has to be where noise() is
        // estimated from few pairs.
        Eigen::VectorXd row;
        // How far the candidates lie from their mean, by the root of their weight, px; then by how much a sigma of the
        // stage's at each of its rows moves the map.
        Eigen::Matrix2Xd apart;
        Eigen::Matrix2d with(const Known& other, const Eigen::Matrix2d& noise) const {
            return row.dot(other.row) * noise + apart * other.apart.transpose();
        }
    };
    Known known(const Eigen::Vector2d& pixel) const;
    void state_rows(const std::array<double, 2>& sigma_mm);
    // The noise is at least what places of this sigma (mm along each axis) give in corrected px.
    void state_places(const Samples& s, double sigma_mm);
    const Eigen::Matrix2d& noise() const { return noise_; }  // covariance of a pair's miss(), px^2
    // Residual over sqrt(1 - leverage) as a square in units of the noise, and the leave-one-out error in px.
    double studentised(std::size_t i, const Eigen::Matrix2d& noise_inverse) const {
        const auto k = static_cast<Eigen::Index>(i);
        const Eigen::Vector2d e = residual_.row(k).transpose();
        return e.dot(noise_inverse * e) / std::max(1 - leverage_(k), kLeastRest);
    }
    Eigen::Vector2d left_out_error(std::size_t i) const {
        const auto k = static_cast<Eigen::Index>(i);
        return residual_.row(k).transpose() / std::max(1 - leverage_(k), kLeastRest);
    }
    int degree() const { return degree_; }  // of the candidate that predicts best
    double effective() const { return effective_; }
    double freedom() const { return static_cast<double>(residual_.rows()) - effective_; }

  private:
    Eigen::Vector2d mean_ = Eigen::Vector2d::Zero();
    double scale_ = 1, side_ = 1, inverse_side_ = 1;
    Eigen::Matrix3d h_ = Eigen::Matrix3d::Identity(), inverse_ = Eigen::Matrix3d::Identity();
    int degree_ = 0;
    std::vector<Eigen::Vector2d> knots_;
    Eigen::MatrixXd poly_, bend_;  // coefficients of u and v, of the mean of the candidates
    // One degree: what known() needs of its polynomial and of the spline's modes.
    struct Degree {
        int degree = 0;
        Eigen::MatrixXd r, cross, rotate;
        std::array<Eigen::MatrixXd, 2> flat_rows,
            bent_rows;  // of u and v: polynomial and modes by the stage's rows
    };
    // One stiffness at one degree.
    struct Candidate {
        std::size_t degree = 0;  // of degrees_
        double error = 0;        // sum of the squared leave-one-out errors, px^2
        double weight = 0;       // relative likelihood; all sum to 1
        double effective = 0;
        Eigen::MatrixXd poly, bend, residual;
        Eigen::VectorXd shrink, leverage;
    };
    std::vector<Degree> degrees_;
    std::vector<Candidate> candidates_;
    double least_error_ = 0, student_ = 1;
    Eigen::MatrixXd residual_;
    Eigen::VectorXd leverage_;
    Eigen::Matrix2d noise_ = Eigen::Matrix2d::Zero();
    double effective_ = 0;
    // By the stage's error at each row, 1 mm: what the samples move by in u and v. Sigma of each row.
    std::array<Eigen::MatrixXd, 2> by_rows_;
    Eigen::Index rows_of_x_ = 0;
    Eigen::VectorXd row_sigma_mm_;

    static Eigen::Index terms(int degree) { return (degree + 1) * (degree + 2) / 2; }
    static Eigen::RowVectorXd monomials(const Eigen::Vector2d& c, int degree) {
        Eigen::RowVectorXd row(terms(degree));
        Eigen::Index at = 0;
        for (int total = 0; total <= degree; ++total)
            for (int k = 0; k <= total; ++k) {
                double value = 1;
                for (int i = 0; i < total - k; ++i) value *= c.x();
                for (int i = 0; i < k; ++i) value *= c.y();
                row(at++) = value;
            }
        return row;
    }
    static double bending(double square) { return square > 0 ? 0.5 * square * std::log(square) : 0; }
    Eigen::RowVectorXd kernel(const Eigen::Vector2d& c) const {
        Eigen::RowVectorXd row(static_cast<Eigen::Index>(knots_.size()));
        for (std::size_t j = 0; j < knots_.size(); ++j)
            row(static_cast<Eigen::Index>(j)) = bending((c - knots_[j]).squaredNorm());
        return row;
    }
    Eigen::Vector2d corrected(const Eigen::Vector2d& pixel) const {
        const Eigen::Vector2d c = (pixel - mean_) / scale_;
        Eigen::Vector2d out = pixel + (monomials(c, degrees_.back().degree) * poly_).transpose();
        if (!knots_.empty()) out += (kernel(c) * bend_).transpose();
        return out;
    }
    bool set_frame(const Samples& s, std::vector<Eigen::Vector2d>& places, Eigen::MatrixXd& y);
    void choose_knots(const std::vector<Eigen::Vector2d>& places);
    bool spline_columns(const std::vector<Eigen::Vector2d>& places, Eigen::MatrixXd& columns,
                        Eigen::MatrixXd& transform) const;
    struct Modes;
    void try_stiffnesses(const Modes& m, const Eigen::MatrixXd& transform);
    double weight_of(const Candidate& c, Eigen::Index pairs) const;
    void average();
    void set_rows(const Samples& s, const StageRows& rows);
};

}  // namespace seamwright::lookup_table
