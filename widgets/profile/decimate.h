#pragma once
// A trace as one stroke per pixel column: from its lowest to its highest point, for each segment. Without Qt.
//
// A point at column c = floor((x - x_left) * px_per_mm) widens the stroke of its segment there. Points of one
// segment in neighbouring columns are joined: the later stroke is widened to the middle between the two, so
// that steep flanks stay closed. Work and output are linear in points; strokes are at most points long.

#include <span>
#include <vector>

#include "core/profile/profile.h"

namespace seamwright {

struct ColumnStroke {
    int column = 0;
    float low = 0, high = 0;  // px, y downwards: low <= high
    int segment = 0;
};

struct TraceScale {
    double x_left_mm = 0, z_top_mm = 0;  // at the left and the upper rim of the picture
    double px_per_mm = 1;
    int width_px = 0, height_px = 0;
};

// Strokes of all accepted points inside the picture's width, in sensor order; the profile may be unfiltered
// (segment 0 throughout). Replaces `strokes`, keeps its capacity. Indices of outliers inside the picture go
// to `outliers`.
void decimate(const Profile& profile, const TraceScale& scale, std::vector<ColumnStroke>& strokes,
              std::vector<int>& outliers);

// Index of the accepted point nearest to (x, z) within `radius_mm`; -1 when there is none.
int nearest_point(const Profile& profile, double x_mm, double z_mm, double radius_mm);

// Signed distance (+z side positive) of each accepted point of `profile` across the polyline of `reference`'s
// accepted points, where both neighbours belong to one segment and the foot lies between them; points without
// such a foot within 3 mm are left out. Windowed along x: linear in points for profiles ordered in x.
void residuals_to_reference(const Profile& profile, const Profile& reference,
                            std::vector<double>& residuals_mm);

}  // namespace seamwright
