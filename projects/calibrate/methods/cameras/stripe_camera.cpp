// Data: stripe_frames.h, or a folder of images that show a chessboard ("7x6" inner corners) and the stripe; robot poses
// beside them (poseNNNN.txt, .yaml, .json as read_pose_file() reads them) give the hand-eye.
// -> {"status","images","boards_found","camera","reprojection_rms_px","laser_plane":{"normal","distance_mm"},
//     "camera_from_laser","on_plane_share" (frames that share the
//     plane),"on_plane_share_all_frames","plane_rms_mm",
//     "working_sigma_mm","hand_eye":{"flange_from_camera","target_spread_mm","target_size",..},"plate":{"shape","stretch","shear","bow_mm"},"frames":[..],...}

#include <algorithm>
#include <cmath>

#include "core/calibration/camera/camera.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/entry.h"
#include "projects/calibrate/input/hand_eye_data.h"
#include "projects/calibrate/methods/cameras/stripe_frames.h"
#include "projects/calibrate/methods/example/example_cell.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/calibrate/solution/camera_json.h"
#include "projects/file/stored_text.h"

namespace seamwright {
namespace {

using nlohmann::json;

// Residual of a frame that took no part: board under the solved camera, place of the target, stripe and laser
// plane.
void judge_excluded(const StripeCameraResult& solved, const StripeObservation& o, const BoardSpec& spec,
                    PoseResidual& pose) {
    if (!o.board) return;
    double least_deg = std::numeric_limits<double>::infinity();
    std::optional<Pose> camera_from_target;
    for (int turns = 0; turns < 4; turns += o.board->symmetry == 4 ? 1 : 2) {
        if (turns > 0 && o.board->symmetry == 1) break;
        const FoundBoard board = turns == 0 ? *o.board : turned(*o.board, spec, turns);
        const auto target = locate_target(solved.camera, {o.id, board.object_mm, board.pixel});
        if (!target) continue;
        pose.rms_px = target->rms_px;
        if (!camera_from_target) camera_from_target = target->camera_from_target;
        if (!o.base_from_flange || !solved.flange_from_camera) break;
        const Pose base_from_target =
            *o.base_from_flange * *solved.flange_from_camera * target->camera_from_target;
        const double deg = deg_from_rad(angle_rad(base_from_target, *solved.base_from_target));
        if (deg >= least_deg) continue;
        least_deg = deg;
        camera_from_target = target->camera_from_target;
        pose.deg = deg;
        pose.rms_mm = distance_mm(base_from_target, *solved.base_from_target);
    }
    if (!camera_from_target || !solved.plane || o.stripe.empty()) return;
    // Where the stripe's rays meet the plate, against the laser plane; the median passes over what is no
    // plate.
    const auto edge = outline(*o.board, spec);
    std::vector<double> off;
    const Eigen::Vector3d normal = camera_from_target->linear().col(2);
    for (const auto& p : o.stripe) {
        bool inside = edge.size() >= 3;
        double side = 0;
        for (std::size_t i = 0; i < edge.size() && inside; ++i) {
            const Eigen::Vector2d &a = edge[i], &b = edge[(i + 1) % edge.size()];
            const double cross = (b - a).x() * (p - a).y() - (b - a).y() * (p - a).x();
            if (side != 0 && cross * side < 0) inside = false;
            if (cross != 0) side = cross;
        }
        if (!inside) continue;
        const Eigen::Vector2d n = solved.camera.undistort(p);
        const Eigen::Vector3d ray(n.x(), n.y(), 1);
        const Eigen::Vector3d point = ray * (normal.dot(camera_from_target->translation()) / normal.dot(ray));
        if (point.allFinite())
            off.push_back(std::abs(solved.plane->normal.dot(point) + solved.plane->offset_mm));
    }
    if (off.empty()) return;
    const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
    std::nth_element(off.begin(), middle, off.end());
    pose.note = Text("excluded; stripe {:.2f} mm off the laser plane", *middle);
    if (std::isnan(pose.rms_mm)) pose.rms_mm = *middle;
}

Expected<CalibrationSolution> solve_stripe_camera(const json& data, const ExcludedIds& exclude) {
    SEAM_TRY(auto set, parse_stripe_data(data));
    const auto& observations = set.observations;
    StripeCameraOptions options;
    options.exclude = exclude;
    SEAM_TRY(const auto robot, repeatability_of(data));
    options.robot = robot;
    SEAM_TRY(auto solved, calibrate_stripe_camera(observations, set.spec, options));

    CalibrationSolution solution;
    json& result = solution.document;
    const bool known = solved.report.judgement.verdict != Verdict::undetermined;
    if (known) {
        CameraAndLaser found{solved.camera, std::nullopt, std::nullopt};
        if (solved.plane) found.camera_from_laser = solved.camera_from_laser;
        if (solved.flange_from_camera)
            found.flange_from_camera = {*solved.flange_from_camera, solved.flange_from_camera_covariance};
        solution.found = std::move(found);
        put_scale(solved.scale, solution);
    }
    result["status"] = known ? "ok" : "undetermined";
    result["images"] = observations.size();
    result["poses"] = std::count_if(observations.begin(), observations.end(), [](const StripeObservation& o) {
        return o.base_from_flange.has_value();
    });
    result["boards_found"] = solved.boards_found;
    result["camera"] = known ? camera_json(solved.camera) : json(nullptr);
    result["reprojection_rms_px"] = number_json(solved.rms_px);
    const bool plane = known && solved.plane;
    result["laser_plane"] = json(nullptr);
    if (plane)
        result["laser_plane"] = {{"normal", vector_json(solved.plane->normal)},
                                 {"distance_mm", solved.plane_distance_mm},
                                 {"sigma_deg", number_json(solved.plane_sigma_deg)},
                                 {"sigma_mm", number_json(solved.plane_sigma_mm)}};
    result["camera_from_laser"] = plane ? pose_json(solved.camera_from_laser) : json(nullptr);
    result["on_plane_share"] = plane ? number_json(solved.on_plane_share) : json(nullptr);
    result["on_plane_share_all_frames"] = plane ? number_json(solved.on_plane_share_all) : json(nullptr);
    result["plane_rms_mm"] = plane ? number_json(solved.plane_rms_mm) : json(nullptr);
    result["hand_eye"] = json(nullptr);
    if (known && solved.flange_from_camera)
        result["hand_eye"] = {
            {"flange_from_camera", pose_json(*solved.flange_from_camera)},
            {"base_from_target", pose_json(*solved.base_from_target)},
            {"sigma", pose_sigma_json(*solved.flange_from_camera, solved.flange_from_camera_covariance)},
            {"covariance_pose", matrix_json(solved.flange_from_camera_covariance)},
            {"target_spread_mm", solved.target_spread_mm},
            {"target_spread_max_mm", solved.target_spread_max_mm},
            {"target_size",
             {{"factor", number_json(solved.target_size)},
              {"sigma", number_json(solved.target_size_sigma)}}}};
    result["working_sigma_mm"] = known ? number_json(solved.working_sigma_mm) : json(nullptr);
    static constexpr const char* shapes[] = {"rigid", "in-plane", "bowed"};
    result["plate"] = {{"shape", shapes[static_cast<int>(solved.shape_freedom)]},
                       {"stretch", solved.shape.stretch},
                       {"shear", solved.shape.shear},
                       {"bow_mm", vector_json(solved.shape.bow_mm)}};
    json frames = json::array();
    for (std::size_t i = 0; i < solved.frames.size(); ++i) {
        const auto& f = solved.frames[i];
        frames.push_back(
            {{"id", f.id},
             {"board_found", f.board_found},
             {"detector", observations[i].board ? json(observations[i].board->detector) : json(nullptr)},
             {"stripe_used", f.stripe_used},
             {"rows_on_board", f.rows_on_board},
             {"rows_on_plane", f.rows_on_plane},
             {"off_plane_mm", number_json(f.median_off_plane_mm)},
             {"camera_from_target", f.used ? pose_json(f.camera_from_target) : json(nullptr)}});
        put_text(frames.back(), "note", f.note);
    }
    result["frames"] = std::move(frames);
    for (std::size_t i = 0; known && i < observations.size(); ++i)
        if (std::count(exclude.begin(), exclude.end(), observations[i].id) > 0)
            judge_excluded(solved, observations[i], set.spec, solved.report.poses[i]);
    solution.report = std::move(solved.report);
    finish_document(solution);
    return solution;
}

json stripe_camera_example() {
    example::Dither dither;
    const SensorModel model{example::camera(), example::camera_from_laser(), std::nullopt};
    json frames = json::array();
    for (const TargetPlace& view : plate_views()) {
        json pixels = json::array(), index = json::array(), stripe = json::array();
        for (int i = 0; i < example::kBoardColumns * example::kBoardRows; ++i) {
            const Eigen::Vector2d p =
                model.camera.project(example::camera_from_board(view) * example::board_corner(i));
            pixels.push_back(example::pair_json(p.x() + dither(example::kPixelNoise),
                                                p.y() + dither(example::kPixelNoise)));
            index.push_back(i);
        }
        // Where the plate (target z = 0) meets the laser plane (sensor y = 0): a line in the sensor's x and
        // z.
        const Pose target_from_laser = target_from_sensor(view);
        const Eigen::Vector3d n = target_from_laser.linear().row(2);
        for (int column = 0; column < example::kWidth; column += 8) {
            // The line's point above this column, by bisection of x.
            double low = -150, high = 150;
            const auto at = [&](double x) {
                const double z = -(target_from_laser.translation().z() + n.x() * x) / n.z();
                return model.camera.project(model.camera_from_laser * Eigen::Vector3d(x, 0, z));
            };
            for (int i = 0; i < 60; ++i) (at((low + high) / 2).x() < column ? low : high) = (low + high) / 2;
            const Eigen::Vector2d p = at((low + high) / 2);
            if (std::abs(p.x() - column) < 0.01 && p.y() > 0 && p.y() < example::kHeight)
                stripe.push_back(example::pair_json(column, p.y() + dither(example::kPixelNoise)));
        }
        frames.push_back(
            {{"id", "frame" + std::to_string(frames.size() + 1)},
             {"size", {example::kWidth, example::kHeight}},
             {"scan", "columns"},
             {"board", {{"pixel", pixels}, {"index", index}, {"symmetry", 1}, {"detector", "measured"}}},
             {"stripe", stripe},
             {"base_from_flange", pose_json(example::base_from_flange(view, dither))}});
    }
    return {{"board",
             {{"columns", example::kBoardColumns},
              {"rows", example::kBoardRows},
              {"pitch_mm", example::kPitch_mm}}},
            {"frames", frames}};
}

// Camera and plate without the robot, once; the robot's poses then against where the camera saw the plate.
Expected<ConventionFits> stripe_camera_conventions(const json& data, const ExcludedIds& exclude) {
    SEAM_TRY(auto set, parse_stripe_data(without_poses(stripe_camera_method().poses, data, nullptr)));
    StripeCameraOptions options;
    options.exclude = exclude;
    SEAM_TRY(const auto solved, calibrate_stripe_camera(set.observations, set.spec, options));
    std::vector<HandEyePair> pairs;
    std::vector<std::size_t> number;  // of the pose in its list
    std::size_t poses = 0;
    for (std::size_t i = 0; i < solved.frames.size(); ++i) {
        const json& entry = data.at("frames").at(i);
        if (!entry.contains("base_from_flange") || entry["base_from_flange"].is_null()) continue;
        const std::size_t own = poses++;
        if (!solved.frames[i].used) continue;
        pairs.push_back({set.observations[i].id, Pose::Identity(), solved.frames[i].camera_from_target});
        number.push_back(own);
    }
    PoseFit fit = [pairs = std::move(pairs),
                   number = std::move(number)](const std::vector<std::vector<Pose>>& lists) mutable {
        for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i].base_from_flange = lists[0][number[i]];
        return convention_fit(Mount::eye_in_hand, pairs, {});
    };
    return ConventionFits{std::move(fit), {}};
}

}  // namespace

