#pragma once
// Pairs of a pixel and the point of the laser plane it shows, as they stand in laser-plane and lut data.

#include <nlohmann/json.hpp>

#include "core/calibration/stripe/laser_plane.h"

namespace seamwright {

// "pairs":[{"id"?,"pixel":[u,v],"laser":[x,z]}].
Expected<std::vector<LaserPair>> parse_laser_pairs(const nlohmann::json& data);

}  // namespace seamwright
