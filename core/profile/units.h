#pragma once
// Do these numbers look like millimetres? A laser-stripe sensor sees some 5 mm to 2 m, at 2 um to 5 mm a
// point and with a noise far below 2 mm, so that a contour in metres, inches or micrometres shows by what it
// spans, by how close its points stand and by how they scatter.

#include <string>

#include "core/error.h"
#include "core/geometry/length_unit.h"
#include "core/profile/profile.h"

namespace seamwright {

// Error (input): points in the laser plane that span less than 1 mm, or more than 5 m. 0 (one point) passes.
Expected<void> check_span_millimetres(double span_mm, const Text& where);

// What a profile's numbers are like, whatever they mean. NaN (suspected: empty) below 10 points with a
// return.
struct ProfileScale {
    std::size_t points = 0;  // with a return
    double x_low = 0, x_high = 0, z_low = 0, z_high = 0;
    double span = 0;   // diagonal of the points' box
    double pitch = 0;  // median distance of neighbouring points
    double noise = 0;  // standard deviation of z about the line of its neighbours, median over the profile
    // What the numbers look like where they do not look like millimetres: "metres or inches",
    // "micrometres", "inches". Empty: like millimetres. It is a reason to ask, never an answer.
    std::string suspected;
    Text why;  // "the points stand 0.0025 mm apart and span 1.6 mm"
};
ProfileScale profile_scale(const Profile& profile);

// Error (input) where profile_scale() suspects another unit. Suspected is
// - less than 1 mm or more than 5 m of span;
// - less than 6 mm at under 20 um a point (a small sensor's field is as fine, but wider);
// - points more than 5 mm apart, or scattering by more than 2 mm, over more than 50 mm;
// - an even pitch that is a round number of millimetres only if it is inches (0.1 mm = 0.003937 in).
Expected<void> check_profile_millimetres(const Profile& profile, const Text& where);

}  // namespace seamwright
