#pragma once
// Shared by measure.cpp and measure_regions.cpp.

#include <cmath>

#include "projects/measure/measure.h"

namespace seamwright {

// Two observed coordinates share the feature's variance: the mean of the trace.
inline double total_sigma_mm(const Spot& spot, const Feature& feature) {
    return std::sqrt(spot.sigma_mm * spot.sigma_mm + 0.5 * feature.covariance_mm2.trace());
}

}  // namespace seamwright
