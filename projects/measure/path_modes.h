#pragma once
// The part of path.h that bends a path.

#include <optional>

#include "core/elastic/elastic_solve.h"
#include "projects/measure/path.h"

namespace seamwright {

// The joint solution of a region as the run's spots give it. Error: the modes do not act on them.
Expected<ElasticCorrection> joint_again(const Project& setup, const Region& region, const RunRecord& run);

// Moves the answer's corrected points by the modes, where `bent` holds them, blended as the displacements are; along the
// path nothing is added. Returns what was added at each point, mm. A point's sigma takes that of the modes across the
// path.
Expected<std::vector<double>> bend_path(const Project& setup, const std::vector<const Region*>& regions,
                                        const std::vector<std::optional<ElasticCorrection>>& bent,
                                        const std::vector<PathPoint>& taught, bool closed,
                                        PathAnswer& answer);

}  // namespace seamwright
