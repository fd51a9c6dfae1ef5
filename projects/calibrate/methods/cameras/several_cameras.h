#pragma once
// Placed cameras as data write them: {"id"?,"camera":CAMERA,"world_from_camera":LINK}; LINK = POSE, or
// {"pose":POSE,"covariance":6x6 (mm, rad)}, or {"pose":POSE,"sigma_mm","sigma_deg"}.

#include "core/calibration/bundle/placed_camera.h"
#include "projects/calibrate/input/entry.h"

namespace seamwright {

Expected<UncertainPose> parse_link(const nlohmann::json& value, const std::string& where);
Expected<PlacedCamera> parse_placed_camera(const nlohmann::json& entry, std::size_t index,
                                           const std::string& where);

}  // namespace seamwright
