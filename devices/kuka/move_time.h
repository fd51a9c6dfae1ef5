#pragma once
// How long a move by command may take: the program SEAMWRIGHT goes at 100 mm/s and settles for 0.3 s.

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/geometry/pose.h"

namespace seamwright {

// Twice the time of the way or of the turn, whichever is longer, for override, acceleration and the settling.
inline std::chrono::milliseconds kuka_move_time(const Pose& from, const Pose& to) {
    constexpr double kMmS = 100, kDegS = 30, kSettleS = 2;
    const double seconds = std::max(distance_mm(from, to) / kMmS, deg_from_rad(angle_rad(from, to)) / kDegS);
    return std::chrono::milliseconds(std::llround(1000 * (2 * seconds + kSettleS)));
}

}  // namespace seamwright
