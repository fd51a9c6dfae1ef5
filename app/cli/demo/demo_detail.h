#pragma once
// Shared by the demo's sources.

#include <chrono>

#include "app/cli/demo/demo.h"
#include "projects/station/station.h"

namespace seamwright::cli {

// The cell draws in this very program, for as long as a busy machine makes it: so long a frame is waited for.
inline constexpr std::chrono::minutes kDrawing{2};

// Where the frames that the robot holds put spots and bead of the project's regions, against where the part truly is.
Expected<void> judge(const SimulatedCell& cell, const Project& project, RobotLink& robot, DemoPart& part);

// Restores the taught frames, as the controller does between two parts.
Expected<void> reset_frames(RobotLink& robot, const Project& project);

// The chapter from the drawing, on the same cell: `connect` gives a station of the copied project its devices.
Expected<DemoOffline> run_offline(const DemoOptions& options, const DemoOutcome& hand, SimulatedCell& world,
                                  const std::string& door_step,
                                  const std::function<Expected<void>(Station&)>& connect,
                                  const std::function<void(const std::string&)>& progress);

}  // namespace seamwright::cli
