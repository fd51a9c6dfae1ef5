// The region's normal equations with the errors that a sensor's spots share as further unknowns, eliminated.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

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

// shared_row() of x and z at once, a lane each.
template <int N>
void shared_rows_xz(const SharedGeometry& spot, const SharedRoot& root, const Pair* f, const Pair* axis,
                    const Eigen::Vector3d& y, Pair* u) {
    const double *w = spot.axes.data(), *m = spot.measured.data(), *r = spot.reference.data(),
                 *l = root.hand_eye.data();
    Pair t[3];
    for (int i = 0; i < 3; ++i)
        t[i] = both(w[3 * i]) * axis[0] + both(w[3 * i + 1]) * axis[1] + both(w[3 * i + 2]) * axis[2];
    Pair b[6];
    const Pair mx = both(m[0]), my = both(m[1]), mz = both(m[2]);
    const Pair yx = both(y.x()), yy = both(y.y()), yz = both(y.z());
    for (int i = 0; i < 3; ++i) b[i] = f[i] - t[i];
    b[3] = t[1] * mz - t[2] * my - f[1] * yz + f[2] * yy;
    b[4] = t[2] * mx - t[0] * mz - f[2] * yx + f[0] * yz;
    b[5] = t[0] * my - t[1] * mx - f[0] * yy + f[1] * yx;
#pragma GCC unroll 6
    for (int column = 0; column < 6; ++column) {
        Pair sum = b[column] * both(l[6 * column + column]);
#pragma GCC unroll 6
        for (int row = column + 1; row < 6; ++row) sum += b[row] * both(l[6 * column + row]);
        u[column] = sum;
    }
    if constexpr (N > kScaleAt) {
        u[6] = both(root.scale.x()) * (f[0] * both(r[0]) - t[0] * mx);
        u[7] = both(root.scale.y()) * (f[2] * both(r[2]) - t[2] * mz);
        u[kShearAt] = both(root.scale.z()) * (f[0] * both(r[2]) - t[0] * mz);
    }
    if constexpr (N > kLatencyAt) {
        u[kLatencyAt] = both(root.latency * spot.latency_travel) * (f[1] - t[1]);
        u[kSpeedAt] = both(-root.speed * spot.latency_travel) * t[1];
        for (int c = 0; c < 3; ++c) u[kDriftAt + c] = both(-root.drift.coeff(c)) * t[c];
    }
}

// Lower triangle of sum w v v^T by columns, and its elimination: the longest loops of a correction with priors, written out
// because they take twice as long as Eigen's expressions. What stands above the diagonal means nothing.
template <int N>
struct Stack {
    static constexpr int kUsed = N + 7, kPairs = (kUsed + 1) / 2;
    Stack() {}  // add() writes every number
    Pair sum[kUsed][kPairs];

