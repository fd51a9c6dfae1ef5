#pragma once
// The project that the first start opens: a car door in the simulated cell, twelve spots taught, four
// regions.

#include "projects/model/project.h"

namespace seamwright {

// The calibration is the cell's truth ("simulated truth"); references are measured in one rendered frame per
// spot, the contour's curve follows the door's edge. Well under a second.
Expected<Project> demo_project();

}  // namespace seamwright
