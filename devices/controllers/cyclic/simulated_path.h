#pragma once
// The programmed path of a simulated controller during a cyclic correction: a slanted circle (or a line there
// and back), travelled at constant speed, with a tool that sways. Every derivative exists, so tangents can be
// checked.

#include "core/geometry/pose.h"

namespace seamwright {

struct SimulatedPath {
    Eigen::Vector3d centre_mm{900, -200, 600};
    double radius_mm = 150, speed_mm_s = 100;
    bool straight = false;
    Pose at(double time_s) const;                  // reference_from_tcp
    Eigen::Vector3d tangent(double time_s) const;  // unit, of the travel
};

}  // namespace seamwright
