#pragma once
// Where to hold the sensor before a calibration target: the poses that a person is led through, and the
// simulated robot goes to. How well they are met is no part of any answer.

#include <vector>

#include "core/geometry/pose.h"

namespace seamwright {

struct TargetPlace {
    Eigen::Vector3d turn_deg;   // rotation vector of the sensor against the target
    Eigen::Vector3d offset_mm;  // of the sensor's origin, target frame
};
Pose target_from_sensor(const TargetPlace& view);

// Plate: tilts to both sides about both axes at different heights and places, turned about the sight line.
const std::vector<TargetPlace>& plate_views();
// Sphere (target frame at its centre): the cut well off the middle to both sides, the sensor turned about all
// three axes, and the sphere all over the field of view. The sensor's directions are known by how far apart
// the centres lie in its frame: with a robot that arrives within 0.034 mm the worst is stated to 0.1 degree,
// to 0.2 degree where the sphere stays within 8 mm of the middle.
const std::vector<TargetPlace>& sphere_views();
// Plate: heights over the whole field, a little tilted to both sides, so that the lines cross the image
// everywhere.
const std::vector<TargetPlace>& line_views();
// Triangular body: its apex all over the field, corners first, the sensor never turned.
const std::vector<TargetPlace>& apex_views();

}  // namespace seamwright
