#include "projects/ahead/simulated_seam.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "devices/capture/capture.h"
#include "devices/controllers/abb/egm_controller.h"
#include "devices/controllers/kuka/rsi_controller.h"
#include "devices/exchange/pose_json.h"
#include "devices/net/socket.h"
#include "devices/registry.h"
#include "devices/simulated/scene/door.h"
#include "projects/reuse/simulated_truth.h"

namespace seamwright {
namespace {

constexpr double kBeadInboardMm = 10.5,
                 kLandMm = -0.8;         // of the bead; of the land against the flange's top (door.h)
constexpr double kSensorInboardMm = 15;  // of the sensor's origin (DoorSpot)
constexpr const char* kFollowedSpot = "T2";
constexpr double kRimMm = 42;
constexpr double kGuideMarginMm = 20, kTeachStepMm = 1;
constexpr double kLeadIn_s = 0.6;  // of the controller with EGM (egm_application.h)
constexpr double kStandsMm = 1e-4;

Eigen::Vector3d bead_at(double arc_mm) {
    const DoorEdge e = door_edge(arc_mm);
    return e.point_mm + kBeadInboardMm * e.inboard + (kDoorFlangeTop_mm + kLandMm) * e.up;
}

double upper_side_arc_mm() {
    const auto spots = default_door_spots();
    const auto t2 =
        std::find_if(spots.begin(), spots.end(), [](const DoorSpot& s) { return s.id == kFollowedSpot; });
    double best = 0, least = 1e9;
    for (double arc = 0; arc < door_edge_length_mm(); arc += 1) {
        const double d = (door_edge(arc).point_mm - t2->workobject_from_sensor.translation()).norm();
        if (d < least) {
            least = d;
            best = arc;
        }
    }
    return best;
}

// The tip on the bead, Y towards the bead `look_ahead_mm` farther on: clockwise, with X inboard (DoorSpot).
Pose workobject_from_tcp(double arc_mm, double look_ahead_mm) {
    const Eigen::Vector3d tip = bead_at(arc_mm);
    Eigen::Matrix3d axes;
    axes.col(1) = (bead_at(arc_mm - look_ahead_mm) - tip).normalized();
    axes.col(0) = axes.col(1).cross(door_edge(arc_mm).up).normalized();
    axes.col(2) = axes.col(0).cross(axes.col(1));
    return make_pose(axes, tip);
}

Spot& followed_spot(Project& project) {
    return *std::find_if(project.spots.begin(), project.spots.end(),
                         [](const Spot& s) { return s.id == kFollowedSpot; });
}

// The rim from its edge to the ramp. A line of the sensor is 0.16 mm wide, and a contour's end is known no better: where
// the sensor rides along with the contour, that error does not average out. The whole shape does not know it.
FeatureRecipe rim_template(const Profile& seen) {
    FeatureRecipe recipe;
    recipe.kind = "template";
    double left = 1e9;
    for (std::size_t i = 0; i < seen.size(); ++i)
        if (seen.segment[i] != kOutlier) left = std::min(left, seen.x_mm[i]);
    Profile& piece = recipe.template_profile;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        if (seen.segment[i] == kOutlier || seen.x_mm[i] > left + kRimMm) continue;
        piece.x_mm.push_back(seen.x_mm[i]);
        piece.z_mm.push_back(seen.z_mm[i]);
        piece.segment.push_back(seen.segment[i]);
    }
    if (piece.size() > 0)
        recipe.template_reference_mm = {piece.x_mm[piece.size() / 2], piece.z_mm[piece.size() / 2]};
    return recipe;
}

std::uint16_t free_tcp_port() {
    return TcpListener::listen("127.0.0.1", 0)->port();
}

}  // namespace

SimulatedSeam::~SimulatedSeam() {
    if (station_) station_->disconnect();
}

