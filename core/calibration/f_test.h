#pragma once
// Whether freed unknowns explain more of the residuals than chance gives them. Private to core/calibration.

namespace seamwright {

// Probability that chance alone takes as much from the squares of one fit to the next, which has `freed` unknowns more, `least`
// as its sum of squares and `freedom` left. One where it has no freedom.
double freed_chance(double squares, double least, double freed, double freedom);

// Up to that chance a misfit is no accident: one in a thousand calibrations of honest data.
inline constexpr double kNoAccident = 1e-3;

}  // namespace seamwright
