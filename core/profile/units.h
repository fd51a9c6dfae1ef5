#pragma once
// Do these numbers look like millimetres? A laser-stripe sensor sees some 5 mm to 2 m, at 5 um to 2 mm a
// point, so that a contour in metres or micrometres shows by what it spans and by how close its points stand.

#include <string>

#include "core/error.h"
#include "core/profile/profile.h"

namespace seamwright {

// Error (input): points in the laser plane that span less than 1 mm, or more than 5 m. 0 (one point) passes.
Expected<void> check_span_millimetres(double span_mm, const std::string& where);

// The same of a profile's points that have a return, from 10 on; besides refused: points that span less than
// 3 mm and stand closer than 4 um (the median), which is a wide contour in metres.
Expected<void> check_profile_millimetres(const Profile& profile, const std::string& where);

}  // namespace seamwright
