#pragma once
// The simulated cell's door as a drawing: the rim of devices/simulated/scene/door.h, from the outer skin's fold to where
// the inner panel begins 60 mm inboard, as B-spline surfaces through the same formula. The inner panel with its beads and
// holes is no part of it: no spot looks there.
//
// Four sides, hinge, top, latch and bottom, each with the strips underside, fold, flange, its broken end, step, land, ramp
// and margin; sewn to one shell. Within 0.01 mm of the formula. Work object frame, millimetres.

#include <string>

#include "core/error.h"

namespace seamwright {

// AP214. Error (device): OpenCASCADE could not make it.
Expected<std::string> door_step();

}  // namespace seamwright
