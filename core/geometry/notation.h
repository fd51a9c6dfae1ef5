#pragma once
// How the robot brands write a pose. Each pair is inverse to rounding; at gimbal lock (|B| = 90 degrees) the
// pose is kept and the first angle takes the whole turn, the last is 0.

#include <array>

#include "core/geometry/pose.h"

namespace seamwright {

// KUKA A, B, C in degrees: intrinsic Z-Y'-X'', R = Rz(A) Ry(B) Rx(C) (C.18). A, C in (-180, 180], B in [-90,
// 90].
struct KukaAbc {
    double a_deg = 0, b_deg = 0, c_deg = 0;
};
Eigen::Matrix3d rotation_from_kuka(const KukaAbc& abc);
KukaAbc kuka_from_rotation(const Eigen::Matrix3d& rotation);

// d(A,B,C in rad)/d(rotation vector in rad, work-object axes) at `rotation`: turns a covariance of the
// tangent's rotation part into one of the angles. Singular at gimbal lock; there the pseudo-inverse is
// returned.
Eigen::Matrix3d kuka_jacobian(const Eigen::Matrix3d& rotation);

// FANUC W, P, R in degrees: the same rotation as KUKA with W = C, P = B, R = A.
struct FanucWpr {
    double w_deg = 0, p_deg = 0, r_deg = 0;
};
Eigen::Matrix3d rotation_from_fanuc(const FanucWpr& wpr);
FanucWpr fanuc_from_rotation(const Eigen::Matrix3d& rotation);

// ABB quaternion q1..q4, w first. Returned with w >= 0. Refuses a norm off 1 by more than 1e-3, else
// normalises.
struct AbbQuaternion {
    double w = 1, x = 0, y = 0, z = 0;
};
Expected<Eigen::Matrix3d> rotation_from_abb(const AbbQuaternion& q, const Text& where);
AbbQuaternion abb_from_rotation(const Eigen::Matrix3d& rotation);

// Universal Robots rotation vector in radian (the brand's own unit): axis times angle.
Eigen::Matrix3d rotation_from_ur(const Eigen::Vector3d& rotvec_rad);
Eigen::Vector3d ur_from_rotation(const Eigen::Matrix3d& rotation);

// Intrinsic Z-Y'-Z'' in degrees (Staubli-older, Kawasaki O A T). Second angle in [0, 180].
struct Zyz {
    double z1_deg = 0, y_deg = 0, z2_deg = 0;
};
Eigen::Matrix3d rotation_from_zyz(const Zyz& zyz);
Zyz zyz_from_rotation(const Eigen::Matrix3d& rotation);

}  // namespace seamwright
