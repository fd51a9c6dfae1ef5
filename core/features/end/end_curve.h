#pragma once
// A contour near its end as a line or, where it is rounded there, an arc of a circle (methods.md 2).
//
// The line is fit_line()'s. The arc goes through the points within 3.5 robust sigma of it (median size of the residuals, not
// less than the profile's noise; iterated), by Gauss-Newton on their distances from it:
//     residual(p) = b0 + b1 s + b2 s^2,   s along the arc, outwards; an offset, a turn and half a change of curvature.
// A hem seen to its steep end turns by 80 degrees over the points: a parabola over their chord would see less of the slope
// there than there is. With T = (curvature / sigma(curvature))^2 the arc counts by w = 1 - 2 / T, between it and the chord of
// its points, and not at all for T < 2 (Akaike's limit: it is not worth its noise), when it loses more than a quarter of
// the line's points, or when it leaves a larger median residual than the line. Without it a robust line takes the rounded
// end, or the flat before it, for outliers and says confidently where neither of them is.
//
// Noise model: equal, across the contour; neighbours may share it (contour_noise.h). Variances:
// v_line + min(T - 2, 1) (v_arc - v_line). Units mm, rad.
// Degenerate: fewer than 6 points, all of them in one place, or turned by more than a half circle, know no arc.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/features/contour/line_fit.h"

namespace seamwright {

// s along it, outwards, from `centre`. Curvature 0: a line.
struct EndCurve {
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();                                  // on it, s = 0
    Eigen::Vector2d direction = Eigen::Vector2d::UnitX();                              // there, outwards
    Eigen::Vector2d mean = Eigen::Vector2d::Zero(), chord = Eigen::Vector2d::UnitX();  // of its points
    double curvature = 0;  // 1/mm, along the normal
    double sigma_mm = 0, rms_mm = 0;
    int used = 0;
    double spread_mm2 = 0;  // sum of squared distances from the centre along the chord
    // What is other than an arc: the residuals' cubic part, without what noise makes of it; of 1, s, s^2, s^3.
    Eigen::Vector4d cubic_misfit = Eigen::Vector4d::Zero();
    // Of (offset, turn, curvature / 2), without the noise: (sum r r^T)^-1, r = (1, s, s^2). Line: of the first two only.
    Eigen::Matrix3d cofactor = Eigen::Matrix3d::Zero();
    double widening = 1;  // of variances, for sigma being estimated from few points
    double alike = 1;     // of variances, for neighbours that share their noise (contour_noise.h)

    Eigen::Vector2d normal() const { return {-direction.y(), direction.x()}; }
    double along(const Eigen::Vector2d& p) const {
        const Eigen::Vector2d v = p - centre;
        const double on = direction.dot(v);
        return curvature == 0 ? on : std::atan2(curvature * on, 1 - curvature * normal().dot(v)) / curvature;
    }
    double residual(const Eigen::Vector2d& p) const {
        const Eigen::Vector2d v = p - centre;
        const double q = normal().dot(v) - 0.5 * curvature * v.squaredNorm();
        return 2 * q / (1 + std::sqrt(std::max(1 - 2 * curvature * q, 0.0)));
    }
    Eigen::Vector2d tangent(double s) const {
        return std::cos(curvature * s) * direction + std::sin(curvature * s) * normal();
    }
    Eigen::Vector2d at(double s) const {
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
        const Eigen::Vector3d r(1, s, s * s);
        return widening * alike * sigma_mm * sigma_mm * r.dot(cofactor * r);
    }
};

class EndFit {
  public:
    // Line through the points, from the end inwards, and the arc where that explains them better. `ok` false: they form no
    // line. `rounded`: the arc it is. `noise`: of the profile.
    struct Result {
        bool ok = false, rounded = false;
        EndCurve curve;
    };
    Result fit(std::span<const double> x, std::span<const double> z, const ProfileNoise& noise);

  private:
    Eigen::Vector2d point(std::size_t i) const { return {x_[i], z_[i]}; }
    bool fit_arc(const LineFit& line, EndCurve& curve);
    bool least_squares(EndCurve& curve) const;
    Eigen::Vector4d cubic(const EndCurve& curve) const;
    double squares(const EndCurve& curve) const;
    double alike(const EndCurve& curve);
    double median_residual(const EndCurve& curve);

    std::span<const double> x_, z_;
    std::vector<double> scratch_;
    std::vector<std::uint8_t> keep_;
    LineWorkspace workspace_;
};

}  // namespace seamwright