    double at(int row, int column) const { return reinterpret_cast<const double*>(sum[column])[row]; }
    double& at(int row, int column) { return reinterpret_cast<double*>(sum[column])[row]; }
    // Two columns at a time, so that their sums stay in registers.
    void add(const StackRow* rows, std::size_t count) {
        add_pairs(rows, count, std::make_integer_sequence<int, kPairs>{});
    }
    template <int... K>
    void add_pairs(const StackRow* rows, std::size_t count, std::integer_sequence<int, K...>) {
        (add_two<K>(rows, count), ...);
    }
    template <int K>
    void add_two(const StackRow* rows, std::size_t count) {
        Pair first[kPairs - K] = {}, second[kPairs - K] = {};
        for (std::size_t r = 0; r < count; ++r) {
            const Pair heavy = both(rows[r].weight) * rows[r].v[K];
            const Pair a = both(heavy[0]), b = both(heavy[1]);
#pragma GCC unroll 8
            for (int j = K; j < kPairs; ++j) {
                first[j - K] += a * rows[r].v[j];
                second[j - K] += b * rows[r].v[j];
            }
        }
        for (int j = K; j < kPairs; ++j) {
            sum[2 * K][j] = first[j - K];
            if (2 * K + 1 < kUsed) sum[2 * K + 1][j] = second[j - K];
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

// Lower triangle of a sum of a b^T that is symmetric as a whole, by columns.
struct Square6 {
    Pair sum[6][3] = {};
    void add(const Pair* a, const Pair* b) {
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i) {
            const Pair first = both(b[i][0]), second = both(b[i][1]);
#pragma GCC unroll 3
            for (int j = i; j < 3; ++j) {
                sum[2 * i][j] += first * a[j];
                sum[2 * i + 1][j] += second * a[j];
            }
        }
    }
    Matrix6 full() const {
        Matrix6 out;
        for (int k = 0; k < 6; ++k)
            for (int j = k; j < 6; ++j)
                out.coeffRef(j, k) = out.coeffRef(k, j) = reinterpret_cast<const double*>(sum[k])[j];
        return out;
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
        const double usual = s.weights.coeff(0);
        if (!s.curved && factor[n] > 0 && usual > 0 && usual == s.weights.coeff(2) &&
            s.weights.coeff(1) == 0) {
            Pair f[3], axis[3], of_spot[3], v[N + 7];
            const double* turn = state.rotation.data();
            for (int i = 0; i < 3; ++i) {
                f[i] = Pair{g.flat.coeff(0, i), g.flat.coeff(2, i)};
                of_spot[i] = Pair{s.axes.coeff(i, 0), s.axes.coeff(i, 2)};
            }
            for (int i = 0; i < 3; ++i)
                axis[i] = both(turn[i]) * of_spot[0] + both(turn[3 + i]) * of_spot[1] +
                          both(turn[6 + i]) * of_spot[2];
            shared_rows_xz<N>(g, root, f, axis, y, v);
            const Pair lx = both(lever.x()), ly = both(lever.y()), lz = both(lever.z());
            for (int i = 0; i < 3; ++i) v[N + i] = axis[i];
            v[N + 3] = ly * axis[2] - lz * axis[1];
            v[N + 4] = lz * axis[0] - lx * axis[2];
            v[N + 5] = lx * axis[1] - ly * axis[0];
            v[N + 6] = Pair{s.offset.coeff(0), s.offset.coeff(2)} - axis[0] * both(from_origin.x()) -
                       axis[1] * both(from_origin.y()) - axis[2] * both(from_origin.z());
            StackRow &x = all[used++], &z = all[used++];
            x.weight = z.weight = usual * usual * heavy;
#pragma GCC unroll 10
            for (int k = 0; k < Stack<N>::kPairs; ++k) {
                const Pair a = v[2 * k], b = 2 * k + 1 < N + 7 ? v[2 * k + 1] : Pair{};
                x.v[k] = Pair{a[0], b[0]};
                z.v[k] = Pair{a[1], b[1]};
            }
            for (int k = 0; k < N; ++k) {
                spot.columns.coeffRef(k, 0) = v[k][0];
                spot.columns.coeffRef(k, 2) = v[k][1];
            }
            for (int k = N; k < kShared; ++k) spot.columns.coeffRef(k, 0) = spot.columns.coeffRef(k, 2) = 0;
            spot.columns.col(1).setZero();
            for (int k = 0; k < 6; ++k) {
                spot.rows.coeffRef(0, k) = v[N + k][0];
                spot.rows.coeffRef(1, k) = 0;
                spot.rows.coeffRef(2, k) = v[N + k][1];
            }
            spot.e.coeffRef(0) = v[N + 6][0];
            spot.e.coeffRef(1) = 0;
            spot.e.coeffRef(2) = v[N + 6][1];
            continue;
        }
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
    stack.add(all.data(), used);
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
    Pair gains[N][3];
    for (int i = N - 1; i >= 0; --i) {
        Pair gain[3];
        for (int j = 0; j < 3; ++j) gain[j] = Pair{stack.at(N + 2 * j, i), stack.at(N + 2 * j + 1, i)};
        double value = -stack.at(N + 6, i);
        for (int k = i + 1; k < N; ++k) {
            const double by = stack.at(k, i);
#pragma GCC unroll 3
            for (int j = 0; j < 3; ++j) gain[j] -= both(by) * gains[k][j];
            value -= by * b.value.coeff(k);
        }
        for (int j = 0; j < 3; ++j) gains[i][j] = both(b.inverse.coeff(i)) * gain[j];
        std::memcpy(&b.gain.coeffRef(0, i), gains[i], sizeof gains[i]);
        b.value.coeffRef(i) = b.inverse.coeff(i) * value;
    }
    for (std::size_t n = 0; n < spots_.size(); ++n) {
        const PreparedSpot& s = spots_[n];
        if (s.sensor != sensor) continue;
        SharedSpot& spot = shared.spots[n];
        for (int i = 0; i < 3; ++i) {
            if (!(s.weights.coeff(i) > 0)) continue;
            Pair row[3];
            for (int j = 0; j < 3; ++j)
                row[j] = Pair{spot.rows.coeff(i, 2 * j), spot.rows.coeff(i, 2 * j + 1)};
            double e = spot.e.coeff(i);
#pragma GCC unroll 14
            for (int k = 0; k < N; ++k) {
                const double by = spot.columns.coeff(k, i);
#pragma GCC unroll 3
                for (int j = 0; j < 3; ++j) row[j] -= both(by) * gains[k][j];
                e += by * b.value.coeff(k);
            }
            for (int j = 0; j < 3; ++j) {
                spot.rows.coeffRef(i, 2 * j) = row[j][0];
                spot.rows.coeffRef(i, 2 * j + 1) = row[j][1];
            }
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

void RegionSystem::cleared(std::size_t n, const Fit& fit, Eigen::Vector3d& e, Rows& rows) const {
    if (fit.shared.sensors.empty()) {
        residual(n, fit.state, e, rows);
        return;
    }
    const SharedSpot& spot = fit.shared.spots[n];
    e = spot.e;
    rows = spot.rows;
}

Eigen::Matrix3d RegionSystem::left(std::size_t n, const Fit& fit) const {
    const int sensor = spots_[n].sensor;
    if (fit.shared.sensors.empty() || sensor < 0) return Eigen::Matrix3d::Zero();
    return left_uncertain(fit.shared.sensors[static_cast<std::size_t>(sensor)], fit.shared.spots[n].columns);
}

Eigen::Matrix3d RegionSystem::left_at_most(std::size_t n, const Fit& fit) const {
    Eigen::Matrix3d out = Eigen::Matrix3d::Zero();
    const int sensor = spots_[n].sensor;
    if (fit.shared.sensors.empty() || sensor < 0) return out;
    const SharedColumns& columns = fit.shared.spots[n].columns;
    const int count = fit.shared.sensors[static_cast<std::size_t>(sensor)].count;
    double xx = 0, xz = 0, zz = 0;  // nothing observed: the priors alone
    for (int k = 0; k < count; ++k) {
        const double x = columns.coeff(k, 0), z = columns.coeff(k, 2);
        xx += x * x;
        xz += x * z;
        zz += z * z;
    }
    out(0, 0) = xx;
    out(0, 2) = out(2, 0) = xz;
    out(2, 2) = zz;
    return out;
}

RegionSystem::Parts RegionSystem::parts(const Shared& shared, const State& state,
                                        std::span<const double> factor, const Spread& spread) const {
    Parts out{spread.covariance, Matrix6::Zero()};
    if (!repeats() || !spread.regular) return out;
    Square6 sum;
    for (const SharedBlock& b : shared.sensors)
        for (int j = 0; j < b.count; ++j) {
            Pair v[3];
            std::memcpy(v, &b.gain.coeff(0, j), sizeof v);
            sum.add(v, v);
        }
    Eigen::Vector3d e;
    Rows rows;
    for (std::size_t n = 0; repeats_ && n < spots_.size(); ++n) {
        const PreparedSpot& s = spots_[n];
        if (!(factor[n] > 0) || !s.repeats) continue;
        if (shared.sensors.empty())
            residual(n, state, e, rows);
        else
            rows = shared.spots[n].rows;
        Pair scaled[3][3];
        const double unit = factor[n] / s.sigma;
        for (int i = 0; i < 3; ++i)
            if (const double w = s.weights.coeff(i); w > 0)
#pragma GCC unroll 3
                for (int j = 0; j < 3; ++j)
                    scaled[i][j] = both(w * w * unit) * Pair{rows.coeff(i, 2 * j), rows.coeff(i, 2 * j + 1)};
        for (int i = 0; i < 3; ++i) {
            if (!(s.weights.coeff(i) > 0)) continue;
            Pair along[3] = {};
            for (int m = 0; m < 3; ++m)
                if (s.weights.coeff(m) > 0)
#pragma GCC unroll 3
                    for (int j = 0; j < 3; ++j) along[j] += both(s.systematic.coeff(i, m)) * scaled[m][j];
            sum.add(scaled[i], along);
        }
    }
    const Matrix6 systematic = sum.full();
    const Matrix6 half = spread.bread.lazyProduct(systematic);
    out.systematic = half.lazyProduct(spread.bread);
    out.random = spread.covariance - out.systematic;
    if (adds()) out.systematic += added(state).sum();
    return out;
}

}  // namespace seamwright::correction
