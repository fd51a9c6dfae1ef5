#include "widgets/pages/teach_live.h"

#include <Eigen/Geometry>

#include "core/features/kinds/feature_registry.h"

namespace seamwright {

Expected<std::shared_ptr<const LiveSnapshot>> live_profile(Desk& desk, const std::string& sensor_id) {
    const Text where("sensor {}", sensor_id);
    const auto age = desk.live().age(sensor_id);
    auto snapshot = desk.live().latest(sensor_id);
    if (!snapshot || !age || snapshot->profile.size() == 0)
        return device_error("there is no live profile to point at", where,
                            "connect the devices and look at light and stand-off");
    if (*age > kStale)
        return device_error(Text("the profile is older than {} s", kStale.count() / 1000), where,
                            "wait until the sensor shows a new one");
    return snapshot;
}

Expected<void> stands_at(Desk& desk, const Spot& spot) {
    const Text where("robot {}", spot.robot_id);
    if (desk.worker().busy())
        return device_error("the robot moves for what is measured just now", where,
                            "wait until that is over");
    for (const RobotState& r : desk.station().robots) {
        if (r.id != spot.robot_id || !r.base_from_flange) continue;
        if (distance_mm(*r.base_from_flange, spot.base_from_flange) <= kAtSpotMm &&
            angle_rad(*r.base_from_flange, spot.base_from_flange) <= rad_from_deg(kAtSpotDeg))
            return {};
        return input_error(Text("the robot does not stand at spot {}", spot.id), where, "go there first");
    }
    return device_error("the robot tells no pose", where, "connect it");
}

Expected<Spot> with_landmark(const Spot& spot, const Profile& seen, const Eigen::Vector2d& at_mm) {
    const Text where("spot {}", spot.id);
    if (spot.feature.template_profile.size() == 0)
        return input_error("it has no template that could carry a reference point", where,
                           "drag its template first");
    SEAM_TRY(const auto finder, make_feature_finder(spot.feature));
    const Feature found = finder->find(seen);
    if (found.status != FeatureStatus::ok || !found.phi_rad)
        return input_error(Text("its template is not found in the live profile: {}", found.message), where,
                           "go to the spot and look whether the whole template is seen");
    Spot after = spot;
    after.feature.template_reference_mm +=
        Eigen::Rotation2Dd(-*found.phi_rad) * Eigen::Vector2d(at_mm - found.point_mm);
    return after;
}

}  // namespace seamwright
