// The region's normal equations with the errors that a sensor's spots share as further unknowns, eliminated.

#include "core/correction/region_system.h"

namespace seamwright::correction {

namespace {

// Columns as the residual is scaled.
void scale(const Eigen::Matrix3d& flat, bool travel, SharedColumns& c) {
    const SharedVector x = c.col(0);
    c.col(0) = flat.coeff(0, 0) * x;
    c.col(2) = flat.coeff(2, 0) * x + flat.coeff(2, 2) * c.col(2);
    if (!travel) return;
    c.col(2) += flat.coeff(2, 1) * c.col(1);
    c.col(1) = flat.coeff(1, 0) * x + flat.coeff(1, 1) * c.col(1);
}

}  // namespace

void RegionSystem::linearize_shared(const State& state, std::span<const double> factor, Linearization& out,
                                    Shared& shared) const {
    out = Linearization{};
    shared.spots.resize(spots_.size());
    shared.sensors.resize(priors_.size());
    for (SharedBlock& b : shared.sensors) {
        b.lower.setIdentity();
        b.cross.setZero();
        b.gradient.setZero();
    }
    const Eigen::Vector3d centre = state.rotation * centroid_;
    for (std::size_t n = 0; n < spots_.size(); ++n) {
        const PreparedSpot& s = spots_[n];
        SharedSpot& spot = shared.spots[n];
        const Eigen::Vector3d from_origin = s.measured - state.translation;
        if (s.curved) {
            residual(n, state, spot.e, spot.rows);
        } else {  // as in linearize()
            spot.e.setZero();
            spot.rows.setZero();
            const Eigen::Vector3d lever = (from_origin - centre) / spread_;
            for (int i = 0; i < 3; ++i) {
                if (!(s.weights.coeff(i) > 0)) continue;
                const Eigen::Vector3d axis = state.rotation.lazyProduct(s.axes.col(i));
                spot.rows.row(i).head<3>() = axis.transpose();
                spot.rows.row(i).tail<3>() = lever.cross(axis).transpose();
                spot.e.coeffRef(i) = s.offset.coeff(i) - axis.dot(from_origin);
            }
        }
        SharedBlock* const block =
            s.sensor < 0 ? nullptr : &shared.sensors[static_cast<std::size_t>(s.sensor)];
        if (block) {
            const SharedGeometry& g = s.geometry;
            const SharedRoot& root = priors_[static_cast<std::size_t>(s.sensor)];
            const Eigen::Vector3d back = state.rotation.transpose().lazyProduct(from_origin) - g.origin;
            const Eigen::Vector3d y = g.axes.transpose().lazyProduct(back);
            const bool travel = s.curved || s.weights.y() > 0;
            for (int i = 0; i < 3; ++i) {
                if (i == 1 && !travel) {
                    spot.columns.col(i).setZero();
                    continue;
                }
                const Eigen::Vector3d axis = state.rotation.lazyProduct(g.axes.col(i));
                spot.columns.col(i) = shared_row(g, root, i, axis, y);
            }
            scale(g.flat, travel, spot.columns);
            if (s.curved) {
                const auto [slope_x, slope_z] = slopes(s, -spot.e.y());
                spot.columns.col(0) -= slope_x * spot.columns.col(1);
                spot.columns.col(2) -= slope_z * spot.columns.col(1);
            }
        }
        for (int i = 0; i < 3; ++i) {
            const double weight = s.weights.coeff(i);
            if (!(weight > 0)) {
                spot.e.coeffRef(i) = 0;
                spot.rows.row(i).setZero();
                if (block) spot.columns.col(i).setZero();
                continue;
            }
            if (!(factor[n] > 0)) continue;
            const double w = weight * weight * factor[n] / (s.sigma * s.sigma), off = spot.e.coeff(i);
            const Vector6 row = spot.rows.row(i).transpose();
            const Vector6 scaled = w * row;
            out.information.noalias() += scaled.lazyProduct(row.transpose());
            out.gradient += off * scaled;
            out.cost += w * off * off;
            if (!block) continue;
            const auto column = spot.columns.col(i);
            const SharedVector heavy = w * column;
            block->gradient += off * heavy;
            for (int k = 0; k < kShared; ++k) {
                block->cross.col(k) += column.coeff(k) * scaled;
                for (int j = k; j < kShared; ++j)
                    block->lower.coeffRef(j, k) += heavy.coeff(k) * column.coeff(j);
            }
        }
    }
    for (SharedBlock& b : shared.sensors) {
        eliminate(b);
        out.information.noalias() -= b.gain.lazyProduct(b.cross.transpose());
        out.gradient += b.cross.lazyProduct(b.value);
        out.cost += b.gradient.dot(b.value);
    }
    for (std::size_t n = 0; n < spots_.size(); ++n) {
        const PreparedSpot& s = spots_[n];
        SharedSpot& spot = shared.spots[n];
        for (int i = 0; i < 3; ++i) {
            if (!(s.weights.coeff(i) > 0)) continue;
            Vector6 row = spot.rows.row(i).transpose();
            if (s.sensor >= 0) {
                const SharedBlock& b = shared.sensors[static_cast<std::size_t>(s.sensor)];
                for (int k = 0; k < kShared; ++k) row -= spot.columns.coeff(k, i) * b.gain.col(k);
                spot.rows.row(i) = row.transpose();
                spot.e.coeffRef(i) += spot.columns.col(i).dot(b.value);
            }
            if (binary_ || !(factor[n] > 0)) continue;
            row *= s.weights[i] * s.weights[i] * factor[n] / s.sigma;
            out.meat.noalias() += row * row.transpose();
        }
    }
    if (binary_) return;
    for (const SharedBlock& b : shared.sensors) out.meat.noalias() += b.gain * b.gain.transpose();
}

void RegionSystem::cleared(std::size_t n, const Fit& fit, Eigen::Vector3d& e, Rows& rows,
                           Eigen::Matrix3d& left) const {
    if (fit.shared.sensors.empty()) {
        residual(n, fit.state, e, rows);
        left.setZero();
        return;
    }
    const SharedSpot& spot = fit.shared.spots[n];
    e = spot.e;
    rows = spot.rows;
    const int sensor = spots_[n].sensor;
    if (sensor < 0)
        left.setZero();
    else
        left = left_uncertain(fit.shared.sensors[static_cast<std::size_t>(sensor)], spot.columns);
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
        if (shared.sensors.empty())
            residual(n, state, e, rows);
        else
            rows = shared.spots[n].rows;
        for (int i = 0; i < 3; ++i) {
            const double wi = s.weights[i] * s.weights[i] * factor[n] / s.sigma;
            for (int k = 0; k < 3; ++k) {
                const double share =
                    s.systematic(i, k) * wi * s.weights[k] * s.weights[k] * factor[n] / s.sigma;
                if (share == 0) continue;
                const Vector6 scaled = share * rows.row(i).transpose();
                systematic.noalias() += scaled.lazyProduct(rows.row(k));
            }
        }
    }
    const Matrix6 random = (binary_ ? lin.information : lin.meat) - systematic;
    const Matrix6 half = spread.bread.lazyProduct(systematic), rest = spread.bread.lazyProduct(random);
    out.random = rest.lazyProduct(spread.bread);
    out.systematic = half.lazyProduct(spread.bread);
    return out;
}

}  // namespace seamwright::correction
