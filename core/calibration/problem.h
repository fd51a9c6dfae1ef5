#pragma once
// What a ceres::Problem of the house needs besides Ceres: poses in the tangent of geometry/pose.h, unknowns that
// move in given directions only, a silent solve, and the normal equations where it ended. For the sources of
// core/calibration; no header that others include brings Ceres along.
//
// Unknowns are those that all residuals share and, apart, one pose per view, which each residual knows at most one
// of: the views are eliminated (Schur complement), so a step costs them once and one system of the shared ones.
//
// A cost functor returns false where a state is impossible (a point behind its camera, a lens that cannot be
// undone): the step there is refused like one uphill. It never answers NaN: Ceres would say so on stderr.

#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "core/calibration/normal_blocks.h"
#include "core/geometry/pose.h"

namespace seamwright {

// A pose as a parameter block: translation (mm), then the unit quaternion x, y, z, w.
using PoseBlock = Eigen::Matrix<double, 7, 1>;
PoseBlock block_of(const Pose& pose);
Pose pose_of(const PoseBlock& block);

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

// Of such a block, inside a cost functor.
template <class T>
Eigen::Map<const Eigen::Quaternion<T>> turn_of(const T* block) {
    return Eigen::Map<const Eigen::Quaternion<T>>(block + 3);
}
template <class T>
Vector3<T> shift_of(const T* block) {
    return {block[0], block[1], block[2]};
}

// How the tangent of a turn goes with its quaternion, for derivatives by hand: [3, 4].
Eigen::Matrix<double, 3, 4> tangent_by_turn(const double* block);

// Rotation vector of a unit quaternion (|w| <= pi), with derivatives at no turn too.
template <class T>
Vector3<T> rotation_vector(const Eigen::Quaternion<T>& q) {
    using std::atan2;
    using std::sqrt;
    constexpr double kNoSine2 = 1e-20;  // up to that, the limit at no turn
    const T sine2 = q.x() * q.x() + q.y() * q.y() + q.z() * q.z();
    T times = T(2.0);
    if (sine2 > T(kNoSine2)) {
        const T sine = sqrt(sine2);
        times = (q.w() < T(0.0) ? atan2(-sine, -q.w()) : atan2(sine, q.w())) * 2.0 / sine;
    } else if (q.w() < T(0.0)) {
        times = T(-2.0);
    }
    return {q.x() * times, q.y() * times, q.z() * times};
}

// The Problem that they are given to owns what these make.
ceres::Manifold* pose_manifold();                                     // retract() of geometry/pose.h
ceres::Manifold* linear_manifold(const Eigen::MatrixXd& directions);  // x + directions * step
ceres::Manifold* plane_manifold();                                    // unit normal (3), offset
ceres::LossFunction* geman_mcclure(double k);                         // s k / (s + k) of the square s

// Levenberg-Marquardt from where the unknowns stand; they are left at the best seen. `views` that the problem does
// not know are passed over. Converged: the relative gain of a step fell below `tolerance`, or nothing moves. The
// cost is the sum of squares after losses, infinity when the start is impossible.
struct Solved {
    bool converged = false;
    double cost = 0;
};
Solved solve(ceres::Problem& problem, const std::vector<double*>& views, int most_iterations,
             double tolerance);

// Residuals and their derivatives (losses applied) by the tangents of `unknowns`, in this order, where they stand.
// False where the state is impossible.
bool linearise(ceres::Problem& problem, const std::vector<double*>& unknowns, Eigen::VectorXd& residuals,
               Eigen::MatrixXd& jacobian);

// Normal equations there. Views without a residual have the identity.
NormalBlocks normal_blocks(ceres::Problem& problem, const std::vector<double*>& shared,
                           const std::vector<double*>& views);

}  // namespace seamwright
