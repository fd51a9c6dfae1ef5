#pragma once
// A camera as the command line writes and reads it:
// {"fx","fy","cx","cy","k1","k2","p1","p2","k3","width","height"}, px.

#include <nlohmann/json.hpp>
#include <string>

#include "core/error.h"
#include "core/profile/sensor_model.h"

namespace seamwright {

nlohmann::json camera_json(const CameraModel& camera);
// fx, fy, cx, cy needed; absent distortion is 0, absent size twice the centre.
Expected<CameraModel> parse_camera(const nlohmann::json& json, const std::string& where);

}  // namespace seamwright
