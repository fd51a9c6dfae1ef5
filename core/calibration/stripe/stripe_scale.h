#pragma once
// How well a solved camera and laser plane know the sensor's own millimetres: the covariance of both carried through
// pixel -> laser plane over the picture, and its linear part (field_scale.h).

#include <functional>

#include "core/calibration/camera/camera.h"
#include "core/calibration/field_scale.h"
#include "core/calibration/stripe/stripe_plane.h"

namespace seamwright {

// `basis`: intrinsics (9) from the first columns of `covariance`; its last three are those of plane_manifold(). `frame`:
// camera_from_laser of a plane. Derivatives by differences of a thousandth of a sigma.
FieldScale stripe_scale(const Intrinsics& intrinsics, int width, int height, const LaserPlane& plane,
                        const Eigen::MatrixXd& basis, const Eigen::MatrixXd& covariance,
                        const std::function<Pose(const LaserPlane&)>& frame);

}  // namespace seamwright
