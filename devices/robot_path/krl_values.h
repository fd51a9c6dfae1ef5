#pragma once
// Frames and functions of KRL. Private to krl.cpp.

#include <optional>
#include <string>
#include <vector>

#include "devices/robot_path/machine/machine.h"

namespace seamwright::program_path {

Value krl_frame_value(const Pose& pose);
// What is missing is taken from `otherwise`. nullopt: a number is not known, or missing with nothing to take.
std::optional<Pose> krl_pose_of(const Value& v, const std::optional<Pose>& otherwise);
// ABS, SIN, INV_POS, ...; nullopt: another function, or of what is not known.
std::optional<Value> krl_function(const std::string& name, const std::vector<Value>& arguments);
// X, A, E1 of a frame and A1 of an axis.
bool is_krl_coordinate(const std::string& component);

}  // namespace seamwright::program_path
