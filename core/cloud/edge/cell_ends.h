#pragma once
// The exact end of a sheet, piece by piece along an edge whose place is known to some millimetres.
//
// The edge is cut into cells of a few profiles' length. A cell's points within `window_mm` lie at (b, n), outward along
// the sheet and out of it; those of the sheet lie about a line n(b) that is found robustly, so that what lies deeper or
// higher is none of it. Their b, sorted from the end inwards, are a stationary point process of mean gap g and squared
// coefficient of variation v that the sheet's end cuts off; the end lies beyond the last of them by
//     E[d] = g / 2 (1 + v)                                                     (renewal theory; Cox 1962, ch. 5)
// which is half a spacing for a scan's regular profiles and a whole one for points at random. The last points are
// averaged: b_i + i g is the place of the last one by the i-th. v is that of long stretches, which noise does not
// change. Without this every end would lie half a spacing inside of the part.
//
// What the spacing leaves unknown is not noise alone: where profiles meet an edge at the same phase, all ends err alike.
// Each cell says the variance E[g^3] / (3 E[g]) - (E[g^2] / (2 E[g]))^2 of one end; what of it is not found as scatter
// between the cells is common to the edge.

#include "core/cloud/cloud.h"
#include "core/cloud/edge/edge_curve.h"

namespace seamwright {

struct CellEnd {
    int curve = 0;          // index of the curve given
    EdgeSample foot;        // part
    double outward_mm = 0;  // of the end from the drawing's edge, along the sheet; positive: longer
    double normal_mm = 0;   // of the sheet at its end, out of it
    double spacing_mm = 0;  // g
    double phase_mm2 = 0;   // variance above
    double slope = 0;       // of the sheet against the drawing's, dn / db
    std::size_t points = 0;
};

struct CellOptions {
    double window_mm = 8;  // into the sheet, and either way out of it
    double beyond_mm = 8;  // how far beyond the drawing's edge the end may lie
    double cell_mm = 3;
    double noise_mm = 0;  // of a point
};

// `cloud` in base. Cells without a sheet, or with one that goes on beyond the window, have no end.
std::vector<CellEnd> cell_ends(const Cloud& cloud, const EdgeCurve& curve, int index,
                               const Pose& base_from_part, const CellOptions& options);

}  // namespace seamwright
