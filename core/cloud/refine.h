#pragma once
// Point to plane, robust, from near.
//
// Unknown: base_from_part. A point p (base) has the residual r = n . (p - q), q the nearest place of the part and n
// the part's normal there. With the part moved by a about the points' middle c and turned by w,
//     r' = r - [n, (q - c) x n] . (a, w),
// so the step is the weighted least squares of r on these rows. Weights are Tukey's with a gate that falls from the
// capture range to kGateSigmas standard deviations of the residuals; points nearest to a border tell nothing about the
// sheet's plane and weigh nothing. Directions whose mean squared row is below kOpenShare are not moved.

#include "core/cloud/surface.h"

namespace seamwright {

// Mean of (n . motion)^2 for a motion of 1 mm at the points' spread below which a direction counts as open: a surface
// that leans by less than a degree against sliding along itself.
inline constexpr double kOpenShare = 3e-4;

// The gate stands at so many robust standard deviations of the residuals.
inline constexpr double kGateSigmas = 4.5;
// What the points' spread counts as at least: rotations are scaled by it.
inline constexpr double kLeastSpread_mm = 1e-3;

struct RefineOptions {
    double gate_mm = 50;    // capture range at the start
    double floor_mm = 0.1;  // the gate falls no further
    int iterations = 60;
    bool facing = false;  // only triangles that face the point's sensor (its normal, towards it) count
};

// The normal equations about the points' middle; rotations scaled by `spread` to mm.
struct FitSystem {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    double spread_mm = 1;
    Matrix6 information = Matrix6::Zero();  // sum of weight * row * row^T
    Vector6 gradient = Vector6::Zero();     // sum of weight * row * residual
    double weight = 0;
    std::size_t matched = 0;  // within the gate, no border
    double median_mm = 0;     // of |residual| of those
};

struct Refined {
    Pose base_from_part = Pose::Identity();
    FitSystem system;
    double gate_mm = 0;
    bool settled = false;
};

Refined refine(const Cloud& cloud, const Surface& surface, const Pose& start, const RefineOptions& options);

// The motion (a, w spread) of FitSystem's unknowns as the house's tangent of base_from_part: delta = M * motion.
Matrix6 tangent_of_motion(const Pose& base_from_part, const Eigen::Vector3d& middle, double spread_mm);

// Distance of every point from the part, at most `most_mm`.
std::vector<double> distances(const Cloud& cloud, const Surface& surface, const Pose& base_from_part,
                              double most_mm, bool facing);

}  // namespace seamwright
