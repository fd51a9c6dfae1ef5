#include "core/geometry/pose.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <cmath>

namespace seamwright {
namespace {

constexpr double kSeries_rad = 1e-4;  // turns below are taken by their series: the quotients lose digits
constexpr double kNoTurn = 1e-9;      // sine of half the angle
constexpr double kOpposite = 1e-12;   // sum of two unit directions that have no middle
constexpr double kFarthest_mm = 1e5;

// d/ds of the integral of Exp(s w): translation part of a screw motion, V(w) with t = V(w) v.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& w) {
    const double angle = w.norm();
    const Eigen::Matrix3d k = skew(w);
    double a, b;  // V = I + a K + b K^2
    if (angle < kSeries_rad) {
        a = 0.5 - angle * angle / 24.0;
        b = 1.0 / 6.0 - angle * angle / 120.0;
    } else {
        a = (1.0 - std::cos(angle)) / (angle * angle);
        b = (angle - std::sin(angle)) / (angle * angle * angle);
    }
    return Eigen::Matrix3d::Identity() + a * k + b * k * k;
}

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
    Eigen::Matrix3d k;
    k << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
    return k;
}

Eigen::Matrix3d rotation_exp(const Eigen::Vector3d& w) {
    const double angle = w.norm();
    const Eigen::Matrix3d k = skew(w);
    double a, b;  // R = I + a K + b K^2 (Rodrigues)
    if (angle < kSeries_rad) {
        a = 1.0 - angle * angle / 6.0;
        b = 0.5 - angle * angle / 24.0;
    } else {
        a = std::sin(angle) / angle;
        const double half = std::sin(0.5 * angle);
        b = 2.0 * half * half / (angle * angle);
    }
    return Eigen::Matrix3d::Identity() + a * k + b * k * k;
}

Eigen::Vector3d rotation_log(const Eigen::Matrix3d& r) {
    // Through the quaternion: well conditioned from 0 to pi, unlike the trace formula.
    Eigen::Quaterniond q(r);
    q.normalize();
    if (q.w() < 0) q.coeffs() *= -1.0;
    const double s = q.vec().norm();
    if (s < kNoTurn) return 2.0 * q.vec() / q.w();
    return q.vec() * (2.0 * std::atan2(s, q.w()) / s);
}

Eigen::Matrix3d rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    // A half turn about `from`, then one about the middle of both.
    const Eigen::Vector3d a = from.normalized(), b = to.normalized(), across = a - b;
    Eigen::Vector3d middle = a + b;
    if (across.squaredNorm() > 2)  // of a short sum only what is square to the difference keeps its digits
        middle -= across.dot(middle) / across.squaredNorm() * across;
    middle = middle.norm() > kOpposite ? middle.normalized() : a.unitOrthogonal();
    const Eigen::Matrix3d first = 2 * a * a.transpose() - Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d second = 2 * middle * middle.transpose() - Eigen::Matrix3d::Identity();
    return second * first;
}

Pose make_pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation_mm) {
    Pose p = Pose::Identity();
    p.linear() = rotation;
    p.translation() = translation_mm;
    return p;
}

Pose retract(const Pose& pose, const Vector6& delta) {
    return make_pose(rotation_exp(delta.tail<3>()) * pose.linear(), pose.translation() + delta.head<3>());
}

Vector6 difference(const Pose& to, const Pose& from) {
    Vector6 d;
    d << to.translation() - from.translation(), rotation_log(to.linear() * from.linear().transpose());
    return d;
}

Matrix6 covariance_of_inverse(const Pose& pose, const Matrix6& covariance) {
    // T^-1 = (R^T, -R^T t). With R <- Exp(w) R: R^T <- Exp(-R^T w) R^T, and d(-R^T t) = -R^T dt - R^T [t]x w.
    const Eigen::Matrix3d rt = pose.linear().transpose();
    Matrix6 j = Matrix6::Zero();
    j.topLeftCorner<3, 3>() = -rt;
    j.topRightCorner<3, 3>() = -rt * skew(pose.translation());
    j.bottomRightCorner<3, 3>() = -rt;
    return j * covariance * j.transpose();
}

Matrix6 covariance_of_product(const Pose& a_from_b, const Matrix6& cov_ab, const Pose& b_from_c,
                              const Matrix6& cov_bc) {
    // t_ac = R_ab t_bc + t_ab: a rotation error of ab swings the lever R_ab t_bc.
    const Eigen::Matrix3d r = a_from_b.linear();
    Matrix6 ja = Matrix6::Identity();
    ja.topRightCorner<3, 3>() = -skew(r * b_from_c.translation());
    Matrix6 jb = Matrix6::Zero();
    jb.topLeftCorner<3, 3>() = r;
    jb.bottomRightCorner<3, 3>() = r;
    return ja * cov_ab * ja.transpose() + jb * cov_bc * jb.transpose();
}

Pose interpolate(const Pose& a, const Pose& b, double s) {
    const Pose d = a.inverse() * b;
    const Eigen::Vector3d w = rotation_log(d.linear());
    const Eigen::Vector3d v = left_jacobian(w).inverse() * d.translation();
    return a * make_pose(rotation_exp(s * w), left_jacobian(s * w) * (s * v));
}

double distance_mm(const Pose& a, const Pose& b) {
    return (a.translation() - b.translation()).norm();
}

double angle_rad(const Pose& a, const Pose& b) {
    return rotation_log(a.linear() * b.linear().transpose()).norm();
}

Expected<Pose> pose_from_matrix(const Eigen::Matrix4d& m, const Text& where, double tolerance) {
    if (!m.allFinite()) return input_error("the pose holds a value that is not a finite number", where);
    const Eigen::RowVector4d last = m.row(3);
    if ((last - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() > tolerance) {
        if (m.col(3).head<3>().isZero(tolerance) && std::abs(m(3, 3) - 1) < tolerance)
            return input_error("the translation stands in the last row: the matrix is transposed", where,
                               "write it row by row with the translation in the last column");
        return input_error("the last row of the matrix is not 0 0 0 1", where);
    }
    const Eigen::Matrix3d r = m.topLeftCorner<3, 3>();
    const double off = (r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (off > tolerance)
        return input_error(Text("the rotation is not orthonormal (off by {:.2g})", off), where,
                           "give a rotation without scale or shear");
    if (r.determinant() < 0)
        return input_error("the rotation is mirrored (determinant -1)", where, "swap the sign of one axis");
    if (m.col(3).head<3>().cwiseAbs().maxCoeff() > kFarthest_mm)
        return input_error("the translation is beyond 100 m", where, "translations are in millimetres");
    Eigen::JacobiSVD<Eigen::Matrix3d> svd(r, Eigen::ComputeFullU | Eigen::ComputeFullV);
    return make_pose(svd.matrixU() * svd.matrixV().transpose(), m.col(3).head<3>());
}

}  // namespace seamwright
