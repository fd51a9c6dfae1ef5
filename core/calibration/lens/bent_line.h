#pragma once
// Which of the points found along a laser line are the line, before its lens is known.
//
// A lens bends a straight line into a parabola to first order: v = a + b u + c u^2 in the axes of the points'
// spread. A reflection, the table beside the plate or a peak on glare lie off it, often as a stretch of their
// own that pulls any fit of all points towards itself. So the parabola is found by the least median of
// squares over triples of points (a fixed seed; up to nearly half of the points may be wrong), then fitted to
// its support by least squares. The support is every point within 6 times the median distance of the support,
// about 4 sigma, and never less than 1 px, which what a lens bends beyond the parabola stays within.

#include <Eigen/Core>
#include <vector>

namespace seamwright {

// 1 for each point on the line, in the order given. Points in px, finite. Fewer than 8 points: all are.
std::vector<char> on_bent_line(const std::vector<Eigen::Vector2d>& points);

}  // namespace seamwright
