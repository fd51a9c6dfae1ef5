#pragma once
// Limits that more than one file judges cameras and their plates by. Private to core/calibration.

namespace seamwright {

// Images of fewer or more pixels a side are none.
inline constexpr int kSmallestImage_px = 16, kLargestImage_px = 100000;

// Two views whose corners are nowhere farther apart are the same picture.
inline constexpr double kSamePicture_px = 1e-3;

// Of the points' spread along their longest line, across it: up to that they lie on one line.
inline constexpr double kPointsOnALine = 1e-3;

// Sigma of the focal length over itself, from which on it is not determined.
inline constexpr double kOpenFocal = 0.05;

// Corners that fit worse than that make a camera poor.
inline constexpr double kPoorCorners_px = 1.5;

}  // namespace seamwright
