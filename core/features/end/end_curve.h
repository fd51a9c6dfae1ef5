#pragma once
// A contour near its end: straight, an arc of a circle, or straight and then an arc (methods.md 2), each as likely as the
// points make it.
//
// How far a rounded end reaches back is not known, and over the few points of a hem the flat before it looks like a part of
// the arc. So there is not one curve but several: the line, the arc through all points, and an arc that begins at one of
// seven places, nearer and nearer to the end, behind a tangent straight piece. By Gauss-Newton on the points' distances:
//     residual(p) = b0 + b1 s + b2 bow(s),   bow = s^2 on the arc, 0 before it;
// s along the curve, outwards, from where the arc begins; an offset, a turn and half a change of curvature. A hem seen to its
// steep end turns by 80 degrees over the points: a parabola over their chord would see less of the slope there than there is.
// Curvatures are expected about 0 with sigma 1.5 / L, L the points' extent; the line is there in 7 cases of 10. Then
// curve j counts by its evidence
//     w_j ~ prior_j |H_j|^(-1/2) exp(-chi2_j / 2),   H_j the information of (b0, b1, b2), chi2_j with the prior's part,
// and what is asked at the end is the mean over the curves; that they differ there is part of its covariance. One curve alone is
// too sure: the line and the arc of a gentle bend explain the same points and end apart.
// Points count within 3.5 robust sigma of the likeliest curve (median size of the residuals, not less than the profile's noise;
// iterated). Where that would leave less than three quarters of the robust line's points, that line is the only curve: without an
// arc it takes the rounded end, or the flat before it, for outliers and says confidently where neither of them is.
// Beside a higher sheet no arc turns up: there the last points stand in light that fell on both.
//
// Noise model: equal, across the contour; neighbours may share it (contour_noise.h). Units mm, rad.
// Degenerate: fewer than 6 points, all of them in one place, or turned by more than a half circle, know no arc.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/features/contour/line_fit.h"

namespace seamwright {

// s along it, outwards, from `centre`. Curvature 0: a line.
struct EndCurve {
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();      // on it, s = 0
    Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  // there, outwards
    Eigen::Vector2d chord = Eigen::Vector2d::UnitX();      // of its points
    double curvature = 0;                                  // 1/mm, along the normal
    bool straight_before = false;                          // the arc begins at s = 0
    double sigma_mm = 0, rms_mm = 0;
    int used = 0;
    double spread_mm2 = 0;  // sum of squared distances from the points' middle along the chord
    // What is other than the curve: the residuals' cubic part, without what noise makes of it; of powers().
    Eigen::Vector4d cubic_misfit = Eigen::Vector4d::Zero();
    // Of (offset, turn, curvature / 2), without the noise: (sum r r^T)^-1, r = (1, s, bow(s)). Line: of the first two only.
    Eigen::Matrix3d cofactor = Eigen::Matrix3d::Zero();
    double widening = 1;  // of variances, for sigma being estimated from few points
    double alike = 1;     // of variances, for neighbours that share their noise (contour_noise.h)
    double weight = 1;    // among the curves of the same points

    Eigen::Vector2d normal() const { return {-direction.y(), direction.x()}; }
    bool straight_at(double s) const { return curvature == 0 || (straight_before && s < 0); }
    double bow(double s) const { return straight_before && s < 0 ? 0 : s * s; }
    Eigen::Vector4d powers(double s) const { return {1, s, bow(s), s * s * s}; }
    double along(const Eigen::Vector2d& p) const {
        const Eigen::Vector2d v = p - centre;
        const double on = direction.dot(v);
        return straight_at(on) ? on : std::atan2(curvature * on, 1 - curvature * normal().dot(v)) / curvature;
    }
    double residual(const Eigen::Vector2d& p) const {
        const Eigen::Vector2d v = p - centre;
        if (straight_at(direction.dot(v))) return normal().dot(v);
        const double q = normal().dot(v) - 0.5 * curvature * v.squaredNorm();
        return 2 * q / (1 + std::sqrt(std::max(1 - 2 * curvature * q, 0.0)));
    }
    Eigen::Vector2d tangent(double s) const {
        if (straight_at(s)) return direction;
        return std::cos(curvature * s) * direction + std::sin(curvature * s) * normal();
    }
    Eigen::Vector2d at(double s) const {
        if (straight_at(s)) return centre + s * direction;
        const double half = 0.5 * curvature * s;
        const double length = half == 0 ? s : s * std::sin(half) / half;
        return centre + length * (std::cos(half) * direction + std::sin(half) * normal());
    }
    // By an offset across, a turn and a change of curvature, all at s = 0.
    void move(double offset, double turn, double bend) {
        centre += offset * normal();
        direction = std::cos(turn) * direction + std::sin(turn) * normal();
        curvature += bend;
    }
    double variance_at(double s) const {
        const Eigen::Vector3d r = powers(s).head<3>();
        return widening * alike * sigma_mm * sigma_mm * r.dot(cofactor * r);
    }
};

class EndFit {
  public:
    // The curves through the points, which come from the end inwards; the likeliest first, weights of sum 1. Empty: they form
    // no line. `noise`: of the profile. `covered`: beside a sheet that is higher, towards +z. Valid until the next fit.
    std::span<const EndCurve> fit(std::span<const double> x, std::span<const double> z,
                                  const ProfileNoise& noise, bool covered);

  private:
    Eigen::Vector2d point(std::size_t i) const { return {x_[i], z_[i]}; }
    bool try_curves(int fewest_used);
    bool line_of_kept(EndCurve& curve);
    bool least_squares(EndCurve& curve, double curvature_weight) const;
    void weigh();
    Eigen::Vector4d cubic(const EndCurve& curve) const;
    double squares(const EndCurve& curve) const;
    double alike(const EndCurve& curve);
    double median_residual(const EndCurve& curve);

    std::span<const double> x_, z_;
    bool covered_ = false;
    std::vector<double> scratch_;
    std::vector<std::uint8_t> keep_;
    std::vector<EndCurve> curves_;
    std::vector<double> evidence_;
    LineWorkspace workspace_;
};

}  // namespace seamwright
