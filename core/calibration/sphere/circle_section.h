#pragma once
// The circle that a laser plane cuts out of a sphere, found in one raw profile among a post, a table and
// stray points.

#include <optional>
#include <vector>

#include "core/profile/profile.h"

namespace seamwright {

struct CircleSectionLimits {
    double smallest_radius_mm = 1;
    double largest_radius_mm =
        1e4;  // a plane fits a huge circle: this bound is what tells a sphere from a table
    double smallest_arc_rad = 0.5;  // shorter arcs do not fix a centre
    int fewest_points = 12;
};

// What a plane cuts of a sphere of this radius, where it cuts enough of it to fix a centre.
CircleSectionLimits limits_of_sphere(double radius_mm);

// Circle (x - x_mm)^2 + (z - z_mm)^2 = radius_mm^2 in the sensor plane. noise_mm: standard deviation of the
// inliers' radial residual. inliers: indices into the profile, ascending.
struct CircleSection {
    double x_mm = 0, z_mm = 0, radius_mm = 0;
    double noise_mm = 0;
    double arc_rad = 0;    // extent of the inliers about the centre
    double mean_side = 0;  // mean of (z - z_mm) / radius_mm: > 0 the arc bulges towards +z
    std::vector<int> inliers;
};

// RANSAC over triples (fixed seed: same input, same answer), scored by truncated squared radial distance,
// then geometric (not algebraic) least squares on the inliers, which are re-chosen at four standard
// deviations until they stay. The inlier band follows the profile's own noise, taken from second differences
// along the sensor order. Points with NaN are "no return". nullopt: no circle within the limits holds enough
// points.
std::optional<CircleSection> find_circle_section(const Profile& profile, const CircleSectionLimits& limits);

}  // namespace seamwright
