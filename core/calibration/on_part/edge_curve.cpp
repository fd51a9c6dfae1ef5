#include "core/calibration/on_part/edge_curve.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/decompositions.h"

namespace seamwright::on_part {
namespace {
constexpr double kCorrelation_mm = 100;
constexpr double kStartCurvature = 0.03;  // 1/mm: does not bind
constexpr double kFarthest = 1e6;         // knots from the first one: what an int holds
constexpr double kLonger = 1.02;          // than its points lie apart; at least a millimetre
constexpr double kPartRidge = 1e-9;       // keeps a part without points solvable
constexpr double kPointWeight = 100;      // 1/mm^2: points to 0.1 mm
}  // namespace

SplineAt spline_at(const EdgeCurve& edge, double s) {
    SplineAt b;
    const double x = (s - edge.low) / edge.step;
    b.first =
        std::clamp(static_cast<int>(std::floor(std::clamp(x, -kFarthest, kFarthest))), 0, edge.segments - 1);
    const double u = x - b.first, v = 1 - u;
    b.value = {v * v * v / 6, (3 * u * u * u - 6 * u * u + 4) / 6,
               (-3 * u * u * u + 3 * u * u + 3 * u + 1) / 6, u * u * u / 6};
    const double h = edge.step;
    b.slope = {-v * v / (2 * h), (3 * u * u - 4 * u) / (2 * h), (-3 * u * u + 2 * u + 1) / (2 * h),
               u * u / (2 * h)};
    return b;
}

CurvePoint at(const EdgeCurve& edge, double s) {
    const SplineAt b = spline_at(edge, s);
    CurvePoint p{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
    for (int axis = 0; axis < 2; ++axis)
        for (int j = 0; j < 4; ++j) {
            const double c = edge.coefficients(axis * edge.per_axis() + b.first + j);
            p.across(axis) += c * b.value[static_cast<std::size_t>(j)];
            p.slope(axis) += c * b.slope[static_cast<std::size_t>(j)];
        }
    return p;
}

Eigen::MatrixXd curvature_rows(const EdgeCurve& edge) {
    const int rows = edge.segments + 1;
    Eigen::MatrixXd second = Eigen::MatrixXd::Zero(rows, edge.per_axis());
    for (int i = 0; i < rows; ++i)
        second.row(i).segment<3>(i) = Eigen::RowVector3d(1, -2, 1) / (edge.step * edge.step);
    const double phi = std::exp(-edge.step / kCorrelation_mm);
    Eigen::MatrixXd white = second;
    for (int i = 1; i < rows; ++i)
        white.row(i) = (second.row(i) - phi * second.row(i - 1)) / std::sqrt(1 - phi * phi);
    return white;
}

EdgeCurve curve_through(const std::vector<Eigen::Vector3d>& points, double knot_mm, int most) {
    EdgeCurve edge;
    for (const auto& p : points) edge.origin += p / static_cast<double>(points.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const auto& p : points) scatter += (p - edge.origin) * (p - edge.origin).transpose();
    edge.axes.col(0) = symmetric_eigen(scatter).vectors.col(2);
    edge.axes.col(1) = edge.axes.col(0).unitOrthogonal();
    edge.axes.col(2) = edge.axes.col(0).cross(edge.axes.col(1));
    double low = 0, high = 0;
    for (const auto& p : points) {
        const double s = edge.axes.col(0).dot(p - edge.origin);
        low = std::min(low, s), high = std::max(high, s);
    }
    const double length = std::max(high - low, 1.0) * kLonger;
    edge.segments = std::clamp(static_cast<int>(std::ceil(length / knot_mm)), 1, most);
    edge.step = length / edge.segments;
    edge.low = 0.5 * (low + high) - 0.5 * length;
    const int n = edge.per_axis();
    const Eigen::MatrixXd prior = curvature_rows(edge) / kStartCurvature;
    Eigen::MatrixXd normal = prior.transpose() * prior + kPartRidge * Eigen::MatrixXd::Identity(n, n);
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n, 2);
    for (const auto& p : points) {
        const Eigen::Vector3d local = edge.axes.transpose() * (p - edge.origin);
        const SplineAt b = spline_at(edge, local.x());
        const Eigen::Map<const Eigen::Vector4d> value(b.value.data());
        normal.block<4, 4>(b.first, b.first) += kPointWeight * value * value.transpose();
        right.block<4, 2>(b.first, 0) += kPointWeight * value * local.tail<2>().transpose();
    }
    const Eigen::MatrixXd solved = solve_symmetric(normal, right);
    edge.coefficients.resize(2L * n);
    edge.coefficients << solved.col(0), solved.col(1);
    return edge;
}

}  // namespace seamwright::on_part
