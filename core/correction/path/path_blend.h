#pragma once
// The application path corrected point by point: between neighbouring regions the correction goes over from
// one displacement to the next without a step.
//
// Regions. Consecutive points of one region form a stretch. Between a stretch of region A and the next one of
// region B lies a transition [s_a, s_b] of the path length s (mm, along the positions of the taught points):
//   - from the last point of A to the first of B where points between them belong to no region;
//   - else `blend_mm` about the middle between the two, at most up to the middle of either stretch.
// Outside of transitions a point takes its region's displacement, bit for bit. Before the first and after the
// last stretch of an open path it takes that of the nearest; a closed path goes on from its last point to its
// first.
//
// Blend. With u = (s - s_a) / (s_b - s_a),
//     D(u) = D_A exp(h(u) log(D_A^-1 D_B)),   h(u) = 6 u^5 - 15 u^4 + 10 u^3,
// the screw motion from D_A to D_B (dual-quaternion ScLERP; Kavan et al. 2006), at a pace whose first and
// second derivative vanish at both ends, so that neither tangent nor curvature of the path jump there. It
// does not depend on the frame in which D is written (F^-1 D F blends to F^-1 D(u) F), nor on which end is
// called the first, and the blend of the inverses is the inverse of the blend.
//
// Uncertainty. Neighbouring regions share spots, so their errors are correlated in a way that is not known
// here. The sigma of a blended point is the bound that holds for every correlation,
//     sigma(u) <= (1 - h) sigma_A + h sigma_B,
// each the standard deviation of the point D p along its worst direction, d(D p) = dt - [R p]x dw (pose.h).

#include <span>
#include <string>
#include <vector>

#include "core/correction/correction.h"
#include "core/geometry/pose.h"

namespace seamwright {

struct PathPoint {
    Pose workobject_from_tool = Pose::Identity();  // as taught
    int region = -1;                               // index of its region, -1 = of none
};

struct PathRegion {
    Displacement displacement;
    Matrix6 covariance = Matrix6::Zero();  // tangent of pose.h
};

struct PathBlendOptions {
    double blend_mm = 60;  // length of a transition where two regions meet without points between
    bool closed = false;
};

// What holds at one point: (1 - share) of `region` and share of `next`, by the pace h above.
struct PathCorrection {
    int region = 0, next = 0;
    double share = 0;
    double length_mm = 0;  // of the path up to here
    Displacement displacement;
    Pose workobject_from_tool = Pose::Identity();  // corrected: D * taught
    double sigma_mm = 0;
};

// The correction's change from one point to the next, measured at the middle m of their positions: |D' m -
// D m| and the angle between D and D'. 0 for a uniform correction, whatever it is.
struct PathStep {
    std::size_t from = 0;  // point; the next one is the first for the last of a closed path
    double mm = 0, deg = 0;
};

struct CorrectedPath {
    std::vector<PathCorrection> points;  // in the order given
    double length_mm = 0;
    PathStep largest_mm, largest_deg;
    // The same if every point took its region's displacement at once, those of no region that of the last
    // before: what the robot would jump by.
    double unblended_mm = 0;
    // Discrete curvature: turn of the direction at a point over the mean length of its two segments. The
    // largest change of it by the correction, and where.
    double curvature_change_per_m = 0;
    std::size_t curvature_point = 0;
    // The path's own largest curvature, taught, to compare.
    double curvature_per_m = 0;
    std::vector<Text> remarks;  // transitions that hold no point: the whole step lies in one segment
};

// Refuses (Error): fewer than 2 points, poses or displacements that are not finite or no rigid motion, a
// region index out of range, no point of any region, a blend length that is not positive, covariances that
// are none, regions turned by more than 90 degrees against each other. `names` are the regions', for the
// remarks.
Expected<CorrectedPath> correct_path(std::span<const PathPoint> points, std::span<const PathRegion> regions,
                                     std::span<const std::string> names, const PathBlendOptions& options);

// h(u), clamped to 0 .. 1 outside.
double blend_pace(double u);

}  // namespace seamwright
