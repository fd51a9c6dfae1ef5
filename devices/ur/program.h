#pragma once
// URScript for PolyScope 3.12 / 5.4 and later: the module of resources/robot/ur with the project's spots
// (poses of the flange in the robot's base, metres and rotation vectors), the application frames and the
// signature written into it.
//
// Settings that it reads from the robot's: "first_register" (24), "trigger_output" (0, a standard digital
// output).

#include "devices/robot_program.h"

namespace seamwright {

// Of every motion of the measuring program: a= in sw_pass.
inline constexpr double kUrAcceleration_mm_s2 = 1200;

// Error (input): more than 64 spots or 32 frames, two frames of one name or of one number (module.h), a speed
// over 2 m/s, a pose that is not finite or beyond 100 m.
Expected<std::vector<ProgramFile>> write_ur_program(const ProgramRequest& request);

// NAME.script: def NAME() along the points; the TCP is the caller's.
Expected<std::vector<ProgramFile>> write_ur_path(const PathProgramRequest& request);

}  // namespace seamwright
