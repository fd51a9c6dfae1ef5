#pragma once
// Two sheets with a gap between them whose width and step are known along it: body and panel as a path
// correction's sensor meets them, for the gap check.
//
// Part frame: the gap runs along Y, its middle at x = 0; the sheet at x < 0 lies in z = 0, the other one
// `flush` above it; Z towards the sensor. Both edges are folded down (radius fold_mm) to a flank 8 mm deep;
// between the flanks there is nothing. The width is the distance of the flanks along X.

#include <vector>

#include "devices/simulated/scene/mesh.h"

namespace seamwright {

// Width and flush are linear between stations.
struct GapStation {
    double y_mm = 0, width_mm = 0, flush_mm = 0;
};

// 300 mm of gap, 5 mm wide, that narrows to 2.6 mm at y = 60 and closes at y = -80 over 8 mm.
std::vector<GapStation> default_gap_stations();

// Precondition: two stations or more, y ascending, widths not negative. fold_mm = 0: sharp edges.
TriangleMesh gap_part_mesh(const std::vector<GapStation>& stations, double fold_mm = 1);
// Between the stations; before the first and behind the last as there.
GapStation gap_at(const std::vector<GapStation>& stations, double y_mm);

}  // namespace seamwright
