#pragma once
// A capture of laser-plane and lut: the apex of a triangular body in the image and in the sensor's plane.

#include "devices/frame.h"
#include "projects/model/project.h"

namespace seamwright {

// {"pixel":[u,v],"laser":[x,z],"flanks":[[u,v] left end, apex, right end]}.
//
// The place in the laser plane comes from the frame's own profile where the sensor gives one in millimetres.
// Else the robot is the stage: the body lies square to the sensor and the robot shifts the sensor in its own
// X and Z alone, so that the apex moves by as much against it. The first apex ("anchor" in `settings`, made
// when it is missing) has the place that the calibration in use gives it, (0, 0) without one: the origin of
// the laser plane stays where it is. Error (input): no apex is seen, the sensor was turned by more than 0.05
// degrees or shifted by more than 1 mm along its Y since the anchor, neither profile nor robot.
Expected<nlohmann::json> apex_pair(nlohmann::json& settings, const SensorSetup& sensor,
                                   const Calibration* base, const Frame& frame,
                                   const std::optional<Pose>& base_from_flange);

}  // namespace seamwright
