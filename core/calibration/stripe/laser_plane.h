#pragma once
// Camera to laser plane (4.1.2-4.1.3): a point of the calibration body seen in the image (u, v) and measured
// in the sensor's profile (x, 0, z), in several positions. Six parameters of camera_from_laser by
// Levenberg-Marquardt on the pixel residuals; (4.9) corrected: the projection is divided by the scale w. No
// start value is asked for: the profile points lie in one plane, so the homography to the image decomposes
// into the pose (both mirror poses are tried).
//
// Noise model: pixels independent, one sigma, estimated from the redundancy (the covariance is as wide as a normal one
// that holds 95 % has to be); where the places' own sigma is stated and says more, as much as that gives in the image. The
// camera counts as exact; where the residuals contradict it (laser_plane_camera.h), the sigmas hold what the pose moves by
// when it is freed.
// Degenerate: points on one line (the pose may turn about it).

#include <string>
#include <vector>

#include "core/calibration/calibration.h"
#include "core/error.h"
#include "core/profile/sensor_model.h"

namespace seamwright {

struct LaserPair {
    std::string id;
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    Eigen::Vector2d laser_mm = Eigen::Vector2d::Zero();  // x, z
};

struct LaserPlaneResult {
    Pose camera_from_laser = Pose::Identity();
    Matrix6 covariance = Matrix6::Zero();
    double rms_px = 0;
    std::vector<Text> notices;
    CalibrationReport report;  // x, y, z (mm), rx, ry, rz (deg)
};

// At least 4 pairs (10 and more advised). A pair that the others contradict is named and left out (from 6 pairs on).
// Error: fewer than 4 pairs, NaN, unknown or double ids. Verdict undetermined: points on one line, sigma beyond 5 mm
// or 2 degrees. poor: pixels and points miss one another by more than 1.5 px, they fit better as [v, u], or another
// camera takes 0.3 px of their residuals away; from 0.5 and 0.1 px on at most usable. place_sigma_mm: of laser_mm
// along each axis, independent from pair to pair (a stage's or a robot's arrivals); 0: not stated.
Expected<LaserPlaneResult> calibrate_laser_plane(const CameraModel& camera,
                                                 const std::vector<LaserPair>& pairs,
                                                 const std::vector<std::string>& exclude,
                                                 double place_sigma_mm = 0);

}  // namespace seamwright
