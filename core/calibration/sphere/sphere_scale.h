#pragma once
// What the cuts of a sphere of known radius say of the sensor's own millimetres: unequal scales and a shear make the cuts
// oval, and the known motions from cut to cut are read longer or shorter. K of field_scale.h by least squares over the
// points, together with hand-eye and centre, every cut's centre free within what the robot's pose errs by.

#include "core/calibration/field_scale.h"
#include "core/calibration/sphere/tcp_sphere_solve.h"

namespace seamwright::tcp_sphere {

// One standard deviation, which is what the cuts can tell at most. The calibration takes none of it off: a value beyond
// chance (0.1 %) counts with its sigma, sqrt(k^2 + sigma^2), and is `shown`. Zero where the cuts do not tell.
// `centre_variance`: of a cut's centre by its pose, an axis.
FieldScale sphere_scale(const std::vector<Section>& sections, const Model& model, double point_variance_mm2,
                        double centre_variance_mm2);

}  // namespace seamwright::tcp_sphere
