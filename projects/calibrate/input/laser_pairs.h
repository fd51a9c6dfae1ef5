#pragma once
// Pairs of a pixel and the point of the laser plane it shows, as they stand in laser-plane and lut data.

#include <nlohmann/json.hpp>

#include "core/calibration/stripe/laser_plane.h"
#include "core/geometry/pose.h"

namespace seamwright {

// "pairs":[{"id"?,"pixel":[u,v],"laser":[x,z]}].
// Sigma of a pair's "laser" along each axis, where a robot carries the sensor or the target from place to place:
// "robot":{"sigma_mm","sigma_deg"?,"lever_mm"?}; the lever is from the flange to the middle of the laser plane, 300 mm
// where it is not given. 0: not stated.
Expected<double> place_sigma_of(const nlohmann::json& data);
// The lever of a sensor mounted so, where the data state a robot without one.
nlohmann::json with_lever(nlohmann::json data, const Pose& flange_from_sensor);

Expected<std::vector<LaserPair>> parse_laser_pairs(const nlohmann::json& data);

}  // namespace seamwright
