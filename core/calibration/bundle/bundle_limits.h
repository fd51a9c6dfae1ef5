#pragma once
// What the files of core/calibration/bundle judge and differentiate by alike. Private to it.

namespace seamwright {

// Steps of the differences by a pose.
inline constexpr double kPoseStep_mm = 1e-3, kPoseStep_rad = 1e-6;

// Of the squares of the misfit: what stays the pixels' noise however much the cameras' places may explain.
inline constexpr double kLeastNoiseShare = 0.1;

}  // namespace seamwright
