#pragma once
// Which of the ends in a search window is meant. A sheet has one end on the asked side: of its first and last
// point the outer one. An end counts when the surface stops there: not where it runs on beyond the window,
// leaves the sensor's field or runs under a higher sheet (contour_sheets.h).

#include <optional>

#include "core/features/end/contour_sheets.h"
#include "core/features/feature.h"

namespace seamwright {

enum class EndSide { left, right };

// highest, lowest: by the distance of the sheets' middles across the direction that they have in common, so
// that a lap is told apart however it is inclined.
enum class EndOf { outermost, longest, highest, lowest, only };

struct EndRule {
    EndSide side = EndSide::left;
    EndOf of = EndOf::only;
    int order = 1;  // outermost: the how-manyth end from outside
    int minimum_points = 6;
};

struct ChosenEnd {
    int first, last;  // of the sheet's points
    bool at_last;
    int mixed;     // line of the farthest point that stands in the step behind it (ContourSheet); -1: none
    bool covered;  // beside a higher sheet
};

// nullopt with status, message and rivals set in `feature`:
//     no_points   no sheet with minimum_points in the window
//     not_found   the meant sheet ends at the window's or the field's rim, or (`only`) under a higher one
//     ambiguous   `only`: more than one end, or one besides a sheet that leaves the field farther out;
//                 longest: the next is nearly as long (a tenth); highest, lowest: the next is as high within
//                 three sigma of the noise
std::optional<ChosenEnd> choose_end(const ContourSheets& sheets, const EndRule& rule, Feature& feature);

}  // namespace seamwright
