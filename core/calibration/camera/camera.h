#pragma once
// Camera calibration from views of a plate (or of any body with known points): start by DLT and
// Zhang's/Tsai's closed form (2.10)-(2.22), then joint refinement of intrinsics, Brown-Conrady distortion
// (2.7)-(2.8) and one pose per view.
//
// Model: pixel = CameraModel::project(camera_from_target * object) + noise, noise independent, isotropic, of
// one unknown variance in px^2. Cost: sum of squared pixel residuals over all views.
//
// Degenerate: all views of a plate parallel to each other leave f undetermined (a longer lens farther away
// looks the same); a plate seen only in the middle of the image leaves the distortion undetermined; both show
// in the covariance and end in the verdict, never in a number called good. Errata of the source: (2.10)'s
// decomposition works for a body only; for a plate the homography constraints on the image of the absolute
// conic are used.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/calibration/calibration.h"
#include "core/calibration/normal_blocks.h"
#include "core/error.h"
#include "core/profile/sensor_model.h"

namespace seamwright {

// Points of one image: object_mm[i] (target frame) was seen at pixel[i].
struct CameraPoints {
    std::string id;
    std::vector<Eigen::Vector3d> object_mm;
    std::vector<Eigen::Vector2d> pixel;
};

struct CameraData {
    int width = 0, height = 0;  // px, the same for all views
    std::vector<CameraPoints> views;
};

// Which intrinsics the data alone say. Of the others (fy = fx, centre of the image, zero distortion) is known how
// cameras are built: held_intrinsics().
struct CameraFreedom {
    bool two_focals = true;
    bool centre = true;
    int radial = 3;  // k1..k3: 0, 1, 2 or 3 of them
    bool tangential = true;
};

struct CameraOptions {
    std::vector<std::string> exclude;  // ids of views left out of the solution
    // Absent: by cross-validation, the richest model within one standard error of the best, the rest held as cameras
    // are built. Given: what it does not free is meant to be exact.
    std::optional<CameraFreedom> freedom;
    double outlier_sigmas = 6;  // a point farther off (robust sigma) is named and left out; 0 = keep all
};

struct CameraResult {
    CameraModel camera;
    CameraFreedom freedom;                      // the model that was solved
    std::vector<Pose> camera_from_target;       // per view of the input, excluded ones included
    std::vector<Matrix6> pose_covariance;       // per view, zero for those left out
    std::vector<std::vector<char>> point_used;  // per view and point
    double rms_px = 0;                          // sqrt(mean |residual|^2 per point), as OpenCV states it
    double sigma_px = 0;                        // standard deviation of one coordinate, from the redundancy
    double covered_share = 0;                   // of the image, by the convex hull of all points
    double tilt_spread_deg = 0;                 // largest angle between the plate normals of two views
    CalibrationReport report;                   // parameters fx, fy, cx, cy (px), k1, k2, p1, p2, k3
};

// Error: fewer than one view of a body or two of a plate, views with fewer than 4 points, points on one line,
// NaN, pixels outside the image, identical views only, unknown ids. Verdict: undetermined when the views
// cannot fix f (sigma above 5 %); poor when sigma(f) > 1 % or rms > 1.5 px, or the views contradict the plate's stated
// shape (plate_doubt.h) and its own moves fx, fy or the centre by more than 3 sigma (less: usable, and the sigmas hold
// it); usable when sigma(f) > 0.2 %, rms
// > 0.5 px or the field is covered by less than a third.
Expected<CameraResult> calibrate_camera(const CameraData& data, const CameraOptions& options);

// Pose of a body with known points under a known camera: closed form (homography or DLT) and refinement; of
// the two mirror poses of a plate the better one. `rms_px` per point. Error: fewer than 4 points, points on
// one line, non-finite.
struct TargetPose {
    Pose camera_from_target = Pose::Identity();
    Matrix6 covariance = Matrix6::Zero();
    double rms_px = 0;
};
Expected<TargetPose> locate_target(const CameraModel& camera, const CameraPoints& view);

// Homography h with (u, v, 1) ~ h (x, y, 1) by normalised DLT; nullopt when degenerate (2.18)-(2.22).
std::optional<Eigen::Matrix3d> homography_dlt(const std::vector<Eigen::Vector2d>& from,
                                              const std::vector<Eigen::Vector2d>& to);

// --- pieces that the other camera calibrations build on
// -----------------------------------------------------------

// Intrinsics as a vector: fx, fy, cx, cy, k1, k2, p1, p2, k3.
using Intrinsics = Eigen::Matrix<double, 9, 1>;
inline constexpr std::array<const char*, 9> kIntrinsicNames{"fx", "fy", "cx", "cy", "k1",
                                                            "k2", "p1", "p2", "k3"};
Intrinsics intrinsics_of(const CameraModel& camera);
CameraModel camera_of(const Intrinsics& intrinsics, int width, int height);

// Columns: how each free unknown moves the nine intrinsics.
Eigen::MatrixXd freedom_basis(const CameraFreedom& freedom);

// What a model does not solve for is known as well as cameras are built, not exactly: directions of the nine
// intrinsics that `freedom` holds, and the standard deviation of their distance from the value they are held
// at. A centre lies within 3 % of the width of the middle, the two focal lengths agree to 0.2 %, k1 0.3, k2
// 0.2, k3 0.1, p1 and p2 0.002. As a prior in the normal equations it widens the covariance by what the data
// do not say, and lets what they do say move the parameter.
struct HeldIntrinsics {
    Eigen::MatrixXd directions;  // [9, n], orthogonal to each other and to freedom_basis
    Eigen::VectorXd sigma;       // [n], of the coordinate along each
};
HeldIntrinsics held_intrinsics(const CameraFreedom& freedom, double focal_px, int width);

// What is not free set to its fixed value: fy = fx, centre of the image, zero distortion.
Intrinsics conform(const Intrinsics& k, const CameraFreedom& freedom, int width, int height);

// The points of a view that are used; all when `used` is empty.
CameraPoints chosen(const CameraPoints& view, const std::vector<char>& used);

// Sum of squares of one view, in px^2. Infinity when a point falls behind the camera.
double squares_px2(const Intrinsics& k, const Pose& camera_from_target, const CameraPoints& view);

// Bare joint refinement from a start, no verdict. `normal` is that of the unknowns at the solution, which move the
// intrinsics by `basis`. With a corner sigma what `freedom` does not solve for is held within held_intrinsics(), and
// `normal` is in units of that sigma; without, it is held exactly, and `normal` is for a sigma of 1 px.
struct CameraSolution {
    Intrinsics intrinsics = Intrinsics::Zero();
    std::vector<Pose> camera_from_target;
    NormalBlocks normal;
    Eigen::MatrixXd basis;
    double cost = 0;  // px^2, of the corners; infinity at an impossible start
    std::size_t points = 0;
    bool converged = false;
};
CameraSolution refine_camera(const CameraData& data, const std::vector<std::vector<char>>& used,
                             const CameraFreedom& freedom, const CameraSolution& start,
                             std::optional<double> corner_sigma_px = std::nullopt);

// Start from closed forms: one focal length, centre in the middle, k1, and poses. nullopt when no view gives
// a pose.
std::optional<CameraSolution> start_camera(const CameraData& data);

}  // namespace seamwright
