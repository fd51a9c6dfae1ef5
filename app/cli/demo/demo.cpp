#include "app/cli/demo/demo.h"

#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <random>

#include "app/cli/demo/demo_detail.h"
#include "core/profile/taught_profile.h"
#include "core/system_text.h"
#include "devices/cell_server.h"
#include "devices/drawing/door_step.h"
#include "devices/exchange/files.h"
#include "devices/exchange/pose_json.h"
#include "devices/exchange/tables/path_csv.h"
#include "devices/net/socket.h"
#include "devices/silence.h"
#include "devices/simulated/scene/door.h"
#include "projects/file/project_file.h"
#include "projects/measure/measure.h"
#include "projects/station/acquire.h"
#include "projects/station/station.h"
#include "projects/station/teach.h"

namespace seamwright::cli {
namespace {

constexpr double kCurveTravelMm = 20;
constexpr int kMostPresses = 3;  // of a person who teaches a spot
constexpr double kPassStepMm = 4;
constexpr const char* kSensor = "A";
constexpr const char* kRobot = "R1";
constexpr int kUsualRobotPort = 54600;  // of kuka-eki

struct Devices {
    std::unique_ptr<ProfileSource> sensor;
    std::unique_ptr<RobotLink> robot;
};

// The devices go before the server that they talk to.
struct ServedDemo {
    std::optional<CellServer> server;
    nlohmann::json sensor_settings, robot_settings;
    Devices devices;
};

// The robot's link and the settings that it listens with. Where no port is asked for: the usual one, else one
// that the system calls free; another program may take it before the link does, then the next.
Expected<ServedDemo> listen_for_robot(const DemoOptions& options, DeviceSession& session) {
    for (int attempt = 0;; ++attempt) {
        int port = options.robot_port;
        if (port == 0 && attempt == 0) port = kUsualRobotPort;
        if (port == 0) {
            SEAM_TRY(auto listener, TcpListener::listen("127.0.0.1", 0));
            port = listener.port();
        }
        const nlohmann::json settings = {{"port", port}};
        auto robot = open_robot("kuka-eki", settings, session);
        if (robot) return ServedDemo{{}, {}, settings, {nullptr, std::move(*robot)}};
        if (options.robot_port != 0 || attempt == 20) return tl::unexpected(robot.error());
    }
}

Expected<ServedDemo> serve_demo(const DemoOptions& options, const std::shared_ptr<SimulatedCell>& cell) {
    DeviceSession session;
    auto demo = listen_for_robot(options, session);
    if (!demo) return demo;
    CellServerOptions serve;
    serve.camera_address = options.camera_address;
    nlohmann::json controller = demo->robot_settings;
    controller["time_scale"] = 8;  // a pace that the camera can follow
    serve.controllers = {{"kuka-eki", controller}};
    SEAM_TRY(auto server, CellServer::start(serve, cell));
    demo->server.emplace(std::move(server));
    demo->sensor_settings = {{"address", demo->server->camera_address()}, {"hardware_trigger", true}};
    nlohmann::json patient = demo->sensor_settings;
    patient["timeout_ms"] = std::chrono::milliseconds(kDrawing).count();
    SEAM_TRY(auto sensor, open_sensor("genicam", patient, session));
    demo->devices.sensor = std::move(sensor);
    return demo;
}

std::string frame_name(const std::string& region_id) {
    return "BASE_" + region_id;
}

// A person presses again where reflections have spoiled the measurements, or where the cell still draws; what stays so
// is told.
Expected<seamwright::TaughtSpot> teach_again(Station& station, const Spot& spot,
                                             const TeachOptions& options) {
    const auto until = std::chrono::steady_clock::now() + kDrawing;
    for (int presses = 1;; ++presses) {
        auto taught = teach_spot(station, spot, options);
        if (!taught && is_silence(taught.error()) && std::chrono::steady_clock::now() < until) {
            --presses;
            continue;
        }
        if (taught || presses == kMostPresses || taught.error().kind != ErrorKind::input) return taught;
    }
}

// A spot of the door: first the edge by its contour end, then the hem around it as template with the edge as
// landmark, then the pass that shows whether the contour stands still and how it curves.
Expected<DemoTaughtSpot> teach(Station& station, const Pose& base_from_flange, const DoorSpot& door,
                               Spot& spot) {
    spot.id = door.id;
    spot.sensor_id = kSensor;
    spot.robot_id = kRobot;
    spot.base_from_flange = base_from_flange;
    spot.entry_mm = std::min(door.entry_mm, kCurveTravelMm);
    spot.exit_mm = std::min(door.exit_mm, kCurveTravelMm);
    spot.sigma_mm = 0.04;
    spot.jitter_mm = 3;
    spot.feature.kind = "contour-end";
    spot.feature.parameters = {{"side", 0.0}};
    const TeachOptions repeated;
    SEAM_TRY(auto edge, teach_again(station, spot, repeated));
    const double x = edge.spot.reference_mm.x(), z = edge.spot.reference_mm.z();
    spot.feature.kind = "template";
    spot.feature.parameters = {{"window_dx_mm", 20}, {"window_dz_mm", 20}, {"window_dphi_deg", 5}};
    spot.feature.template_profile = cut_out(edge.mean, x - 1, x + 40);
    spot.feature.template_reference_mm = {x, z};
    SEAM_TRY(auto taught, teach_again(station, spot, repeated));
    spot = taught.spot;
    PassOptions passing;
    passing.step_mm = kPassStepMm;
    SEAM_TRY(auto pass, record_pass(station, spot, passing));
    AlignmentOptions alignment;
    alignment.jitter_mm = spot.jitter_mm;
    SEAM_TRY(auto frozen, check_alignment(pass.profiles, alignment));
    SEAM_TRY(auto curve, fit_contour_curve(pass.references));
    spot.curve = curve;
    return DemoTaughtSpot{spot.id, taught.spread_mm, frozen, alignment};
}

// Deviation of a taught point (work object): what is left between the frame on the controller and the part's
// true place, in the directions across the edge.
DemoDeviation deviation(const SimulatedCell& cell, const Region& region, const Pose& pushed,
                        const Eigen::Vector3d& point_mm, const Eigen::Vector3d& across,
                        const Eigen::Vector3d& up) {
    const Pose& base_from_workobject = cell.base_from_workobject();
    const Eigen::Vector3d truth = base_from_workobject * cell.displaced(point_mm);
    const Eigen::Vector3d taught = base_from_workobject * point_mm;
    const Eigen::Vector3d corrected = pushed * (region.base_from_frame.inverse() * taught);
    const Eigen::Matrix3d workobject_from_base = base_from_workobject.linear().transpose();
    const Eigen::Vector3d before = workobject_from_base * (truth - taught);
    const Eigen::Vector3d after = workobject_from_base * (truth - corrected);
    DemoDeviation d;
    d.region_id = region.id;
    d.before_mm = {before.dot(across), before.dot(up)};
    d.after_mm = {after.dot(across), after.dot(up)};
    return d;
}

// The bead as the application was taught it, for `seamwright path`: tool Z into the sheet, X along the path.
std::string taught_bead(const SimulatedCell& cell) {
    const std::vector<Eigen::Vector3d> bead = door_bead_path(10);
    ApplicationPath path;
    path.regions_named = true;
    for (std::size_t i = 0; i < bead.size(); ++i) {
        Eigen::Matrix3d axes;
        axes.col(0) = (bead[(i + 1) % bead.size()] - bead[(i + bead.size() - 1) % bead.size()]).normalized();
        axes.col(2) = -Eigen::Vector3d::UnitZ();
        axes.col(1) = axes.col(2).cross(axes.col(0));
        path.points.push_back(
            {cell.base_from_workobject() * make_pose(axes, bead[i]), door_side_of(bead[i])});
    }
    return path_csv(path, PathNotation::kuka);
}

PartState next_part(std::mt19937_64& random, bool bent) {
    std::uniform_real_distribution<double> unit(-1, 1);
    Eigen::Vector3d t, w;
    for (int i = 0; i < 3; ++i) t[i] = 10 * unit(random);
    for (int i = 0; i < 3; ++i) w[i] = rad_from_deg(0.6 * unit(random));
    PartState part;
    part.workobject_from_movedworkobject = make_pose(rotation_exp(w), t);
    part.bend = {0.3 * unit(random), 0.2 * unit(random)};
    if (!bent) part.bend = {};
    return part;
}

nlohmann::json cell_settings(const DemoOptions& options) {
    // A board that stays in the field of view when the sensor tilts over it.
    nlohmann::json settings = {{"seed", options.seed},
                               {"board", {{"columns", 7}, {"rows", 6}, {"pitch_mm", 7}}}};
    for (const DoorRegion& region : dense_door_regions())  // the frames that the application program runs in
        settings["robot"]["frames"][frame_name(region.id)] =
            pose_json(default_cell_settings().base_from_workobject);
    if (options.without.contains(DemoSource::noise)) {
        settings["noise"] = {
            {"shot", false}, {"read_electrons", 0}, {"speckle", 0}, {"stray_probability", 0}};
        settings["surface"] = {{"dark_share", 0}};
    }
    if (options.without.contains(DemoSource::repeatability))
        settings["robot"]["repeatability_mm"] = settings["robot"]["repeatability_deg"] = 0;
    if (options.without.contains(DemoSource::jitter)) settings["robot"]["trigger_jitter_mm"] = 0;
    return settings;
}

// What a perfect calibration would find.
DemoCalibration true_calibration(const SimulatedCell& cell) {
    DemoCalibration demo;
    demo.calibration.model = cell.sensor_model();
    demo.calibration.flange_from_sensor = cell.flange_from_sensor();
    demo.calibration.method = "simulated truth";
    demo.calibration.verdict = Verdict::good;
    return demo;
}

}  // namespace

Expected<void> judge(const SimulatedCell& cell, const Project& project, RobotLink& robot, DemoPart& part) {
    for (const Region& region : project.regions) {
        SEAM_TRY(auto pushed, robot.read_frame(region.frame_name));
        for (const DoorSpot& spot : dense_door_spots()) {
            if (door_side_of(spot.workobject_from_sensor.translation()) != region.id) continue;
            const Eigen::Matrix3d axes = spot.workobject_from_sensor.linear();
            part.spots.push_back(deviation(cell, region, pushed, spot.workobject_from_sensor * spot.edge_mm,
                                           axes.col(0), axes.col(2)));
            part.spots.back().arc_mm = static_cast<double>(part.spots.size() - 1);
        }
        const std::vector<Eigen::Vector3d> path = door_bead_path(10);
        for (std::size_t i = 0; i < path.size(); ++i) {
            if (door_side_of(path[i]) != region.id) continue;
            const Eigen::Vector3d along =
                (path[(i + 1) % path.size()] - path[(i + path.size() - 1) % path.size()]).normalized();
            const Eigen::Vector3d across = Eigen::Vector3d::UnitZ().cross(along).normalized();
            part.path.push_back(deviation(cell, region, pushed, path[i], across, along.cross(across)));
            part.path.back().arc_mm = 10.0 * static_cast<double>(i);
        }
    }
    return {};
}

Expected<void> reset_frames(RobotLink& robot, const Project& project) {
    for (const Region& region : project.regions)
        SEAM_OK(robot.write_frame(region.frame_name, region.base_from_frame));
    return {};
}

std::string_view to_string(DemoSource source) {
    switch (source) {
        case DemoSource::calibration:
            return "calibration";
        case DemoSource::noise:
            return "noise";
        case DemoSource::repeatability:
            return "repeatability";
        case DemoSource::jitter:
            return "jitter";
        case DemoSource::bend:
            return "bend";
    }
    return "";
}

void DeviationTally::add(const DemoDeviation& d) {
    before_max_mm = std::max(before_max_mm, d.before_mm.norm());
    after_max_mm = std::max(after_max_mm, d.after_mm.norm());
    for (double v : d.after_mm) n += 1, sum += v, squares += v * v;
}

DemoStatistic DeviationTally::statistic(const std::string& region_id) const {
    DemoStatistic row;
    row.region_id = region_id;
    row.before_max_mm = before_max_mm;
    row.after_max_mm = after_max_mm;
    if (n > 1) {
        row.after_mean_mm = sum / n;
        row.after_three_sigma_mm = 3 * std::sqrt(std::max(0.0, (squares - sum * sum / n) / (n - 1)));
    }
    return row;
}

void add(const DemoOutcome& outcome, std::vector<DemoDeviation> DemoPart::*which,
         std::vector<std::pair<std::string, DeviationTally>>& tallies) {
    const auto of = [&](const std::string& name) -> DeviationTally& {
        for (auto& [known, tally] : tallies)
            if (known == name) return tally;
        return tallies.emplace_back(name, DeviationTally{}).second;
    };
    for (const Region& r : outcome.project.regions) of(r.id);
    of("all");
    for (const DemoPart& part : outcome.parts)
        if (part.pushed())
            for (const DemoDeviation& d : part.*which) of(d.region_id).add(d), of("all").add(d);
}

DemoStatistic statistic_of(const std::vector<DemoPart>& parts, const std::string& region_id,
                           std::vector<DemoDeviation> DemoPart::*which) {
    DeviationTally tally;
    for (const DemoPart& part : parts)
        if (part.pushed())
            for (const DemoDeviation& d : part.*which)
                if (d.region_id == region_id) tally.add(d);
    return tally.statistic(region_id);
}

std::vector<DemoStatistic> statistics(const DemoOutcome& outcome,
                                      std::vector<DemoDeviation> DemoPart::*which) {
    std::vector<std::pair<std::string, DeviationTally>> tallies;
    add(outcome, which, tallies);
    std::vector<DemoStatistic> rows;
    for (const auto& [name, tally] : tallies) rows.push_back(tally.statistic(name));
    return rows;
}

Expected<DemoOutcome> run_demo(const DemoOptions& options,
                               const std::function<void(const std::string&)>& progress) {
    const auto start = std::chrono::steady_clock::now();
    std::error_code failed;
    std::filesystem::create_directories(options.folder, failed);
    if (failed)
        return file_error(Text("the folder cannot be made: {}", system_text(failed)),
                          options.folder.string());

    DemoOutcome outcome;
    outcome.project_file = options.folder / "demo.seam";
    outcome.report_file = options.folder / "report.html";
    nlohmann::json settings = cell_settings(options);
    SEAM_TRY(auto opened, SimulatedCell::open(settings));
    const std::shared_ptr<SimulatedCell> cell = opened;
    SimulatedCell& world = *cell;
    Expected<ServedDemo> served =
        ServedDemo{{}, settings, settings, {make_simulated_sensor(cell), make_simulated_robot(cell)}};
    if (options.loopback) served = serve_demo(options, cell);
    if (!served) return tl::unexpected(served.error());
    if (options.loopback) {
        const std::string controller = fmt::format("kuka-eki:{}", served->robot_settings["port"].get<int>());
        progress(
            fmt::format("camera on {}, robot controller {}", served->server->camera_address(), controller));
        settings["serve"] = {{"camera", served->server->camera_address()}, {"controllers", {controller}}};
    }
    // For `seamwright sim-cell`: the same cell again, for further runs of the project.
    SEAM_OK(write_text_file(options.folder / "cell.json", settings.dump(2)));

    progress("calibrating the sensor on plate and sphere");
    world.set_mode(RobotMode::manual_reduced);  // moved by command while calibrating and teaching
    Project& project = outcome.project;
    project.name = "Demo: door left";
    project.part = {"door left", "procedural door", {}, world.base_from_workobject()};
    SensorSetup sensor_setup;
    sensor_setup.id = kSensor;
    sensor_setup.driver = options.loopback ? "genicam" : "simulated";
    sensor_setup.settings = served->sensor_settings;
    RobotSetup robot_setup;
    robot_setup.id = kRobot;
    robot_setup.driver = options.loopback ? "kuka-eki" : "simulated";
    robot_setup.settings = served->robot_settings;
    robot_setup.required_mode = RobotMode::automatic;
    sensor_setup.identity = served->devices.sensor->identity();
    SEAM_TRY(auto identity, served->devices.robot->identity());
    robot_setup.identity = identity;
    SEAM_TRY(auto calibrated,
             options.without.contains(DemoSource::calibration)
                 ? Expected<DemoCalibration>(true_calibration(world))
                 : calibrate_demo_sensor(world, *served->devices.sensor, *served->devices.robot));
    outcome.calibration = std::move(calibrated);
    if (options.parts == 0) return outcome;
    Calibration& calibration = outcome.calibration.calibration;
    calibration.id = "cal-1";
    calibration.sensor_id = kSensor;
    calibration.robot_id = kRobot;
    calibration.sensor_identity = sensor_setup.identity;
    calibration.robot_identity = robot_setup.identity;
    calibration.created_utc = utc_now();
    sensor_setup.calibration_id = calibration.id;
    project.sensors = {sensor_setup};
    project.robots = {robot_setup};
    project.calibrations = {calibration};

    SEAM_TRY(auto file, ProjectFile::create(outcome.project_file, project, true));
    Station station(std::move(file), project);
    world.set_scene(Scene::part);
    std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
    std::map<std::string, std::unique_ptr<RobotLink>> robots;
    sensors[kSensor] = std::move(served->devices.sensor);
    robots[kRobot] = std::move(served->devices.robot);
    station.connect(std::move(sensors), std::move(robots));

    for (const DoorSpot& door : dense_door_spots()) {
        progress("teaching spot " + door.id);
        Spot spot;
        SEAM_TRY(auto taught, teach(station, world.flange_for(door.workobject_from_sensor), door, spot));
        outcome.taught.push_back(std::move(taught));
        project.spots.push_back(std::move(spot));
    }
    for (const DoorRegion& door : dense_door_regions()) {
        Region region;
        region.id = door.id;
        region.spot_ids = door.spot_ids;
        region.frame_name = frame_name(door.id);
        region.base_from_frame = project.part.base_from_workobject;
        project.regions.push_back(region);
    }
    SEAM_OK(station.edit(project));
    for (const DemoTaughtSpot& spot : outcome.taught)
        if (auto kept = station.file().append_evidence(
                {0, {}, 0, frozen_contour(spot.id, spot.alignment, spot.judged_by)}, project);
            !kept)
            return tl::unexpected(kept.error());
    SEAM_TRY(const auto drawing, door_step());
    SEAM_OK(write_text_file(options.folder / "door.step", drawing));
    SEAM_OK(write_text_file(options.folder / "bead.csv", taught_bead(world)));
    world.store_program(measuring_program(project, kRobot));  // loaded on the controller
    world.set_mode(RobotMode::automatic);
    for (const Region& region : project.regions) {
        SEAM_TRY(auto plan,
                 plan_region(planned_observations(project, region), correction_options(project, region)));
        outcome.plans.push_back(std::move(plan));
    }

    RobotLink& robot = *station.robot(kRobot);
    SEAM_OK(reset_frames(robot, project));
    for (int i = 0; i < 3; ++i) {
        progress(fmt::format("zero shift, run {} of 3", i + 1));
        RunOptions run;
        run.limits.frame_timeout = kDrawing;
        run.part_id = fmt::format("master {}", i + 1);
        SEAM_TRY(auto record, station.run(run));
        record.captures.clear();
        outcome.zero_shift.push_back(std::move(record));
    }
    std::mt19937_64 random(options.seed);
    for (int i = 0; i < options.parts; ++i) {
        progress(fmt::format("part {} of {}: displaced, measured, corrected, pushed", i + 1, options.parts));
        DemoPart part;
        part.truth = next_part(random, !options.without.contains(DemoSource::bend));
        world.set_part(part.truth);
        SEAM_OK(reset_frames(robot, project));
        RunOptions run;
        run.limits.frame_timeout = kDrawing;
        run.part_id = fmt::format("CAR-{:04}", i + 1);
        run.push = true;
        SEAM_TRY(auto record, station.run(run));
        record.captures.clear();
        part.run = std::move(record);
        SEAM_OK(judge(world, project, robot, part));
        outcome.parts.push_back(std::move(part));
    }
    outcome.cell = world.describe();
    if (options.offline) {
        station.disconnect();
        SEAM_TRY(outcome.offline, run_offline(
                                      options, outcome, world, drawing,
                                      [&](Station& copy) -> Expected<void> {
                                          if (options.loopback) return copy.connect();
                                          std::map<std::string, std::unique_ptr<ProfileSource>> again;
                                          std::map<std::string, std::unique_ptr<RobotLink>> links;
                                          again[kSensor] = make_simulated_sensor(cell);
                                          links[kRobot] = make_simulated_robot(cell);
                                          copy.connect(std::move(again), std::move(links));
                                          return {};
                                      },
                                      progress));
    }
    outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return outcome;
}

}  // namespace seamwright::cli
