#pragma once
// The laser stripe as pixels, for calibrations that need no millimetres.

#include <Eigen/Core>
#include <vector>

#include "core/error.h"
#include "core/profile/stripe/peaks.h"

namespace seamwright {

// The stripe, tracked through reflections: one point a column, in order. `peaks` is a buffer to reuse.
Expected<std::vector<Eigen::Vector2d>> stripe_points(const StripeImage& image, StripePeaks& peaks);

// The stripe of a flat plate alone, without what stands beside the plate and without reflections
// (core/calibration/lens/bent_line.h).
std::vector<Eigen::Vector2d> on_the_plate(std::vector<Eigen::Vector2d> points);

}  // namespace seamwright
