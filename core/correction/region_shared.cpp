// The region's normal equations with the errors that a sensor's spots share as further unknowns, eliminated.

#include "core/correction/region_system.h"

namespace seamwright::correction {

void RegionSystem::linearize_shared(const State& state, std::span<const double> factor, Linearization& out,
                                    Shared& shared) const {
    out = Linearization{};
    shared.columns.resize(spots_.size());
    shared.sensors.resize(priors_.size());
    for (SharedBlock& b : shared.sensors) {
        b.lower.setIdentity();
        b.cross.setZero();
        b.gradient.setZero();
    }
    Eigen::Vector3d e;
    Rows rows;
    for (std::size_t n = 0; n < spots_.size(); ++n) {
        const PreparedSpot& s = spots_[n];
        residual(n, state, e, rows);
        SharedColumns& columns = shared.columns[n];
        if (s.sensor >= 0) {
            const SharedGeometry& g = s.geometry;
            const Eigen::Vector3d y =
                g.axes.transpose() *
                (state.rotation.transpose() * (s.measured - state.translation) - g.origin);
            const SharedRoot& root = priors_[static_cast<std::size_t>(s.sensor)];
            for (int i = 0; i < 3; ++i) {
                // Along Y only where something asks for it.
                if (i == 1 && !s.curved && s.weights.y() == 0)
                    columns.col(i).setZero();
                else
                    columns.col(i) = shared_row(g, root, i, state.rotation * g.axes.col(i), y);
            }
            columns = columns.lazyProduct(g.flat.transpose()).eval();
            if (s.curved) {
                const auto [slope_x, slope_z] = slopes(s, -e.y());
                columns.col(0) -= slope_x * columns.col(1);
                columns.col(2) -= slope_z * columns.col(1);
            }
        }
        if (!(factor[n] > 0)) continue;
        for (int i = 0; i < 3; ++i) {
            const double weight = s.weights.coeff(i);
            if (!(weight > 0)) continue;
            const double w = weight * weight * factor[n] / (s.sigma * s.sigma);
            const Vector6 row = rows.row(i).transpose();
            const Vector6 scaled = w * row;
            out.information.noalias() += scaled.lazyProduct(row.transpose());
            out.gradient += e.coeff(i) * scaled;
            out.cost += w * e.coeff(i) * e.coeff(i);
            if (s.sensor < 0) continue;
            SharedBlock& b = shared.sensors[static_cast<std::size_t>(s.sensor)];
            for (int k = 0; k < kShared; ++k) {
                const double u = columns.coeff(k, i);
                b.cross.col(k) += u * scaled;
                b.gradient.coeffRef(k) += w * e.coeff(i) * u;
                for (int j = k; j < kShared; ++j) b.lower.coeffRef(j, k) += w * u * columns.coeff(j, i);
            }
        }
    }
    for (SharedBlock& b : shared.sensors) {
        eliminate(b);
        out.information.noalias() -= b.gain.lazyProduct(b.cross.transpose());
        out.gradient += b.cross.lazyProduct(b.value);
        out.cost += b.gradient.dot(b.value);
    }
    if (binary_) return;
    for (std::size_t n = 0; n < spots_.size(); ++n) {
        if (!(factor[n] > 0)) continue;
        const PreparedSpot& s = spots_[n];
        residual(n, state, e, rows);
        if (s.sensor >= 0)
            rows -= shared.columns[n].transpose() *
                    shared.sensors[static_cast<std::size_t>(s.sensor)].gain.transpose();
        for (int i = 0; i < 3; ++i) {
            if (!(s.weights[i] > 0)) continue;
            const double w = s.weights[i] * s.weights[i] * factor[n] / s.sigma;
            const Vector6 scaled = w * rows.row(i).transpose();
            out.meat.noalias() += scaled * scaled.transpose();
        }
    }
    for (const SharedBlock& b : shared.sensors) out.meat.noalias() += b.gain * b.gain.transpose();
}

void RegionSystem::cleared(std::size_t n, const Fit& fit, Eigen::Vector3d& e, Rows& rows,
                           Eigen::Matrix3d& left) const {
    residual(n, fit.state, e, rows);
    const int sensor = spots_[n].sensor;
    if (sensor < 0 || fit.shared.sensors.empty()) {
        left.setZero();
        return;
    }
    const SharedColumns& columns = fit.shared.columns[n];
    const SharedBlock& b = fit.shared.sensors[static_cast<std::size_t>(sensor)];
    Eigen::Matrix<double, kShared, 3> half;
    for (int i = 0; i < 3; ++i) {
        e.coeffRef(i) += columns.col(i).dot(b.value);
        rows.row(i) -= b.gain.lazyProduct(columns.col(i)).transpose();
        half.col(i) = forward(b, columns.col(i));
    }
    left.noalias() = half.transpose().lazyProduct(half);
}

RegionSystem::Parts RegionSystem::parts(const Linearization& lin, const Shared& shared, const State& state,
                                        std::span<const double> factor, const Spread& spread) const {
    Parts out{spread.covariance, Matrix6::Zero()};
    if (!repeats() || !spread.regular) return out;
    Matrix6 systematic = Matrix6::Zero();
    for (const SharedBlock& b : shared.sensors)
        systematic.noalias() += b.gain.lazyProduct(b.gain.transpose());
    Eigen::Vector3d e;
    Rows rows;
    for (std::size_t n = 0; repeats_ && n < spots_.size(); ++n) {
        const PreparedSpot& s = spots_[n];
        if (!(factor[n] > 0) || !s.repeats) continue;
        residual(n, state, e, rows);
        if (s.sensor >= 0 && !shared.sensors.empty())
            rows -= shared.columns[n].transpose().lazyProduct(
                shared.sensors[static_cast<std::size_t>(s.sensor)].gain.transpose());
        for (int i = 0; i < 3; ++i) rows.row(i) *= s.weights[i] * s.weights[i] * factor[n] / s.sigma;
        systematic.noalias() += rows.transpose().lazyProduct(Rows(s.systematic.lazyProduct(rows)));
    }
    const Matrix6 random = (binary_ ? lin.information : lin.meat) - systematic;
    out.random = spread.bread * random * spread.bread;
    out.systematic = spread.bread * systematic * spread.bread;
    return out;
}

}  // namespace seamwright::correction
