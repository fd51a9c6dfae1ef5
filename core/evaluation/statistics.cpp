#include "core/evaluation/statistics.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright {

Summary summarise(std::span<const double> values) {
    Summary s;
    for (double v : values) {
        if (!std::isfinite(v)) continue;
        s.minimum = s.count == 0 ? v : std::min(s.minimum, v);
        s.maximum = s.count == 0 ? v : std::max(s.maximum, v);
        ++s.count;
        const double step = v - s.mean;
        s.mean += step / static_cast<double>(s.count);
        s.variance += step * (v - s.mean);
    }
    s.variance = s.count > 1 ? s.variance / static_cast<double>(s.count - 1) : 0;
    s.three_sigma = 3 * std::sqrt(s.variance);
    return s;
}

NeesInterval nees_interval(int degrees, int trials) {
    assert(degrees > 0 && trials > 0);
    const double k = static_cast<double>(degrees) * trials, a = 2 / (9 * k);
    const auto quantile = [&](double z) { return degrees * std::pow(1 - a + z * std::sqrt(a), 3); };
    return {quantile(-kNormal95), quantile(kNormal95)};
}

double nees(const Vector6& error, const Matrix6& covariance) {
    if (!(covariance.diagonal().minCoeff() > 0)) return std::numeric_limits<double>::infinity();
    const Vector6 scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
    const Matrix6 correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
    const Vector6 d = scale.asDiagonal() * error;
    return d.dot(Vector6(solve_symmetric(correlation, d)));
}

Eigen::Matrix2d landmark_bound(std::span<const Eigen::Vector2d> points,
                               std::span<const Eigen::Vector2d> normals, const Eigen::Vector2d& landmark_mm,
                               double sigma_mm) {
    assert(points.size() == normals.size());
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector2d lever = points[i] - landmark_mm;
        const Eigen::Vector2d& n = normals[i];
        const Eigen::Vector3d row(n.x(), n.y(), lever.x() * n.y() - lever.y() * n.x());
        information += row * row.transpose() / (sigma_mm * sigma_mm);
    }
    const LeastSquares inverse = least_squares(information, Eigen::Matrix3d::Identity());
    if (inverse.rank < 3) return Eigen::Matrix2d::Constant(std::numeric_limits<double>::quiet_NaN());
    return inverse.x.topLeftCorner<2, 2>();
}

Matrix6 displacement_bound(std::span<const SpotObservation> spots,
                           std::span<const Eigen::Matrix2d> landmark_bounds) {
    assert(spots.size() == landmark_bounds.size());
    Matrix6 information = Matrix6::Zero();
    for (std::size_t n = 0; n < spots.size(); ++n) {
        const Eigen::Matrix3d axes = spots[n].workobject_from_sensor.linear().transpose();
        const Eigen::Vector3d at = spots[n].workobject_from_sensor * spots[n].reference_mm;
        Eigen::Matrix<double, 3, 6> all;
        all << axes, -axes * skew(at);
        Eigen::Matrix<double, 2, 6> rows;
        rows << all.row(0), all.row(2);
        information += rows.transpose() * landmark_bounds[n].inverse() * rows;
    }
    const Vector6 scale = information.diagonal().cwiseSqrt().cwiseInverse();
    const Matrix6 scaled = scale.asDiagonal() * information * scale.asDiagonal();
    return scale.asDiagonal() * inverse_matrix(scaled) * scale.asDiagonal();
}

double mean_square_at_spots(std::span<const SpotObservation> spots, const Matrix6& covariance) {
    double sum = 0;
    for (const SpotObservation& s : spots) {
        Eigen::Matrix<double, 3, 6> rows;
        rows << Eigen::Matrix3d::Identity(), -skew(s.workobject_from_sensor * s.reference_mm);
        sum += (rows * covariance * rows.transpose()).trace();
    }
    return spots.empty() ? 0 : sum / static_cast<double>(spots.size());
}

}  // namespace seamwright
