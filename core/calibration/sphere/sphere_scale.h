#pragma once
// What the cuts of a sphere of known radius say of the sensor's own millimetres: a scale changes the cuts' radii, unequal
// scales and a shear make them oval. K of field_scale.h by least squares, every cut's centre free (what hand-eye and robot
// err by), its radius as good as the place along the sensor's Y is known: sigma_y |y| / rho.

#include "core/calibration/field_scale.h"
#include "core/calibration/sphere/tcp_sphere_solve.h"

namespace seamwright::tcp_sphere {

// As the calibration takes none of it off, found values count with their sigmas: sqrt(k^2 + sigma^2). Zero where the cuts
// do not tell. `centre_sigma_mm`: of each cut's centre along Y, robot and solution together.
FieldScale sphere_scale(const std::vector<Section>& sections, const Model& model, double point_variance_mm2,
                        double centre_sigma_mm);

}  // namespace seamwright::tcp_sphere
