// The region's normal equations with the errors that a sensor's spots share as further unknowns, eliminated.

#include <algorithm>

#include "core/correction/region_system.h"
#include "core/geometry/decompositions.h"

namespace seamwright::correction {

namespace {

// Two numbers at once: GCC's and clang's vectors, which both compile to SSE or NEON.
typedef double Pair __attribute__((vector_size(16)));
constexpr Pair both(double v) {
    return Pair{v, v};
}

// (u, xi, e) of one residual, N + 7 numbers, and 0 where that is odd.
struct StackRow {
    Pair v[(kShared + 8) / 2];
    double weight = 0;
    double& at(int k) { return reinterpret_cast<double*>(v)[k]; }
};
// Of this thread; keeps its memory.
std::vector<StackRow>& stack_rows(std::size_t most) {
    thread_local std::vector<StackRow> rows;
    if (rows.size() < most) rows.resize(most);
    return rows;
}

// Lower triangle of sum w v v^T by columns, and its elimination: the longest loops of a correction with priors, written out
// because they take twice as long as Eigen's expressions. What stands above the diagonal means nothing.
template <int N>
struct Stack {
    static constexpr int kUsed = N + 7, kPairs = (kUsed + 1) / 2;
    Pair sum[kUsed][kPairs] = {};

    double at(int row, int column) const { return reinterpret_cast<const double*>(sum[column])[row]; }
    double& at(int row, int column) { return reinterpret_cast<double*>(sum[column])[row]; }
    void add(const StackRow& row) {
        const double* v = reinterpret_cast<const double*>(row.v);
        for (int k = 0; k < kUsed; ++k) {
            const Pair heavy = both(row.weight * v[k]);
            Pair* column = sum[k];
#pragma GCC unroll 4
            for (int j = k / 2; j < kPairs; ++j) column[j] += heavy * row.v[j];
        }
    }
    // Cholesky of the first N columns of sum + I over u: below them stand cross^T and gradient over the factor, in the rest
    // what is left of information, gradient and cost. `inverse`: 1 / diagonal.
    void eliminate(SharedVector& inverse) {
        for (int k = 0; k < N; ++k) at(k, k) += 1;
        for (int k = 0; k < N; ++k) {
            const double root = std::sqrt(at(k, k));  // of a matrix whose eigenvalues are at least 1
            inverse.coeffRef(k) = 1 / root;
            const Pair by = both(1 / root);
            Pair* pivot = sum[k];
#pragma GCC unroll 4
            for (int j = k / 2; j < kPairs; ++j) pivot[j] *= by;
            for (int c = k + 1; c < kUsed; ++c) {
                const Pair share = both(at(c, k));
                Pair* column = sum[c];
#pragma GCC unroll 4
                for (int j = c / 2; j < kPairs; ++j) column[j] -= share * pivot[j];
            }
        }
    }
};

}  // namespace

template <int N>
void RegionSystem::add_shared(const State& state, std::span<const double> factor, int sensor,
                              Linearization& out, Shared& shared) const {
    Stack<N> stack;
    const auto block_at = static_cast<std::size_t>(sensor);
    const SharedRoot& root = priors_[block_at];
    const Eigen::Vector3d centre = state.rotation * centroid_;
    const double per_spread = 1 / spread_;
    // Written first and summed afterwards: a vector is not read while its numbers are still on their way to memory.
    std::vector<StackRow>& all = stack_rows(3 * spots_.size());
    std::size_t used = 0;
    for (std::size_t n = 0; n < spots_.size(); ++n) {
        const PreparedSpot& s = spots_[n];
        if (s.sensor != sensor) continue;
        SharedSpot& spot = shared.spots[n];
        const SharedGeometry& g = s.geometry;
        const Eigen::Vector3d from_origin = s.measured - state.translation;
        const Eigen::Vector3d lever = per_spread * (from_origin - centre);
        const Eigen::Vector3d back = state.rotation.transpose().lazyProduct(from_origin) - g.origin;
        const Eigen::Vector3d y = g.axes.transpose().lazyProduct(back);
        if (s.curved) residual(n, state, spot.e, spot.rows);
        const double heavy = factor[n] / (s.sigma * s.sigma);
        if (s.curved) {  // its rows and columns lean on those of the travel
            for (int i = 0; i < 3; ++i) {
                spot.columns.col(i).setZero();
                shared_row(g, root, g.flat.row(i).transpose(), state.rotation * s.axes.col(i), y,
                           spot.columns.col(i).data());
            }
            const auto [slope_x, slope_z] = slopes(s, -spot.e.y());
            spot.columns.col(0) -= slope_x * spot.columns.col(1);
            spot.columns.col(2) -= slope_z * spot.columns.col(1);
        }
        for (int i = 0; i < 3; ++i) {
            const double weight = s.weights.coeff(i);
            if (!(weight > 0)) {
                spot.e.coeffRef(i) = 0;
                spot.rows.row(i).setZero();
                spot.columns.col(i).setZero();
                continue;
            }
            double* const column = &spot.columns.coeffRef(0, i);
            if (!s.curved) {  // as in linearize()
                const Eigen::Vector3d axis = state.rotation.lazyProduct(s.axes.col(i));
                spot.rows.row(i).head<3>() = axis.transpose();
                spot.rows.row(i).tail<3>() = lever.cross(axis).transpose();
                spot.e.coeffRef(i) = s.offset.coeff(i) - axis.dot(from_origin);
                shared_row(g, root, g.flat.row(i).transpose(), axis, y, column);
                for (int k = N; k < kShared; ++k) column[k] = 0;
            }
            if (!(factor[n] > 0)) continue;
            StackRow& row = all[used++];
            row.weight = weight * weight * heavy;
            for (int k = 0; k < N; ++k) row.at(k) = column[k];
            for (int k = 0; k < 6; ++k) row.at(N + k) = spot.rows.coeff(i, k);
            row.at(N + 6) = spot.e.coeff(i);
            row.at(2 * Stack<N>::kPairs - 1) = N % 2 ? row.at(N + 6) : 0;
        }
    }
    for (std::size_t k = 0; k < used; ++k) stack.add(all[k]);
    SharedBlock& b = shared.sensors[block_at];
    b.count = N;
    if constexpr (N < kShared) {
        b.gain.template rightCols<kShared - N>().setZero();
        b.value.template tail<kShared - N>().setZero();
    }
    stack.eliminate(b.inverse);
    for (int k = 0; k < 6; ++k) {
        for (int j = k; j < 6; ++j) {
            out.information.coeffRef(j, k) += stack.at(N + j, N + k);
            if (j > k) out.information.coeffRef(k, j) += stack.at(N + j, N + k);
        }
        out.gradient.coeffRef(k) += stack.at(N + 6, N + k);
    }
    out.cost += stack.at(N + 6, N + 6);
    for (int k = 0; k < N; ++k)
        for (int j = k; j < N; ++j) b.lower.coeffRef(j, k) = stack.at(j, k);
    // (cross, -gradient) (H_uu + I)^-1, from the right.
    for (int i = N - 1; i >= 0; --i) {
        Vector6 gain;
        for (int k = 0; k < 6; ++k) gain.coeffRef(k) = stack.at(N + k, i);
        double value = -stack.at(N + 6, i);
        for (int k = i + 1; k < N; ++k) {
            gain -= stack.at(k, i) * b.gain.col(k);
            value -= stack.at(k, i) * b.value.coeff(k);
        }
        b.gain.col(i) = b.inverse.coeff(i) * gain;
        b.value.coeffRef(i) = b.inverse.coeff(i) * value;
    }
    for (std::size_t n = 0; n < spots_.size(); ++n) {
        const PreparedSpot& s = spots_[n];
        if (s.sensor != sensor) continue;
        SharedSpot& spot = shared.spots[n];
        for (int i = 0; i < 3; ++i) {
            if (!(s.weights.coeff(i) > 0)) continue;
            Vector6 row = spot.rows.row(i).transpose();
            double e = spot.e.coeff(i);
            for (int k = 0; k < N; ++k) {
                row -= spot.columns.coeff(k, i) * b.gain.col(k);
                e += spot.columns.coeff(k, i) * b.value.coeff(k);
            }
            spot.rows.row(i) = row.transpose();
            spot.e.coeffRef(i) = e;
        }
    }
}

void RegionSystem::linearize_shared(const State& state, std::span<const double> factor, Linearization& out,
                                    Shared& shared) const {
    out = Linearization{};
    shared.spots.resize(spots_.size());
    shared.sensors.resize(priors_.size());
    for (int k = 0; k < static_cast<int>(priors_.size()); ++k)
        switch (priors_[static_cast<std::size_t>(k)].count) {
            case kScaleAt:
                add_shared<kScaleAt>(state, factor, k, out, shared);
                break;
            case kLatencyAt:
                add_shared<kLatencyAt>(state, factor, k, out, shared);
                break;
            default:
                add_shared<kShared>(state, factor, k, out, shared);
        }
    for (std::size_t n = 0; n < spots_.size(); ++n) {
        const PreparedSpot& s = spots_[n];
        SharedSpot& spot = shared.spots[n];
        if (s.sensor < 0) {
            spot.columns.setZero();
            residual(n, state, spot.e, spot.rows);
            for (int i = 0; i < 3; ++i)
                if (!(s.weights.coeff(i) > 0)) spot.e.coeffRef(i) = 0, spot.rows.row(i).setZero();
            if (factor[n] > 0) {
                add_information(n, spot.rows, factor[n], out.information, out.meat);
                for (int i = 0; i < 3; ++i) {
                    const double w = s.weights[i] * s.weights[i] * factor[n] / (s.sigma * s.sigma),
                                 off = spot.e[i];
                    out.gradient += w * off * spot.rows.row(i).transpose();
                    out.cost += w * off * off;
                }
            }
        }
        if (binary_ || !(factor[n] > 0) || s.sensor < 0) continue;
        for (int i = 0; i < 3; ++i) {
            if (!(s.weights.coeff(i) > 0)) continue;
            const Vector6 row =
                (s.weights[i] * s.weights[i] * factor[n] / s.sigma) * spot.rows.row(i).transpose();
            out.meat.noalias() += row * row.transpose();
        }
    }
    if (binary_) return;
    for (const SharedBlock& b : shared.sensors) out.meat.noalias() += b.gain * b.gain.transpose();
}

RegionSystem::Added RegionSystem::added(const State& state) const {
    Added out;
    if (!adds()) return out;
    // xi from the tangent, as tangent_from_xi() inverted.
    Matrix6 to_xi = Matrix6::Identity();
    to_xi.topRightCorner<3, 3>() = -skew(state.rotation * centroid_);
    to_xi.bottomRightCorner<3, 3>() *= spread_;
    if (!all_free_) {  // nothing errs that is fixed
        const Matrix6 b = xi_from_parameters(state);
        to_xi = b * least_squares(b, to_xi).x;
    }
    // Exp(eta) D Exp(-eta): the rotation errs by (I - R) theta, the translation by (I - R) rho + theta x t.
    const Eigen::Matrix3d rest = Eigen::Matrix3d::Identity() - state.rotation;
    Matrix6 laid = Matrix6::Zero();
    laid.topLeftCorner<3, 3>() = laid.bottomRightCorner<3, 3>() = rest;
    laid.topRightCorner<3, 3>() = -skew(state.translation);
    const Matrix6 path = to_xi * laid, robot = to_xi;
    out.workobject = path * options_.workobject_covariance * path.transpose();
    out.robot_drift = options_.robot_drift_sigma_mm * options_.robot_drift_sigma_mm * robot.leftCols<3>() *
                      robot.leftCols<3>().transpose();
    return out;
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

RegionSystem::Parts RegionSystem::parts(const Shared& shared, const State& state,
                                        std::span<const double> factor, const Spread& spread) const {
    Parts out{spread.covariance, Matrix6::Zero()};
    if (!repeats() || !spread.regular) return out;
    Matrix6 systematic = Matrix6::Zero();
    for (const SharedBlock& b : shared.sensors)
        for (int j = 0; j < b.count; ++j)
            for (int k = 0; k < 6; ++k) systematic.col(k) += b.gain.coeff(k, j) * b.gain.col(j);
    Eigen::Vector3d e;
    Rows rows;
    for (std::size_t n = 0; repeats_ && n < spots_.size(); ++n) {
        const PreparedSpot& s = spots_[n];
        if (!(factor[n] > 0) || !s.repeats) continue;
        if (shared.sensors.empty())
            residual(n, state, e, rows);
        else
            rows = shared.spots[n].rows;
        Eigen::Matrix<double, 6, 3> scaled;
        for (int i = 0; i < 3; ++i)
            if (const double w = s.weights[i] * s.weights[i] * factor[n] / s.sigma; w > 0)
                for (int k = 0; k < 6; ++k) scaled.coeffRef(k, i) = w * rows.coeff(i, k);
        for (int i = 0; i < 3; ++i) {
            if (!(s.weights[i] > 0)) continue;
            Vector6 along = Vector6::Zero();
            for (int k = 0; k < 3; ++k)
                if (s.weights[k] > 0) along += s.systematic.coeff(i, k) * scaled.col(k);
            for (int k = 0; k < 6; ++k) systematic.col(k) += along.coeff(k) * scaled.col(i);
        }
    }
    const Matrix6 half = spread.bread.lazyProduct(systematic);
    out.systematic = half.lazyProduct(spread.bread);
    out.random = spread.covariance - out.systematic;
    if (adds()) out.systematic += added(state).sum();
    return out;
}

}  // namespace seamwright::correction
