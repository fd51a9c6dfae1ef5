#include "core/correction/nuisance.h"

#include <algorithm>
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

bool semidefinite_xz(const Eigen::Matrix2d& c) {
    if (!(c(0, 0) >= 0 && c(1, 1) >= 0)) return false;
    const double size = std::sqrt(c(0, 0)) * std::sqrt(c(1, 1));
    return std::isfinite(size) && std::abs(c(0, 1) - c(1, 0)) <= kRounding * size &&
           std::abs(c(0, 1)) <= (1 + kRounding) * size;
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
    return prior.hand_eye_covariance.isZero(0) && prior.scale_sigma.isZero(0) && prior.shear_sigma == 0 &&
           prior.latency_sigma == 0 && prior.speed_sigma == 0 && prior.drift_sigma_mm.isZero(0);
}

bool same_priors(const std::vector<SensorPrior>& a, const std::vector<SensorPrior>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const SensorPrior& p, const SensorPrior& q) {
        return p.id == q.id && same_bits(p.hand_eye_covariance, q.hand_eye_covariance) &&
               p.scale_sigma == q.scale_sigma && p.shear_sigma == q.shear_sigma &&
               p.latency_sigma == q.latency_sigma && p.speed_sigma == q.speed_sigma &&
               p.drift_sigma_mm == q.drift_sigma_mm;
    });
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
    out.latency = prior.latency_sigma;
    out.speed = prior.speed_sigma;
    out.drift = prior.drift_sigma_mm;
    const bool more = out.latency > 0 || out.speed > 0 || !out.drift.isZero(0);
    out.count = more ? kShared : out.scale.isZero(0) ? kScaleAt : kLatencyAt;
    return out;
}

void shared_row(const SharedGeometry& spot, const SharedRoot& root, const Eigen::Vector3d& f,
                const Eigen::Vector3d& axis, const Eigen::Vector3d& y, double* u) {
    const Eigen::Vector3d t = spot.axes.transpose().lazyProduct(axis);  // f R_A
    const Eigen::Vector3d& m = spot.measured;
    const Eigen::Vector3d& r = spot.reference;
    // f (rho + theta x y) - t (rho + theta x m).
    double b[6];
    for (int i = 0; i < 3; ++i) b[i] = f.coeff(i) - t.coeff(i);
    b[3] = t.y() * m.z() - t.z() * m.y() - f.y() * y.z() + f.z() * y.y();
    b[4] = t.z() * m.x() - t.x() * m.z() - f.z() * y.x() + f.x() * y.z();
    b[5] = t.x() * m.y() - t.y() * m.x() - f.x() * y.y() + f.y() * y.x();
    for (int column = 0; column < 6; ++column) {
        double sum = 0;
        for (int row = column; row < 6; ++row) sum += b[row] * root.hand_eye.coeff(row, column);
        u[column] = sum;
    }
    if (root.count == kScaleAt) return;
    u[6] = root.scale.x() * (f.x() * r.x() - t.x() * m.x());
    u[7] = root.scale.y() * (f.z() * r.z() - t.z() * m.z());
    u[kShearAt] = root.scale.z() * (f.x() * r.z() - t.x() * m.z());
    if (root.count == kLatencyAt) return;
    u[kLatencyAt] = root.latency * spot.latency_travel * (f.y() - t.y());
    u[kSpeedAt] = -root.speed * spot.latency_travel * t.y();
    for (int c = 0; c < 3; ++c) u[kDriftAt + c] = -root.drift.coeff(c) * t.coeff(c);
}

Matrix6 arrival_along_sensor(const Pose& pose, const Matrix6& c) {
    // (dt, dw) of the work object: rho = R^T dt, theta = R^T dw.
    const Eigen::Matrix3d& r = pose.linear();
    Matrix6 out;
    for (int i = 0; i < 2; ++i)
        for (int k = 0; k < 2; ++k) {
            const Eigen::Matrix3d half = r.transpose().lazyProduct(c.block<3, 3>(3 * i, 3 * k));
            out.block<3, 3>(3 * i, 3 * k) = half.lazyProduct(r);
        }
    return out;
}

CovarianceXz arrival_xz(const Matrix6& c, const Eigen::Vector3d& p) {
    // x moves by rho_x + theta_y p_z - theta_z p_y, z by rho_z + theta_x p_y - theta_y p_x.
    const double px = p.x(), py = p.y(), pz = p.z();
    CovarianceXz out;
    out.xx = c.coeff(0, 0) + pz * pz * c.coeff(4, 4) + py * py * c.coeff(5, 5) +
             2 * (pz * c.coeff(0, 4) - py * c.coeff(0, 5) - pz * py * c.coeff(4, 5));
    out.zz = c.coeff(2, 2) + py * py * c.coeff(3, 3) + px * px * c.coeff(4, 4) +
             2 * (py * c.coeff(2, 3) - px * c.coeff(2, 4) - px * py * c.coeff(3, 4));
    out.zx = c.coeff(0, 2) + py * c.coeff(0, 3) - px * c.coeff(0, 4) +
             pz * (c.coeff(4, 2) + py * c.coeff(4, 3) - px * c.coeff(4, 4)) -
             py * (c.coeff(5, 2) + py * c.coeff(5, 3) - px * c.coeff(5, 4));
    return out;
}

Eigen::Matrix3d arrival_covariance(const Matrix6& c, const Eigen::Vector3d& p, bool travel) {
    // A point moves by rho + theta x p = rho - [p] theta.
    Eigen::Matrix3d out = Eigen::Matrix3d::Zero();
    if (travel) {
        const Eigen::Matrix3d lever = skew(p);
        const Eigen::Matrix3d rho_theta =
            c.topRightCorner<3, 3>() - lever.lazyProduct(c.bottomRightCorner<3, 3>());
        out = c.topLeftCorner<3, 3>() - lever.lazyProduct(c.bottomLeftCorner<3, 3>());
        out -= rho_theta.lazyProduct(lever.transpose());
        return out;
    }
    const CovarianceXz xz = arrival_xz(c, p);
    out(0, 0) = xz.xx;
    out(0, 2) = out(2, 0) = xz.zx;
    out(2, 2) = xz.zz;
    return out;
}

Eigen::Matrix3d left_uncertain(const SharedBlock& b, const SharedColumns& columns) {
    // x and z side by side; Y only where it is observed.
    Eigen::Array<double, 2, kShared> xz;
    Eigen::Array2d xx = Eigen::Array2d::Zero();
    double cross = 0;
    for (int i = 0; i < b.count; ++i) {
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
    double yy = 0, xy = 0, zy = 0;
    for (int i = 0; i < b.count; ++i) {
        for (int k = 0; k < i; ++k) y.coeffRef(i) -= b.lower.coeff(i, k) * y.coeff(k);
        y.coeffRef(i) *= b.inverse.coeff(i);
        yy += y.coeff(i) * y.coeff(i);
        xy += xz(0, i) * y.coeff(i);
        zy += xz(1, i) * y.coeff(i);
    }
    out(1, 1) = yy;
    out(0, 1) = out(1, 0) = xy;
    out(2, 1) = out(1, 2) = zy;
    return out;
}

}  // namespace seamwright::correction
