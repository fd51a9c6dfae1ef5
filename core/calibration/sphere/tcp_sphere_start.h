#pragma once
// Where the search for the common sphere begins: the minima of the reduced problem from no start at all.

#include <vector>

#include "core/calibration/sphere/tcp_sphere_solve.h"

namespace seamwright::tcp_sphere {

struct Start {
    Model model;
    double cost = 0;  // robust, mm^2 per profile
};
// Different minima of the reduced problem over all starts, best first (at most four). `radius_free` lets r
// move. `subsets`: where profiles contradict the best, small subsets are searched too.
std::vector<Start> global_start(const std::vector<Section>& sections, double radius, bool radius_free,
                                bool subsets);

}  // namespace seamwright::tcp_sphere
