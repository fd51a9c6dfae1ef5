#pragma once
// Whether freed unknowns explain more of the residuals than chance gives them. Private to core/calibration.

namespace seamwright {

// Probability that F of these degrees of freedom, all above zero, is beyond `f`; exact to 1e-10.
double f_chance(double f, double numerator, double denominator);

// The same of two fits to the same numbers, `freed` of them more unknown in the second one: its sum of squares is
// `least`, and `freedom` what it leaves. One where the second has no freedom.
double freed_chance(double squares, double least, double freed, double freedom);

// Up to that chance a misfit is no accident: one in a thousand calibrations of honest data.
inline constexpr double kNoAccident = 1e-3;

}  // namespace seamwright
