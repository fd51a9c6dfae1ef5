#pragma once
// Where a camera (or area sensor) sits on the flange, or in the base, from poses of one fixed target.
//
// eye_in_hand: the camera rides on the flange, the target is fixed in the base:
//     base_from_flange_i * flange_from_camera * camera_from_target_i = base_from_target        (X =
//     flange_from_camera)
// eye_to_hand: the camera is fixed in the base, the target rides on the flange:
//     flange_from_base_i * base_from_camera * camera_from_target_i = flange_from_target         (X =
//     base_from_camera)
// Both are A_i X C_i = Y with X and Y unknown.
//
// Start: five closed forms (Park and Martin 1994: logarithms of the relative rotations; Horaud and Dornaika
// 1995: their quaternions; Andreff 1999: Kronecker product for rotation and translation at once; Daniilidis
// 1999: dual quaternions; Shah 2013: Kronecker product of the rotations of X and Y at once), on all pairs
// and, when pairs contradict one another, on small subsets; the one with the smallest sum of absolute
// residuals is kept. Refinement: X and Y jointly by Levenberg-Marquardt over
//     r_t = A_i X t_Ci - t_Y  [mm],   r_r = log(R_Y^T R_Ai R_X R_Ci)  [rad],   sum |r_t|^2 / s_t^2 + |r_r|^2
//     / s_r^2
// where s_t and s_r are estimated from the residuals themselves (variance components), so neither unit nor
// lever is weighed by hand. So wrong pairs are found. The answer then weighs the pairs by what cameras and robots err by
// (hand_eye_noise.h).
//
// Noise model: pairs independent; each errs across the sight of the target, along it, in tilt and in turn, and with the
// robot's turn, by five variances that are estimated. Covariances hold what this estimating adds: value +- 1.96 sigma
// holds 95 %. A stated repeatability of the robot is a part of every pair's error beside them that is not estimated.
// A stand of the robot counts once, however many pairs were taken there: their mean, so a robot's error that they share
// stays one error. Fewer than ten stands: hand_eye_few.h.
//
// The target's size is not solved for, but tested: camera_from_target's translations by one factor as a thirteenth
// unknown. Where it is off by more than 4 sigma, 2e-4 and 0.15 mm at the target, the answer is poor; where it is off by
// less, what that moves is in the covariance.
//
// Three stands of a stated robot do not tell the size that well: beside the test, a size that may be wrong by 1 %, as far as
// the pairs leave it open, is in the covariance.
//
// A camera that was bumped while the poses were taken sits otherwise from one of them on: looked for over the order of the
// pairs (hand_eye_break.h) from eight stands on; beyond chance (0.1 %) and 0.15 mm at the target, the answer is poor.
//
// Degenerate: one orientation (X's translation is free), rotations about one axis (translation along it and
// the turn about it are free): status undetermined, in words. A pair that the others contradict is found,
// named and left out.

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/calibration/calibration.h"
#include "core/calibration/robot_repeatability.h"
#include "core/geometry/pose.h"

namespace seamwright {

enum class Mount { eye_in_hand, eye_to_hand };
std::string_view name_of(Mount mount);
std::optional<Mount> mount_named(std::string_view name);

struct HandEyePair {
    std::string id;
    Pose base_from_flange = Pose::Identity();
    Pose camera_from_target = Pose::Identity();
};

inline constexpr int kHandEyeFewestPairs = 3;  // different robot poses; eight or more are better

enum class HandEyeStatus { ok, undetermined };
std::string_view name_of(HandEyeStatus status);

struct HandEyeResult {
    HandEyeStatus status = HandEyeStatus::undetermined;
    Pose x = Pose::Identity();  // flange_from_camera (eye_in_hand) or base_from_camera (eye_to_hand)
    Pose y = Pose::Identity();  // base_from_target (eye_in_hand) or flange_from_target (eye_to_hand)
    Matrix6 covariance_x = Matrix6::Zero(), covariance_y = Matrix6::Zero();
    // |r_t|, |r_r| over the pairs used, and the estimated s_t, s_r an axis; known also of an undetermined answer.
    double rms_mm = 0, rms_deg = 0;
    double sigma_mm = 0, sigma_deg = 0;
    int pairs_used = 0;
    bool fits = false;  // pairs not used fit as they should; how well the poses determine the answer is apart
    // The factor that the camera's distances to the target want by the robot's motion, and its sigma (1/1): pitch over
    // stated pitch, or the focal length's error. NaN: too few pairs, or they do not fit.
    double target_size = std::numeric_limits<double>::quiet_NaN(),
           target_size_sigma = std::numeric_limits<double>::quiet_NaN();
    bool reversed = false;  // what is poor or undetermined fits with the directions of one list reversed
    std::string start;      // which closed form the refinement began from
    std::vector<Text> degenerate;  // plain words
    std::vector<Text> notices;
    CalibrationReport report;  // parameters x y z [mm] rx ry rz [deg] of X, then target_* of Y
};

// Three pairs without a stated robot are poor: they do not tell what they err by.
//
// Whether the target's size is off beyond chance, and by more than what robots and pitches are known to at that distance.
bool wrong_target_size(double size, double sigma, double reach_mm);
// "by the robot's motion the target is .. larger than stated"
Judgement wrong_size_judgement(double size);

// Bad input (fewer than three different pairs, a pair given twice, metres, NaN, unknown id to exclude, a repeatability that is none) is an
// Error.
Expected<HandEyeResult> calibrate_hand_eye(Mount mount, const std::vector<HandEyePair>& pairs,
                                           const std::vector<std::string>& exclude = {},
                                           const RobotRepeatability& robot = {});

}  // namespace seamwright
