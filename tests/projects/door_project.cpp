#include "tests/projects/door_project.h"

#include "devices/capture/capture.h"
#include "devices/exchange/pose_json.h"
#include "devices/registry.h"
#include "devices/simulated/scene/door.h"

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
    Project p;
    p.name = "door";
    p.part.base_from_workobject = cell.base_from_workobject();
    SensorSetup sensor;
    sensor.id = "A";
    sensor.driver = "simulated";
    sensor.settings = settings;
    sensor.calibration_id = "truth";
    RobotSetup robot;
    robot.id = "R1";
    robot.driver = "simulated";
    robot.settings = settings;
    DeviceSession session;
    sensor.identity = (*open_sensor("simulated", settings, session))->identity();
    robot.identity = *(*open_robot("simulated", settings, session))->identity();
    Calibration c;
    c.id = "truth";
    c.method = "simulated truth";
    c.sensor_id = "A";
    c.robot_id = "R1";
    c.sensor_identity = sensor.identity;
    c.robot_identity = robot.identity;
    c.model = cell.sensor_model();
    c.flange_from_sensor = cell.flange_from_sensor();
    c.verdict = Verdict::good;
    c.created_utc = utc_now();
    p.sensors = {sensor};
    p.robots = {robot};
    p.calibrations = {c};
    Region region;
    region.id = "all";
    region.frame_name = "path";
    region.sigma_limit_mm = 1;
    region.sigma_limit_deg = 0.5;
    region.base_from_frame = p.part.base_from_workobject;
    for (const DoorSpot& door : default_door_spots()) {
        Spot s;
        s.id = door.id;
        s.sensor_id = "A";
        s.robot_id = "R1";
        s.base_from_flange = cell.flange_for(door.workobject_from_sensor);
        s.entry_mm = door.entry_mm;
        s.exit_mm = door.exit_mm;
        s.feature = edge_recipe();
        s.sigma_mm = 0.1;
        s.required = false;
        p.spots.push_back(s);
        region.spot_ids.push_back(s.id);
    }
    p.regions = {region};
    return p;
}

}  // namespace seamwright
