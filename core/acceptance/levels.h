#pragma once
// Numbers that the studies have in common.

namespace seamwright {

// Probabilities below the ends of a two-sided interval of 95 %.
inline constexpr double kBelowLow95 = 0.025, kBelowHigh95 = 0.975;

// A scatter below this is rounding: mm, or of the values where these are larger than 1 mm.
inline constexpr double kRoundedScatter = 1e-12;

inline constexpr double kMeanRange = 1.128;  // d2 of two values, in sigma
inline constexpr double kMostRange = 3.267;  // D4 of two values, in mean ranges

}  // namespace seamwright
