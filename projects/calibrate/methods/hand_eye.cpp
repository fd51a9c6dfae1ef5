// {"mount":"eye_in_hand|eye_to_hand","pairs":[{"id"?,"base_from_flange":POSE,"camera_from_target":POSE}],
//  "robot":{"sigma_mm","sigma_deg"?}?}
// -> {"status","flange_from_camera" | "base_from_camera","base_from_target" |
// "flange_from_target","rms_mm","rms_deg","sigma","target_size":{"factor","sigma"},...}

#include "core/calibration/pose/hand_eye.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/hand_eye_data.h"
#include "projects/calibrate/methods/example/example_cell.h"
#include "projects/calibrate/methods/methods.h"

namespace seamwright {

using nlohmann::json;

namespace {

Expected<CalibrationSolution> solve_hand_eye(const json& data, const ExcludedIds& exclude) {
    SEAM_TRY(auto set, parse_hand_eye_data(data));
    SEAM_TRY(auto solved, calibrate_hand_eye(set.mount, set.pairs, exclude, set.robot));

    CalibrationSolution solution;
    json& result = solution.document;
    const bool ok = solved.status == HandEyeStatus::ok;
    const bool in_hand = set.mount == Mount::eye_in_hand;
    const UncertainPose camera{solved.x, solved.covariance_x};
    if (ok && in_hand) solution.found = CameraOnFlange{camera};
    if (ok && !in_hand) solution.found = CameraBesideRobot{camera};
    result["mount"] = std::string(name_of(set.mount));
    result["status"] = std::string(name_of(solved.status));
    result[in_hand ? "flange_from_camera" : "base_from_camera"] = ok ? pose_json(solved.x) : json(nullptr);
    result[in_hand ? "base_from_target" : "flange_from_target"] = ok ? pose_json(solved.y) : json(nullptr);
    result["rms_mm"] = ok ? number_json(solved.rms_mm) : json(nullptr);
    result["rms_deg"] = ok ? number_json(solved.rms_deg) : json(nullptr);
    result["sigma"] = ok ? pose_sigma_json(solved.x, solved.covariance_x) : json(nullptr);
    if (ok) {
        result["covariance_pose"] = matrix_json(solved.covariance_x);
        result["noise"] = {{"sigma_mm", solved.sigma_mm}, {"sigma_deg", solved.sigma_deg}};
    }
    result["target_size"] = {{"factor", number_json(solved.target_size)},
                             {"sigma", number_json(solved.target_size_sigma)}};
    result["start"] = solved.start;
    solution.report = std::move(solved.report);
    solution.notices = std::move(solved.notices);
    solution.degenerate = std::move(solved.degenerate);
    finish_document(solution);
    return solution;
}

json hand_eye_example() {
    example::Dither dither;
    json pairs = json::array();
    for (const TargetPlace& view : plate_views())
        pairs.push_back({{"id", "P" + std::to_string(pairs.size() + 1)},
                         {"base_from_flange", pose_json(example::base_from_flange(view, dither))},
                         {"camera_from_target",
                          pose_json(example::shaken(example::camera_from_board(view), dither, 0.02, 1e-4))}});
    return {{"mount", "eye_in_hand"}, {"pairs", pairs}};
}

Expected<ConventionFits> hand_eye_conventions(const json& data, const ExcludedIds& exclude) {
    auto set = parse_hand_eye_data(without_poses(hand_eye_method().poses, data, pose_json(Pose::Identity())));
    if (!set) return tl::unexpected(set.error());
    PoseFit fit = [set = std::move(*set), exclude](const std::vector<std::vector<Pose>>& lists) mutable {
        for (std::size_t i = 0; i < set.pairs.size(); ++i) {
            set.pairs[i].base_from_flange = lists[0][i];
            set.pairs[i].camera_from_target = lists[1][i];
        }
        return convention_fit(set.mount, set.pairs, exclude);
    };
    return ConventionFits{std::move(fit), {}};
}

}  // namespace

CalibrationMethod hand_eye_method() {
    CalibrationMethod m;
    m.id = "hand-eye";
    m.help = "Camera on the flange, or beside the robot";
    m.usage = "pairs.json";
    m.layout =
        R"({"mount":"eye_in_hand"|"eye_to_hand","pairs":[{"id"?,"base_from_flange":POSE,"camera_from_target":POSE},..],
   "robot":{"sigma_mm","sigma_deg"?}?})";
    m.fields = {{"", {"mount", "pairs", "robot"}, {"board"}},
                {"pairs[]", {"id", "base_from_flange", "camera_from_target"}, {"size", "outline"}},
                robot_fields()};
    m.example = hand_eye_example;
    m.poses = {{"pairs", kRobotPose}, {"pairs", "camera_from_target"}};
    m.quantities = {{"pairs[].base_from_flange"}, {"pairs[].camera_from_target"}};
    m.solve = solve_hand_eye;
    m.convention_fits = hand_eye_conventions;
    m.entries = "pairs";
    m.capture = CaptureKind::board_pose;
    m.fewest = 3;
    m.advised = 8;
    m.robot = m.model = m.repeatability = true;
    m.settings = board_settings();
    m.fixed_settings = {{"mount", "eye_in_hand"}};
    m.title = "Camera on the flange (hand-eye)";
    m.why = "Finds where the camera sits on the flange, from views of one fixed board.";
    m.need = {"A flat chessboard that stays where it is.",
              "A calibrated camera: the board's place in the picture must be right.",
              "8 or more poses turned about at least two axes."};
    m.file = "JSON with pairs of poses, or a folder of images with pose files";
    m.drawing = SetUpDrawing::board;
    return m;
}

}  // namespace seamwright
