#pragma once
// Calibrating a laser-stripe camera from frames that each show a plate and the stripe, with or without the
// robot's pose: intrinsics, laser plane in the camera (4.1.2 with the plate in place of the triangular body),
// and hand-eye.
//
// The unknowns are solved together (plate_bundle.h), the plate's true shape among them. Which intrinsics and
// how much plate shape are free is decided by leave-one-frame-out prediction of the corners. The laser plane
// is found by consensus of whole frames first: a frame whose stripe contradicts the others (the laser was
// touched, the plate was lifted at the stripe) is named and left out, never averaged in.
//
// Noise model: corners independent, one sigma in px; robot poses one sigma in mm and in rad, at the flange; stripe rows 0.2
// mm with Huber's weight, and one error of each frame's stripe as a whole (stripe_move.h). The first three and the last are
// estimated from the residuals; the robot's are the stated ones where its repeatability is given and the residuals are not
// beyond chance against it.
//
// Poor: a laser that moved against the camera between two frames (named).
//
// Good: six frames or more and three sigma of the working point within 0.5 mm; poor beyond 3 mm, or where the robot's motion
// says that the plate is larger or smaller than stated (as of hand_eye.h).
//
// Degenerate: all plates parallel (f undetermined without robot motion); all stripes on one line in space
// (the plane may turn about it); fewer than two rotation axes of the robot (hand-eye undetermined).

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/calibration/board/board.h"
#include "core/calibration/camera/plate_bundle.h"
#include "core/calibration/field_scale.h"
#include "core/calibration/robot_repeatability.h"
#include "core/error.h"

namespace seamwright {

struct StripeFrame {
    std::string id;
    StripeImage image;
    std::optional<Pose> base_from_flange;
};

// What one frame says; kept as raw data, so that it can be solved again without the image.
struct StripeObservation {
    std::string id;
    int width = 0, height = 0;
    std::optional<FoundBoard> board;
    BoardMiss miss;  // of the picture; nothing of what was stored
    ScanLines scan = ScanLines::rows;
    std::vector<Eigen::Vector2d>
        stripe;  // candidates of all lines, several a line where there are reflections
    std::optional<Pose> base_from_flange;
};

// Finds plate and stripe. Never fails for what is not in the image: then the board is empty or the stripe has
// no points.
StripeObservation observe(const StripeFrame& frame, const BoardSpec& spec);

struct StripeCameraOptions {
    std::vector<std::string> exclude;      // frames left out of the solution
    std::optional<CameraFreedom> freedom;  // both or none: fixes the model instead of choosing it
    std::optional<ShapeFreedom> shape;
    RobotRepeatability robot;
};

struct StripeFrameResult {
    std::string id;
    bool board_found = false, used = false, stripe_used = false, robot_used = false;
    Text note;
    double corner_rms_px = 0;
    Pose camera_from_target = Pose::Identity();
    std::vector<Eigen::Vector2d> stripe;  // the rows on the plate
    std::vector<double> off_plane_mm;     // per row, signed
    double median_off_plane_mm = 0;
    int rows_on_board = 0,
        rows_on_plane = 0;  // rows within 0.5 mm; rows of the plate without a usable peak count as off
    // Hand-eye residual, also of a robot pose that was left out; NaN: no pose, no hand-eye.
    double robot_mm = std::numeric_limits<double>::quiet_NaN(),
           robot_deg = std::numeric_limits<double>::quiet_NaN();
};

struct StripeCameraResult {
    CameraModel camera;
    CameraFreedom freedom;
    ShapeFreedom shape_freedom = ShapeFreedom::rigid;
    PlateShape shape;
    double rms_px = 0, sigma_px = 0;
    int boards_found = 0;
    std::optional<LaserPlane> plane;  // normal with z > 0; offset = -distance
    double plane_distance_mm = 0;     // of the camera's centre
    double plane_sigma_deg = 0, plane_sigma_mm = 0;
    double on_plane_share = 0;      // rows within 0.5 mm / rows on the plate, frames that share the plane
    double on_plane_share_all = 0;  // the same over every frame with a stripe, contradicting ones included
    double plane_rms_mm = 0;        // over the rows of the frames that share the plane
    Pose camera_from_laser =
        Pose::Identity();  // sensor frame: y = normal, z towards the camera, origin on the optical axis
    std::optional<Pose> flange_from_camera, base_from_target;
    Matrix6 flange_from_camera_covariance = Matrix6::Zero();
    FieldScale scale;             // of the millimetres that camera and plane give; zero without a plane
    double target_spread_mm = 0;  // rms distance of the plate's origin in the base from its mean
    double target_spread_max_mm = 0;
    // As HandEyeResult's, the focal length's sigma with it; NaN without hand-eye.
    double target_size = std::numeric_limits<double>::quiet_NaN(),
           target_size_sigma = std::numeric_limits<double>::quiet_NaN();
    // Largest sigma of the point of the laser plane on the optical axis, on the flange where there is a hand-eye, else in
    // the camera; NaN without a plane.
    double working_sigma_mm = std::numeric_limits<double>::quiet_NaN();
    // Beyond chance above what the robot is stated to repeat; the larger of both counts.
    bool robot_contradicts = false;
    std::vector<StripeFrameResult> frames;
    CalibrationReport report;
};

// Error: unknown ids, mixed image sizes, no board in any frame, fewer than 3 frames with a board, all of them
// the same view, a pitch or a length unit that contradicts the robot's motion.
Expected<StripeCameraResult> calibrate_stripe_camera(const std::vector<StripeObservation>& observations,
                                                     const BoardSpec& spec,
                                                     const StripeCameraOptions& options);

}  // namespace seamwright
