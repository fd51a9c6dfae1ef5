#include "core/geometry/notation.h"

#include <fmt/format.h>

#include <cmath>

#include "core/geometry/decompositions.h"

namespace seamwright {
namespace {

Eigen::Matrix3d rot_x(double rad) {
    return Eigen::AngleAxisd(rad, Eigen::Vector3d::UnitX()).toRotationMatrix();
}
Eigen::Matrix3d rot_y(double rad) {
    return Eigen::AngleAxisd(rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
}
Eigen::Matrix3d rot_z(double rad) {
    return Eigen::AngleAxisd(rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

// Below this cosine (sine for ZYZ) the two outer axes are parallel to within rounding and only their sum is
// known.
constexpr double kLock = 1e-9;

}  // namespace

Eigen::Matrix3d rotation_from_kuka(const KukaAbc& abc) {
    return rot_z(rad_from_deg(abc.a_deg)) * rot_y(rad_from_deg(abc.b_deg)) * rot_x(rad_from_deg(abc.c_deg));
}

KukaAbc kuka_from_rotation(const Eigen::Matrix3d& r) {
    const double cos_b = std::hypot(r(0, 0), r(1, 0));
    const double b = std::atan2(-r(2, 0), cos_b);
    if (cos_b < kLock) return {deg_from_rad(std::atan2(-r(0, 1), r(1, 1))), deg_from_rad(b), 0.0};
    return {deg_from_rad(std::atan2(r(1, 0), r(0, 0))), deg_from_rad(b),
            deg_from_rad(std::atan2(r(2, 1), r(2, 2)))};
}

Eigen::Matrix3d kuka_jacobian(const Eigen::Matrix3d& r) {
    // The columns are the axes that A, B and C turn about, in the outer frame: dw = M (dA, dB, dC).
    const KukaAbc abc = kuka_from_rotation(r);
    const Eigen::Matrix3d ra = rot_z(rad_from_deg(abc.a_deg));
    const Eigen::Matrix3d rb = rot_y(rad_from_deg(abc.b_deg));
    Eigen::Matrix3d m;
    m.col(0) = Eigen::Vector3d::UnitZ();
    m.col(1) = ra * Eigen::Vector3d::UnitY();
    m.col(2) = ra * rb * Eigen::Vector3d::UnitX();
    return least_squares(m, Eigen::Matrix3d::Identity()).x;
}

Eigen::Matrix3d rotation_from_fanuc(const FanucWpr& wpr) {
    return rotation_from_kuka({wpr.r_deg, wpr.p_deg, wpr.w_deg});
}

FanucWpr fanuc_from_rotation(const Eigen::Matrix3d& r) {
    const KukaAbc abc = kuka_from_rotation(r);
    return {abc.c_deg, abc.b_deg, abc.a_deg};
}

Expected<Eigen::Matrix3d> rotation_from_abb(const AbbQuaternion& q, const Text& where) {
    const double norm = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    if (!(std::abs(norm - 1.0) <= 1e-3))
        return input_error(Text("the quaternion has length {:.4g} instead of 1", norm), where,
                           "give w x y z of a unit quaternion, w first");
    return Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
}

AbbQuaternion abb_from_rotation(const Eigen::Matrix3d& r) {
    Eigen::Quaterniond q(r);
    q.normalize();
    if (q.w() < 0) q.coeffs() *= -1.0;
    return {q.w(), q.x(), q.y(), q.z()};
}

Eigen::Matrix3d rotation_from_ur(const Eigen::Vector3d& rotvec_rad) {
    return rotation_exp(rotvec_rad);
}
Eigen::Vector3d ur_from_rotation(const Eigen::Matrix3d& r) {
    return rotation_log(r);
}

Eigen::Matrix3d rotation_from_zyz(const Zyz& zyz) {
    return rot_z(rad_from_deg(zyz.z1_deg)) * rot_y(rad_from_deg(zyz.y_deg)) * rot_z(rad_from_deg(zyz.z2_deg));
}

Zyz zyz_from_rotation(const Eigen::Matrix3d& r) {
    const double sin_y = std::hypot(r(0, 2), r(1, 2));
    const double y = std::atan2(sin_y, r(2, 2));
    // At y = 0 or 180 degrees both outer axes fall together: R = Rz(z1) diag(c, 1, c), column 1 = (-sin z1,
    // cos z1, 0).
    if (sin_y < kLock) return {deg_from_rad(std::atan2(-r(0, 1), r(1, 1))), deg_from_rad(y), 0.0};
    return {deg_from_rad(std::atan2(r(1, 2), r(0, 2))), deg_from_rad(y),
            deg_from_rad(std::atan2(r(2, 1), -r(2, 0)))};
}

}  // namespace seamwright
