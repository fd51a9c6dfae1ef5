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

// A point that lies less deep is behind the camera.
inline constexpr double kLeastDepth_mm = 1e-6;

struct Corner {
    Eigen::Vector3d object_mm;
    Eigen::Vector2d pixel;
    double weight = 1;  // of the residual, not of its square
};

// Intrinsics, shape, frame_from_target: weight * (projection - pixel) of every corner of a view, whose camera stands
// at camera_from_frame.
ceres::CostFunction* corners(std::vector<Corner> view, const PlateShape& place,
                             const Pose& camera_from_frame = Pose::Identity());

// Pose of a body under cameras that are known, from where it stands.
struct Sights {
    Intrinsics camera;
    Pose camera_from_world = Pose::Identity();
    std::vector<Corner> corners;
};
struct KnownCamerasFit {
    double cost = 0;  // weighted sum of squares; infinity when a corner lies behind its camera at the start
    Matrix6 information = Matrix6::Zero();
};
KnownCamerasFit solve_pose(std::vector<Sights> sights, Pose& world_from_object);
// flange_from_camera, base_from_target, camera_from_target: Z * C^-1 * X^-1 against base_from_flange, in the flange's
// frame, (mm, rad) over their sigmas.
ceres::CostFunction* robot(const Pose& base_from_flange, double sigma_mm, double sigma_rad);
// Intrinsics, shape, plane, camera_from_target: distance of a stripe point of the plate from the plane over sigma.
ceres::CostFunction* stripe(const Eigen::Vector2d& pixel, const PlateShape& place, bool on_bow, int width,
                            int height, double sigma_mm);

}  // namespace seamwright::camera_costs
