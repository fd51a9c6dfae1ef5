#pragma once
// Measuring with several cameras: the point two rays nearly meet in (2.3), and the frame of one object seen
// by several cameras (2.24).

#include <vector>

#include "core/calibration/camera/camera.h"

namespace seamwright {

struct PlacedCamera {
    CameraModel camera;
    Pose camera_from_world = Pose::Identity();
};

// Midpoint of the common perpendicular of the rays through `pixels`, and the rays' distance there. nullopt:
// parallel rays, a ray that is not finite, a point behind a camera.
struct StereoPoint {
    Eigen::Vector3d world_mm = Eigen::Vector3d::Zero();
    double gap_mm = 0;
};
std::optional<StereoPoint> triangulate(const PlacedCamera& first, const Eigen::Vector2d& first_pixel,
                                       const PlacedCamera& second, const Eigen::Vector2d& second_pixel);

// One feature of the object in one camera. Weight v of (2.24): 1 / variance relative to the others; 0 = not
// detected.
struct BundleSight {
    int camera = 0;
    Eigen::Vector3d object_mm = Eigen::Vector3d::Zero();
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    double weight = 1;
};

struct BundlePose {
    Pose world_from_object = Pose::Identity();
    Matrix6 covariance = Matrix6::Zero();  // zero when there is no redundancy
    double rms_px = 0;                     // weighted
    bool determined =
        false;  // false: the sights leave a direction open (fewer than 3 features, all on one line)
};

// min sum v d(Q(a_j, b_i, X), p_ij)^2 over X = world_from_object, from `start`. Error: no camera of that
// number, weights negative or not finite, fewer than three sights, a feature behind its camera at the start.
Expected<BundlePose> bundle_object(const std::vector<PlacedCamera>& cameras,
                                   const std::vector<BundleSight>& sights, const Pose& start);

}  // namespace seamwright
