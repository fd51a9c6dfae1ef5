#pragma once
// The programmed path of a simulated controller during a cyclic correction: a slanted circle (or a line there
// and back), travelled at constant speed, with a tool that sways: every derivative exists, so tangents can be
// checked. Or a path of poses, straight from one to the next, that ends standing at the last one; it carries the
// cell's flange (and its sensor) while it runs.

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/error.h"
#include "core/geometry/pose.h"
#include "devices/simulated/cell.h"

namespace seamwright {

struct SimulatedPath {
    Eigen::Vector3d centre_mm{900, -200, 600};
    double radius_mm = 150, speed_mm_s = 100;
    bool straight = false;
    std::vector<Pose> poses;     // reference_from_tcp; none: circle or line
    std::vector<double> way_mm;  // of each, from the first; as long as `poses`
    Pose flange_from_tcp = Pose::Identity();
    Pose at(double time_s) const;                  // reference_from_tcp
    Eigen::Vector3d tangent(double time_s) const;  // unit, of the travel

    // The robot is there: so is the cell's flange, if the path is one of poses and there is a cell.
    void carry(SimulatedCell* cell, const Pose& reference_from_tcp) const;
};

// Of {"path": [POSE, POSE, ...] (reference_from_tcp; the reference is base), "flange_from_tcp": POSE}, where given.
Expected<void> read_simulated_path(const nlohmann::json& settings, SimulatedPath& path);

}  // namespace seamwright
