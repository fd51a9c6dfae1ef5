#pragma once
// A frame from six picked points of the part, as fixtures locate it: three lie on the plane z = 0, two on its line
// y = 0, one has x = 0.
//
// z is the plane's normal, so that the three go round it counter-clockwise (right hand); x runs from the first of the two
// to the second along the plane. The frame takes no average: points err by what they are picked with, at the edge of the
// triangle by as much as there.

#include <array>

#include "core/error.h"
#include "core/geometry/pose.h"

namespace seamwright {

inline constexpr double kNearestPick_mm = 1;  // two picks nearer than that say no direction
inline constexpr double kFlattestPick_deg =
    3;  // of the triangle's smallest angle; and of the line against the normal

// part_from_frame; mm. Error (input): picks that coincide or are not finite, three on a line, a line along the normal.
Expected<Pose> frame_by_three_two_one(const std::array<Eigen::Vector3d, 3>& plane,
                                      const std::array<Eigen::Vector3d, 2>& line,
                                      const Eigen::Vector3d& point);

}  // namespace seamwright