CalibrationMethod stripe_camera_method() {
    CalibrationMethod m;
    m.id = "stripe-camera";
    m.help = "Intrinsics, laser plane and hand-eye from images of a board and the stripe";
    m.usage = "images --board 7x6 --pitch-mm 10 --report report.html";
    m.layout =
        R"({"board":{"columns","rows","pitch_mm","pattern"?:"chessboard"|"circles"|"charuco"|"aprilgrid","marker_mm"?,
   "dictionary"?,"legacy"?:true|false},"frames":[{"id"?,"size":[W,H],"scan":"rows"|"columns",
   "board":{"pixel":[[u,v],..],"index":[row*columns+column,..],"symmetry","detector"} or null,
   "stripe":[[u,v],..],"base_from_flange":POSE or null},..],
   "robot":{"sigma_mm","sigma_deg"?}?})";
    m.fields = {{"", {"board", "frames", "robot"}},
                {"board", {"columns", "rows", "pitch_mm", "pattern", "marker_mm", "dictionary", "legacy"}},
                {"frames[]", {"id", "size", "scan", "board", "stripe", "base_from_flange"}},
                {"frames[].board", {"pixel", "index", "symmetry", "detector"}},
                robot_fields()};
    m.example = stripe_camera_example;
    m.poses = {{"frames", kRobotPose}};
    m.quantities = {{"frames[].base_from_flange"}};
    m.solve = solve_stripe_camera;
    m.data_of_images = stripe_folder_data;
    m.convention_fits = stripe_camera_conventions;
    m.entries = "frames";
    m.capture = CaptureKind::board_and_stripe;
    m.fewest = 3;
    m.advised = 10;
    m.robot = m.repeatability = true;
    m.settings = board_settings();
    m.title = "Camera and laser plane (board)";
    m.why = "Finds lens, laser plane and, with robot poses, the place on the flange, from one board.";
    m.need = {
        "A flat chessboard, its corners counted and its pitch known.",
        "10 or more pictures with the stripe across the board, tilted to both sides about both axes, at "
        "different heights, out to the corners of the picture.",
        "The board stays where it is; only the robot moves."};
    m.file = "folder of images with pose files";
    m.drawing = SetUpDrawing::board_and_stripe;
    return m;
}

}  // namespace seamwright
