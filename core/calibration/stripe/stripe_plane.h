#pragma once
// One plane through the stripes of many frames. Private to core/calibration/stripe.

#include <optional>
#include <vector>

#include "core/calibration/camera/plate_bundle.h"

namespace seamwright::detail {

// Per frame the stripe's points in the camera frame (mm), empty where it has none.
using StripePoints = std::vector<std::vector<Eigen::Vector3d>>;

// Least squares with Cauchy weights (scale 0.2 mm) over the chosen frames, every frame weighing the same.
std::optional<LaserPlane> fit_plane(const StripePoints& points, const std::vector<char>& chosen);

double median_off_plane(const LaserPlane& plane,
                        const std::vector<Eigen::Vector3d>& points);  // of |distance|

// Plane that most frames share: from every pair of frames, a frame belongs when the median distance of its
// rows is below `limit_mm`; refined on its frames until the set stands still.
struct PlaneConsensus {
    LaserPlane plane;
    std::vector<char> frames;
};
std::optional<PlaneConsensus> consensus_plane(const StripePoints& points, double limit_mm);

}  // namespace seamwright::detail
