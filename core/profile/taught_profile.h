#pragma once
// What teaching makes of profiles: the mean of several, whose noise is the smaller, and the piece around a contour
// that becomes a template.

#include <Eigen/Geometry>
#include <span>

#include "core/profile/profile.h"

namespace seamwright {

// Point by point (line of the image, or column of the sensor) the mean of x, z and intensity, where every profile has an
// accepted point; NaN elsewhere, and filtered again. Of profiles of different length, which have no common lines,
// the first. Where the profiles' noise is that of the light alone it falls with the root of their number; what
// stands still with the part (speckle, its surface) stays.
Profile mean_profile(std::span<const Profile> profiles);

// The accepted points (every one of a profile that is not filtered) inside the window, which includes its rim. Open
// sides: infinite.
Profile cut_out(const Profile& profile, const Eigen::AlignedBox2d& window);
// The same, bounded in x alone.
Profile cut_out(const Profile& profile, double from_mm, double to_mm);

}  // namespace seamwright
