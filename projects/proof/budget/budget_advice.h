#pragma once
// What of a region's budget is worth mending: its contributions across the bead, the largest first, each with what would
// make it smaller and the uncertainty that is left once it is gone.

#include <vector>

#include "projects/proof/budget.h"

namespace seamwright {

struct Mending {
    ErrorSource source = ErrorSource::feature;
    Text what;         // "recalibrate sensor A with more poses, turned further: ..."
    double share = 0;  // of the variance, 0..1
    double u_mm = 0;   // without it
};

inline constexpr double kWorthMending = 0.05;  // of the variance, at least

// Of the measurand across the bead whose u is larger; empty where there is none or the region is under-determined.
std::vector<Mending> mendings(const RegionBudget& budget);

// The measurand that the advice is about; nullptr: none.
const MeasurandBudget* worst_across_bead(const RegionBudget& budget);

}  // namespace seamwright
