#pragma once
// Curved contours: what a part that slides along them does to a straight-line model and to the curve learnt
// from the profiles between entry and exit (thesis 5.1: the straight line errs by r - sqrt(r^2 - e^2)).

#include <atomic>
#include <vector>

#include "projects/evaluate/cell.h"

namespace seamwright::evaluation {

// One displacement e along X, that is along the contour of six of the twelve spots and across that of the
// others (curved_cell). Means over repeated measures with noise and the robot's repeatability.
struct CurveStep {
    double displacement_mm = 0;
    double expected_mm = 0;  // (5.1)
    // Error of the model at those six spots: residual across the contour at the true displacement, mean over
    // the spots in the sense in which their contour bends.
    double straight_mm = 0, learnt_mm = 0;
    double sigma_mm = 0;         // standard error of both means, from the scatter of the repeats
    double learnt_worst_mm = 0;  // largest of a single spot: the noise of its teaching is in it
    // Of the region: largest mean deviation of a spot after the correction.
    double region_straight_mm = 0, region_learnt_mm = 0;
};
struct CurvedContour {
    double radius_mm = 0;
    std::vector<CurveStep> steps;  // -10 .. 10 mm
};

inline constexpr double kCurveRadiiMm[] = {200, 350, 500, 700, 1000, 2000, 3000};

// Error: a spot cannot be taught.
Expected<CurvedContour> curved_contour(const EvaluationSettings& settings, double radius_mm,
                                       std::atomic<std::size_t>& profiles);

}  // namespace seamwright::evaluation
