#pragma once
// A scan on edges of its drawing: where the part stands, by where its sheets end.
//
// Ends found in the cloud alone (sheet_ends.h) are brought onto the edges from the start and from starts beside it: the
// nearest place of an edge whose sheet lies on the same side, residuals across the edge within the sheet and out of it,
// Tukey's weights with a gate that falls from the capture range. Then the exact ends cell by cell (cell_ends.h), trimmed,
// and generalised least squares with the model of the part's deviation of form (form_model.h), the cells' two residuals
// its nodes: noise is the scatter between neighbouring cells, form what they have in common. What the points' spacing
// leaves open of an end in common to all cells of an edge is added to the covariance edge by edge.
//
// A row of an end p with the direction d (outward, then normal) is (d, (p - c) x d): nothing is said of a motion along
// the edge. So a straight edge leaves the shift along and the turn about itself open, a circle the turn about its axis;
// they are named and refused, as is what is known worse than the limit, and an edge of which less than half was seen. Every edge lies somewhere from the start, so
// without one nothing is fitted. Ambiguous: another place within the start's tolerance that as many ends lie on.
//
// Frames, tangent, status and what the pose means are fit.h's.

#include <span>

#include "core/cloud/deviation.h"
#include "core/cloud/edge/edge_curve.h"
#include "core/cloud/fit.h"

namespace seamwright {

struct EdgeFit {
    // As of a surface; points: cells of the edges whose sheet was scanned; points_used: those whose end counts;
    // share_on_part: of them.
    SurfaceFit fit;
    Cloud ends;  // base, one a cell, those left out too
    // Along the sheet of every end from the drawing's edge, positive where the part is larger; share_seen is of the
    // edges' length. Empty where there is no pose.
    DeviationMap deviation;
    double normal_rms_mm = 0;  // out of the sheet, of the ends that count
    double spacing_mm = 0;     // of the points at an end, median
    double radius_mm = 0;      // within which the scan surrounds a point
};

// Error (input): no start and no pairs, an edge without length, and those of fit_surface. `surface` is the part's that
// the edges are of: its size and its longer axes.
Expected<EdgeFit> fit_edges(const Cloud& cloud, std::span<const EdgeCurve> edges, const Surface& surface,
                            const FitOptions& options);

}  // namespace seamwright