Expected<std::unique_ptr<SimulatedSeam>> SimulatedSeam::make(const SimulatedSeamOptions& options,
                                                             const std::filesystem::path& file) {
    const bool rsi = options.driver == "kuka-rsi";
    if (!rsi && options.driver != "abb-egm")
        return usage_error(Text("\"{}\" is no controller with a correction in every cycle", options.driver),
                           "controller", "kuka-rsi or abb-egm");
    if (!(options.speed_mm_s > 0 && options.length_mm >= 100 && options.length_mm <= 500 &&
          options.look_ahead_mm >= 10 && options.look_ahead_mm <= 100))
        return usage_error("the seam is none (100 to 500 mm long, the sensor 10 to 100 mm ahead)", "seam");
    std::unique_ptr<SimulatedSeam> seam(new SimulatedSeam());
    seam->options_ = options;
    const nlohmann::json frame = pose_json(default_cell_settings().base_from_workobject);
    SEAM_TRY(seam->cell_, SimulatedCell::open({{"seed", options.seed},
                                               {"optics", {{"width", 640}, {"height", 512}}},
                                               {"buffers", 64},
                                               {"robot",
                                                {{"repeatability_mm", 0.01},
                                                 {"repeatability_deg", 0.001},
                                                 {"trigger_jitter_mm", 0.5},
                                                 {"frames", {{"path", frame}}}}}}));
    const std::shared_ptr<SimulatedCell>& cell = seam->cell_;
    const auto make_sensor = [&]() -> std::unique_ptr<ProfileSource> {
        return options.sensor ? options.sensor(cell) : make_simulated_sensor(cell);
    };
    constexpr double kPartsBend_mm = 0.4;
    Project project = simulated_door_project(*cell, "seam", kPartsBend_mm);
    project.name = "simulated seam";
    if (options.sensor) project.calibrations.front().model.reset();  // its profiles are in mm
    RobotSetup& robot = project.robots.front();

    // The path, and how the tool stands to the sensor.
    const Pose tcp_from_sensor = make_pose(
        Eigen::Matrix3d::Identity(), {kSensorInboardMm - kBeadInboardMm, options.look_ahead_mm, -kLandMm});
    const Pose flange_from_tcp = cell->flange_from_sensor() * tcp_from_sensor.inverse();
    const double begin = upper_side_arc_mm() + options.length_mm / 2;
    nlohmann::json path = nlohmann::json::array();
    for (double s = 0; s <= options.length_mm + 1e-9; s += 2)
        path.push_back(
            pose_json(cell->base_from_workobject() * workobject_from_tcp(begin - s, options.look_ahead_mm)));
    const std::uint16_t port = UdpSocket::bind("127.0.0.1", 0)->port(), tcp = free_tcp_port();
    const nlohmann::json measuring = {{"driver", rsi ? "kuka-eki" : "abb-rapid"},
                                      {"settings", {{"port", tcp}}}};
    robot.driver = options.driver;
    robot.settings = {{"port", port},
                      {"cycle_ms", options.cycle_ms},
                      {"frames", {{"path", {{"base_from_frame", frame}}}}},
                      {"flange_from_tcp", pose_json(flange_from_tcp)},
                      {"max_translation_mm", 25},
                      {"max_rotation_deg", 3},
                      {"max_late", 100},
                      {"session_gap_ms", 2000},
                      {"measuring", measuring}};
    if (!rsi) robot.settings.update({{"speed_mm_s", 40}, {"acceleration_mm_s2", 400}});
    robot.settings.update(options.link);

    SEAM_TRY(auto created, ProjectFile::create(file, project, true));
    seam->station_.emplace(std::move(created), project);
    Station& station = *seam->station_;

    // The guide: driven step by step over the undisplaced door.
    {
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        sensors["A"] = make_sensor();
        robots["R1"] = make_simulated_robot(cell);
        station.connect(std::move(sensors), std::move(robots));
        DrivenGapPass drive;
        drive.sensor_id = "A";
        drive.robot_id = "R1";
        drive.step_mm = kTeachStepMm;
        for (double s = -kGuideMarginMm - options.look_ahead_mm; s <= options.length_mm + kGuideMarginMm;
             s += 10)
            drive.stands.push_back(cell->base_from_workobject() *
                                   workobject_from_tcp(begin - s, options.look_ahead_mm) *
                                   flange_from_tcp.inverse());
        SEAM_TRY(const auto pass, gap_pass(station, drive));
        project = station.project();
        followed_spot(project).feature = rim_template(pass.sections[pass.sections.size() / 2].profile);
        SEAM_OK(station.edit(project));
        SEAM_TRY(const auto guide, taught_guide(project, kFollowedSpot, pass));
        seam->follow_.guide_csv = guide_csv(guide);
        station.disconnect();
    }
    seam->follow_.region_id = "seam";
    seam->follow_.spot_id = kFollowedSpot;
    seam->follow_.guide_name = "the pass over the undisplaced part";

    cell->store_program(measuring_program(project, "R1"));
    nlohmann::json controller = {
        {"port", port},
        {"cycle_ms", options.cycle_ms},
        {"path", path},
        {"flange_from_tcp", pose_json(flange_from_tcp)},
        {"speed_mm_s", options.speed_mm_s},
        {"path_s", options.length_mm / options.speed_mm_s - (rsi ? 0 : kLeadIn_s)},
        {"restart_ms", rsi ? 1000 : 5000},
        {"max_translation_mm", 30},
        {"measuring", {{"driver", measuring["driver"]}, {"settings", {{"port", tcp}, {"time_scale", 40}}}}}};
    controller.update(options.controller);
    DeviceSession session;
    std::unique_ptr<RobotLink> link;
    const auto open_link = [&]() -> Expected<void> {
        SEAM_TRY(link, open_robot(options.driver, robot.settings, session));
        if (options.wire) controller["port"] = options.wire(port);
        return {};
    };
    // Who listens begins: EKI's client is the robot, the server on an ABB the controller.
    if (rsi) SEAM_OK(open_link());
    if (!rsi && options.wire) controller["port"] = options.wire(port);
    SEAM_TRY(seam->controller_, start_controller(options.driver, cell, controller));
    if (!rsi) {
        SEAM_TRY(link, open_robot(options.driver, robot.settings, session));
    }
    constexpr int kTries = 100;
    for (int i = 0; i < kTries && !link->identity(); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
    std::map<std::string, std::unique_ptr<RobotLink>> robots;
    sensors["A"] = make_sensor();
    robots["R1"] = std::move(link);
    station.connect(std::move(sensors), std::move(robots));

    project = station.project();
    project.calibrations[0].sensor_identity = project.sensors[0].identity;
    project.calibrations[0].robot_identity = project.robots[0].identity;
    SEAM_OK(station.edit(project));
    SEAM_TRY(const auto taught, station.run({}));
    if (taught.status == RunStatus::device) return device_error(taught.message, "simulated seam");
    for (std::size_t i = 0; i < project.spots.size(); ++i)
        if (taught.spots[i].status == SpotStatus::measured)
            project.spots[i].reference_mm = taught.spots[i].measured_mm;
    SEAM_OK(station.edit(project));
    return seam;
}

std::vector<SeamSample> SimulatedSeam::history() const {
    std::vector<SeamSample> out;
    const auto take = [&](const auto& samples) {
        for (const auto& s : samples) out.push_back({s.programmed, s.corrected});
    };
    if (options_.driver == "kuka-rsi")
        take(static_cast<SimulatedRsi&>(*controller_).history());
    else
        take(static_cast<SimulatedEgm&>(*controller_).history());
    return out;
}

std::uint64_t SimulatedSeam::stops() const {
    return options_.driver == "kuka-rsi" ? static_cast<SimulatedRsi&>(*controller_).stops()
                                         : static_cast<SimulatedEgm&>(*controller_).stops();
}

SeamErrors judge_seam(SimulatedSeam& seam, const Pose& base_from_moved, double run_in_mm) {
    const std::vector<SeamSample> all = seam.history();
    // The longest stretch of cycles with motion.
    std::size_t first = 0, count = 0;
    for (std::size_t i = 0; i + 1 < all.size();) {
        std::size_t k = i;
        while (k + 1 < all.size()) {
            const double step = distance_mm(all[k + 1].programmed, all[k].programmed);
            if (step < kStandsMm || step > run_in_mm) break;
            ++k;
        }
        if (k - i > count) {
            first = i;
            count = k - i;
        }
        i = std::max(k, i + 1);
    }
    std::vector<GuidePoint> bead;
    const double middle = upper_side_arc_mm();
    const PartState part = seam.cell().part();
    for (double s = -400; s <= 400; s += 2)
        bead.push_back({seam.cell().displaced(bead_at(middle + s)),
                        part.workobject_from_movedworkobject.linear() * door_edge(middle + s).up});
    SeamErrors out;
    const auto truth = GuideCurve::make(bead);
    if (!truth) return out;
    const Pose workobject_from_base = seam.cell().base_from_workobject().inverse();
    std::vector<double> pooled[3];
    SeamWay* ways[3] = {&out.without, &out.frame, &out.online};
    for (std::size_t i = first; i < first + count; ++i) {
        const SeamSample& s = all[i];
        out.travelled_mm += i > first ? distance_mm(s.programmed, all[i - 1].programmed) : 0;
        if (out.travelled_mm < run_in_mm) continue;
        ++out.cycles;
        const Eigen::Vector3d tips[3] = {s.programmed.translation(),
                                         base_from_moved * s.programmed.translation(),
                                         s.corrected.translation()};
        for (int k = 0; k < 3; ++k) {
            const Eigen::Vector2d off = truth->foot(workobject_from_base * tips[k]).off_mm;
            pooled[k].push_back(off.x());
            pooled[k].push_back(off.y());
            ways[k]->worst_mm = std::max(ways[k]->worst_mm, off.norm());
        }
    }
    for (int k = 0; k < 3; ++k)
        if (!pooled[k].empty()) ways[k]->error = summarise(pooled[k]);
    return out;
}

}  // namespace seamwright
