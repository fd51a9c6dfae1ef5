#pragma once
// Where a sheet ends in a cloud, found in the cloud alone: rough places for a first alignment, the exact ones are
// cell_ends.h's.
//
// A point is an end where its neighbours on the same sheet leave more than 100 degrees about it open. Neighbours on the
// same sheet: within `radius_mm` and within a flat cone about the plane through the point that most of them lie on
// (random triples), so that what lies a sheet's thickness deeper is none. The radius is the smallest at which most
// points are surrounded on all sides: it follows the coarser of the spacings, that between the profiles as a rule. The
// border of a scan is an end as well; which end is one of the part, the drawing says.

#include <functional>

#include "core/cloud/cloud.h"

namespace seamwright {

struct SheetEnd {
    Eigen::Vector3d place_mm = Eigen::Vector3d::Zero();
    Eigen::Vector3d outward = Eigen::Vector3d::Zero();  // unit: along the sheet, away from it
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();   // unit: of the sheet, of either sign
};

struct SheetEnds {
    std::vector<SheetEnd> ends;  // at most some thousand
    double radius_mm = 0;        // 0: no radius surrounds the points; then there are no ends
    double noise_mm = 0;  // of a point about its neighbours' plane, curvature within the radius included
};

// The same for the same cloud. Cancelled: no ends.
SheetEnds sheet_ends(const Cloud& cloud, const std::function<bool()>& cancelled = {});

}  // namespace seamwright
