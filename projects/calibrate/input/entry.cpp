#include "projects/calibrate/input/entry.h"

#include "core/geometry/pose.h"
#include "devices/exchange/json_fields.h"

namespace seamwright {

using nlohmann::json;

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

Expected<RobotRepeatability> repeatability_of(const json& data) {
    const auto robot = data.find("robot");
    if (robot == data.end() || robot->is_null()) return RobotRepeatability{};
    SEAM_TRY(const double mm, json_number(*robot, "sigma_mm", "robot"));
    SEAM_TRY(const double deg, json_number_or(*robot, "sigma_deg", 0.0, "robot"));
    const RobotRepeatability stated{mm, rad_from_deg(deg)};
    SEAM_OK(check_repeatability(stated));
    return stated;
}

}  // namespace seamwright
