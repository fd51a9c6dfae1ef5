#include "core/geometry/notation.h"

#include <fmt/format.h>

#include <cmath>

#include "core/geometry/decompositions.h"
#include "core/geometry/euler.h"

namespace seamwright {
namespace {

constexpr EulerConvention kKuka{EulerOrder::zyx, EulerTurns::intrinsic};
constexpr EulerConvention kZyz{EulerOrder::zyz, EulerTurns::intrinsic};

Eigen::Vector3d radians(double a_deg, double b_deg, double c_deg) {
    return {rad_from_deg(a_deg), rad_from_deg(b_deg), rad_from_deg(c_deg)};
}

}  // namespace

Eigen::Matrix3d rotation_from_kuka(const KukaAbc& abc) {
    return rotation_from_euler(kKuka, radians(abc.a_deg, abc.b_deg, abc.c_deg));
}

KukaAbc kuka_from_rotation(const Eigen::Matrix3d& r) {
    const Eigen::Vector3d abc = euler_from_rotation(kKuka, r);
    return {deg_from_rad(abc[0]), deg_from_rad(abc[1]), deg_from_rad(abc[2])};
}

Eigen::Matrix3d kuka_jacobian(const Eigen::Matrix3d& r) {
    // The columns are the axes that A, B and C turn about, in the outer frame: dw = M (dA, dB, dC).
    const KukaAbc abc = kuka_from_rotation(r);
    const Eigen::Matrix3d ra = rotation_from_kuka({abc.a_deg, 0, 0});
    const Eigen::Matrix3d rb = rotation_from_kuka({0, abc.b_deg, 0});
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
    constexpr double kOffUnit = 1e-3;
    const double norm = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    if (!(std::abs(norm - 1.0) <= kOffUnit))
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
    return rotation_from_euler(kZyz, radians(zyz.z1_deg, zyz.y_deg, zyz.z2_deg));
}

Zyz zyz_from_rotation(const Eigen::Matrix3d& r) {
    const Eigen::Vector3d zyz = euler_from_rotation(kZyz, r);
    return {deg_from_rad(zyz[0]), deg_from_rad(zyz[1]), deg_from_rad(zyz[2])};
}

}  // namespace seamwright
