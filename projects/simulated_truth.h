#pragma once
// The calibration that a simulated cell has by construction: its own optics and mounting. For desks, demos
// and tests; what a person calibrates is in core/calibration.

#include "projects/project.h"

namespace seamwright {

// Sensor and robot of driver "simulated", as connected (their identities go into the calibration). Error
// (input): another driver, settings that the cell refuses.
Expected<Calibration> simulated_truth(const SensorSetup& sensor, const RobotSetup& robot);

}  // namespace seamwright
