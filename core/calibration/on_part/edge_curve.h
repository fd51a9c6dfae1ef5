#pragma once
// An edge as a curve over its chord. Private to core/calibration/on_part.
//
// In the edge's own axes (columns of `axes`: along the chord, and two across) the point at s along the chord lies at
// (s, y(s), z(s)), y and z uniform cubic B-splines of the same knots: c(s) = sum c_j B_j(s). Distance of a point p:
// (q_y - y(s), q_z - z(s)) with s, q its coordinates; exactly zero on the curve. Curvature is y''(s) at the knots,
// (c_j-1 - 2 c_j + c_j+1) / h^2; a priori normal with sigma kappa, correlation exp(-|s - s'| / 100 mm)
// (Ornstein-Uhlenbeck), so its whitened form has two terms a knot. A straight line costs nothing.

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/geometry/pose.h"

namespace seamwright::on_part {

// Curvature of an edge that counts as straight, 1/mm.
inline constexpr double kStraightEdge = 1e-6;

struct EdgeCurve {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    double low = 0, step = 1;  // first knot and their distance (mm)
    int segments = 1;
    Eigen::VectorXd coefficients;  // those of y, then those of z

    int per_axis() const { return segments + 3; }
    double length() const { return step * segments; }
};

// The four B-splines that are not zero at s, and their slopes; beyond the ends the last segment's polynomials go on.
struct SplineAt {
    int first = 0;
    std::array<double, 4> value{}, slope{};
};
SplineAt spline_at(const EdgeCurve& edge, double s);

struct CurvePoint {
    Eigen::Vector2d across, slope;
};
CurvePoint at(const EdgeCurve& edge, double s);

// Rows [segments + 1, per_axis()] of one axis: whitened curvatures for kappa = 1.
Eigen::MatrixXd curvature_rows(const EdgeCurve& edge);

// A curve through points: chord and axes by their scatter, knots about `knot_mm` apart, coefficients by least squares
// with a mild prior. `most` segments at most.
EdgeCurve curve_through(const std::vector<Eigen::Vector3d>& points, double knot_mm, int most);

}  // namespace seamwright::on_part
