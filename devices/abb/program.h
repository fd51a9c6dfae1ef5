#pragma once
// RAPID for IRC5 and OmniCore (RobotWare 6.0 and later): SeamwrightServer.mod (a task of its own, rapid.h),
// Seamwright.mod and the project's SeamwrightSpots.mod (T_ROB1): entry, trigger and exit of every spot as
// robtargets of the flange in wobj0, triggered path-synchronously (TriggL), the application's work objects
// with base_from_frame in `oframe`, and the signature.
//
// Settings that it reads from the robot's, all optional:
//   "address": "192.168.125.1", "port": 1025        where the server listens
//   "tool": NAME of a tooldata of T_ROB1, whose load the moves then carry, or
//   "load": {"mass_kg", "centre_mm": [x, y, z], "inertia_kgm2": [x, y, z]}, in the flange's frame.
// Without either the moves carry what tool0 does, 1 g: the controller then knows nothing of the sensor's
// weight.
//
// For abb-egm also SeamwrightEgm.mod with the robot's "cycle_ms" as sample rate; the settings above are then
// those of its measuring driver.

#include "devices/robot_program.h"

namespace seamwright {

// Error (input): more than 64 spots or 32 frames, names that RAPID cannot hold, reserves or our modules use,
// two frames of one name, a speed over 2 m/s, a pose that is not finite or beyond 100 m, a sample rate that EGM
// has not.
Expected<std::vector<ProgramFile>> write_abb_program(const ProgramRequest& request);

// NAME.mod: PROC NAME_run(tool) along the points in a work object of its own.
Expected<std::vector<ProgramFile>> write_abb_path(const PathProgramRequest& request);

}  // namespace seamwright
