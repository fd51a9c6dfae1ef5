#pragma once
// How the parts of a region bend, as learnt from stored runs (core/elastic/modes.h), kept beside the region. Off until
// a person switches it on.

#include <cstdint>
#include <string>
#include <vector>

#include "core/elastic/elastic_solve.h"
#include "core/value_type.h"

namespace seamwright {

// A run that was learnt from.
struct LearntRun {
    std::int64_t run = 0;
    std::string part_id, utc;
};

struct RegionModes {
    SEAM_VALUE_TYPE(RegionModes);
    std::string id;  // the region's
    bool on = false;
    std::string learnt_utc, switched_utc;  // ISO 8601; the second empty: never switched
    double most_added_mm =
        1;  // at a spot or a point of the path; beyond, the modes are off or the path refused
    ElasticModes modes;
    std::vector<LearntRun> learnt_from;
};

// What the modes did in a region's run, where they were switched on.
struct ActingModes {
    SEAM_VALUE_TYPE(ActingModes);
    bool acted = false;  // else the rigid answer stands
    Text why;            // not acted: the reason
    std::vector<double> amplitudes_mm, sigma_mm;
    double largest_added_mm = 0;  // at a spot
    double probability = 1;       // that what is left is noise
    // (6 + modes)^2, row by row: the tangent of pose.h, then amplitudes; empty when not acted.
    std::vector<double> covariance;
};

Text said_of(const ActingModes& modes);  // "2 modes act: at most 0.230 mm are added at a spot"

}  // namespace seamwright
