// {"target":{"place_mm":[x,y,z],"radius_mm"?,"radius_sigma_mm"?,"covariance_mm2":3x3 | "sigma_mm"?,
//   "calibration"? (which one's sphere it is, as a session notes it)},
//  "touches":[{"id"?,"base_from_flange":POSE}],"sigma_mm"?,"tip_radius_mm"?,"programmed":POSE?,
//  "robot":{"sigma_mm","sigma_deg"?}?}
// -> {"status":"ok|undetermined","flange_from_nozzle","sigma":{"xyz_mm","worst_mm"},"covariance" 3x3 (mm^2, flange),
//     "covariance_random","covariance_systematic" (the same),"covariance_pose" 6x6 (tangent of pose.h),
//     "deviation":{"mm","length_mm","chi_squared","limit","beyond_chance"} or null (no programmed tool),
//     "touch_sigma_mm","rms_mm","degrees","unobservable":[..],"advice",...}
// Without radius_mm the target is a sharp point. "programmed" is flange_from_tool as the controller has it; the identity
// is the flange itself and counts as none.

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core/calibration/nozzle/nozzle.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/entry.h"
#include "projects/calibrate/methods/example/example_cell.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/file/stored_text.h"

namespace seamwright {

using nlohmann::json;

namespace {

struct NozzleData {
    std::vector<NozzleTouch> touches;
    NozzleTarget target;
    NozzleOptions options;
    bool exact_place = false;  // nothing is said of how sure it is
};

// The field, where it is there.
const json* given_field(const json& holder, const char* key) {
    const auto it = holder.find(key);
    return it == holder.end() || it->is_null() ? nullptr : &*it;
}

Expected<Eigen::Matrix3d> matrix3_of(const json& rows, const std::string& where) {
    if (!rows.is_array() || rows.size() != 3)
        return input_error(Text("this is no {} x {} matrix", 3, 3), where, "write rows of numbers");
    Eigen::Matrix3d matrix;
    for (std::size_t i = 0; i < 3; ++i) {
        SEAM_TRY(auto row, as_numbers(rows[i], 3, json_path(where, i)));
        matrix.row(static_cast<Eigen::Index>(i)) = Eigen::Map<const Eigen::RowVector3d>(row.data());
    }
    return matrix;
}

Expected<void> parse_target(const json& data, NozzleData& set) {
    SEAM_TRY(auto field, json_field(data, "target", ""));
    SEAM_OK(only_fields(
        *field, {"place_mm", "radius_mm", "radius_sigma_mm", "covariance_mm2", "sigma_mm", "calibration"},
        "target"));
    SEAM_TRY(auto place, json_vector3(*field, "place_mm", "target"));
    set.target.place_mm = place;
    if (given_field(*field, "radius_mm")) {
        SEAM_TRY(auto radius, json_number(*field, "radius_mm", "target"));
        set.target.radius_mm = radius;
    }
    if (given_field(*field, "radius_sigma_mm")) {
        SEAM_TRY(auto radius_sigma, json_number(*field, "radius_sigma_mm", "target"));
        set.target.radius_sigma_mm = radius_sigma;
    }
    const json *matrix = given_field(*field, "covariance_mm2"), *sigma = given_field(*field, "sigma_mm");
    if (matrix && sigma)
        return input_error("covariance_mm2 and sigma_mm say the same", "target", "give one of them");
    if (matrix) {
        SEAM_TRY(auto covariance, matrix3_of(*matrix, "target.covariance_mm2"));
        SEAM_OK(check_variances(covariance.diagonal(), "target.covariance_mm2"));
        set.target.covariance_mm2 = covariance;
    } else if (sigma) {
        SEAM_TRY(auto each, json_sigma_or_exact(*field, "sigma_mm", 0, "target"));
        set.target.covariance_mm2 = each * each * Eigen::Matrix3d::Identity();
    }
    set.exact_place = !matrix && !sigma;
    return {};
}

Expected<NozzleData> parse_nozzle_data(const json& data, const ExcludedIds& exclude) {
    NozzleData set;
    set.options.exclude = exclude;
    SEAM_OK(parse_target(data, set));
    SEAM_TRY(auto list, json_array(data, "touches", ""));
    for (std::size_t i = 0; i < list->size(); ++i) {
        const json& entry = (*list)[i];
        const std::string where = json_path("touches", i);
        NozzleTouch touch;
        SEAM_TRY(auto id, entry_id(entry, i, where));
        touch.id = id;
        SEAM_TRY(auto field, json_field(entry, "base_from_flange", where));
        SEAM_TRY(auto pose, parse_pose(*field, json_path(where, "base_from_flange")));
        touch.base_from_flange = pose;
        set.touches.push_back(std::move(touch));
    }
    if (given_field(data, "sigma_mm")) {
        SEAM_TRY(auto sigma, json_number(data, "sigma_mm", ""));
        set.options.sigma_mm = sigma;
    }
    SEAM_TRY(auto ball, json_number_or(data, "tip_radius_mm", 0, ""));
    set.options.tip_radius_mm = ball;
    SEAM_TRY(const auto robot, repeatability_of(data));
    set.options.robot = robot;
    if (const json* tool = given_field(data, "programmed")) {
        SEAM_TRY(auto pose, parse_pose(*tool, "programmed"));
        if (!pose.isApprox(Pose::Identity(), 1e-12)) set.options.programmed = pose;
    }
    return set;
}

json deviation_json(const NozzleResult& solved) {
    if (!solved.deviation) return nullptr;
    const NozzleDeviation& d = *solved.deviation;
    return {{"mm", vector_json(d.mm)},
            {"length_mm", number_json(d.mm.norm())},
            {"chi_squared", number_json(d.chi_squared)},
            {"limit", number_json(d.limit)},
            {"beyond_chance", d.beyond_chance}};
}

// What the numbers mean for the controller.
std::vector<Text> nozzle_notices(const NozzleResult& solved, bool exact_place) {
    std::vector<Text> notices;
    if (solved.deviation)
        notices.push_back(
            solved.deviation->beyond_chance
                ? Text("the nozzle lies {:.2f} mm off the programmed tool, more than chance: enter the found "
                       "tool on the controller, or straighten the nozzle",
                       solved.deviation->mm.norm())
                : Text("the programmed tool is right as far as the touches tell: {:.2f} mm off",
                       solved.deviation->mm.norm()));
    if (exact_place)
        notices.push_back(
            Text("the target's place is taken as exact: state covariance_mm2 or sigma_mm of it"));
    notices.insert(notices.end(), solved.notices.begin(), solved.notices.end());
    return notices;
}

Expected<CalibrationSolution> solve_nozzle(const json& data, const ExcludedIds& exclude) {
    SEAM_TRY(auto set, parse_nozzle_data(data, exclude));
    SEAM_TRY(auto solved, calibrate_nozzle(set.touches, set.target, set.options));
    CalibrationSolution solution;
    json& result = solution.document;
    const bool ok = solved.status == NozzleStatus::ok;
    result["status"] = std::string(name_of(solved.status));
    result["flange_from_nozzle"] = ok ? pose_json(solved.flange_from_nozzle) : json(nullptr);
    result["sigma"] = nullptr;
    result["deviation"] = deviation_json(solved);
    if (ok) {
        NozzleOnFlange found;
        found.flange_from_nozzle.pose = solved.flange_from_nozzle;
        found.flange_from_nozzle.covariance.topLeftCorner<3, 3>() = solved.covariance;
        found.degrees = set.options.sigma_mm ? std::numeric_limits<double>::infinity() : solved.freedom;
        if (solved.deviation && solved.deviation->beyond_chance)
            found.off_programmed_mm = solved.deviation->mm.norm();
        const Eigen::Vector3d sigma = solved.covariance.diagonal().cwiseMax(0).cwiseSqrt();
        result["sigma"] = {{"xyz_mm", vector_json(sigma)}, {"worst_mm", number_json(solved.worst_sigma_mm)}};
        result["covariance_random"] = matrix_json(solved.covariance_random);
        result["covariance_systematic"] = matrix_json(solved.covariance_systematic);
        result["covariance_pose"] = matrix_json(found.flange_from_nozzle.covariance);
        result["touch_sigma_mm"] = number_json(solved.sigma_mm);
        result["rms_mm"] = number_json(solved.rms_mm);
        result["degrees"] = number_json(found.degrees);
        result["off_programmed_mm"] = found.off_programmed_mm;
        solution.found = found;
    }
    Text advice;
    for (const Text& next : solved.advice) advice = joined(advice, "; ", next);
    put_text(result, "advice", advice);
    put_texts(result, "unobservable", solved.open);
    solution.notices = nozzle_notices(solved, set.exact_place);
    solution.degenerate = std::move(solved.open);
    solution.report = std::move(solved.report);
    finish_document(solution);
    return solution;
}

// Ten touches by hand all over the upper half of the sphere, the flange leaning otherwise at each.
json nozzle_example() {
    constexpr double kHand_mm = 0.08, kRobot_mm = 0.02;
    example::Dither dither;
    const Eigen::Vector3d tip(4.2, -1.6, 231.5), centre = example::base_from_target().translation();
    json touches = json::array();
    for (int i = 0; i < 10; ++i) {
        const double round = 2.4 * i, height = i == 0 ? 3 : 0.2 + 0.25 * (i % 4);
        const Eigen::Vector3d side = Eigen::Vector3d(std::cos(round), std::sin(round), height).normalized();
        const Eigen::Matrix3d down = rotation_exp(Eigen::Vector3d(kPi, 0, 0)),
                              lean = rotation_exp(Eigen::Vector3d(0.35 * std::sin(1.7 * i),
                                                                  0.35 * std::cos(2.3 * i),
                                                                  0.5 * std::sin(0.9 * i)));
        const Eigen::Matrix3d turn = lean * down;
        const Eigen::Vector3d at = centre + (example::kRadius_mm + dither(kHand_mm)) * side;
        touches.push_back({{"id", "T" + std::to_string(i + 1)},
                           {"base_from_flange", pose_json(example::shaken(make_pose(turn, at - turn * tip),
                                                                          dither, kRobot_mm, 2e-5))}});
    }
    const Eigen::Vector3d seen = centre + Eigen::Vector3d(0.02, -0.01, 0.03);
    return {
        {"target",
         {{"place_mm", example::vector3_json(seen)}, {"radius_mm", example::kRadius_mm}, {"sigma_mm", 0.03}}},
        {"programmed", pose_json(make_pose(rotation_exp(Eigen::Vector3d(0, 0.5, 0)), {4, -1, 231}))},
        {"robot", {{"sigma_mm", kRobot_mm}, {"sigma_deg", 0.001}}},
        {"touches", touches}};
}

// Residuals below this are exact: two readings then tie.
constexpr double kExactTouch_mm = 0.01;

std::optional<ConventionFit> nozzle_fit(NozzleData& set, const std::vector<Pose>& poses, bool thorough) {
    for (std::size_t i = 0; i < set.touches.size(); ++i) set.touches[i].base_from_flange = poses[i];
    set.options.thorough = thorough;
    const auto solved = calibrate_nozzle(set.touches, set.target, set.options);
    if (!solved || solved->status != NozzleStatus::ok) return std::nullopt;
    const Verdict verdict = solved->report.judgement.verdict;
    // Where the poses are nonsense the scatter is larger than what a tip may still be found with.
    const double scatter_mm = std::max({kExactTouch_mm, solved->sigma_mm, solved->rms_mm});
    return ConventionFit{scatter_mm * scatter_mm, std::max(1.0, solved->freedom), solved->rms_mm,
                         thorough && serves(verdict), thorough ? verdict : Verdict::undetermined};
}

Expected<ConventionFits> nozzle_conventions(const json& data, const ExcludedIds& exclude) {
    SEAM_TRY(
        auto parsed,
        parse_nozzle_data(without_poses(nozzle_method().poses, data, pose_json(Pose::Identity())), exclude));
    parsed.options.sigma_mm.reset();  // the scatter is what is compared
    const auto set = std::make_shared<NozzleData>(std::move(parsed));
    using Lists = std::vector<std::vector<Pose>>;
    return ConventionFits{[set](const Lists& lists) { return nozzle_fit(*set, lists[0], true); },
                          [set](const Lists& lists) { return nozzle_fit(*set, lists[0], false); }};
}

// The sphere that the sensor was calibrated on, as the calibration in use has measured it; one that a file gave stays.
Expected<json> prepare_nozzle(json settings, const Calibration* base, const std::vector<Calibration>&) {
    if (const auto it = settings.find("target");
        it != settings.end() && !(it->is_object() && it->contains("calibration")))
        return settings;
    const json none;
    const auto in_result = [&](const char* key) -> const json& {
        if (!base || !base->result.is_object()) return none;
        const auto it = base->result.find(key);
        return it == base->result.end() ? none : *it;
    };
    const json &centre = in_result("centre_base_mm"), &radius = in_result("radius_mm"),
               &covariance = in_result("centre_covariance_mm2");
    if (!centre.is_array() || !radius.is_number())
        return input_error("where the sphere stands is not known", "nozzle",
                           "calibrate the sensor on the sphere first, or load touches with their target");
    settings["target"] = {{"place_mm", centre}, {"radius_mm", radius}, {"calibration", base->id}};
    if (covariance.is_array()) settings["target"]["covariance_mm2"] = covariance;
    return settings;
}

std::vector<MethodSetting> nozzle_settings() {
    return {number_setting("tool_x", "/programmed/xyz/0", "mm", -5000, 5000, 0, 3,
                           "Of the tool as the controller has it; all 0: not compared.", "Programmed tool X"),
            number_setting("tool_y", "/programmed/xyz/1", "mm", -5000, 5000, 0, 3,
                           "Of the tool as the controller has it.", "Programmed tool Y"),
            number_setting("tool_z", "/programmed/xyz/2", "mm", -5000, 5000, 0, 3,
                           "Of the tool as the controller has it.", "Programmed tool Z"),
            number_setting("tip_radius", "/tip_radius_mm", "mm", 0, 50, 0, 3,
                           "Of a ball at the measuring tip; 0 for a sharp one.", "Ball at the tip")};
}

}  // namespace

CalibrationMethod nozzle_method() {
    CalibrationMethod m;
    m.id = "nozzle";
    m.help = "Nozzle tip on the flange from touches of the sphere";
    m.usage = "touches.json --exclude T3";
    m.layout = R"({"target":{"place_mm":[x,y,z],"radius_mm"? (absent: a sharp point),
     "radius_sigma_mm"? (absent: 0.5 % of the radius),"covariance_mm2":3x3 or "sigma_mm"?},"touches":[{"id"?,"base_from_flange":POSE},..],
   "sigma_mm"? (of a touch; absent: from the scatter),"tip_radius_mm"?,"programmed":POSE? (flange_from_tool),
   "robot":{"sigma_mm","sigma_deg"?}?}   mm, robot's base; |base_from_flange tip - place| = radius + tip_radius)";
    m.fields = {{"", {"target", "touches", "sigma_mm", "tip_radius_mm", "programmed", "robot"}},
                {"touches[]", {"id", "base_from_flange"}},
                robot_fields()};
    m.example = nozzle_example;
    m.poses = {{"touches", kRobotPose}};
    m.quantities = {{"touches[].base_from_flange"}};
    m.solve = solve_nozzle;
    m.convention_fits = nozzle_conventions;
    m.entries = "touches";
    m.capture = CaptureKind::touch;
    m.use = AnswerUse::record;
    m.fewest = 4;
    m.advised = 9;
    m.robot = m.repeatability = true;
    m.settings = nozzle_settings();
    m.fixed_settings = {{"programmed", {{"xyz", {0, 0, 0}}, {"abc", {0, 0, 0}}}}};
    m.prepare = prepare_nozzle;
    m.title = "Nozzle on the flange (touch)";
    m.why =
        "Finds where the nozzle's tip is on the flange, from touches of the sphere that the sensor has "
        "measured.";
    m.need = {
        "The sphere where it stood when the sensor was calibrated.",
        "A measuring tip in the nozzle, sharp or a ball of known radius.",
        "9 or more touches: from above and from all sides, the flange turned by 20 degrees and more between "
        "them. Bring the tip to the sphere by hand or slowly by jogging, then capture."};
    m.file = "JSON with the sphere (or a point) and the robot's pose at each touch";
    m.drawing = SetUpDrawing::sphere;
    return m;
}

}  // namespace seamwright
