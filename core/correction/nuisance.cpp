#include "core/correction/nuisance.h"

#include <cmath>

namespace seamwright {

Matrix6 hand_eye_along_sensor(const Pose& flange_from_sensor, const Matrix6& covariance) {
    // F Exp(rho, theta) = (Exp(dw) R, t + dt): theta = R^T dw, rho = R^T dt.
    Matrix6 turn = Matrix6::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = flange_from_sensor.linear().transpose();
    return turn * covariance * turn.transpose();
}

}  // namespace seamwright

namespace seamwright::correction {
namespace {

// Of correlations, where a pivot counts as none.
constexpr double kRounding = 1e-9;

}  // namespace

bool semidefinite(const Eigen::Ref<const Eigen::MatrixXd>& c) {
    constexpr Eigen::Index kMost = 6;
    const Eigen::Index n = c.rows();
    if (n != c.cols() || n > kMost || !c.allFinite()) return false;
    // Cholesky of the correlations; a direction without variance must have no correlation either.
    Eigen::Matrix<double, kMost, kMost> l;
    double scale[kMost];
    for (Eigen::Index j = 0; j < n; ++j) {
        if (c(j, j) < 0) return false;
        scale[j] = c(j, j) > 0 ? 1 / std::sqrt(c(j, j)) : 0;
        for (Eigen::Index i = 0; i < j; ++i) {
            const double size = std::sqrt(c(i, i)) * std::sqrt(c(j, j));
            if (std::abs(c(i, j) - c(j, i)) > kRounding * size) return false;
            if (size == 0 && c(i, j) != 0) return false;
        }
    }
    for (Eigen::Index j = 0; j < n; ++j) {
        double pivot = scale[j] > 0 ? 1 : 0;
        for (Eigen::Index k = 0; k < j; ++k) pivot -= l(j, k) * l(j, k);
        if (pivot < -kRounding) return false;
        const bool none = pivot <= kRounding;
        l(j, j) = none ? 0 : std::sqrt(pivot);
        for (Eigen::Index i = j + 1; i < n; ++i) {
            double sum = c(i, j) * scale[i] * scale[j];
            for (Eigen::Index k = 0; k < j; ++k) sum -= l(i, k) * l(j, k);
            // Of a semidefinite matrix this is at most sqrt(pivot).
            if (none && std::abs(sum) > 2 * std::sqrt(kRounding)) return false;
            l(i, j) = none ? 0 : sum / l(j, j);
        }
    }
    return true;
}

bool is_zero(const SensorPrior& prior) {
    return prior.hand_eye_covariance.isZero(0) && prior.scale_sigma.isZero(0) && prior.shear_sigma == 0;
}

SharedRoot root_of(const SensorPrior& prior) {
    SharedRoot out;
    const Matrix6& c = prior.hand_eye_covariance;
    Matrix6& l = out.hand_eye;
    l.setZero();
    for (int j = 0; j < 6; ++j) {
        double pivot = c(j, j);
        for (int k = 0; k < j; ++k) pivot -= l(j, k) * l(j, k);
        if (!(pivot > kRounding * c(j, j))) continue;  // known exactly, or by the directions before
        l(j, j) = std::sqrt(pivot);
        for (int i = j + 1; i < 6; ++i) {
            double sum = c(i, j);
            for (int k = 0; k < j; ++k) sum -= l(i, k) * l(j, k);
            l(i, j) = sum / l(j, j);
        }
    }
    out.scale << prior.scale_sigma, prior.shear_sigma;
    return out;
}

SharedVector shared_row(const SharedGeometry& spot, const SharedRoot& root, int i,
                        const Eigen::Vector3d& axis, const Eigen::Vector3d& y) {
    // Row i of R_A.
    const Eigen::Vector3d turned = spot.axes.transpose().lazyProduct(axis);
    const Eigen::Vector3d& m = spot.measured;
    const Eigen::Vector3d& r = spot.reference;
    Vector6 b;
    b.head<3>() = -turned;
    b.coeffRef(i) += 1;
    b.tail<3>() = turned.cross(m);
    // - e_i x y.
    const int j = i == 2 ? 0 : i + 1, k = i == 0 ? 2 : i - 1;
    b.coeffRef(3 + j) += y.coeff(k);
    b.coeffRef(3 + k) -= y.coeff(j);
    SharedVector u;
    for (int column = 0; column < 6; ++column) {
        double sum = 0;
        for (int row = column; row < 6; ++row) sum += b.coeff(row) * root.hand_eye.coeff(row, column);
        u.coeffRef(column) = sum;
    }
    u.coeffRef(6) = root.scale.x() * ((i == 0 ? r.x() : 0.0) - turned.x() * m.x());
    u.coeffRef(7) = root.scale.y() * ((i == 2 ? r.z() : 0.0) - turned.z() * m.z());
    u.coeffRef(8) = root.scale.z() * ((i == 0 ? r.z() : 0.0) - turned.x() * m.z());
    return u;
}

Eigen::Matrix3d arrival_covariance(const Pose& pose, const Matrix6& c, const Eigen::Vector3d& p) {
    // dp = dt - [R p]x dw in the work object.
    const Eigen::Matrix3d lever = skew(pose.linear() * p);
    const Eigen::Matrix3d cross = lever.lazyProduct(c.bottomLeftCorner<3, 3>());
    const Eigen::Matrix3d moved =
        c.topLeftCorner<3, 3>() - cross - cross.transpose() +
        Eigen::Matrix3d(lever.lazyProduct(c.bottomRightCorner<3, 3>())).lazyProduct(lever.transpose());
    return Eigen::Matrix3d(pose.linear().transpose().lazyProduct(moved)).lazyProduct(pose.linear());
}

void eliminate(SharedBlock& b) {
    auto& l = b.lower;
    double inverse[kShared];
    for (int j = 0; j < kShared; ++j) {
        double pivot = l.coeff(j, j);
        for (int k = 0; k < j; ++k) pivot -= l.coeff(j, k) * l.coeff(j, k);
        const double root = std::sqrt(pivot);  // of a matrix whose eigenvalues are at least 1
        l.coeffRef(j, j) = root;
        inverse[j] = 1 / root;
        for (int i = j + 1; i < kShared; ++i) {
            double sum = l.coeff(i, j);
            for (int k = 0; k < j; ++k) sum -= l.coeff(i, k) * l.coeff(j, k);
            l.coeffRef(i, j) = sum * inverse[j];
        }
    }
    b.gain = b.cross;
    b.value = -b.gradient;
    for (int i = 0; i < kShared; ++i) {
        for (int k = 0; k < i; ++k) {
            b.gain.col(i) -= l.coeff(i, k) * b.gain.col(k);
            b.value.coeffRef(i) -= l.coeff(i, k) * b.value.coeff(k);
        }
        b.gain.col(i) *= inverse[i];
        b.value.coeffRef(i) *= inverse[i];
    }
    for (int i = kShared - 1; i >= 0; --i) {
        for (int k = i + 1; k < kShared; ++k) {
            b.gain.col(i) -= l.coeff(k, i) * b.gain.col(k);
            b.value.coeffRef(i) -= l.coeff(k, i) * b.value.coeff(k);
        }
        b.gain.col(i) *= inverse[i];
        b.value.coeffRef(i) *= inverse[i];
    }
}

SharedVector forward(const SharedBlock& b, const SharedVector& v) {
    SharedVector x = v;
    for (int i = 0; i < kShared; ++i) {
        for (int k = 0; k < i; ++k) x.coeffRef(i) -= b.lower.coeff(i, k) * x.coeff(k);
        x.coeffRef(i) /= b.lower.coeff(i, i);
    }
    return x;
}

}  // namespace seamwright::correction
