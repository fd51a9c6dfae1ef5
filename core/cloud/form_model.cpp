#include "core/cloud/form_model.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/median.h"

namespace seamwright {
namespace {

// Where a bend may have its middle: over the part and beyond its ends, so that a part held at its very end is no rarity.
constexpr double kPlaceReach = 1.6;
// Of the part's size: between these the series of the form's lengths begins.
constexpr double kLeastShortest = 1e-4, kMostShortest = 0.2;
// Of the residuals that a rigid motion leaves: where the series of the form's heights begins, and how far it goes on.
constexpr double kLeastForm = 0.1, kFormRange = 100;
constexpr double kLeastRms_mm = 1e-6;
constexpr double kRidge = 1e-9;  // on the normal equations of the rigid motion
constexpr int kModes = 3, kUnknowns = 6 + kModes;
using Full = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using FullVector = Eigen::Matrix<double, kUnknowns, 1>;

struct Candidate {
    double form_mm = 0, length_mm = 0, log_likelihood = 0;
    FullVector mean = FullVector::Zero();
    Full covariance = Full::Zero();
};

struct Nodes {
    Eigen::MatrixXd distance, facing;
    Eigen::MatrixXd rows;  // n x 9: of the motion, of the modes
    Eigen::VectorXd residuals, noise;
};

Nodes matrices(const std::vector<FormNode>& nodes, const PlateAxes& plate) {
    const auto n = static_cast<Eigen::Index>(nodes.size());
    Nodes m{Eigen::MatrixXd(n, n), Eigen::MatrixXd(n, n), Eigen::MatrixXd(n, kUnknowns), Eigen::VectorXd(n),
            Eigen::VectorXd(n)};
    for (Eigen::Index i = 0; i < n; ++i) {
        const FormNode& a = nodes[static_cast<std::size_t>(i)];
        const Eigen::Vector3d at =
            (plate.axes.transpose() * (a.place_mm - plate.middle_mm)).cwiseQuotient(plate.half_mm);
        const double up = plate.axes.col(2).dot(a.normal);
        m.rows.row(i) << a.row.transpose(), up * at.x() * at.x() / 2, up * at.x() * at.y(),
            up * at.y() * at.y() / 2;
        m.residuals[i] = a.residual_mm;
        m.noise[i] = a.noise_mm2;
        for (Eigen::Index j = 0; j < n; ++j) {
            const FormNode& b = nodes[static_cast<std::size_t>(j)];
            m.distance(i, j) = (a.place_mm - b.place_mm).norm();
            m.facing(i, j) = a.normal.dot(b.normal);
        }
    }
    return m;
}

// One field (s, L) with every t of `bends`: the rows are whitened once, and with the modes as unknowns of prior variance
// t^2, |V_t| |A^T V_t^-1 A| is |V| t^(2 m) |N|, N the normal equations of both.
void solve_field(const Nodes& m, double form_mm, double length_mm, const std::vector<double>& bends,
                 std::vector<Candidate>& all) {
    Eigen::MatrixXd v = Eigen::MatrixXd::Zero(m.rows.rows(), m.rows.rows());
    if (form_mm > 0) {
        v = (form_mm * form_mm * (m.distance.array() / -length_mm).exp() * m.facing.array()).matrix();
    }
    v.diagonal() += m.noise;
    const Eigen::LLT<Eigen::MatrixXd> factor(v);
    if (factor.info() != Eigen::Success) return;
    const Eigen::MatrixXd rows = factor.matrixL().solve(m.rows);
    const Eigen::VectorXd r = factor.matrixL().solve(m.residuals);
    const Full information = rows.transpose() * rows;
    const FullVector right = rows.transpose() * r;
    const double log_v = factor.matrixLLT().diagonal().array().log().sum();
    for (const double bend : bends) {
        Full with_prior = information;
        with_prior.diagonal().tail<kModes>().array() += 1 / (bend * bend);
        const Eigen::LLT<Full> inner(with_prior);
        if (inner.info() != Eigen::Success) continue;
        Candidate c;
        c.form_mm = form_mm;
        c.length_mm = length_mm;
        c.mean = inner.solve(right);
        c.covariance = inner.solve(Full::Identity());
        c.log_likelihood = -log_v - kModes * std::log(bend) -
                           inner.matrixLLT().diagonal().array().log().sum() -
                           (r.squaredNorm() - right.dot(c.mean)) / 2;
        if (std::isfinite(c.log_likelihood) && c.covariance.allFinite()) all.push_back(c);
    }
}

// Mean and second moment of the motion that a bend about another place of the part amounts to.
void add_place_of_bend(const Full& second_moment, const FullVector& mean, const PlateAxes& plate,
                       const Eigen::Vector3d& middle_mm, double spread_mm, FormSolution& out) {
    // Motion of the fit's unknowns for a displacement of the sheet e3 (c + g . (u, v)).
    const auto motion = [&](double c, const Eigen::Vector2d& g) {
        const Eigen::Vector3d up = plate.axes.col(2);
        const Eigen::Vector3d slope =
            plate.axes.col(0) * (g.x() / plate.half_mm.x()) + plate.axes.col(1) * (g.y() / plate.half_mm.y());
        const Eigen::Vector3d turn = slope.cross(up);  // turn x p = up (slope . p) in the plane
        Vector6 m;
        m << up * (c + slope.dot(middle_mm - plate.middle_mm)), turn * spread_mm;
        return m;
    };
    constexpr int kPlaces = 7;
    Eigen::Matrix<double, 6, kModes> average = Eigen::Matrix<double, 6, kModes>::Zero();
    std::vector<Eigen::Matrix<double, 6, kModes>> places;
    for (int i = 0; i < kPlaces; ++i)
        for (int j = 0; j < kPlaces; ++j) {
            const double u = kPlaceReach * (2 * (i + 0.5) / kPlaces - 1),
                         w = kPlaceReach * (2 * (j + 0.5) / kPlaces - 1);
            Eigen::Matrix<double, 6, kModes>
                a;  // the bend about (u, w) less the bend about the middle, a mode a column
            a.col(0) = motion(u * u / 2, {-u, 0});
            a.col(1) = motion(u * w, {-w, -u});
            a.col(2) = motion(w * w / 2, {0, -w});
            average += a / (kPlaces * kPlaces);
            places.push_back(a);
        }
    const Eigen::Matrix3d bends = second_moment.bottomRightCorner<kModes, kModes>();
    // Bend and twist have places of their own: nothing says that they lie together.
    for (const auto& a : places)
        for (Eigen::Index k = 0; k < kModes; ++k) {
            const Vector6 off = a.col(k) - average.col(k);
            out.covariance += bends(k, k) * off * off.transpose() / static_cast<double>(places.size());
        }
    // r = A motion + modes: a bend about elsewhere puts its line into the modes, and takes it from the motion.
    const Eigen::Matrix<double, 6, kModes> shift = average;
    const Eigen::Matrix<double, kUnknowns, kUnknowns> central = second_moment - mean * mean.transpose();
    const Eigen::Matrix<double, 6, kModes> cross = central.topRightCorner<6, kModes>();
    out.motion += shift * mean.tail<kModes>();
    out.covariance += shift * central.bottomRightCorner<kModes, kModes>() * shift.transpose() +
                      cross * shift.transpose() + shift * cross.transpose();
}

}  // namespace

FormSolution solve_with_form(const std::vector<FormNode>& nodes, const PlateAxes& plate,
                             const Eigen::Vector3d& middle_mm, double spread_mm) {
    FormSolution out;
    if (nodes.size() < 12) return out;
    const Nodes m = matrices(nodes, plate);
    const double size_mm = 2 * plate.half_mm.norm();
    std::vector<double> nearest;
    for (Eigen::Index i = 0; i < m.distance.rows(); ++i) {
        double d = size_mm;
        for (Eigen::Index j = 0; j < m.distance.rows(); ++j)
            if (j != i && m.distance(i, j) > 0) d = std::min(d, m.distance(i, j));
        nearest.push_back(d);
    }
    const double shortest =
        std::clamp(median(nearest) / 2, kLeastShortest * size_mm, kMostShortest * size_mm);
    // What a rigid motion leaves over is form and noise: where the nodes were taken does not count.
    const Eigen::MatrixXd rigid = m.rows.leftCols<6>();
    const Matrix6 normal = rigid.transpose() * rigid + kRidge * Matrix6::Identity();
    const Vector6 motion = normal.ldlt().solve(Vector6(rigid.transpose() * m.residuals));
    const double rms = std::max(kLeastRms_mm, std::sqrt((m.residuals - rigid * motion).squaredNorm() /
                                                        static_cast<double>(nodes.size())));
    const std::vector<double> bends{0.01 * rms, 0.3 * rms, 1 * rms, 3 * rms, 10 * rms, 30 * rms};
    std::vector<Candidate> all;
    solve_field(m, 0, 1, bends, all);
    constexpr int kSteps = 8;
    for (int l = 0; l < kSteps; ++l)
        for (int s = 0; s < kSteps; ++s)
            solve_field(m, rms * kLeastForm * std::pow(kFormRange, s / (kSteps - 1.0)),
                        shortest * std::pow(size_mm / shortest, l / (kSteps - 1.0)), bends, all);
    if (all.empty()) return out;
    double best = all.front().log_likelihood;
    for (const Candidate& c : all) best = std::max(best, c.log_likelihood);
    double total = 0, log_length = 0, with_form = 0;
    FullVector mean = FullVector::Zero();
    Full second = Full::Zero();
    for (const Candidate& c : all) {
        const double w = std::exp(c.log_likelihood - best);
        total += w;
        mean += w * c.mean;
        second += w * (c.covariance + c.mean * c.mean.transpose());
        out.form_mm += w * c.form_mm;
        if (c.form_mm > 0) {
            log_length += w * std::log(c.length_mm);
            with_form += w;
        }
    }
    mean /= total;
    second /= total;
    out.motion = mean.head<6>();
    out.covariance = (second - mean * mean.transpose()).topLeftCorner<6, 6>();
    out.bend_mm = mean.tail<kModes>();
    out.form_mm /= total;
    out.length_mm = with_form > 0 ? std::exp(log_length / with_form) : 0;
    add_place_of_bend(second, mean, plate, middle_mm, spread_mm, out);
    out.solved = out.covariance.allFinite();
    return out;
}

}  // namespace seamwright
