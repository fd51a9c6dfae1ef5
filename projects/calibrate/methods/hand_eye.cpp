// {"mount":"eye_in_hand|eye_to_hand","pairs":[{"id"?,"base_from_flange":POSE,"camera_from_target":POSE}],
//  "robot":{"sigma_mm","sigma_deg"?}?}
// -> {"status","flange_from_camera" | "base_from_camera","base_from_target" |
// "flange_from_target","rms_mm","rms_deg","sigma","target_size":{"factor","sigma"},...}

#include <algorithm>
#include <array>
#include <cmath>

#include "core/calibration/pose/hand_eye.h"
#include "core/geometry/notation.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/hand_eye_data.h"
#include "projects/calibrate/methods/example/example_cell.h"
#include "projects/calibrate/methods/methods.h"

namespace seamwright {

using nlohmann::json;

namespace {

// As KUKA A, B, C whose radians were read as degrees.
Pose from_radians(const Pose& pose) {
    const KukaAbc read = kuka_from_rotation(pose.linear());
    return make_pose(
        rotation_from_kuka({deg_from_rad(read.a_deg), deg_from_rad(read.b_deg), deg_from_rad(read.c_deg)}),
        pose.translation());
}

bool angles_of_radians(const std::vector<HandEyePair>& pairs, Pose HandEyePair::*list) {
    constexpr double kHalfTurn = 3.2;  // rad
    return std::all_of(pairs.begin(), pairs.end(), [&](const HandEyePair& pair) {
        const KukaAbc read = kuka_from_rotation((pair.*list).linear());
        return std::max({std::abs(read.a_deg), std::abs(read.b_deg), std::abs(read.c_deg)}) < kHalfTurn;
    });
}

// Pairs that do not fit as they are, but in another unit; empty: in none.
Text other_unit(const HandEyeData& set, const ExcludedIds& exclude) {
    using List = Pose HandEyePair::*;
    const std::array<std::pair<List, const char*>, 2> lists{
        {{&HandEyePair::base_from_flange, "base_from_flange"},
         {&HandEyePair::camera_from_target, "camera_from_target"}}};
    const auto fits = [&](const std::vector<HandEyePair>& pairs) {
        const auto solved = calibrate_hand_eye(set.mount, pairs, exclude, set.robot);
        return solved && solved->status == HandEyeStatus::ok && serves(solved->report.judgement.verdict);
    };
    std::vector<HandEyePair> both = set.pairs;
    int small = 0;
    for (const auto& [list, name] : lists) {
        if (!angles_of_radians(set.pairs, list)) continue;
        std::vector<HandEyePair> pairs = set.pairs;
        for (HandEyePair& p : pairs) p.*list = from_radians(p.*list);
        if (fits(pairs)) return Text("the angles of {} are radians: write degrees", name);
        for (HandEyePair& p : both) p.*list = from_radians(p.*list);
        ++small;
    }
    if (small == 2 && fits(both)) return "the angles of both lists are radians: write degrees";
    constexpr std::array<std::pair<double, const char*>, 2> kUnits{{{25.4, "inches"}, {1000, "metres"}}};
    for (const auto& [list, name] : lists)
        for (const auto& [factor, unit] : kUnits) {
            std::vector<HandEyePair> pairs = set.pairs;
            for (HandEyePair& p : pairs) (p.*list).translation() *= factor;
            if (fits(pairs)) return Text("the lengths of {} are {}: write millimetres", name, Text(unit));
        }
    return {};
}

Expected<CalibrationSolution> solve_hand_eye(const json& data, const ExcludedIds& exclude) {
    SEAM_TRY(auto set, parse_hand_eye_data(data));
    SEAM_TRY(auto solved, calibrate_hand_eye(set.mount, set.pairs, exclude, set.robot));

    if (!serves(solved.report.judgement.verdict))
        if (Text unit = other_unit(set, exclude); !unit.empty())
            solved.report.judgement.cure = std::move(unit);

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
