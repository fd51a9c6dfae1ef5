#pragma once
// Where a body may stand so that its points lie on given rays, without a start.

#include <vector>

#include "core/geometry/pose.h"

namespace seamwright {

// A point of the body on a ray of the world.
struct SightRay {
    Eigen::Vector3d origin_mm, direction;  // unit
    Eigen::Vector3d point_mm;              // body
    double weight = 1;
};

// The `most` best of the places found from rotations all over SO(3), best first, those a degree apart told apart; the
// points lie before the rays' origins. Empty: no place puts them there. Object-space alternation (Lu, Hager and Mjolsness
// 2000) for rays of several origins; to about 1e-3 of the distance, to be refined on pixels.
std::vector<Pose> onto_rays(const std::vector<SightRay>& rays, std::size_t most);

}  // namespace seamwright
