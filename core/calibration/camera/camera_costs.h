#pragma once
// The residuals of cameras and their plates as cost functions with automatic derivatives, compiled once. Private
// to core/calibration/camera.
//
// Blocks: intrinsics (9, order of camera.h); shape of the plate (5: stretch, shear, bow); poses as of problem.h;
// plane (4: unit normal, offset), all frames those of plate_bundle.h.

#include <ceres/cost_function.h>

#include <vector>

#include "core/calibration/camera/plate_bundle.h"
#include "core/calibration/problem.h"

namespace seamwright::camera_costs {

using Shape = Eigen::Matrix<double, 5, 1>;

struct Corner {
    Eigen::Vector3d object_mm;
    Eigen::Vector2d pixel;
    double weight = 1;  // of the residual, not of its square
};

// Intrinsics, shape, camera_from_target: weight * (projection - pixel) of every corner of a view.
ceres::CostFunction* corners(std::vector<Corner> view, const PlateShape& place);
// world_from_object alone, seen by a known camera that stands at camera_from_world.
ceres::CostFunction* known_camera(std::vector<Corner> view, const Intrinsics& camera,
                                  const Pose& camera_from_world);
// flange_from_camera, base_from_target, camera_from_target: base_from_flange * X * C against Z, (mm, rad) over
// their sigmas.
ceres::CostFunction* robot(const Pose& base_from_flange, double sigma_mm, double sigma_rad);
// Intrinsics, shape, plane, camera_from_target: distance of a stripe point of the plate from the plane over sigma.
ceres::CostFunction* stripe(const Eigen::Vector2d& pixel, const PlateShape& place, bool on_bow, int width,
                            int height, double sigma_mm);

}  // namespace seamwright::camera_costs
