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

bool definite(const Matrix6& c) {
    Matrix6 l;  // c = l diag l^T
    double pivot[6];
    for (int j = 0; j < 6; ++j) {
        pivot[j] = c.coeff(j, j);
        for (int k = 0; k < j; ++k) pivot[j] -= l.coeff(j, k) * l.coeff(j, k) * pivot[k];
        if (!(pivot[j] > kRounding * c.coeff(j, j))) return false;
        const double inverse = 1 / pivot[j];
        for (int i = j + 1; i < 6; ++i) {
            double sum = c.coeff(i, j);
            if (sum != c.coeff(j, i)) return false;
            for (int k = 0; k < j; ++k) sum -= l.coeff(i, k) * l.coeff(j, k) * pivot[k];
            l.coeffRef(i, j) = sum * inverse;
        }
    }
    return true;
}

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

Eigen::Matrix3d arrival_covariance(const Pose& pose, const Matrix6& c, const Eigen::Vector3d& p,
                                   bool travel) {
    // Along an axis a of the sensor: a . (dt + dw x R p) = a . dt + (R p x a) . dw.
    const Eigen::Vector3d lever = pose.linear().lazyProduct(p);
    Eigen::Matrix<double, 6, 3> along, image;
    for (const int i : {0, 2, 1}) {
        if (i == 1 && !travel) break;
        along.col(i).head<3>() = pose.linear().col(i);
        along.col(i).tail<3>() = lever.cross(pose.linear().col(i));
        image.col(i) = c.lazyProduct(along.col(i));
    }
    Eigen::Matrix3d out = Eigen::Matrix3d::Zero();
    for (const int i : {0, 2, 1}) {
        if (i == 1 && !travel) break;
        for (const int k : {0, 2, 1}) {
            if (k == 1 && !travel) break;
            out(i, k) = along.col(i).dot(image.col(k));
        }
    }
    return out;
}

void eliminate(SharedBlock& b) {
    auto& l = b.lower;
    for (int j = 0; j < kShared; ++j) {
        double pivot = l.coeff(j, j);
        for (int k = 0; k < j; ++k) pivot -= l.coeff(j, k) * l.coeff(j, k);
        const double root = std::sqrt(pivot);  // of a matrix whose eigenvalues are at least 1
        l.coeffRef(j, j) = root;
        b.inverse.coeffRef(j) = 1 / root;
        for (int i = j + 1; i < kShared; ++i) {
            double sum = l.coeff(i, j);
            for (int k = 0; k < j; ++k) sum -= l.coeff(i, k) * l.coeff(j, k);
            l.coeffRef(i, j) = sum * b.inverse.coeff(j);
        }
    }
    b.gain = b.cross;
    b.value = -b.gradient;
    for (int i = 0; i < kShared; ++i) {
        for (int k = 0; k < i; ++k) {
            b.gain.col(i) -= l.coeff(i, k) * b.gain.col(k);
            b.value.coeffRef(i) -= l.coeff(i, k) * b.value.coeff(k);
        }
        b.gain.col(i) *= b.inverse.coeff(i);
        b.value.coeffRef(i) *= b.inverse.coeff(i);
    }
    for (int i = kShared - 1; i >= 0; --i) {
        for (int k = i + 1; k < kShared; ++k) {
            b.gain.col(i) -= l.coeff(k, i) * b.gain.col(k);
            b.value.coeffRef(i) -= l.coeff(k, i) * b.value.coeff(k);
        }
        b.gain.col(i) *= b.inverse.coeff(i);
        b.value.coeffRef(i) *= b.inverse.coeff(i);
    }
}

Eigen::Matrix3d left_uncertain(const SharedBlock& b, const SharedColumns& columns) {
    // x and z side by side; Y only where it is observed.
    Eigen::Array<double, 2, kShared> xz;
    Eigen::Array2d xx = Eigen::Array2d::Zero();
    double cross = 0;
    for (int i = 0; i < kShared; ++i) {
        Eigen::Array2d v(columns.coeff(i, 0), columns.coeff(i, 2));
        for (int k = 0; k < i; ++k) v -= b.lower.coeff(i, k) * xz.col(k);
        v *= b.inverse.coeff(i);
        xz.col(i) = v;
        xx += v * v;
        cross += v.x() * v.y();
    }
    Eigen::Matrix3d out = Eigen::Matrix3d::Zero();
    out(0, 0) = xx.x();
    out(2, 2) = xx.y();
    out(0, 2) = out(2, 0) = cross;
    if (columns.col(1).isZero(0)) return out;
    SharedVector y = columns.col(1);
    for (int i = 0; i < kShared; ++i) {
        for (int k = 0; k < i; ++k) y.coeffRef(i) -= b.lower.coeff(i, k) * y.coeff(k);
        y.coeffRef(i) *= b.inverse.coeff(i);
    }
    out(1, 1) = y.squaredNorm();
    out(0, 1) = out(1, 0) = xz.row(0).matrix().dot(y.transpose());
    out(2, 1) = out(1, 2) = xz.row(1).matrix().dot(y.transpose());
    return out;
}

}  // namespace seamwright::correction
