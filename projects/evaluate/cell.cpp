#include "projects/evaluate/cell.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "core/alignment/alignment.h"
#include "core/profile/filter.h"
#include "core/profile/taught_profile.h"
#include "devices/simulated/scene/door.h"
#include "devices/simulated/scene/profile_cut.h"
#include "devices/simulated/scene/swept_rim.h"
#include "projects/station/teach.h"

namespace seamwright::evaluation {
namespace {

constexpr double kPassMm = 20;
constexpr double kSmallestSigmaMm = 1e-4;
constexpr double kTemplateBeyondMm = 1, kTemplateReachMm = 40;  // outboard and inboard of the landmark

void finish_cell(Cell& cell) {
    const EvaluationSettings& s = cell.settings;
    cell.stated_jitter_mm = s.jitter_mm;
    cell.sensor_from_believed.assign(cell.spots.size(), Pose::Identity());
    if (s.calibration_mm == 0 && s.calibration_deg == 0) return;
    for (std::size_t n = 0; n < cell.spots.size(); ++n) {
        Random random(hash64(s.seed, 31), n);
        const Eigen::Vector3d move = s.calibration_mm * random.normal3();
        const Eigen::Vector3d turn = rad_from_deg(s.calibration_deg) * random.normal3();
        cell.sensor_from_believed[n] = make_pose(rotation_exp(turn), move);
    }
}

Cell swept_cell(const EvaluationSettings& settings, std::vector<CellSpot> spots,
                const std::vector<double>& radii, std::atomic<std::size_t>& profiles) {
    Cell cell;
    cell.settings = settings;
    cell.profiles = &profiles;
    cell.spots = std::move(spots);
    std::vector<RimPiece> pieces;
    for (std::size_t n = 0; n < cell.spots.size(); ++n)
        pieces.push_back({cell.spots[n].workobject_from_sensor, radii[n], 60});
    cell.taught = cell.measured = std::make_shared<MeshTree>(swept_rim_mesh(pieces));
    finish_cell(cell);
    return cell;
}

std::vector<CellSpot> door_spots() {
    std::vector<CellSpot> spots;
    for (const DoorSpot& door : default_door_spots()) spots.push_back({door.id, door.workobject_from_sensor});
    return spots;
}

// As the robot carries it: the taught pose, turned when misaligned.
Pose taught_pose(const Cell& cell, const Method& method, std::size_t n) {
    Pose pose = cell.spots[n].workobject_from_sensor;
    if (method.misaligned)
        pose.linear() *= rotation_exp({0, 0, rad_from_deg(cell.settings.misalignment_deg)});
    return pose;
}

// The sensor where the robot, its trigger and the calibration really put it.
Pose arrived(const Cell& cell, const Pose& taught, std::size_t n, bool in_motion, Random& random) {
    Pose at = taught;
    at.translation() += cell.settings.repeatability_mm * random.normal3();
    if (in_motion)
        at.translation() +=
            random.uniform(-cell.settings.jitter_mm, cell.settings.jitter_mm) * taught.linear().col(1);
    return at * cell.sensor_from_believed[n].inverse();
}

void take_frame(const Cell& cell, const MeshTree& part, const Pose& part_from_sensor, Random& random,
                Frame& frame) {
    cut_profile(part, part_from_sensor, cell.optics, frame.profile);
    ++*cell.profiles;
    add_noise(frame.profile, cell.settings.noise_mm, random);
}

// The sensor, robot and calibration that all methods share, and an untaught spot.
Project project_of(const Cell& cell, const Method& method) {
    const EvaluationSettings& s = cell.settings;
    Project project;
    RobotSetup& robot = project.robots.emplace_back();
    robot.id = "R1";
    robot.arrival_covariance.topLeftCorner<3, 3>().diagonal().setConstant(s.repeatability_mm *
                                                                          s.repeatability_mm);
    Region& all = project.regions.emplace_back();
    all.id = "all";
    all.limits = {
        100, 10};  // they count at the work object's origin, far from the middle that the parts turn about
    for (std::size_t n = 0; n < cell.spots.size(); ++n) {
        const std::string& id = cell.spots[n].id;
        SensorSetup& sensor = project.sensors.emplace_back();
        sensor.id = sensor.calibration_id = id;
        sensor.filter.as_delivered = !method.matched;
        Calibration& calibration = project.calibrations.emplace_back();
        calibration.id = calibration.sensor_id = id;
        calibration.covariance.diagonal() << Eigen::Vector3d::Constant(s.calibration_mm * s.calibration_mm),
            Eigen::Vector3d::Constant(std::pow(rad_from_deg(s.calibration_deg), 2));
        Spot& spot = project.spots.emplace_back();
        spot.id = spot.sensor_id = id;
        spot.robot_id = robot.id;
        spot.base_from_flange = taught_pose(cell, method, n);
        spot.entry_mm = spot.exit_mm = kPassMm;
        spot.sigma_mm = kSmallestSigmaMm;  // everything that errs is stated by its source
        spot.jitter_mm = cell.stated_jitter_mm;
        spot.stop_at_trigger = !method.in_motion;
        spot.feature.kind = "contour-end";
        spot.feature.parameters = {{"side", 0.0}};
        all.spot_ids.push_back(id);
    }
    return project;
}

// teach_spot() with the cell in the devices' place.
Expected<seamwright::TaughtSpot> measured_reference(const Cell& cell, Project& project, std::size_t n,
                                                    Random& random) {
    const Spot& draft = project.spots[n];
    SEAM_TRY(auto measurer, SpotMeasurer::make(project, draft.id));
    const int arrivals = TeachOptions().repeats;
    std::vector<SpotMeasurement> measurements;
    std::vector<Profile> profiles;
    Frame frame;
    for (int a = 0; a < arrivals; ++a) {
        const Pose at = arrived(cell, draft.base_from_flange, n, false, random);
        for (int k = 0; k < kTaughtAnArrival; ++k) {
            take_frame(cell, *cell.taught, at, random, frame);
            measurements.push_back(measurer.measure(frame));
            profiles.push_back(measurer.profile());
        }
    }
    auto taught = taught_from(draft, std::move(measurements), profiles, arrivals);
    if (!taught) {
        Error error = taught.error();
        error.mend = "evaluate with less noise";
        return tl::unexpected(std::move(error));
    }
    project.spots[n] = taught->spot;
    return taught;
}

// As a person does: the contour's end first, then the piece around it as template with the end as landmark.
Expected<TaughtSpot> teach(const Cell& cell, const Method& method, Project project, std::size_t n) {
    Random random(hash64(cell.settings.seed, 1000 * static_cast<std::uint64_t>(method.number) + n));
    TaughtSpot spot;
    const Pose pose = spot.workobject_from_sensor = project.spots[n].base_from_flange;
    cut_profile(*cell.taught, pose * cell.sensor_from_believed[n].inverse(), cell.optics, spot.clean);
    SEAM_TRY(auto taught, measured_reference(cell, project, n, random));
    if (method.matched) {
        const Eigen::Vector3d end = taught.spot.reference_mm;
        FeatureRecipe& recipe = project.spots[n].feature;
        recipe.kind = "template";
        recipe.parameters = {{"window_dx_mm", 20}, {"window_dz_mm", 20}, {"window_dphi_deg", 5}};
        recipe.template_reference_mm = {end.x(), end.z()};
        recipe.template_profile =
            cut_out(taught.mean, end.x() - kTemplateBeyondMm, end.x() + kTemplateReachMm);
        SEAM_TRY(taught, measured_reference(cell, project, n, random));
    }
    spot.spread_mm = std::sqrt(0.5 * taught.spread_mm.squaredNorm());
    spot.landmark = pose * taught.spot.reference_mm;

    SEAM_TRY(auto measurer, SpotMeasurer::make(project, taught.spot.id));
    std::vector<TravelProfile> pass;
    std::vector<TravelPoint> points;
    Frame frame;
    const double step = PassOptions().step_mm;
    for (int k = -static_cast<int>(kPassMm / step); k * step <= kPassMm; ++k) {
        Pose at = pose;
        at.translation() += k * step * pose.linear().col(1);
        take_frame(cell, *cell.taught, arrived(cell, at, n, false, random), random, frame);
        const SpotMeasurement& m = measurer.measure(frame);
        if (m.status == SpotStatus::measured)
            points.push_back({k * step, m.feature.point_mm.x(), m.feature.point_mm.y()});
        Profile& profile = pass.emplace_back(TravelProfile{k * step, measurer.profile()}).profile;
        (void)filter_profile(profile, {});  // refuses only arrays of different length
    }
    AlignmentOptions alignment;
    alignment.jitter_mm = std::max(0.1, cell.settings.jitter_mm);
    SEAM_TRY(auto frozen, check_alignment(pass, alignment));
    spot.flagged = frozen.status == AlignmentStatus::drifting;
    spot.yaw_deg = frozen.yaw_deg;
    if (method.matched) {
        SEAM_TRY(auto curve, fit_contour_curve(points));
        project.spots[n].curve = curve;
    }
    spot.spot = project.spots[n];
    return spot;
}

}  // namespace

Cell door_cell(const EvaluationSettings& settings, std::atomic<std::size_t>& profiles) {
    Cell cell;
    cell.settings = settings;
    cell.profiles = &profiles;
    cell.spots = door_spots();
    TriangleMesh mesh = door_mesh();
    cell.taught = cell.measured = std::make_shared<MeshTree>(mesh);
    if (settings.bend_mm != 0) {
        const Eigen::AlignedBox3d box = mesh.box();
        for (Eigen::Vector3d& v : mesh.vertices) v.z() += bend_at({settings.bend_mm, 0}, box, v);
        cell.measured = std::make_shared<MeshTree>(std::move(mesh));
    }
    finish_cell(cell);
    return cell;
}

Cell straight_cell(const EvaluationSettings& settings, std::atomic<std::size_t>& profiles) {
    const std::vector<CellSpot> spots = door_spots();
    return swept_cell(settings, spots,
                      std::vector<double>(spots.size(), std::numeric_limits<double>::infinity()), profiles);
}

Cell curved_cell(const EvaluationSettings& settings, double radius_mm, std::atomic<std::size_t>& profiles) {
    struct Side {
        const char* letter;
        Eigen::Vector3d inboard;
        double bend;  // sense
    };
    const Side sides[] = {
        {"T", {0, -1, 0}, 1}, {"L", {-1, 0, 0}, 1}, {"B", {0, 1, 0}, -1}, {"H", {1, 0, 0}, -1}};
    const Eigen::Vector3d middle(500, 375, 0), half(450, 350, 0);
    std::vector<CellSpot> spots;
    std::vector<double> radii;
    for (const Side& side : sides) {
        for (int i = -1; i <= 1; ++i) {
            Eigen::Matrix3d axes;
            axes.col(0) = side.inboard;
            axes.col(2) = Eigen::Vector3d::UnitZ();
            axes.col(1) = axes.col(2).cross(axes.col(0));
            spots.push_back(
                {side.letter + std::to_string(i + 2),
                 make_pose(axes, middle - side.inboard.cwiseProduct(half) + 230.0 * i * axes.col(1))});
            radii.push_back(side.bend * radius_mm);
        }
    }
    return swept_cell(settings, std::move(spots), radii, profiles);
}

Expected<TaughtCell> teach_all(const Cell& cell, const Method& method) {
    TaughtCell taught{project_of(cell, method), std::vector<TaughtSpot>(cell.spots.size())};
    std::vector<std::optional<Error>> errors(cell.spots.size());
    spread_out(cell.settings.jobs, cell.spots.size(), [&] {
        return [&](std::size_t n) {
            if (auto spot = teach(cell, method, taught.project, n))
                taught.spots[n] = std::move(*spot);
            else
                errors[n] = spot.error();
        };
    });
    for (const auto& e : errors)
        if (e) return tl::unexpected(*e);
    for (std::size_t n = 0; n < taught.spots.size(); ++n) taught.project.spots[n] = taught.spots[n].spot;
    return taught;
}

Measurers make_measurers(const TaughtCell& taught) {
    Measurers measurers;
    for (const TaughtSpot& s : taught.spots)
        measurers.push_back(std::move(*SpotMeasurer::make(taught.project, s.spot.id)));
    return measurers;
}

const SpotMeasurement& measure_spot(const Cell& cell, const Method& method, const TaughtSpot& spot,
                                    std::size_t n, SpotMeasurer& measurer, const Pose& truth, Random& random,
                                    Frame& frame) {
    const Pose at = arrived(cell, spot.workobject_from_sensor, n, method.in_motion, random);
    take_frame(cell, *cell.measured, truth.inverse() * at, random, frame);
    return measurer.measure(frame);
}

SpotObservation observation_of(const TaughtSpot& spot, const SpotMeasurement& measurement) {
    return observation(spot.spot, Pose::Identity(), Pose::Identity(), measurement);
}

std::optional<RegionCorrection> correct(const Project& project,
                                        std::span<const SpotMeasurement> measurements) {
    const std::vector<RegionRecord> records = correct_regions(project, measurements);
    if (!records.front().correction || records.front().correction->status != CorrectionStatus::ok)
        return std::nullopt;
    return *records.front().correction;
}

void spread_out(int jobs, std::size_t count,
                const std::function<std::function<void(std::size_t)>()>& worker) {
    std::atomic<std::size_t> next{0};
    const auto run = [&] {
        const auto work = worker();
        for (std::size_t i = next++; i < count; i = next++) work(i);
    };
    std::vector<std::jthread> threads;
    for (int t = 1; t < jobs; ++t) threads.emplace_back(run);
    run();
}

}  // namespace seamwright::evaluation
