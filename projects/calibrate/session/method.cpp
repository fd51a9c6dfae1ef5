#include "projects/calibrate/session/method.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/calibration/sphere/drift_check.h"

namespace seamwright {
namespace {

using nlohmann::json;

MethodSetting number(const char* name, const char* pointer, const char* unit, double minimum, double maximum,
                     double otherwise, int decimals, const char* help) {
    MethodSetting s;
    s.info.name = name;
    s.info.unit = unit;
    s.info.minimum = minimum;
    s.info.maximum = maximum;
    s.info.default_value = otherwise;
    s.info.decimals = decimals;
    s.info.help = help;
    s.pointer = pointer;
    return s;
}

std::vector<MethodSetting> board_settings() {
    return {number("board_columns", "/board/columns", "", 3, 200, 7, 0, "Inner corners along the board."),
            number("board_rows", "/board/rows", "", 3, 200, 6, 0, "Inner corners across the board."),
            number("board_pitch", "/board/pitch_mm", "mm", 0.2, 1000, 10, 3, "Edge of a square.")};
}

Expected<CalibrateOutcome> solve_lut(const json& data, const std::vector<std::string>& exclude) {
    return calibrate_lut_json(data, exclude);
}

}  // namespace

bool shows_board(CaptureKind kind) {
    return kind == CaptureKind::board_and_stripe || kind == CaptureKind::board_pose ||
           kind == CaptureKind::board_points || kind == CaptureKind::board_chain;
}

const std::vector<CalibrationMethod>& calibration_methods() {
    static const std::vector<CalibrationMethod> methods = [] {
        std::vector<CalibrationMethod> list;
        const auto add = [&](CalibrationMethod m) { list.push_back(std::move(m)); };
        add({"tcp-sphere",
             "observations",
             CaptureKind::sphere_profile,
             AnswerUse::sensor,
             6,
             9,
             true,
             true,
             calibrate_tcp_sphere_json,
             {number("radius", "/radius_mm", "mm", 1, 500, 25, 4, "Radius of the sphere.")}});
        add({"stripe-camera", "frames", CaptureKind::board_and_stripe, AnswerUse::sensor, 3, 10, true, false,
             calibrate_stripe_camera_json, board_settings()});
        add({"hand-eye", "pairs", CaptureKind::board_pose, AnswerUse::sensor, 3, 8, true, true,
             calibrate_hand_eye_json, board_settings()});
        add({"laser-plane",
             "pairs",
             CaptureKind::apex,
             AnswerUse::sensor,
             4,
             10,
             false,
             true,
             calibrate_laser_plane_json,
             {}});
        add({"lut", "pairs", CaptureKind::apex, AnswerUse::sensor, 9, 25, false, false, solve_lut, {}});
        add({"static", "sensors", CaptureKind::board_chain, AnswerUse::sensor, 1, 1, false, true,
             calibrate_static_json, board_settings()});
        add({"lens",
             "lines",
             CaptureKind::stripe_line,
             AnswerUse::record,
             3,
             10,
             false,
             false,
             calibrate_lens_json,
             {}});
        add({"plate", "points", CaptureKind::board_points, AnswerUse::record, 3, 6, false, true,
             calibrate_plate_json, board_settings()});
        add({"drift",
             "observations",
             CaptureKind::sphere_profile,
             AnswerUse::check,
             1,
             3,
             true,
             true,
             check_drift_json,
             {number("radius", "/radius_mm", "mm", 1, 500, 25, 4, "Radius of the sphere."),
              number("limit_mm", "/limits/translation_mm", "mm", 0.001, 10, 0.1, 3,
                     "A shift beyond this counts as drifted."),
              number("limit_deg", "/limits/rotation_deg", "deg", 0.001, 10, DriftLimits{}.rotation_deg, 3,
                     "A turn beyond this counts as drifted.")}});
        return list;
    }();
    return methods;
}

const CalibrationMethod* find_method(const std::string& id) {
    const auto& list = calibration_methods();
    const auto it = std::find_if(list.begin(), list.end(), [&](const auto& m) { return m.id == id; });
    return it == list.end() ? nullptr : &*it;
}

json default_settings(const CalibrationMethod& method) {
    json settings = json::object();
    for (const MethodSetting& s : method.settings)
        settings[json::json_pointer(s.pointer)] = s.info.default_value;
    if (method.id == "hand-eye") settings["mount"] = "eye_in_hand";
    return settings;
}

Expected<void> set_setting(const CalibrationMethod& method, json& settings, const std::string& name,
                           double value) {
    for (const MethodSetting& s : method.settings) {
        if (s.info.name != name) continue;
        if (auto ok = validate({{name, value}}, {s.info}, method.id); !ok) return ok;
        settings[json::json_pointer(s.pointer)] = s.info.decimals == 0 ? std::round(value) : value;
        return {};
    }
    return input_error(Text("there is no setting \"{}\"", name), method.id);
}

double setting(const MethodSetting& which, const json& settings) {
    const json::json_pointer at(which.pointer);
    return settings.contains(at) && settings[at].is_number() ? settings[at].get<double>()
                                                             : which.info.default_value;
}

}  // namespace seamwright
