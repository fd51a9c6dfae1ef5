#pragma once
// Numbers that more than one room of core/calibration judges by. Private to core/calibration.

namespace seamwright {

// Probability below the upper end of the middle 95 %: Student's quantile of it over the normal one (kNormal95) widens a
// sigma that rests on few numbers.
inline constexpr double kUpper95 = 0.975;

// Median of a Rayleigh distribution (length of a two-dimensional normal error) over its sigma.
inline constexpr double kRayleighMedian = 1.1774;

// Coordinates farther out are no millimetres: 1 km in the world, 100 m on a body.
inline constexpr double kFarthestPoint_mm = 1e6, kLargestBody_mm = 1e5;

// Of a covariance's size, by which it may be unsymmetric or a variance negative.
inline constexpr double kCovarianceSlack = 1e-6;

// Pairs of pixel and laser point: their spread across over that along, below which they lie on one line; and what they
// fit to at most, else the answer is poor.
inline constexpr double kPairsOnALine = 0.01, kPoorPairs_px = 3;

}  // namespace seamwright
