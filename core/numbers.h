#pragma once
// Numbers that more than one folder calls by name.

#include <limits>

namespace seamwright {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Standard deviation of normal noise over its median absolute deviation: 1 / Phi^-1(3/4).
inline constexpr double kMadToSigma = 1.4826;

// Phi^-1(0.975): that many standard deviations of a normal variable hold 95 % of it.
inline constexpr double kNormal95 = 1.959963984540054;

}  // namespace seamwright
