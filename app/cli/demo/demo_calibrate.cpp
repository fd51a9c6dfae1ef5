#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "app/cli/demo/demo_detail.h"
#include "core/calibration/lens/lens.h"
#include "core/calibration/sphere/tcp_sphere.h"
#include "core/calibration/stripe/stripe_camera.h"
#include "core/profile/filter.h"
#include "core/profile/stripe/peaks.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/stripe_line_points.h"
#include "projects/calibrate/methods/example/target_views.h"
#include "projects/station/acquire.h"

namespace seamwright::cli {
namespace {

constexpr double kPlateExposureUs = 6000;
constexpr int kLooks = 3;  // at a view at most
constexpr std::size_t kLeastLinePoints = 200;

// Takes every view, solves, and takes those views once more that the solution left out: a person at the cell
// would. `take(view)` -> Expected<void>; `solve(left_out)` -> Expected<result>, sets left_out[view].
template <class Take, class Solve>
auto solve_with_further_looks(std::size_t views, int& looks_again, const Take& take, const Solve& solve)
    -> decltype(solve(std::declval<std::vector<char>&>())) {
    std::vector<char> wanted(views, 1);
    for (int look = 1;; ++look) {
        for (std::size_t i = 0; i < views; ++i) {
            if (!wanted[i]) continue;
            SEAM_OK(take(i));
            looks_again += look > 1;
        }
        std::vector<char> left_out(views, 0);
        auto solved = solve(left_out);
        const bool complete = std::count(left_out.begin(), left_out.end(), 1) == 0;
        if (look == kLooks || (solved && complete)) return solved;
        wanted = complete ? std::vector<char>(views, 1) : left_out;  // no solution and nobody to blame: all
    }
}

Expected<FramePtr> snap(ProfileSource& sensor) {
    SEAM_OK(sensor.trigger(""));
    return sensor.wait_next(kDrawing);
}

Expected<FramePtr> look(const SimulatedCell& cell, ProfileSource& sensor, RobotLink& robot,
                        const TargetPlace& view, Pose& base_from_flange) {
    if (auto there = robot.move_to(cell.settings().base_from_target * target_from_sensor(view) *
                                   cell.flange_from_sensor().inverse());
        !there)
        return tl::unexpected(there.error());
    SEAM_TRY(auto at, robot.base_from_flange());
    base_from_flange = at;
    return snap(sensor);
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
    SEAM_TRY(const auto by_software, SoftwareTriggered::begin(sensor));
    SEAM_OK(sensor.start());

    // Plate: each view twice, the board under ambient light with the laser off, then the stripe on it.
    cell.set_scene(Scene::plate);
    const double exposure_us = *sensor.get("exposure_us");
    BoardSpec board;
    board.columns = cell.settings().board.columns;
    board.rows = cell.settings().board.rows;
    board.pitch_mm = cell.settings().board.pitch_mm;
    std::vector<StripeObservation> observations(plate_views().size());
    const auto take_plate = [&](std::size_t i) -> Expected<void> {
        StripeObservation observation;
        observation.id = fmt::format("plate{:02}", i + 1);
        observation.width = cell.settings().optics.width;
        observation.height = cell.settings().optics.height;
        observation.scan = ScanLines::columns;
        Pose base_from_flange;
        SEAM_OK(expose(cell, sensor, 0, kPlateExposureUs));
        auto image = look(cell, sensor, robot, plate_views()[i], base_from_flange);
        if (!image) return tl::unexpected(image.error());
        observation.board = find_board((*image)->image, board).board;
        observation.base_from_flange = base_from_flange;
        SEAM_OK(expose(cell, sensor, 1, exposure_us));
        image = snap(sensor);  // the robot stands still between the two
        if (!image) return tl::unexpected(image.error());
        SEAM_TRY(auto stripe, stripe_points((*image)->image, peaks));
        observation.stripe = std::move(stripe);
        observations[i] = std::move(observation);
        return {};
    };
    SEAM_TRY(auto camera,
             solve_with_further_looks(
                 observations.size(), demo.looks_again, take_plate, [&](std::vector<char>& left_out) {
                     auto solved = calibrate_stripe_camera(observations, board, {});
                     for (std::size_t i = 0; i < observations.size(); ++i)
                         left_out[i] = !observations[i].board ||
                                       (solved && !(solved->frames[i].used && solved->frames[i].stripe_used));
                     return solved;
                 }));
    if (!camera.plane || !camera.flange_from_camera)
        return device_error(
            Text("the plate frames do not determine the laser plane: {}", camera.report.judgement.reason),
            "stripe-camera");
    Calibration& c = demo.calibration;
    c.model = SensorModel{camera.camera, camera.camera_from_laser, std::nullopt};
    demo.steps.push_back(
        {"stripe-camera", camera.report,
         fmt::format("{} boards, f {:.1f} px, reprojection {:.3f} px, {:.1f} % of the stripe within 0.5 mm "
                     "of the plane",
                     camera.boards_found, camera.camera.fx, camera.rms_px, 100 * camera.on_plane_share)});

    // Lens: stripes on the plate at all heights are straight lines in the world; an independent look at the
    // distortion.
    std::vector<std::vector<Eigen::Vector2d>> lines(line_views().size());
    const auto take_line = [&](std::size_t i) -> Expected<void> {
        Pose base_from_flange;
        SEAM_TRY(auto image, look(cell, sensor, robot, line_views()[i], base_from_flange));
        SEAM_TRY(auto line, stripe_points(image->image, peaks));
        lines[i] = on_the_plate(std::move(line));
        return {};
    };
    auto straight =
        solve_with_further_looks(lines.size(), demo.looks_again, take_line, [&](std::vector<char>& left_out) {
            LensData lens;
            lens.width = cell.settings().optics.width;
            lens.height = cell.settings().optics.height;
            std::vector<std::size_t> view;
            for (std::size_t i = 0; i < lines.size(); ++i) {
                left_out[i] = lines[i].size() < kLeastLinePoints;
                if (left_out[i]) continue;
                lens.lines.push_back(lines[i]);
                view.push_back(i);
            }
            auto solved = calibrate_lens(lens, {});
            for (std::size_t i = 0; solved && i < view.size(); ++i)
                left_out[view[i]] = !solved->report.poses[i].used;
            return solved;
        });
    if (!straight) return tl::unexpected(straight.error());
    demo.steps.push_back({"lens", straight->report,
                          fmt::format("stripes straight within {:.3f} px, before {:.3f} px",
                                      straight->straightness_after_px, straight->straightness_before_px)});

    // Sphere: where the sensor sits on the flange, with the laser's exposure.
    cell.set_scene(Scene::sphere);
    std::vector<SphereObservation> sphere(sphere_views().size());
    ProfileCandidates candidates;
    const auto take_sphere = [&](std::size_t i) -> Expected<void> {
        SphereObservation observation;
        SEAM_TRY(auto image, look(cell, sensor, robot, sphere_views()[i], observation.base_from_flange));
        observation.id = fmt::format("sphere{:02}", i + 1);
        SEAM_OK(find_peaks(image->image, {}, peaks));
        to_millimetres(peaks, *c.model, candidates);
        SEAM_OK(track_stripe(candidates, {}, observation.profile));
        sphere[i] = std::move(observation);
        return {};
    };
    TcpSphereOptions options;
    options.radius_mm = cell.settings().sphere_radius_mm;
    SEAM_TRY(auto tcp, solve_with_further_looks(sphere.size(), demo.looks_again, take_sphere,
                                                [&](std::vector<char>& left_out) {
                                                    auto solved = calibrate_tcp_sphere(sphere, options);
                                                    for (std::size_t i = 0; solved && i < sphere.size(); ++i)
                                                        left_out[i] = !solved->report.poses[i].used;
                                                    return solved;
                                                }));
    if (tcp.status != TcpSphereStatus::ok)
        return device_error(
            Text("the sphere does not determine the sensor's place: {}", tcp.report.judgement.reason),
            "tcp-sphere");
    c.flange_from_sensor = tcp.flange_from_sensor;
    c.covariance = tcp.covariance;
    const FieldScale scale = better_known(camera.scale, tcp.scale);
    c.scale_sigma = scale.scale_sigma;
    c.shear_sigma = scale.shear_sigma;
    c.method = "stripe-camera + tcp-sphere";
    c.source = Text("{} frames of a plate, {} of a sphere of {} mm, rendered", observations.size(),
                    sphere.size(), *options.radius_mm);
    c.raw = sphere_json(sphere, *options.radius_mm);
    c.verdict = std::max(camera.report.judgement.verdict, tcp.report.judgement.verdict);
    demo.steps.push_back({"tcp-sphere", tcp.report,
                          fmt::format("rms {:.4f} mm, sigma at the working distance {:.4f} mm", tcp.rms_mm,
                                      tcp.working_sigma_mm)});
    sensor.stop();
    demo.truth_mm = chain_error_mm(cell, c);
    return demo;
}

}  // namespace seamwright::cli
