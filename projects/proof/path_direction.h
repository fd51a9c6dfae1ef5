#pragma once
// The measurand of a region: the deviation across the bead, along normal and binormal of the path, at its path
// points. A path point is a spot's reference; the tangent is the taught contour's, the normal the sensor's height
// axis freed of it.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "projects/model/project.h"

namespace seamwright {

struct PathDirection {
    std::string spot_id;
    bool normal = false;                  // else the binormal
    Eigen::Vector3d point_mm, direction;  // work object, the part as taught
    // What a displacement D (workobject_from_movedworkobject) moves the point along it, mm.
    double value(const Pose& d) const { return direction.dot(d * point_mm - point_mm); }
};

// Normal and binormal of each calibrated, enabled spot, in the region's order.
std::vector<PathDirection> path_directions(const Project& project, const Region& region);

}  // namespace seamwright
