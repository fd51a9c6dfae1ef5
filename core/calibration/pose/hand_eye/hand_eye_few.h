#pragma once
// X and Y from so few pairs that their own scatter does not tell what they err by. Inner part of hand_eye.h.
//
// The five standard deviations of hand_eye_parts.h are one size times ratios. What the ratios of cameras and robots are
// is known to a factor of about two (kRatios); the size is known of nothing but the pairs, never below 0.02 mm. For each
// of a fixed set of ratios the pairs give X and Y by generalised least squares, the size by what is left, and by the
// restricted likelihood (the size integrated out, prior 1/size) how well the ratios explain the pairs. The answer is the
// mean over them, its covariance the mean of theirs, widened so that the ellipse of 95 % of six numbers holds (F of 6 and
// 6 n - 12 degrees; single intervals then hold a little more), and their scatter. Where the robot's
// repeatability is stated the size of what is beyond it is integrated out on a grid.

#include "core/calibration/pose/hand_eye/hand_eye_noise.h"

namespace seamwright::hand_eye {

Weighed weigh_few(Chain chain, bool robot_outside, const RobotRepeatability& robot, Pose x, Pose y,
                  bool free_size);

}  // namespace seamwright::hand_eye
