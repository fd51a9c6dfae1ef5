#pragma once
// Statistics of deviations and of the honesty of a stated covariance (methods.md 7; thesis 5.2).

#include <Eigen/Core>
#include <span>

#include "core/correction/correction.h"

namespace seamwright {

// Of finite values; variance is the unbiased one. All 0 when there are none (variance 0 for a single one).
struct Summary {
    std::size_t count = 0;
    double mean = 0, minimum = 0, maximum = 0, variance = 0, three_sigma = 0;
};
Summary summarise(std::span<const double> values);

// Normalised estimation error squared, mean over `trials` of d^T C^-1 d with `degrees` each: chi-square, so
// its mean lies in [low, high] with 95 % when C is the truth (Wilson and Hilferty, 1e-3 for degrees * trials
// above 10).
struct NeesInterval {
    double low = 0, high = 0;
};
NeesInterval nees_interval(int degrees, int trials);

// d^T C^-1 d, scaled so that mm and rad do not matter; infinity when C is singular.
double nees(const Vector6& error, const Matrix6& covariance);

// Cramer-Rao bound of the landmark of a rigid planar match, from the points' noise alone. Points of the
// noise-free contour and their unit normals; noise of standard deviation sigma_mm across the contour,
// independent. Parameters (dx, dz, phi) about the landmark; returns the bound of (dx, dz) in mm^2 with phi
// unknown. Precondition: at least 3 points with normals in two directions (else the bound is infinite: NaN).
Eigen::Matrix2d landmark_bound(std::span<const Eigen::Vector2d> points,
                               std::span<const Eigen::Vector2d> normals, const Eigen::Vector2d& landmark_mm,
                               double sigma_mm);

// Bound of D (tangent of pose.h) from the bounds of its spots' landmarks (x, z).
Matrix6 displacement_bound(std::span<const SpotObservation> spots,
                           std::span<const Eigen::Matrix2d> landmark_bounds);

// Mean square displacement of the spots' references that a covariance of D stands for, mm^2 (three axes).
double mean_square_at_spots(std::span<const SpotObservation> spots, const Matrix6& covariance);

}  // namespace seamwright
