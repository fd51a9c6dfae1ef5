#pragma once
// The stripe of one frame, told apart: which peaks lie on the plate. Private to core/calibration/stripe.

#include <Eigen/Core>
#include <vector>

#include "core/profile/stripe/stripe_image.h"

namespace seamwright::detail {

// On a flat plate the stripe is one straight line of the undistorted image; table, clamps and reflections
// make other lines or points. `on` are the indices of the peaks of the plate, at most one a scan line;
// `missed` counts scan lines inside the plate's part of the stripe whose peaks all lie off the line for fewer
// than 20 lines in a row (glare, a wrong peak): they are rows of the plate that were measured wrongly. Longer
// interruptions are taken for another surface.
struct PlateStripe {
    std::vector<std::size_t> on;
    int missed = 0;
};

// `straight` are the peaks in undistorted pixels, `line` the scan line of each. Lines by number of scan lines
// they cover, longest first, at most `most` of them.
std::vector<PlateStripe> stripe_lines(const std::vector<Eigen::Vector2d>& straight,
                                      const std::vector<int>& line, double tolerance_px, int most);

}  // namespace seamwright::detail
