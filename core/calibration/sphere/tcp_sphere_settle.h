#pragma once
// Which profiles belong to the common sphere: those that contradict the others (they show something else, or their pose is
// wrong) are left out, and looked at again.

#include <vector>

#include "core/calibration/sphere/circle_section.h"
#include "core/calibration/sphere/tcp_sphere_solve.h"

namespace seamwright::tcp_sphere {

// Three numbers a profile against nine unknowns, and one to check with.
inline constexpr int kFewestSections = 4;
// So many must stay when one is left out as contradicting the others. Where the robot's poses err, two numbers of a
// profile count (its cut's radius says little): of fewer, the rest fits one sphere whichever was left out.
constexpr int fewest_agreeing(bool radius_free) {
    constexpr int kChecks = 5, kNumbers = 2;
    return ((radius_free ? 10 : 9) + kChecks + kNumbers - 1) / kNumbers;
}

// Sum of the squared distances of the points from the sphere, mm^2.
double point_squares(const Section& section, const Model& model);
// Root of their mean, mm; NaN without points.
double section_rms(const Section& section, const Model& model);
size_t used_count(const std::vector<Section>& sections);

// Rounds of: common sphere without the contradicting profiles, exact on the statistics. Sets Section::used; never of a
// profile whose observation is `excluded`.
void settle(std::vector<Section>& sections, Model& model, bool radius_free, const CircleSectionLimits& limits,
            const std::vector<bool>& excluded);

}  // namespace seamwright::tcp_sphere
