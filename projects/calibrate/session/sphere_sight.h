#pragma once
// Whether a profile shows the calibration sphere, and not one of the roundings that every sheet has.
//
// Of the circles in the profile that a plane can cut of the sphere, the one that holds the most points is taken that
//   - bulges towards the sensor: mean_side >= 0.5 (a visible cap's is 0.77 and more);
//   - stands alone: at least half of all points within a quarter of its radius from its line are on it;
//   - ends: a sphere turns out of sight, so behind the last point of its arc the contour jumps or is lost, where a
//     rounding runs on into its flanks. What hangs together with an end of the arc and leaves it in its direction is
//     shorter than 0.4 radii.
// A sphere half out of the picture is still one: its arc ends with the picture.

#include "core/calibration/sphere/circle_section.h"
#include "core/error.h"

namespace seamwright {

// radius_mm 0: not known. either_side: the device may count z away from itself, so an arc may bulge towards -z.
// Error (input): no circle of the sphere; a circle that is no sphere's, and why it is none.
Expected<CircleSection> sphere_in_profile(const Profile& profile, double radius_mm, bool either_side,
                                          const Text& where);

}  // namespace seamwright
