#pragma once
// Where a part might lie, from nothing but its scan: starts for refine.h, never a result.
//
// Fast point feature histograms (Rusu 2009; PCL's) of scan and part; triples of points whose histograms are alike and
// whose sides are as long give a pose each (sample consensus, own verification: the share of the scan that lies near
// the part with it); and the 24 attitudes that put the scan's principal axes on the part's. The best by that share
// come first, poses that are near another one left out.

#include <vector>

#include "core/cloud/surface.h"

namespace seamwright {

struct CoarseOptions {
    std::uint64_t seed = 1;
    int trials = 6000;
    std::size_t most = 16;  // poses
};

// `cloud` with normals, thinned to some thousand points. Empty: nothing to go by. Error (file): as of loaded_object.h.
Expected<std::vector<Pose>> coarse_poses(const Cloud& cloud, const Surface& surface,
                                         const CoarseOptions& options);

// The rigid motion that brings `from` onto `to` with the least squares of distances (Kabsch); three points or more,
// not on a line (their triangle's height at least 1 % of its longest side). Error (input) otherwise.
Expected<Pose> pose_of_pairs(const std::vector<Eigen::Vector3d>& from,
                             const std::vector<Eigen::Vector3d>& to);

}  // namespace seamwright
