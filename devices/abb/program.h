#pragma once
// RAPID for IRC5 and OmniCore (RobotWare 6.0 and later): SeamwrightServer.mod (a task of its own, rapid.h),
// Seamwright.mod and the project's SeamwrightSpots.mod (T_ROB1): entry, trigger and exit of every spot as
// robtargets of the flange in wobj0, triggered path-synchronously (TriggL), the application's work objects
// with base_from_frame in `oframe`, and the signature.
//
// Settings that it reads from the robot's: "address" and "port" (where the server listens).

#include "devices/robot_program.h"

namespace seamwright {

// Error (input): more than 64 spots or 32 frames, names that RAPID cannot hold, two frames of one name, a
// speed over 2 m/s, a pose that is not finite or beyond 100 m.
Expected<std::vector<ProgramFile>> write_abb_program(const ProgramRequest& request);

// NAME.mod: PROC NAME_run(tool) along the points in a work object of its own.
Expected<std::vector<ProgramFile>> write_abb_path(const PathProgramRequest& request);

}  // namespace seamwright
