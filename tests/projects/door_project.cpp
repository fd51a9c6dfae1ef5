#include "tests/projects/door_project.h"

#include "devices/capture/capture.h"
#include "devices/exchange/pose_json.h"
#include "devices/registry.h"
#include "devices/simulated/scene/door.h"
#include "projects/reuse/simulated_truth.h"

namespace seamwright {

nlohmann::json cell_settings(const Pose& displacement) {
    return {
        {"seed", 5},
        {"part", {{"displacement", pose_json(displacement)}}},
        {"robot", {{"repeatability_mm", 0.02}, {"repeatability_deg", 0.001}, {"trigger_jitter_mm", 0.5}}}};
}

FeatureRecipe edge_recipe() {
    FeatureRecipe recipe;
    recipe.kind = "contour-end";
    recipe.parameters = {{"side", 0}, {"segment", 1}};
    return recipe;
}

Project door_project(const SimulatedCell& cell, const nlohmann::json& settings) {
    constexpr double kSigma_mm = 0.1;
    Project p = simulated_door_project(cell, "all", kSigma_mm);
    p.name = "door";
    SensorSetup& sensor = p.sensors.front();
    RobotSetup& robot = p.robots.front();
    sensor.settings = robot.settings = settings;
    DeviceSession session;
    sensor.identity = (*open_sensor("simulated", settings, session))->identity();
    robot.identity = *(*open_robot("simulated", settings, session))->identity();
    p.calibrations.front().sensor_identity = sensor.identity;
    p.calibrations.front().robot_identity = robot.identity;
    const auto doors = default_door_spots();
    for (std::size_t i = 0; i < p.spots.size(); ++i) {
        p.spots[i].entry_mm = doors[i].entry_mm;
        p.spots[i].exit_mm = doors[i].exit_mm;
    }
    return p;
}

}  // namespace seamwright
