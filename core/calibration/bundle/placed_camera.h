#pragma once
// A camera that is calibrated and whose place is known: what several cameras measure with together.

#include <string>

#include "core/calibration/camera/camera.h"
#include "core/calibration/pose/static_chain.h"

namespace seamwright {

// World: whatever frame all cameras are placed in; for sensors on a gripper, the flange or the robot's base. The
// covariance of the place is the camera's own (zero = taken as exact); cameras err independently of each other.
struct PlacedCamera {
    std::string id;
    CameraModel camera;
    UncertainPose world_from_camera;
};

// Of one pixel coordinate, where nothing says it: what a feature in an image is found to.
inline constexpr double kUnknownNoise_px = 0.3;
// Up to these the noise that was found is good, or usable; what lies nearer than the last is no wrong sight.
inline constexpr double kGoodNoise_px = 0.5, kUsableNoise_px = 1.5, kSmallestWrong_px = 0.5;

// Refuses lenses without focal length, places that are no rigid poses in mm, covariances that are none, ids missing or
// twice.
Expected<void> check_cameras(const std::vector<PlacedCamera>& cameras);
// A pixel outside the image is somebody else's.
Expected<void> check_pixel(const PlacedCamera& camera, const Eigen::Vector2d& pixel, const Text& where);

// Root of the largest variance in any direction.
double worst_sigma(const Eigen::Matrix3d& covariance);

}  // namespace seamwright
