#pragma once
// Pixel to millimetre: a point of the image to a point of the laser plane.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/pose.h"
#include "core/profile/profile.h"
#include "core/profile/stripe_image.h"

namespace seamwright {

// Brown-Conrady camera (2.7)-(2.8), OpenCV's order of coefficients: k1, k2, p1, p2, k3. Pixels.
struct CameraModel {
    double fx = 1, fy = 1, cx = 0, cy = 0;
    double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
    int width = 0, height = 0;
    Eigen::Vector2d project(const Eigen::Vector3d& point_camera_mm) const;  // to pixel, distorted
    Eigen::Vector2d undistort(const Eigen::Vector2d& pixel) const;          // to normalised x/z, y/z
};

// Look-up table on a regular pixel grid (2.4.1): bilinear between nodes; NaN nodes are holes.
struct LookupTable {
    double u0 = 0, v0 = 0, step_u = 1, step_v = 1;  // px
    int columns = 0, rows = 0;
    std::vector<double> x_mm, z_mm;  // [rows * columns], row-major
};

// Camera and laser plane, or a table. camera_from_laser maps (x, 0, z) of the sensor frame into the camera
// (4.18).
struct SensorModel {
    CameraModel camera;
    Pose camera_from_laser = Pose::Identity();
    std::optional<LookupTable> table;  // used instead when present
    // nullopt: the ray misses the plane, goes backwards, or falls into a hole of the table.
    std::optional<Eigen::Vector2d> to_laser(const Eigen::Vector2d& pixel) const;  // (x, z) mm
    std::optional<Eigen::Vector2d> to_pixel(const Eigen::Vector2d& xz_mm) const;  // camera form only
};

// All candidates of a frame at once; no allocation after the first frame of a size. Peaks the model cannot
// place are left out.
void to_millimetres(const StripePeaks& peaks, const SensorModel& model, ProfileCandidates& candidates);

}  // namespace seamwright
