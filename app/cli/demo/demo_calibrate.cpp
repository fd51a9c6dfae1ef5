#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>

#include "app/cli/demo/demo.h"
#include "core/calibration/lens.h"
#include "core/calibration/stripe_camera.h"
#include "core/calibration/tcp_sphere.h"
#include "core/profile/filter.h"
#include "core/profile/peaks.h"
#include "devices/exchange/pose_json.h"
#include "projects/acquire.h"

namespace seamwright::cli {
namespace {

// The engineer jogs the sensor in front of the targets; how well is no part of the answer.
struct TargetView {
    Eigen::Vector3d turn_deg;   // rotation vector of the sensor against the target
    Eigen::Vector3d offset_mm;  // of the sensor's origin, target frame
};

// Plate: tilts to both sides about both axes at different heights and places, turned about the sight line.
const std::vector<TargetView> kPlateViews = {
    {{0, 0, 0}, {0, 0, 0}},         {{22, 0, 10}, {0, 8, 6}},     {{-20, 0, -15}, {5, -8, -6}},
    {{0, 22, 30}, {-8, 0, 4}},      {{0, -22, 60}, {8, 4, -5}},   {{16, 16, 90}, {0, 0, 10}},
    {{-16, 16, 120}, {-6, 6, -10}}, {{16, -16, 150}, {6, -6, 8}}, {{-16, -16, 45}, {4, 4, 0}},
    {{25, 8, 75}, {-4, -10, -8}},   {{-25, -8, -60}, {0, 10, 8}}, {{8, 25, -30}, {10, 0, -4}},
    {{-8, -25, 20}, {-10, 0, 0}},   {{12, -4, 180}, {0, 5, 12}},
};

// Sphere: the cut off the middle to both sides, the sensor turned about all three axes.
const std::vector<TargetView> kSphereViews = {
    {{0, 0, 0}, {0, 4, 22}},        {{22, 0, 0}, {0, -5, 20}},       {{-22, 0, 0}, {6, 6, 24}},
    {{0, 20, 0}, {-6, 8, 18}},      {{0, -20, 0}, {4, -8, 22}},      {{0, 0, 45}, {0, 9, 26}},
    {{0, 0, -50}, {-5, -9, 16}},    {{18, 14, 90}, {8, 3, 20}},      {{-18, 14, 130}, {-8, -3, 24}},
    {{18, -14, -100}, {3, 10, 18}}, {{-18, -14, 20}, {-3, -10, 26}}, {{15, 15, 170}, {0, 6, 22}},
};

// Plate: heights over the whole field, a little tilted to both sides, so that the lines cross the image
// everywhere.
const std::vector<TargetView> kLineViews = {
    {{0, 0, 5}, {0, 0, -48}},  {{0, 7, 5}, {0, 0, -38}},   {{0, -7, 5}, {0, 0, -30}},
    {{0, 10, 5}, {0, 0, -20}}, {{0, -10, 5}, {0, 0, -10}}, {{0, 0, 5}, {0, 0, 0}},
    {{0, 12, 5}, {0, 0, 8}},   {{0, -12, 5}, {0, 0, 16}},  {{0, 8, 5}, {0, 0, 24}},
    {{0, -8, 5}, {0, 0, 32}},  {{0, 0, 5}, {0, 0, 40}},
};

constexpr double kPlateExposureUs = 6000;

Expected<FramePtr> snap(ProfileSource& sensor) {
    if (auto fired = sensor.trigger(""); !fired) return tl::unexpected(fired.error());
    return sensor.wait_next(std::chrono::milliseconds(5000));
}

Expected<FramePtr> look(const SimulatedCell& cell, ProfileSource& sensor, RobotLink& robot,
                        const TargetView& view, Pose& base_from_flange) {
    const Pose target_from_sensor = make_pose(rotation_exp(view.turn_deg * (kPi / 180)), view.offset_mm);
    if (auto there = robot.move_to(cell.settings().base_from_target * target_from_sensor *
                                   cell.flange_from_sensor().inverse());
        !there)
        return tl::unexpected(there.error());
    auto at = robot.base_from_flange();
    if (!at) return tl::unexpected(at.error());
    base_from_flange = *at;
    return snap(sensor);
}

// The stripe in pixels, tracked through reflections: one point a column, in order.
Expected<std::vector<Eigen::Vector2d>> stripe_points(const StripeImage& image, StripePeaks& peaks) {
    if (auto found = find_peaks(image, {}, peaks); !found) return tl::unexpected(found.error());
    ProfileCandidates candidates;
    candidates.lines = peaks.lines;
    candidates.per_line = peaks.per_line;
    candidates.count = peaks.count;
    candidates.intensity = peaks.intensity;
    candidates.z_mm.assign(peaks.position_px.begin(),
                           peaks.position_px.end());  // the model has no unit: 1 px stands for 1 mm
    candidates.x_mm.resize(candidates.z_mm.size());
    for (int line = 0; line < peaks.lines; ++line)
        for (int k = 0; k < peaks.per_line; ++k)
            candidates.x_mm[static_cast<std::size_t>(peaks.index(line, k))] = line;
    Profile stripe;
    if (auto tracked = track_stripe(candidates, {}, stripe); !tracked) return tl::unexpected(tracked.error());
    std::vector<Eigen::Vector2d> points;
    for (std::size_t i = 0; i < stripe.size(); ++i)
        if (stripe.segment[i] != kOutlier) points.emplace_back(stripe.x_mm[i], stripe.z_mm[i]);
    return points;
}

// The stripe of the plate alone: lines of a lens bend like a parabola, and what stands beside the plate lies
// off it.
std::vector<Eigen::Vector2d> on_the_plate(std::vector<Eigen::Vector2d> points) {
    for (int round = 0; round < 4 && points.size() > 20; ++round) {
        Eigen::MatrixXd a(points.size(), 3);
        Eigen::VectorXd v(points.size());
        for (Eigen::Index i = 0; i < v.size(); ++i) {
            const Eigen::Vector2d& p = points[static_cast<std::size_t>(i)];
            const double u = p.x() / 1000;
            a.row(i) << 1, u, u * u;
            v(i) = p.y();
        }
        const Eigen::VectorXd off = (v - a * a.colPivHouseholderQr().solve(v)).cwiseAbs();
        std::vector<double> sorted(off.begin(), off.end());
        std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                         sorted.end());
        const double limit = std::max(1.0, 6 * sorted[sorted.size() / 2]);
        std::vector<Eigen::Vector2d> kept;
        for (Eigen::Index i = 0; i < v.size(); ++i)
            if (off(i) <= limit) kept.push_back(points[static_cast<std::size_t>(i)]);
        points = std::move(kept);
    }
    return points;
}

Expected<void> expose(SimulatedCell& cell, ProfileSource& sensor, double laser, double exposure_us) {
    cell.set_parameter("laser", laser);  // the switch on the sensor's housing
    return sensor.set("exposure_us", exposure_us);
}

nlohmann::json sphere_json(const std::vector<SphereObservation>& observations, double radius_mm) {
    nlohmann::json data = {{"radius_mm", radius_mm}, {"observations", nlohmann::json::array()}};
    for (const SphereObservation& o : observations) {
        nlohmann::json points = nlohmann::json::array();
        for (std::size_t i = 0; i < o.profile.size(); ++i)
            if (!std::isnan(o.profile.z_mm[i])) points.push_back({o.profile.x_mm[i], o.profile.z_mm[i]});
        data["observations"].push_back(
            {{"id", o.id}, {"base_from_flange", pose_json(o.base_from_flange)}, {"profile", points}});
    }
    return data;
}

// Largest distance between where the calibrated chain and the true chain put what a pixel sees, over the
// working range.
double chain_error_mm(const SimulatedCell& cell, const Calibration& c) {
    double worst = 0;
    for (double x : {-30.0, 0.0, 30.0})
        for (double z : {-15.0, 0.0, 15.0}) {
            const auto pixel = cell.sensor_model().to_pixel({x, z});
            if (!pixel) continue;
            const auto seen = c.model->to_laser(*pixel);
            if (!seen) return std::numeric_limits<double>::infinity();
            const Eigen::Vector3d truth = cell.flange_from_sensor() * Eigen::Vector3d(x, 0, z);
            const Eigen::Vector3d found = c.flange_from_sensor * Eigen::Vector3d(seen->x(), 0, seen->y());
            worst = std::max(worst, (truth - found).norm());
        }
    return worst;
}

}  // namespace

