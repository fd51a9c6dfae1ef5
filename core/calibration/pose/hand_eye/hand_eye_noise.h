#pragma once
// What the pairs of a hand-eye calibration err by, and X and Y weighed by it. Inner part of hand_eye.h.
//
// A camera knows the target's distance and tilt several times worse than its place across and its turn about its own
// normal, and a robot that turns wrongly moves what it carries. So the residual of pair i (mm in the frame of Y's
// parent, rad in the target) has the covariance
//     S_i = v_across A_i + v_depth D_i + v_tilt T + v_turn N + v_robot R_i + s_mm^2 (A_i + D_i) + s_rad^2 R_i
// A_i, D_i: across and along the sight of the target; T, N: about the target's x and y, and about its z; R_i: a turn
// of the flange, with its lever. (Equal errors in all directions, as a robot's place has, are A_i + D_i and T + N.)
// Fewer than ten pairs do not tell five variances apart (hand_eye_few.h). s_mm, s_rad: the robot's repeatability
// where it is stated, known and not estimated; the variances then hold what is beyond it.
//
// The five variances by restricted maximum likelihood (Patterson and Thompson 1971), by the multiplicative steps of Zhou
// et al. 2019, which stay positive; X and Y by generalised least squares. Covariance: Kenward and Roger 1997, that is with
// what the estimated variances add, and Student's factor by Satterthwaite's degrees of freedom of each number.

#include "core/calibration/pose/hand_eye/hand_eye_parts.h"
#include "core/calibration/pose/hand_eye/hand_eye_solve.h"
#include "core/calibration/robot_repeatability.h"

namespace seamwright::hand_eye {

struct Weighed {
    Pose x, y;
    double size = 1;            // that the camera's distances to the target want to be multiplied by
    UnknownsSquare covariance;  // of X, Y and, where it is free, the size; value +- 1.96 sigma holds 95 %
};

// `robot_outside`: the robot's pose errs in the frame of Y's parent (eye_to_hand), else in its own.
Weighed weigh(const Chain& chain, bool robot_outside, const RobotRepeatability& robot, const Pose& x,
              const Pose& y, const Scales& scales, bool free_size = false);

}  // namespace seamwright::hand_eye
