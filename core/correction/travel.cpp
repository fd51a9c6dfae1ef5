#include "core/correction/travel.h"

#include <algorithm>

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

Eigen::Matrix2d travel_covariance(const SpotObservation& spot, const Displacement& displacement,
                                  double sigma_mm) {
    const Eigen::Vector3d direction = contour_direction(spot, displacement);
    const Eigen::Vector2d slope = sigma_mm * Eigen::Vector2d(direction.x(), direction.z());
    return slope * slope.transpose();
}

}  // namespace seamwright