Expected<DemoCalibration> calibrate_demo_sensor(SimulatedCell& cell, ProfileSource& sensor,
                                                RobotLink& robot) {
    DemoCalibration demo;
    StripePeaks peaks;
    auto by_software = SoftwareTriggered::begin(sensor);
    if (!by_software) return tl::unexpected(by_software.error());
    if (auto started = sensor.start(); !started) return tl::unexpected(started.error());

    // Plate: each view twice, the board under ambient light with the laser off, then the stripe on it.
    cell.set_scene(Scene::plate);
    const double exposure_us = *sensor.get("exposure_us");
    BoardSpec board;
    board.columns = cell.settings().board.columns;
    board.rows = cell.settings().board.rows;
    board.pitch_mm = cell.settings().board.pitch_mm;
    std::vector<StripeObservation> observations;
    for (std::size_t i = 0; i < kPlateViews.size(); ++i) {
        StripeObservation observation;
        observation.id = fmt::format("plate{:02}", i + 1);
        observation.width = cell.settings().optics.width;
        observation.height = cell.settings().optics.height;
        observation.scan = ScanLines::columns;
        Pose base_from_flange;
        if (auto set = expose(cell, sensor, 0, kPlateExposureUs); !set) return tl::unexpected(set.error());
        auto image = look(cell, sensor, robot, kPlateViews[i], base_from_flange);
        if (!image) return tl::unexpected(image.error());
        observation.board = find_board((*image)->image, board);
        observation.base_from_flange = base_from_flange;
        if (auto set = expose(cell, sensor, 1, exposure_us); !set) return tl::unexpected(set.error());
        image = snap(sensor);  // the robot stands still between the two
        if (!image) return tl::unexpected(image.error());
        auto stripe = stripe_points((*image)->image, peaks);
        if (!stripe) return tl::unexpected(stripe.error());
        observation.stripe = std::move(*stripe);
        observations.push_back(std::move(observation));
    }
    auto camera = calibrate_stripe_camera(observations, board, {});
    if (!camera) return tl::unexpected(camera.error());
    if (!camera->plane || !camera->flange_from_camera)
        return device_error(
            "the plate frames do not determine the laser plane: " + camera->report.judgement.reason,
            "stripe-camera");
    Calibration& c = demo.calibration;
    c.model = SensorModel{camera->camera, camera->camera_from_laser, std::nullopt};
    demo.steps.push_back(
        {"stripe-camera", camera->report,
         fmt::format("{} boards, f {:.1f} px, reprojection {:.3f} px, {:.1f} % of the stripe within 0.5 mm "
                     "of the plane",
                     camera->boards_found, camera->camera.fx, camera->rms_px, 100 * camera->on_plane_share)});

    // Lens: stripes on the plate at all heights are straight lines in the world; an independent look at the
    // distortion.
    LensData lens;
    lens.width = cell.settings().optics.width;
    lens.height = cell.settings().optics.height;
    for (const TargetView& view : kLineViews) {
        Pose base_from_flange;
        auto image = look(cell, sensor, robot, view, base_from_flange);
        if (!image) return tl::unexpected(image.error());
        auto line = stripe_points((*image)->image, peaks);
        if (!line) return tl::unexpected(line.error());
        std::vector<Eigen::Vector2d> straight_line = on_the_plate(std::move(*line));
        if (straight_line.size() >= 200) lens.lines.push_back(std::move(straight_line));
    }
    auto straight = calibrate_lens(lens, {});
    if (!straight) return tl::unexpected(straight.error());
    demo.steps.push_back({"lens", straight->report,
                          fmt::format("stripes straight within {:.3f} px, before {:.3f} px",
                                      straight->straightness_after_px, straight->straightness_before_px)});

    // Sphere: where the sensor sits on the flange, with the laser's exposure.
    cell.set_scene(Scene::sphere);
    std::vector<SphereObservation> sphere;
    ProfileCandidates candidates;
    for (std::size_t i = 0; i < kSphereViews.size(); ++i) {
        SphereObservation observation;
        auto image = look(cell, sensor, robot, kSphereViews[i], observation.base_from_flange);
        if (!image) return tl::unexpected(image.error());
        observation.id = fmt::format("sphere{:02}", i + 1);
        if (auto found = find_peaks((*image)->image, {}, peaks); !found) return tl::unexpected(found.error());
        to_millimetres(peaks, *c.model, candidates);
        if (auto tracked = track_stripe(candidates, {}, observation.profile); !tracked)
            return tl::unexpected(tracked.error());
        sphere.push_back(std::move(observation));
    }
    TcpSphereOptions options;
    options.radius_mm = cell.settings().sphere_radius_mm;
    auto tcp = calibrate_tcp_sphere(sphere, options);
    if (!tcp) return tl::unexpected(tcp.error());
    if (tcp->status != TcpSphereStatus::ok)
        return device_error(
            "the sphere does not determine the sensor's place: " + tcp->report.judgement.reason,
            "tcp-sphere");
    c.flange_from_sensor = tcp->flange_from_sensor;
    c.covariance = tcp->covariance;
    c.method = "stripe-camera + tcp-sphere";
    c.source = fmt::format("{} frames of a plate, {} of a sphere of {} mm, rendered", observations.size(),
                           sphere.size(), *options.radius_mm);
    c.raw = sphere_json(sphere, *options.radius_mm);
    c.verdict =
        std::string(name_of(std::max(camera->report.judgement.verdict, tcp->report.judgement.verdict)));
    demo.steps.push_back({"tcp-sphere", tcp->report,
                          fmt::format("rms {:.4f} mm, sigma at the working distance {:.4f} mm", tcp->rms_mm,
                                      tcp->working_sigma_mm)});
    sensor.stop();
    demo.truth_mm = chain_error_mm(cell, c);
    return demo;
}

}  // namespace seamwright::cli
