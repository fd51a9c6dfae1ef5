#pragma once
// Poses, frames and the one tangent of the house.
//
// A Pose named `to_from` maps a point given in frame `from` to frame `to`: p_to = to_from * p_from. Lengths
// are millimetres. Angles are radians inside core; names that end in _deg are degrees (edges only).
//
// Tangent (the one definition): 6 numbers, translation first, then rotation vector:
//     delta = (dt_x, dt_y, dt_z, dw_x, dw_y, dw_z)            [mm, mm, mm, rad, rad, rad]
//     retract(T, delta):  R <- Exp(dw) R,  t <- t + dt        (both expressed in the `to` frame)
// Translation and rotation are perturbed apart, so the first three standard deviations of a covariance are
// those of the printed x, y, z. Every 6x6 covariance of a pose in the project is in this order and this
// tangent.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/error.h"

namespace seamwright {

using Pose = Eigen::Isometry3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

inline constexpr double kPi = 3.14159265358979323846;
constexpr double deg_from_rad(double rad) {
    return rad * (180.0 / kPi);
}
constexpr double rad_from_deg(double deg) {
    return deg * (kPi / 180.0);
}

// Rotation vector (rad) to rotation and back. Exact to rounding from 0 to pi; log returns |w| <= pi, and at
// pi one of the two equivalent axes.
Eigen::Matrix3d rotation_exp(const Eigen::Vector3d& rotation_vector);
Eigen::Vector3d rotation_log(const Eigen::Matrix3d& rotation);

// Cross-product matrix: skew(a) * b = a x b.
Eigen::Matrix3d skew(const Eigen::Vector3d& a);

// The smallest rotation that turns the direction `from` (of any length) into `to`; a half turn about one of
// the axes across when they are opposite. Eigen's FromTwoVectors, compiled once: it takes 5 s per source.
Eigen::Matrix3d rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

Pose make_pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation_mm);

Pose retract(const Pose& pose, const Vector6& delta);
// Inverse of retract: the delta with retract(from, delta) == to (rotation difference below pi).
Vector6 difference(const Pose& to, const Pose& from);

// First-order propagation. `covariance` is that of `pose`; the results are those of the inverse and of a
// product of two independent poses, all in the tangent above.
Matrix6 covariance_of_inverse(const Pose& pose, const Matrix6& covariance);
Matrix6 covariance_of_product(const Pose& a_from_b, const Matrix6& cov_ab, const Pose& b_from_c,
                              const Matrix6& cov_bc);

// Screw interpolation (constant twist) from a (s = 0) to b (s = 1); s outside [0, 1] extrapolates.
Pose interpolate(const Pose& a, const Pose& b, double s);

// Translation distance in mm and rotation angle in rad between two poses of the same frames.
double distance_mm(const Pose& a, const Pose& b);
double angle_rad(const Pose& a, const Pose& b);

// Checks finite entries, last row 0 0 0 1, orthonormal rotation (entrywise within `tolerance`), determinant
// +1; then returns the nearest rotation. The Error names what is wrong: NaN, a mirrored or scaled or sheared
// matrix, a transposed one (translation in the last row). Translations beyond 100 m are refused.
Expected<Pose> pose_from_matrix(const Eigen::Matrix4d& matrix, const Text& where, double tolerance = 1e-4);

}  // namespace seamwright
