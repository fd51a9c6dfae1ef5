#include "devices/simulated/scene/profile_cut.h"

#include <cmath>
#include <limits>

namespace seamwright {

void cut_profile(const MeshTree& part, const Pose& part_from_sensor, const OpticsSettings& optics,
                 Profile& profile) {
    const std::size_t n = static_cast<std::size_t>(optics.width);
    profile.clear();
    profile.x_mm.resize(n);
    profile.z_mm.resize(n);
    const Pose sensor_from_part = part_from_sensor.inverse();
    const Eigen::Vector3d laser = part_from_sensor * Eigen::Vector3d(0, 0, optics.stand_off_mm);
    const Eigen::Vector3d camera =
        part_from_sensor * sensor_model_of(optics).camera_from_laser.inverse().translation();
    for (std::size_t i = 0; i < n; ++i) {
        const double x = optics.field_mm * ((static_cast<double>(i) + 0.5) / static_cast<double>(n) - 0.5);
        const Eigen::Vector3d ray = (part_from_sensor * Eigen::Vector3d(x, 0, 0) - laser).normalized();
        profile.x_mm[i] = profile.z_mm[i] = std::numeric_limits<double>::quiet_NaN();
        const auto hit = part.first_hit(laser, ray, 0.4 * optics.stand_off_mm, 1.6 * optics.stand_off_mm);
        if (!hit) continue;
        const Eigen::Vector3d at = laser + hit->distance_mm * ray;
        if (part.blocked(camera, at, hit->triangle, 0.05)) continue;
        const Eigen::Vector3d p = sensor_from_part * at;
        profile.x_mm[i] = p.x();
        profile.z_mm[i] = p.z();
    }
}

void add_noise(Profile& profile, double sigma_mm, Random& random) {
    for (std::size_t i = 0; i < profile.size(); ++i) {
        if (!std::isfinite(profile.z_mm[i])) continue;
        profile.x_mm[i] += sigma_mm * random.normal();
        profile.z_mm[i] += sigma_mm * random.normal();
    }
}

}  // namespace seamwright
