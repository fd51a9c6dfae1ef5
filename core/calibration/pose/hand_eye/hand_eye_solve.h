#pragma once
// The numbers below calibrate_hand_eye(): pairs A_i X C_i = Y, their residuals, and their least squares. Inner part of
// hand_eye.h, where model and noise stand. Its own twelve unknowns and not ceres::Problem: the detective of conventions
// solves thousands of these, 1.2 ms each for 12 pairs (their variances, hand_eye_noise.h, take about as long again), 2.6
// times that on Ceres with the same numbers.

#include <cstddef>
#include <limits>
#include <vector>

#include "core/geometry/pose.h"

namespace seamwright::hand_eye {

using Matrix12 = Eigen::Matrix<double, 12, 12>;

// Information of a tangent that no pair tells.
inline constexpr double kUntold = 1e-30;
// Added to the diagonal of an information scaled to unit diagonal: keeps open directions solvable.
inline constexpr double kRidge = 1e-14;

struct Chain {
    std::vector<Pose> a, c;
    std::vector<bool> used;
    std::size_t size() const { return a.size(); }
    std::size_t used_count() const;
};

// No camera and robot are better.
inline constexpr double kFloor_mm = 0.02, kFloor_rad = 2e-4;

// Fewer pairs leave the turns so free that they take up what the places scatter: both scales are then one, turns on the
// lever of shared_lever_mm().
inline constexpr std::size_t kFewestForScales = 6;
// Cameras and robots that err by a millimetre turn wrongly by a radian over about that: 0.4 of the target's distance.
double shared_lever_mm(const Chain& chain);

// Standard deviations an axis that the residuals are divided by.
struct Scales {
    double mm = 1, rad = 0.01;
};

Eigen::Vector3d residual_mm(const Chain& chain, std::size_t i, const Pose& x, const Pose& y);
Eigen::Vector3d residual_rad(const Chain& chain, std::size_t i, const Pose& x, const Pose& y);
// |r_t|^2 / s_t^2 + |r_r|^2 / s_r^2
double pair_square(const Chain& chain, std::size_t i, const Pose& x, const Pose& y, const Scales& s);

// X and Y from where they stand, robust by Geman-McClure over whole pairs: cost q k / (q + k) of the square q; k
// infinite = least squares.
void refine(const Chain& chain, Pose& x, Pose& y, const Scales& s, double k, int most_iterations);

// Axis sigmas from the medians of the residuals; of fewer than kFewestForScales pairs one, turns on the shared lever.
Scales scales_from_medians(const Chain& chain, const Pose& x, const Pose& y);

// Least squares with the two scales estimated along; of few pairs as above.
Scales solve(const Chain& chain, Pose& x, Pose& y, Scales scales);

// Residuals and derivatives by the tangents of X and Y, six rows a used pair, over the scales.
struct Linear {
    Eigen::VectorXd residuals;
    Eigen::MatrixXd jacobian;
};
Linear linearise_pairs(const Chain& chain, const Pose& x, const Pose& y, const Scales& s);

// Largest sigma of X with the noise floor: what the poses determine, whatever the noise.
struct Determination {
    double worst_mm = 0, worst_rad = 0;
};
Determination determination(const Chain& chain, const Pose& x, const Pose& y, const Scales& scales);

}  // namespace seamwright::hand_eye
