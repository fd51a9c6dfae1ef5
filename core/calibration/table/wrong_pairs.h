#pragma once
// Pairs that contradict the others. Private to core/calibration/table.

#include <vector>

#include "core/calibration/table/smooth_map.h"

namespace seamwright::lookup_table {

// Names the wrong pairs and leaves them out; the map of the others. False: no map.
bool fit_without_wrong(const std::vector<LaserPair>& pairs, const std::vector<char>& allowed,
                       std::vector<char>& used, SmoothMap& map);

}  // namespace seamwright::lookup_table
