#include "projects/calibrate/solution/camera_json.h"

#include <algorithm>
#include <cmath>

#include "devices/exchange/json_fields.h"

namespace seamwright {

using nlohmann::json;

json camera_json(const CameraModel& c) {
    return {{"fx", c.fx}, {"fy", c.fy}, {"cx", c.cx}, {"cy", c.cy},       {"k1", c.k1},        {"k2", c.k2},
            {"p1", c.p1}, {"p2", c.p2}, {"k3", c.k3}, {"width", c.width}, {"height", c.height}};
}

Expected<CameraModel> parse_camera(const json& data, const std::string& where) {
    CameraModel c;
    for (auto [key, target] : {std::pair{"fx", &c.fx}, {"fy", &c.fy}, {"cx", &c.cx}, {"cy", &c.cy}}) {
        SEAM_TRY(auto value, json_number(data, key, where));
        *target = value;
    }
    for (auto [key, target] :
         {std::pair{"k1", &c.k1}, {"k2", &c.k2}, {"p1", &c.p1}, {"p2", &c.p2}, {"k3", &c.k3}}) {
        SEAM_TRY(auto value, json_number_or(data, key, 0, where));
        *target = value;
    }
    if (!(c.fx > 0) || !(c.fy > 0))
        return input_error("a focal length must be positive", where, "give fx and fy in pixels");
    auto width = json_number_or(data, "width", std::ceil(2 * std::abs(c.cx)) + 1, where);
    auto height = json_number_or(data, "height", std::ceil(2 * std::abs(c.cy)) + 1, where);
    if (!width) return tl::unexpected(width.error());
    if (!height) return tl::unexpected(height.error());
    c.width = static_cast<int>(std::clamp(*width, 1.0, 1e6));
    c.height = static_cast<int>(std::clamp(*height, 1.0, 1e6));
    return c;
}

}  // namespace seamwright
