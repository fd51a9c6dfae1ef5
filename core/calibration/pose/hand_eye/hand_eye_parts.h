#pragma once
// Of what the error of a pair of hand-eye is made. Inner part of hand_eye.h.

#include <array>
#include <vector>

#include "core/calibration/pose/hand_eye/hand_eye_solve.h"
#include "core/calibration/robot_repeatability.h"

namespace seamwright::hand_eye {

// Across and along the sight of the target (mm in the frame of Y's parent); about the target's x and y, about its z; a
// turn of the flange, with its lever.
inline constexpr std::size_t kErrorKinds = 5;

// Of the residuals over the scales, one entry a used pair.
struct PairParts {
    std::vector<std::array<Matrix6, kErrorKinds>> parts;  // each of variance 1
    std::vector<Matrix6> known;                           // the stated robot's
};

// `robot_outside`: the robot's pose errs in the frame of Y's parent (eye_to_hand), else in its own.
PairParts pair_parts(const Chain& chain, bool robot_outside, const RobotRepeatability& robot,
                     const Scales& scales, const Pose& x, const Pose& y);

// Twelve columns of X and Y and, where the target's size is free, a thirteenth: of all camera_from_target's translations
// by one factor.
using PairRows = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 13>;
using Unknowns = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 13, 1>;
using UnknownsSquare = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 13, 13>;

struct PairLinear {
    std::vector<Vector6> residual;
    std::vector<PairRows> jacobian;
};
PairLinear linear_pairs(const Chain& chain, const Pose& x, const Pose& y, const Scales& scales,
                        bool free_size);

// I^-1 of an information, whatever its units.
UnknownsSquare cover_of(const UnknownsSquare& information);

// Moves X, Y and, as the thirteenth of `step`, the size of the target in `chain`.
void move_by(const Unknowns& step, Chain& chain, Pose& x, Pose& y);

}  // namespace seamwright::hand_eye
