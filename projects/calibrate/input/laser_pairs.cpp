#include "projects/calibrate/input/laser_pairs.h"

#include "devices/exchange/json_fields.h"
#include "projects/calibrate/input/entry.h"

namespace seamwright {

using nlohmann::json;

Expected<double> place_sigma_of(const json& data) {
    constexpr double kUsualLever_mm = 300, kLongestLever_mm = 5000;
    SEAM_TRY(const auto robot, repeatability_of(data));
    if (!robot.stated()) return 0.0;
    SEAM_TRY(const double lever_mm, json_number_or(data.at("robot"), "lever_mm", kUsualLever_mm, "robot"));
    if (!(lever_mm >= 0 && lever_mm <= kLongestLever_mm))
        return input_error("the lever is negative or above 5000 mm", "robot.lever_mm",
                           "give the distance of the flange to the middle of the laser plane");
    return place_sigma_mm(robot, lever_mm);
}

json with_lever(json data, const Pose& flange_from_sensor) {
    const double lever_mm = flange_from_sensor.translation().norm();
    if (const auto robot = data.find("robot"); robot != data.end() && robot->is_object() && lever_mm > 0)
        if (!robot->contains("lever_mm")) (*robot)["lever_mm"] = lever_mm;
    return data;
}

Expected<std::vector<LaserPair>> parse_laser_pairs(const json& data) {
    SEAM_TRY(auto list, json_array(data, "pairs", ""));
    std::vector<LaserPair> pairs;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const json& entry = (*list)[i];
        const std::string where = json_path("pairs", i);
        LaserPair pair;
        SEAM_TRY(auto id, entry_id(entry, i, where));
        SEAM_TRY(auto pixel, json_vector2(entry, "pixel", where));
        SEAM_TRY(auto laser, json_vector2(entry, "laser", where));
        pairs.push_back({id, pixel, laser});
    }
    return pairs;
}

}  // namespace seamwright
