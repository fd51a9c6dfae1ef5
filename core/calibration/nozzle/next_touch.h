#pragma once
// The touch that would tell most, in words.

#include "core/calibration/nozzle/touch_fit.h"

namespace seamwright::nozzle {

// Of touches from all sides and above, with the flange as it was and turned by 30 degrees about its axes: the one that
// leaves the smallest worst sigma of the tip, and tells it from a second place that fits as well.
Text next_touch(const TouchSet& set, const TouchFit& fit);
// What the touches leave open: "the tip along X of the flange".
std::vector<Text> open_directions(const TouchFit& fit);

}  // namespace seamwright::nozzle
