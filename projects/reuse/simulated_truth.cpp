#include "projects/reuse/simulated_truth.h"

#include <fmt/format.h>

#include "devices/capture/capture.h"
#include "devices/exchange/files.h"
#include "devices/exchange/pose_json.h"
#include "devices/registry.h"
#include "devices/simulated/gripper_cell.h"
#include "devices/simulated/scene/door.h"
#include "devices/simulated/scene/mesh_file.h"

namespace seamwright {

Expected<Calibration> simulated_truth(const SensorSetup& sensor, const RobotSetup& robot) {
    if (!is_simulated_cell(sensor.driver) || !is_simulated_cell(robot.driver))
        return input_error("only a simulated cell knows its own calibration", Text("sensor {}", sensor.id),
                           "calibrate the sensor");
    SEAM_TRY(const auto cell, parse_cell_settings(sensor.settings));
    Calibration c;
    c.id = "simulated-truth";
    c.method = "simulated truth";
    c.sensor_id = sensor.id;
    c.robot_id = robot.id;
    c.sensor_identity = sensor.identity;
    c.robot_identity = robot.identity;
    c.created_utc = utc_now();
    c.source = "the simulated cell's own optics and mounting";
    c.model = sensor_model_of(cell.optics);
    c.flange_from_sensor = cell.flange_from_sensor;
    c.verdict = Verdict::good;
    return c;
}

Project simulated_door_project(const SimulatedCell& cell, const std::string& region_id, double sigma_mm) {
    Project p;
    p.part.base_from_workobject = cell.base_from_workobject();
    SensorSetup sensor;
    sensor.id = "A";
    sensor.driver = "simulated";
    sensor.calibration_id = "truth";
    RobotSetup robot;
    robot.id = "R1";
    robot.driver = "simulated";
    Calibration c;
    c.id = "truth";
    c.method = "simulated truth";
    c.sensor_id = sensor.id;
    c.robot_id = robot.id;
    c.model = cell.sensor_model();
    c.flange_from_sensor = cell.flange_from_sensor();
    c.verdict = Verdict::good;
    c.created_utc = utc_now();
    Region region;
    region.id = region_id;
    region.frame_name = "path";
    region.sigma_limit_mm = 1;
    region.sigma_limit_deg = 0.5;
    region.base_from_frame = p.part.base_from_workobject;
    for (const DoorSpot& door : default_door_spots()) {
        Spot s;
        s.id = door.id;
        s.sensor_id = sensor.id;
        s.robot_id = robot.id;
        s.base_from_flange = cell.flange_for(door.workobject_from_sensor);
        s.feature.kind = "contour-end";
        s.feature.parameters = {{"side", 0}, {"segment", 1}};  // the flange, not the inner panel behind it
        s.sigma_mm = sigma_mm;
        s.required = false;
        region.spot_ids.push_back(s.id);
        p.spots.push_back(std::move(s));
    }
    p.sensors = {std::move(sensor)};
    p.robots = {std::move(robot)};
    p.calibrations = {std::move(c)};
    p.regions = {std::move(region)};
    return p;
}

Expected<Project> simulated_panel_project(const nlohmann::json& given) {
    constexpr const char* kFrame = "panel";
    SEAM_TRY(const auto parsed, parse_gripper_settings(given));
    nlohmann::json settings = given;
    settings.erase("head");
    settings["robot"]["frames"][kFrame] = pose_json(parsed.base_from_opening);
    DeviceSession session;
    SEAM_TRY(auto cell, shared_gripper_cell(settings, session));

    Project p;
    p.name = "simulated panel";
    RobotSetup robot;
    robot.id = "R1";
    robot.driver = "simulated-gripper";
    robot.settings = settings;
    robot.identity = *make_gripper_robot(cell)->identity();
    for (const auto& [head, flange_from_sensor] : parsed.heads) {
        SensorSetup sensor;
        sensor.id = head;
        sensor.driver = "simulated-gripper";
        sensor.settings = settings;
        sensor.settings["head"] = head;
        sensor.identity = make_gripper_sensor(cell, head)->identity();
        Calibration c;
        c.id = sensor.calibration_id = "truth " + head;
        c.method = "simulated truth";
        c.sensor_id = head;
        c.robot_id = robot.id;
        c.sensor_identity = sensor.identity;
        c.robot_identity = robot.identity;
        c.created_utc = utc_now();
        c.source = "the simulated gripper's own optics and mounting";
        c.model = cell->sensor_model();
        c.flange_from_sensor = flange_from_sensor;
        c.verdict = Verdict::good;
        p.calibrations.push_back(std::move(c));
        p.sensors.push_back(std::move(sensor));
    }
    p.robots.push_back(robot);

    PanelJob job;
    job.id = "panel";
    job.robot_id = robot.id;
    job.base_from_gripper = parsed.base_from_opening;
    job.frame_name = kFrame;
    job.base_from_frame = parsed.base_from_opening;
    job.limits = {20, 2};
    for (const GripperPlace& place : default_gripper_places()) {
        PanelPlace out;
        out.id = place.id;
        out.sensor_id = "H" + place.id.substr(1);
        if (parsed.heads.count(out.sensor_id + "b")) out.second_sensor_id = out.sensor_id + "b";
        if (!parsed.heads.count(out.sensor_id)) continue;
        out.gauge.reference = GapFlushSettings::Reference::right;
        out.sigma_mm = 0.05;
        job.places.push_back(std::move(out));
    }
    p.panel_jobs.push_back(std::move(job));
    return p;
}

Expected<Project> simulated_gap_project(nlohmann::json settings, const std::vector<GapStation>& gap,
                                        const std::filesystem::path& mesh_file) {
    std::error_code failed;
    if (std::filesystem::exists(mesh_file, failed))
        return input_error("it is there already", mesh_file.string(), "give the project another name");
    Project p;
    p.name = "simulated gap";
    p.part.name = "two sheets with a gap";
    p.part.mesh_ply = ply_bytes(gap_part_mesh(gap));
    const std::string_view ply(reinterpret_cast<const char*>(p.part.mesh_ply.data()), p.part.mesh_ply.size());
    SEAM_OK(write_text_file(mesh_file, ply));
    settings["mesh"] = std::filesystem::absolute(mesh_file).string();
    settings["mesh_unit"] = "mm";
    SEAM_TRY(auto cell, SimulatedCell::open(settings));
    p.part.base_from_workobject = cell->base_from_workobject();
    SensorSetup sensor;
    sensor.id = "A";
    sensor.driver = "simulated";
    sensor.settings = settings;
    sensor.identity = make_simulated_sensor(cell)->identity();
    RobotSetup robot;
    robot.id = "R1";
    robot.driver = "simulated";
    robot.settings = settings;
    robot.identity = *make_simulated_robot(cell)->identity();
    SEAM_TRY(auto truth, simulated_truth(sensor, robot));
    sensor.calibration_id = truth.id;
    constexpr double kShares[] = {0.05, 0.4, 0.6, 0.95};
    for (const double share : kShares) {
        const double y = gap.front().y_mm + share * (gap.back().y_mm - gap.front().y_mm);
        Spot spot;
        spot.id = fmt::format("S{}", p.spots.size() + 1);
        spot.sensor_id = sensor.id;
        spot.robot_id = robot.id;
        spot.base_from_flange =
            cell->flange_for(make_pose(Eigen::Matrix3d::Identity(), {0, y, gap_at(gap, y).flush_mm / 2}));
        spot.feature.kind = "contour-end";
        spot.feature.parameters = {{"side", 1}};
        p.spots.push_back(std::move(spot));
    }
    p.sensors = {std::move(sensor)};
    p.robots = {std::move(robot)};
    p.calibrations = {std::move(truth)};
    return p;
}

}  // namespace seamwright
