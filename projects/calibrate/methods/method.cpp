#include "projects/calibrate/methods/method.h"

#include <cmath>

#include "devices/exchange/json_fields.h"

namespace seamwright {

using nlohmann::json;

bool shows_board(CaptureKind kind) {
    return kind == CaptureKind::board_and_stripe || kind == CaptureKind::board_pose ||
           kind == CaptureKind::board_points || kind == CaptureKind::board_chain;
}

Expected<json> prepared_settings(const CalibrationMethod& method, json settings, const Calibration* base,
                                 const std::vector<Calibration>& kept) {
    return method.prepare ? method.prepare(std::move(settings), base, kept)
                          : Expected<json>(std::move(settings));
}

json default_settings(const CalibrationMethod& method) {
    json settings = method.fixed_settings;
    for (const MethodSetting& s : method.settings)
        settings[json::json_pointer(s.pointer)] = s.info.default_value;
    return settings;
}

Expected<void> set_setting(const CalibrationMethod& method, json& settings, const std::string& name,
                           double value) {
    for (const MethodSetting& s : method.settings) {
        if (s.info.name != name) continue;
        SEAM_OK(validate({{name, value}}, {s.info}, method.id));
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

MethodSetting number_setting(const char* name, const char* pointer, const char* unit, double minimum,
                             double maximum, double otherwise, int decimals, const char* help, Text label) {
    MethodSetting s;
    s.info.name = name;
    s.info.unit = unit;
    s.info.minimum = minimum;
    s.info.maximum = maximum;
    s.info.default_value = otherwise;
    s.info.decimals = decimals;
    s.info.help = help;
    s.pointer = pointer;
    s.label = std::move(label);
    return s;
}

MethodSetting sphere_radius_setting() {
    return number_setting("radius", "/radius_mm", "mm", 1, 500, 25, 4, "Radius of the sphere.",
                          "Radius of the sphere");
}

std::vector<MethodSetting> board_settings() {
    return {number_setting("board_columns", "/board/columns", "", 3, 200, 7, 0,
                           "Inner corners along the board.", "Corners along"),
            number_setting("board_rows", "/board/rows", "", 3, 200, 6, 0, "Inner corners across the board.",
                           "Corners across"),
            number_setting("board_pitch", "/board/pitch_mm", "mm", 0.2, 1000, 10, 3, "Edge of a square.",
                           "Edge of a square")};
}

Expected<std::string> entry_id(const json& entry, std::size_t index, const std::string& where) {
    if (!entry.is_object()) return input_error("this is not an object", where);
    const auto it = entry.find("id");
    if (it == entry.end()) return std::to_string(index);
    if (it->is_string()) return it->get<std::string>();
    if (it->is_number()) return it->dump();
    return input_error("the id is neither text nor number", json_path(where, "id"));
}

Expected<std::pair<int, int>> image_size_of(const json& data, const std::string& where) {
    SEAM_TRY(auto field, json_field(data, "size", where));
    const std::string at = json_path(where, "size");
    SEAM_TRY(auto size, as_numbers(*field, 2, at));
    constexpr double kLargest = 1e5;
    for (const double side : size)
        if (!(side >= 1 && side <= kLargest))
            return input_error("this is no image size", at, "give [width, height] in pixels");
    return std::pair(static_cast<int>(size[0]), static_cast<int>(size[1]));
}

}  // namespace seamwright
