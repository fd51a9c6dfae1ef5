#pragma once
// A region's modes from its stored runs, and the proof of what they bring, on parts and at spots that were held out.

#include <string>

#include "core/evaluation/statistics.h"
#include "projects/elastic/stored_shapes.h"

namespace seamwright {

// Learnt and not switched on.
Expected<RegionModes> learn_region(const StoredShapes& shapes, const std::string& now_utc);

// Takes the place of the region's modes.
void put_modes(Project& project, RegionModes modes);
// Error (input): none were learnt, they hold no mode, it is so already.
Expected<void> switch_modes(Project& project, const std::string& region, bool on, double most_added_mm,
                            const std::string& now_utc);

// Every spot of every part is predicted from the other spots of that part, with modes that were learnt from other
// parts without that spot: what the bead would be off by between spots. What the spot measured is the truth, along
// the directions that it tells, so that its noise is in all figures.
struct ModesComparison {
    std::string region_id;
    int parts = 0, modes = 0;
    int predictions = 0, acted = 0;  // spots of parts; those of them in which the modes acted
    Summary rigid, elastic;          // mm, of all predictions; where the modes did not act, both rigid
    double stated_three_sigma = 0;   // of the elastic answer, noise of the spot included
    double inside = 0;               // share of its 95 % that holds, where the modes acted
    double gain() const { return elastic.three_sigma > 0 ? rigid.three_sigma / elastic.three_sigma : 1; }
};
Expected<ModesComparison> compare_region(const StoredShapes& shapes);

}  // namespace seamwright
