#pragma once
// Pixel to millimetre: a point of the image to a point of the laser plane.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/pose.h"
#include "core/profile/profile.h"
#include "core/profile/stripe/stripe_image.h"

namespace seamwright {

// Brown-Conrady camera (2.7)-(2.8), OpenCV's order of coefficients: k1, k2, p1, p2, k3. Pixels.
//     x_d = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2),  u = fx x_d + cx   (y alike, p1
//     and p2 swapped)
// A polynomial distortion folds back at some radius: beyond it one pixel has several rays. Only the part from
// the axis to the fold is the lens; rays and pixels beyond it come out as NaN.
struct CameraModel {
    double fx = 1, fy = 1, cx = 0, cy = 0;
    double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
    int width = 0, height = 0;
    // To pixel, distorted; may lie outside width x height. NaN: not in front of the camera, or beyond the
    // fold.
    Eigen::Vector2d project(const Eigen::Vector3d& point_camera_mm) const;
    // To normalised (x/z, y/z): fixed-point start, then Newton, to 1e-12 of the normalised pixel. NaN where
    // no ray has this pixel.
    Eigen::Vector2d undistort(const Eigen::Vector2d& pixel) const;
};

// Look-up table on a regular pixel grid (2.4.1): node (i, j) is pixel (u0 + i step_u, v0 + j step_v),
// bilinear between nodes. NaN nodes are holes: a cell with one such corner gives nothing. Pixels outside the
// grid give nothing.
struct LookupTable {
    double u0 = 0, v0 = 0, step_u = 1, step_v = 1;                          // px, steps above 0
    int columns = 0, rows = 0;                                              // nodes, at least 2 each
    std::vector<double> x_mm, z_mm;                                         // [rows * columns], row-major
    std::optional<Eigen::Vector2d> at(const Eigen::Vector2d& pixel) const;  // (x, z) mm
};

// Camera and laser plane, or a table. camera_from_laser maps (x, 0, z) of the sensor frame into the camera
// (4.18).
struct SensorModel {
    CameraModel camera;
    Pose camera_from_laser = Pose::Identity();
    std::optional<LookupTable> table;  // used instead when present
    // nullopt: the ray misses the plane (or meets it at less than 1e-9 rad), goes backwards, or falls into a
    // hole of the table; the pixel is not finite or has no ray.
    std::optional<Eigen::Vector2d> to_laser(const Eigen::Vector2d& pixel) const;  // (x, z) mm
    // Camera form only, whether a table is present or not; the inverse of the camera form of to_laser.
    // nullopt: behind the camera or beyond the lens.
    std::optional<Eigen::Vector2d> to_pixel(const Eigen::Vector2d& xz_mm) const;
};

// The camera form of a model on a grid that covers the camera's width x height; nodes it cannot place are
// holes.
LookupTable tabulate(const SensorModel& model, double step_px);

// The pixel of a position on an image line: (line, position) of columns, (position, line) of rows.
inline Eigen::Vector2d pixel_of(ScanLines scan, int line, double position_px) {
    return scan == ScanLines::columns ? Eigen::Vector2d(line, position_px)
                                      : Eigen::Vector2d(position_px, line);
}

// All candidates of a frame at once; no allocation after the first frame of a size. Peaks the model cannot
// place are left out, and so are truncated ones, whose middle was not seen.
void to_millimetres(const StripePeaks& peaks, const SensorModel& model, ProfileCandidates& candidates);

}  // namespace seamwright
