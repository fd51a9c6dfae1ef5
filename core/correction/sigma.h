#pragma once
// How sure a displacement is, as the safety gate judges it: where the path runs, along the worst direction.

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/pose.h"

namespace seamwright {

// Standard deviation along the worst direction of a covariance; NaN when it is none (negative or not finite).
inline double worst_sigma(const Eigen::Matrix3d& covariance) {
    if (!covariance.allFinite()) return std::numeric_limits<double>::quiet_NaN();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
    const double smallest = solver.eigenvalues().minCoeff(), largest = solver.eigenvalues().maxCoeff();
    if (smallest < -1e-9 * std::max(1.0, largest)) return std::numeric_limits<double>::quiet_NaN();
    return std::sqrt(std::max(0.0, largest));
}

// Of a point that the displacement D carries along: d(D p) = dt - [R p]x dw. `covariance` is D's, tangent of
// pose.h; work object, mm.
inline double sigma_at_mm(const Matrix6& covariance, const Pose& displacement,
                          const Eigen::Vector3d& point_mm) {
    Eigen::Matrix<double, 3, 6> j;
    j << Eigen::Matrix3d::Identity(), -skew(displacement.linear() * point_mm);
    return worst_sigma(j * covariance * j.transpose());
}

}  // namespace seamwright
