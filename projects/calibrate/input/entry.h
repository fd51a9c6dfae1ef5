#pragma once
// Fields that the data of several methods have.

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "core/calibration/robot_repeatability.h"
#include "core/error.h"

namespace seamwright {

// "id" of an entry as text, a number as its text, absent: the entry's index ("0", "1", ...).
Expected<std::string> entry_id(const nlohmann::json& entry, std::size_t index, const std::string& where);
// "size": [width, height] in pixels.
Expected<std::pair<int, int>> image_size_of(const nlohmann::json& data, const std::string& where);
// "robot":{"sigma_mm","sigma_deg"?}: the robot's repeatability, one standard deviation of an arrival. Absent or null: not
// stated.
Expected<RobotRepeatability> repeatability_of(const nlohmann::json& data);

}  // namespace seamwright
