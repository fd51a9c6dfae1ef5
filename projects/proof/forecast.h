#pragma once
// What a region will be able to tell, as the safety gate will judge it, before anything is measured: over the
// part as taught and as displaced by as much as is required to be recovered, each spot with the noise of its
// feature (larger than the reference profile states, as another profile's own estimate may be: one and a half
// times, of a contour end two and a half times) and of its trigger's travel along the displaced contour. And
// what would make it better.

#include <string>
#include <vector>

#include "core/correction/correction.h"
#include "core/text.h"
#include "projects/model/project.h"

namespace seamwright {

// What could be done, and the sigma at the spots that it leads to.
struct Cure {
    Text what;
    double sigma_mm = 0;
};

struct RegionForecast {
    RegionPlan plan;  // at the place as taught
    // Largest sigma of a correction at any of its spots, along the worst direction, and of its turn; over the
    // part as taught and displaced. Infinite when under-determined.
    double sigma_mm = 0, sigma_deg = 0;
    std::string worst_spot;
    double wanted_mm = 0;  // the smaller of the region's sigma limit and a third of the required 3 sigma
    double wanted_deg = 0;
    bool enough() const { return sigma_mm <= wanted_mm && sigma_deg <= wanted_deg; }
    // What would make it better, the most effective first; empty when the plan is under-determined (its
    // advice says where to add spots).
    std::vector<Cure> cures;
};

// Error: what plan_region refuses (no spot, ...).
Expected<RegionForecast> forecast_region(const Project& project, const Region& region);

// The part as taught, and displaced both ways along and about each axis through `middle` (work object) by what is
// required to be recovered.
std::vector<Displacement> required_displacements(const Requirements& need, const Eigen::Vector3d& middle);

}  // namespace seamwright
