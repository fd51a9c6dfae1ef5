#pragma once
// The simulated door as a project: contour ends at the default spots, one region of all of them, calibrated
// by construction. References are still to be taught.

#include "devices/capture/capture.h"
#include "devices/exchange/pose_json.h"
#include "devices/registry.h"
#include "devices/simulated/cell.h"
#include "devices/simulated/scene/door.h"
#include "projects/model/project.h"

namespace seamwright {

nlohmann::json cell_settings(const Pose& displacement);
FeatureRecipe edge_recipe();
Project door_project(const SimulatedCell& cell, const nlohmann::json& settings);

}  // namespace seamwright
