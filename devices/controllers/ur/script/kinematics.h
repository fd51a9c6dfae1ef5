#pragma once
// Joint angles of a UR10e for a pose of the flange, as RTDE tells them.

#include <array>

#include "core/geometry/pose.h"

namespace seamwright::urscript {

using Joints = std::array<double, 6>;  // rad

// By the Denavit-Hartenberg parameters that Universal Robots publishes.
Pose base_from_flange(const Joints& q);
// Some damped least-squares steps from `q` towards the pose; out of reach it stretches that way.
Joints joints_towards(const Pose& base_from_flange, Joints q, int steps);

}  // namespace seamwright::urscript
