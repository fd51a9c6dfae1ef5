#pragma once
// The calibration that a simulated cell has by construction: its own optics and mounting. For desks, demos
// and tests; what a person calibrates is in core/calibration.

#include <filesystem>

#include "devices/simulated/cell.h"
#include "devices/simulated/scene/gap_part.h"
#include "projects/model/project.h"

namespace seamwright {

// Sensor and robot of driver "simulated", as connected (their identities go into the calibration). Error
// (input): another driver, settings that the cell refuses.
Expected<Calibration> simulated_truth(const SensorSetup& sensor, const RobotSetup& robot);

// The simulated door (devices/simulated/scene/door.h) as a project, not taught yet: sensor "A" and robot "R1" of driver
// "simulated" with the calibration "truth" of that cell, its default spots as contour ends of the outer flange, none of them
// required, and one region of all of them for the frame "path". Settings and identities of the devices are left to whoever
// opens them.
Project simulated_door_project(const SimulatedCell& cell, const std::string& region, double sigma_mm);

// The simulated gripper (devices/simulated/gripper_cell.h) as a project: its sensors and robot calibrated by
// construction, one panel job "panel" of its places, not taught yet. `settings`:
// those of the cell, without "head"; the job's frame is added to them.
Expected<Project> simulated_panel_project(const nlohmann::json& settings);

// The simulated cell before two sheets with a gap (devices/simulated/scene/gap_part.h), as a project: calibrated by
// construction, spots S1 .. S4 along the gap for the gap check. The sheets are written to `mesh_file` (PLY),
// which must not be there yet. `settings`: those of the cell (cell.h), without "mesh" and "scene".
Expected<Project> simulated_gap_project(nlohmann::json settings, const std::vector<GapStation>& gap,
                                        const std::filesystem::path& mesh_file);

}  // namespace seamwright
