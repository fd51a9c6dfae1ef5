#pragma once
// Edges of a drawing as what a scan is fitted to (core/cloud/edge): for each of its faces the sheet that ends there.

#include <string>
#include <vector>

#include "core/cloud/edge/edge_curve.h"
#include "devices/drawing/drawing.h"

namespace seamwright {

// `chain`: with every edge the tangent edges that it goes on in. An edge that is in another's chain is taken once. Error
// (input): no such edge, none given.
Expected<std::vector<EdgeCurve>> drawn_edges(const Drawing& drawing, const std::vector<std::string>& edges,
                                             bool chain);

}  // namespace seamwright
