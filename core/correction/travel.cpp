#include "core/correction/travel.h"

#include <algorithm>
#include <cmath>

namespace seamwright {

Eigen::Vector3d contour_direction(const SpotObservation& spot, const Displacement& displacement) {
    const Pose& w = spot.workobject_from_sensor;
    const Pose& d = displacement.workobject_from_movedworkobject;
    Eigen::Vector3d along = Eigen::Vector3d::UnitY();
    if (spot.curve && spot.weights.y() == 0) {
        const ContourCurve& c = *spot.curve;
        const Eigen::Vector3d taught = w.inverse() * (d.inverse() * (w * spot.measured_mm));
        const double y = std::clamp(taught.y() - spot.reference_mm.y(), c.valid_from_mm, c.valid_to_mm);
        const Eigen::Vector3d powers(1, 2 * y, 3 * y * y);
        along.x() = c.x_coefficients.dot(powers);
        along.z() = c.z_coefficients.dot(powers);
    }
    const Eigen::Vector3d moved = w.linear().transpose() * (d.linear() * (w.linear() * along));
    return moved / moved.y();
}

Eigen::Vector3d displaced_measure(const SpotObservation& spot, const Displacement& displacement) {
    const Pose moved = spot.workobject_from_sensor.inverse() * displacement.workobject_from_movedworkobject *
                       spot.workobject_from_sensor;
    const Eigen::Vector3d& r = spot.reference_mm;
    const ContourCurve curve = spot.curve && spot.weights.y() == 0 ? *spot.curve : ContourCurve{};
    double y = 0;
    Eigen::Vector3d at = moved * r;
    constexpr int kSteps = 8;               // of Newton; the bend of a contour is gentle
    constexpr double kAcrossTravel = 1e-3;  // of the contour's direction along Y: it does not come by
    for (int step = 0; step < kSteps; ++step) {
        const double inside =
            spot.curve ? std::clamp(y, curve.valid_from_mm, curve.valid_to_mm) : 0.0;  // tangent beyond
        const auto shape = [&](const Eigen::Vector3d& c, double& value, double& slope) {
            slope = c.dot(Eigen::Vector3d(1, 2 * inside, 3 * inside * inside));
            value = c.dot(Eigen::Vector3d(inside, inside * inside, inside * inside * inside)) +
                    slope * (y - inside);
        };
        double x, z, dx, dz;
        shape(curve.x_coefficients, x, dx);
        shape(curve.z_coefficients, z, dz);
        at = moved * (r + Eigen::Vector3d(x, y, z));
        const double along = (moved.linear() * Eigen::Vector3d(dx, 1, dz)).y();
        if (!(std::abs(along) > kAcrossTravel)) return r;
        y -= (at.y() - r.y()) / along;
    }
    return {at.x(), r.y(), at.z()};
}

Eigen::Matrix2d travel_covariance(const SpotObservation& spot, const Displacement& displacement,
                                  double sigma_mm) {
    const Eigen::Vector3d direction = contour_direction(spot, displacement);
    const Eigen::Vector2d slope = sigma_mm * Eigen::Vector2d(direction.x(), direction.z());
    return slope * slope.transpose();
}

void add_travel(SpotObservation& spot, const Displacement& displacement, double half_window_mm) {
    if (half_window_mm == 0) return;
    constexpr double kNothingMm2 = 1e6;
    const double sigma2 = spot.sigma_mm * spot.sigma_mm;
    Eigen::Matrix2d c = travel_covariance(spot, displacement, half_window_mm / std::sqrt(3.0));
    if (!c.allFinite() || c.trace() > kNothingMm2) c = kNothingMm2 * Eigen::Matrix2d::Identity();
    if (spot.weights.x() == spot.weights.z()) {
        spot.covariance_mm2 = c + spot.covariance_mm2.value_or(sigma2 * Eigen::Matrix2d::Identity());
    } else {
        const double worst = std::max(spot.weights.x() > 0 ? c(0, 0) : 0, spot.weights.z() > 0 ? c(1, 1) : 0);
        spot.sigma_mm = std::sqrt(sigma2 + worst);
    }
}

}  // namespace seamwright
