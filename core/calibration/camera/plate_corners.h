#pragma once
// Corners of one view of a plate and what they say of its shape. Private to core/calibration/camera.

#include "core/calibration/camera/plate_bundle.h"

namespace seamwright {

using ShapeNumbers = Eigen::Matrix<double, 5, 1>;  // of PlateShape
inline constexpr Eigen::Index kPoseNumbers = 6, kShapeNumbers = 5;

bool given_flat(const CameraData& data);
PlateShape shape_over(const CameraData& data);  // flat, about the middle of what the views show

// Projected less seen, px: u and v of each corner.
Eigen::VectorXd corner_misses(const Intrinsics& k, const Pose& pose, const PlateShape& shape,
                              const ShapeNumbers& bent, const CameraPoints& view);
// Their derivatives by the pose's tangent and the shape's numbers.
Eigen::MatrixXd by_pose_and_shape(const Intrinsics& intrinsics, const Pose& pose, const PlateShape& shape,
                                  const CameraPoints& view);

}  // namespace seamwright
