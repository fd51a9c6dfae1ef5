#include "devices/controllers/cyclic/simulated_path.h"

#include <cmath>

namespace seamwright {
namespace {
const Eigen::Matrix3d kPlane = rotation_exp({0.3, -0.2, 0.1});
}

constexpr double kLine = 4000;  // mm, one way

Pose SimulatedPath::at(double time_s) const {
    if (straight) {
        const double way = std::fmod(speed_mm_s * time_s, 2 * kLine);
        const double along = way <= kLine ? way : 2 * kLine - way;
        return make_pose(rotation_exp({kPi - 0.2, 0.1, 0.05}),
                         centre_mm + kPlane * Eigen::Vector3d(0, along, 0));
    }
    const double angle = speed_mm_s * time_s / radius_mm;
    const Eigen::Vector3d on_circle(radius_mm * std::cos(angle), radius_mm * std::sin(angle), 0);
    const Eigen::Matrix3d tool = rotation_exp({kPi - 0.2, 0.1 * std::sin(angle), 0.15 * std::cos(angle)});
    return make_pose(tool, centre_mm + kPlane * on_circle);
}

Eigen::Vector3d SimulatedPath::tangent(double time_s) const {
    if (straight)
        return kPlane * Eigen::Vector3d(0, std::fmod(speed_mm_s * time_s, 2 * kLine) <= kLine ? 1 : -1, 0);
    const double angle = speed_mm_s * time_s / radius_mm;
    return kPlane * Eigen::Vector3d(-std::sin(angle), std::cos(angle), 0);
}

}  // namespace seamwright
