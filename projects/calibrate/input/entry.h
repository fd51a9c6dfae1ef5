#pragma once
// Fields that the data of several methods have.

#include <Eigen/Core>
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
// A sigma, in the unit that its name ends with. Error (input): not above 0 (or_exact: below 0), or above 1000 mm or px, 180
// degrees: what is larger says nothing, and its square or inverse is no number at last.
inline constexpr double kLargestSigma = 1000, kLargestSigma_deg = 180;
Expected<double> json_sigma(const nlohmann::json& entry, const std::string& key, const std::string& where);
Expected<double> json_sigma_or_exact(const nlohmann::json& entry, const std::string& key, double otherwise,
                                     const std::string& where);
// Error (input): a variance of these beyond what a sigma may be; the first three are of millimetres, the others of radians.
Expected<void> check_variances(const Eigen::VectorXd& variances, const std::string& where);
// "robot":{"sigma_mm","sigma_deg"?}: the robot's repeatability, one standard deviation of an arrival. Absent or null: not
// stated.
Expected<RobotRepeatability> repeatability_of(const nlohmann::json& data);

}  // namespace seamwright
