#include "core/correction/region_system.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/decompositions.h"
#include "core/geometry/notation.h"

namespace seamwright::correction {
namespace {

// Smallest ratio of eigenvalues of the information (in xi) that counts as regular.
constexpr double kSingular = 1e-13;
constexpr double kStepMm = 1e-9, kStepRad = 1e-12;
constexpr double kRough = 1e8;  // in these units: 0.1 mm
// Near the minimum a step is no longer than this, in these units, and its square than this of the last one.
constexpr double kNear = 1e4, kShrinks = 0.1;
constexpr double kNoLimit = 1e9;   // mm or degrees: wider limits are as good as none
constexpr double kUnseen = 1e-10;  // of the largest eigenvalue: nothing is known
// Near the gimbal lock: determinant of the free angles' axes; cos B.
constexpr double kLockedAxes = 1e-9, kLockedCos = 1e-3;
// Levenberg's damping, of a unit diagonal: where the matrix is singular, and where a step made things worse, it starts at
// the first and is given up at the last; after a step that helped it falls, and below kLeastDamping is none.
constexpr double kSingularDamping = 1e-8, kMostSingularDamping = 1e8;
constexpr double kWorseDamping = 1e-4, kMostWorseDamping = 1e12;
constexpr double kLeastDamping = 1e-7, kDampingFalls = 0.1, kDampingRises = 10;
// Of 1 + cost: a gain that drowns in rounding, what the cost may then rise and what else; a gain that no longer matters,
// once it is more than kStalls of the last.
constexpr double kDrowns = 1e-9, kDrownedRise = 1e-6, kRise = 1e-12;
constexpr double kNoGain = 1e-14, kStalls = 0.25;

// Rz(A) Ry(B) Rx(C), written out: an angle of 0 leaves exact zeros, so that it is 0 when read back.
Eigen::Matrix3d rotation_from_abc(const Eigen::Vector3d& abc) {
    const double ca = std::cos(abc.x()), sa = std::sin(abc.x()), cb = std::cos(abc.y()),
                 sb = std::sin(abc.y());
    const double cc = std::cos(abc.z()), sc = std::sin(abc.z());
    Eigen::Matrix3d r;
    r << ca * cb, ca * sb * sc - sa * cc, ca * sb * cc + sa * sc,  //
        sa * cb, sa * sb * sc + ca * cc, sa * sb * cc - ca * sc,   //
        -sb, cb * sc, cb * cc;
    return r;
}

// d(rotation vector)/d(A, B, C): the axes about which the angles turn.
Eigen::Matrix3d rotation_vector_from_abc(const Eigen::Vector3d& abc) {
    const Eigen::AngleAxisd a(abc.x(), Eigen::Vector3d::UnitZ()), b(abc.y(), Eigen::Vector3d::UnitY());
    Eigen::Matrix3d g;
    g.col(0) = Eigen::Vector3d::UnitZ();
    g.col(1) = a * Eigen::Vector3d::UnitY();
    g.col(2) = a * (b * Eigen::Vector3d::UnitX());
    return g;
}

// Cholesky factor of a matrix with unit diagonal, written out because this is the inner loop of a run. False
// when a pivot says that the matrix is singular.
bool factorise(const Matrix6& m, Matrix6& l) {
    for (int j = 0; j < 6; ++j) {
        double pivot = m.coeff(j, j);
        for (int k = 0; k < j; ++k) pivot -= l.coeff(j, k) * l.coeff(j, k);
        if (!(pivot > kSingular)) return false;
        const double root = std::sqrt(pivot), inverse = 1 / root;
        l.coeffRef(j, j) = root;
        for (int i = j + 1; i < 6; ++i) {
            double sum = m.coeff(i, j);
            for (int k = 0; k < j; ++k) sum -= l.coeff(i, k) * l.coeff(j, k);
            l.coeffRef(i, j) = sum * inverse;
        }
    }
    return true;
}

Vector6 solve_factorised(const Matrix6& l, const Vector6& right) {
    Vector6 x = right;
    for (int i = 0; i < 6; ++i) {
        for (int k = 0; k < i; ++k) x.coeffRef(i) -= l.coeff(i, k) * x.coeff(k);
        x.coeffRef(i) /= l.coeff(i, i);
    }
    for (int i = 5; i >= 0; --i) {
        for (int k = i + 1; k < 6; ++k) x.coeffRef(i) -= l.coeff(k, i) * x.coeff(k);
        x.coeffRef(i) /= l.coeff(i, i);
    }
    return x;
}

// (L L^T)^-1 = L^-T L^-1.
Matrix6 invert_factorised(const Matrix6& l) {
    Matrix6 k = Matrix6::Zero();
    for (int j = 0; j < 6; ++j) {
        k.coeffRef(j, j) = 1 / l.coeff(j, j);
        for (int i = j + 1; i < 6; ++i) {
            double sum = 0;
            for (int m = j; m < i; ++m) sum -= l.coeff(i, m) * k.coeff(m, j);
            k.coeffRef(i, j) = sum / l.coeff(i, i);
        }
    }
    Matrix6 out;
    for (int j = 0; j < 6; ++j) {
        for (int i = j; i < 6; ++i) {
            double sum = 0;
            for (int m = i; m < 6; ++m) sum += k.coeff(m, i) * k.coeff(m, j);
            out.coeffRef(i, j) = out.coeffRef(j, i) = sum;
        }
    }
    return out;
}

// Value and slope of c1 s + c2 s^2 + c3 s^3 at s inside [from, to], continued along the tangent outside.
void follow(const Eigen::Vector3d& c, double s, double from, double to, double& value, double& slope) {
    const double inside = std::clamp(s, from, to);
    slope = c[0] + inside * (2 * c[1] + inside * 3 * c[2]);
    value = inside * (c[0] + inside * (c[1] + inside * c[2])) + slope * (s - inside);
}

}  // namespace

std::array<double, 2> RegionSystem::slopes(const PreparedSpot& s, double travel_mm) {
    double value, x, z;
    follow(s.curve.x_coefficients, travel_mm, s.curve.valid_from_mm, s.curve.valid_to_mm, value, x);
    follow(s.curve.z_coefficients, travel_mm, s.curve.valid_from_mm, s.curve.valid_to_mm, value, z);
    return {x, z};
}

void RegionSystem::residual(std::size_t n, const State& state, Eigen::Vector3d& e, Rows& rows) const {
    const PreparedSpot& s = spots_[n];
    const Eigen::Vector3d from_origin = s.measured - state.translation;
    e = s.reference - s.sensor_from_workobject * (state.rotation.transpose() * from_origin - s.sensor_origin);
    // Rows: the sensor's axes as they stand on the displaced part.
    Eigen::Matrix3d axes = s.sensor_from_workobject * state.rotation.transpose();
    if (s.curved) {
        const double travel = -e.y();
        double value, slope_x, slope_z;
        follow(s.curve.x_coefficients, travel, s.curve.valid_from_mm, s.curve.valid_to_mm, value, slope_x);
        e.x() += value;
        follow(s.curve.z_coefficients, travel, s.curve.valid_from_mm, s.curve.valid_to_mm, value, slope_z);
        e.z() += value;
        axes.row(0) -= slope_x * axes.row(1);
        axes.row(2) -= slope_z * axes.row(1);
    }
    const Eigen::Vector3d lever = (from_origin - state.rotation * centroid_) / spread_;
    rows.leftCols<3>() = axes;
    for (int i = 0; i < 3; ++i) rows.block<1, 3>(i, 3) = lever.cross(axes.row(i).transpose()).transpose();
}

void RegionSystem::add_information(std::size_t n, const Rows& rows, double factor, Matrix6& information,
                                   Matrix6& meat) const {
    const PreparedSpot& s = spots_[n];
    for (int i = 0; i < 3; ++i) {
        if (!(s.weights[i] > 0)) continue;
        const double w = s.weights[i] * s.weights[i] * factor / (s.sigma * s.sigma);
        const Vector6 row = rows.row(i).transpose();
        const Vector6 scaled = w * row;
        information.noalias() += scaled * row.transpose();
        if (!binary_) meat.noalias() += (s.sigma * s.sigma) * (scaled * scaled.transpose());
    }
}

void RegionSystem::linearize(const State& state, std::span<const double> factor, Linearization& out) const {
    // Inner loop of a run: as residual() and add_information(), but only the observed rows. With the sensor's
    // axis a = R s_i on the displaced part, e_i = (r_i + s_i . origin) - a . (p - t).
    out = Linearization{};
    const Eigen::Vector3d centre = state.rotation * centroid_;
    Eigen::Vector3d e;
    Rows rows;
    for (std::size_t n = 0; n < spots_.size(); ++n) {
        if (!(factor[n] > 0)) continue;
        const PreparedSpot& s = spots_[n];
        if (s.curved) residual(n, state, e, rows);
        const Eigen::Vector3d from_origin = s.measured - state.translation;
        const Eigen::Vector3d lever = (from_origin - centre) / spread_;
        const double scale = factor[n] / (s.sigma * s.sigma);
        for (int i = 0; i < 3; ++i) {
            const double weight = s.weights.coeff(i);
            if (!(weight > 0)) continue;
            const double w = weight * weight * scale;
            Vector6 row;
            double off;
            if (s.curved) {
                row = rows.row(i).transpose();
                off = e.coeff(i);
            } else {
                const Eigen::Vector3d axis = state.rotation.lazyProduct(s.axes.col(i));
                row.head<3>() = axis;
                row.tail<3>() = lever.cross(axis);
                off = s.offset.coeff(i) - axis.dot(from_origin);
            }
            const Vector6 scaled = w * row;
            out.information.noalias() += scaled.lazyProduct(row.transpose());
            out.gradient += off * scaled;
            out.cost += w * off * off;
            if (!binary_) out.meat.noalias() += (s.sigma * s.sigma) * scaled.lazyProduct(scaled.transpose());
        }
    }
}

double RegionSystem::beyond_curve_mm(std::size_t n, const State& state) const {
    const PreparedSpot& s = spots_[n];
    if (!s.curved) return 0;
    const Eigen::Vector3d q =
        s.sensor_from_workobject *
        (state.rotation.transpose() * (s.measured - state.translation) - s.sensor_origin);
    const double travel = q.y() - s.reference.y();
    return std::abs(travel - std::clamp(travel, s.curve.valid_from_mm, s.curve.valid_to_mm));
}

Matrix6 RegionSystem::xi_from_parameters(const State& state) const {
    if (all_free_) return Matrix6::Identity();
    // dt_c = dt - (R c) x w and L w, for dt = unit vectors and w = the rotation's own parameters.
    const Eigen::Matrix3d g =
        by_angles_ ? rotation_vector_from_abc(state.abc) : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
    Matrix6 b = Matrix6::Zero();
    b.topLeftCorner<3, 3>().setIdentity();
    b.topRightCorner<3, 3>() = -skew(state.rotation * centroid_) * g;
    b.bottomRightCorner<3, 3>() = spread_ * g;
    for (int i = 0; i < 6; ++i) {
        if (!options_.free[static_cast<std::size_t>(i)]) b.col(i).setZero();
    }
    return b;
}

Vector6 RegionSystem::tangent_from_xi(const Vector6& xi, const State& state) const {
    Vector6 t;
    t.tail<3>() = xi.tail<3>() / spread_;
    t.head<3>() = xi.head<3>() + (state.rotation * centroid_).cross(t.tail<3>());
    return t;
}

Spread RegionSystem::spread(const Linearization& lin, const State& state) const {
    Spread out;
    const Matrix6 b = xi_from_parameters(state);
    Matrix6 h = lin.information;
    if (!all_free_) {
        h = b.transpose() * lin.information * b;
        for (int i = 0; i < 6; ++i) {
            if (!options_.free[static_cast<std::size_t>(i)]) h(i, i) = 1;
        }
    }
    // Scaled to a unit diagonal, so that the pivots tell the rank whatever the units.
    Vector6 scale;
    for (int i = 0; i < 6; ++i) {
        if (!(h(i, i) > 0) || !std::isfinite(h(i, i))) return out;
        scale[i] = 1 / std::sqrt(h(i, i));
    }
    Matrix6 factor;
    if (!factorise(scale.asDiagonal() * h * scale.asDiagonal(), factor)) return out;
    const Matrix6 inverse = scale.asDiagonal() * invert_factorised(factor) * scale.asDiagonal();
    if (all_free_) {
        out.bread = inverse;
    } else {
        out.bread = b * inverse * b.transpose();  // columns of fixed parameters are 0 in b
    }
    out.covariance = binary_ ? out.bread : Matrix6(out.bread * lin.meat * out.bread);
    out.regular = true;
    return out;
}

Vector6 RegionSystem::per_limit() const {
    const double limit_mm = std::min(options_.sigma_limit_mm, kNoLimit);
    const double limit_rotation =
        std::min(limit_mm, rad_from_deg(std::min(options_.sigma_limit_deg, kNoLimit)) * spread_);
    Vector6 out;
    out << Eigen::Vector3d::Constant(1 / limit_mm), Eigen::Vector3d::Constant(1 / limit_rotation);
    return out;
}

bool RegionSystem::surely_observable(const Spread& s) const {
    // The trace bounds the largest eigenvalue.
    return s.regular && s.covariance.diagonal().dot(per_limit().cwiseAbs2()) < 1;
}

double RegionSystem::weakest_sigma_mm(const Spread& s) const {
    // Largest eigenvalue by powers: C^32 by squaring, then twelve steps; good to 0.1 % whatever the other
    // eigenvalues.
    const double trace = s.covariance.trace();
    if (!(trace > 0)) return 0;
    Matrix6 power = s.covariance / trace;
    for (int k = 0; k < 5; ++k) {
        const Matrix6 square = power.lazyProduct(power);
        power = square / square.trace();
    }
    Eigen::Index largest;
    power.diagonal().maxCoeff(&largest);
    Vector6 v = power.col(largest);
    for (int k = 0; k < 12; ++k) {
        const Vector6 next = power.lazyProduct(v);
        v = next / next.cwiseAbs().maxCoeff();
    }
    const Vector6 image = s.covariance.lazyProduct(v);
    return std::sqrt(std::max(0.0, v.dot(image) / v.squaredNorm()));
}

Observability RegionSystem::observability(const Linearization& lin, const State& state,
                                          double inflation) const {
    Observability out;
    // eta = xi over its limit: a direction is weak when its sigma in eta exceeds 1.
    const Vector6 to_eta = per_limit();
    const Spread s = spread(lin, state);
    Eigen::MatrixXd b(6, free_count_);
    {
        const Matrix6 all = xi_from_parameters(state);
        for (int i = 0, k = 0; i < 6; ++i) {
            if (options_.free[static_cast<std::size_t>(i)]) b.col(k++) = to_eta.asDiagonal() * all.col(i);
        }
    }
    const Vector6 to_xi = to_eta.cwiseInverse();
    const Eigen::MatrixXd m = b.transpose() * b;
    const Matrix6 information = to_xi.asDiagonal() * lin.information * to_xi.asDiagonal();  // in eta
    // Basis of the free space, orthonormal in eta.
    Eigen::MatrixXd q = b * symmetric_eigen(m).vectors;
    for (int k = 0; k < free_count_; ++k) q.col(k).normalize();
    // Re-orthogonalised: the metric may be ill-conditioned when the origin lies far from the spots.
    for (int k = 0; k < free_count_; ++k) {
        for (int j = 0; j < k; ++j) q.col(k) -= q.col(j).dot(q.col(k)) * q.col(j);
        q.col(k).normalize();
    }
    SymmetricEigen eigen;
    Vector6 sigma;
    if (s.regular) {
        const Eigen::MatrixXd sigma_squared =
            q.transpose() * (to_eta.asDiagonal() * s.covariance * to_eta.asDiagonal()) * q;
        eigen = symmetric_eigen(sigma_squared);
        for (int k = 0; k < free_count_; ++k)
            sigma[k] = inflation * std::sqrt(std::max(0.0, eigen.values[k]));
    } else {
        const Eigen::MatrixXd h = q.transpose() * information * q;
        eigen = symmetric_eigen(h);
        const double largest = std::max(0.0, eigen.values[free_count_ - 1]);
        for (int k = 0; k < free_count_; ++k) {
            const double lambda = eigen.values[k];
            const bool none = !(lambda > kUnseen * largest) || largest == 0;
            out.singular = out.singular || none;
            sigma[k] = none ? std::numeric_limits<double>::infinity() : inflation / std::sqrt(lambda);
        }
        if (!out.singular) {  // the pivots said singular: believe them
            out.singular = true;
            sigma[0] = std::numeric_limits<double>::infinity();
        }
    }
    out.weak.resize(6, 0);
    double worst = -1;
    for (int k = 0; k < free_count_; ++k) {
        const Vector6 xi = to_xi.asDiagonal() * (q * eigen.vectors.col(k));
        const double length = xi.norm();
        if (sigma[k] > worst) {
            worst = sigma[k];
            out.weakest = xi / length;
            out.weakest_sigma_mm = sigma[k] * length;
        }
        if (sigma[k] > 1) {
            out.weak.conservativeResize(6, out.weak.cols() + 1);
            out.weak.col(out.weak.cols() - 1) = xi / length;
        }
    }
    out.ok = out.weak.cols() == 0;
    return out;
}

Matrix6 RegionSystem::tangent_of(const Matrix6& covariance_xi, const State& state) const {
    Matrix6 s = Matrix6::Identity();
    s.topRightCorner<3, 3>() = skew(state.rotation * centroid_) / spread_;
    s.bottomRightCorner<3, 3>() /= spread_;
    Matrix6 tangent;
    tangent = s * covariance_xi * s.transpose();  // assigned: constructed, Eigen rounds it otherwise
    for (int i = 0; i < 3; ++i) {
        if (options_.free[static_cast<std::size_t>(i)]) continue;
        tangent.row(i).setZero();
        tangent.col(i).setZero();
    }
    return tangent;
}

Eigen::Matrix3d RegionSystem::abc_from_rotation(const State& state) const {
    if (by_angles_) {
        // Only the free angles' columns of d(w)/d(A, B, C), so that fixed ones come out as exactly 0.
        Eigen::Matrix3d g = rotation_vector_from_abc(state.abc);
        Eigen::Matrix3d square = Eigen::Matrix3d::Identity();
        for (int i = 0; i < 3; ++i)
            if (!options_.free[static_cast<std::size_t>(i + 3)]) g.col(i).setZero();
        for (int i = 0; i < 3; ++i)
            for (int k = 0; k < i; ++k) square(i, k) = square(k, i) = g.col(i).dot(g.col(k));
        // Unit axes: the determinant is near 0 in the gimbal lock alone.
        if (square.determinant() > kLockedAxes) return square.inverse() * g.transpose();
        return least_squares(g, Eigen::Matrix3d::Identity()).x;
    }
    // Closed form of kuka_jacobian away from the gimbal lock: the axes of A, B, C are Z, the turned Y,
    // and R X.
    const Eigen::Vector3d x = state.rotation.col(0);
    const double cos_b = std::hypot(x.x(), x.y());
    if (!(cos_b > kLockedCos)) return kuka_jacobian(state.rotation);
    Eigen::Matrix3d axes;
    axes << 0, -x.y() / cos_b, x.x(), 0, x.x() / cos_b, x.y(), 1, 0, x.z();
    return axes.inverse();
}

void RegionSystem::sigmas(const Matrix6& tangent, const Eigen::Matrix3d& to_abc, Eigen::Vector3d& sigma_xyz,
                          Eigen::Vector3d& sigma_abc) {
    const Eigen::Matrix3d abc = to_abc * tangent.bottomRightCorner<3, 3>() * to_abc.transpose();
    for (int i = 0; i < 3; ++i) {
        sigma_xyz[i] = std::sqrt(std::max(0.0, tangent(i, i)));
        sigma_abc[i] = std::sqrt(std::max(0.0, abc(i, i)));
    }
}

void RegionSystem::outer(const Matrix6& covariance_xi, const State& state, Matrix6& tangent,
                         Eigen::Vector3d& sigma_xyz, Eigen::Vector3d& sigma_abc) const {
    tangent = tangent_of(covariance_xi, state);
    sigmas(tangent, abc_from_rotation(state), sigma_xyz, sigma_abc);
}

void RegionSystem::step(State& state, const Vector6& theta, const Vector6& xi) const {
    if (by_angles_) {
        state.abc += theta.tail<3>();
        state.translation += theta.head<3>();
        state.rotation = rotation_from_abc(state.abc);
        return;
    }
    const Vector6 t = tangent_from_xi(xi, state);
    state.translation += all_free_ ? t.head<3>() : theta.head<3>();
    state.rotation = rotation_exp(t.tail<3>()) * state.rotation;
}

void RegionSystem::Fit::clear() {
    converged = false;
    iterations = 0;
    state = {};
    lin = {};
    shared.clear();
}

// From a solution near by.
void RegionSystem::fit_shared(std::span<const double> factor, Fit& out) const {
    constexpr int kMostSteps = 8;
    out.converged = false;
    for (int k = 0; k < kMostSteps && !out.converged; ++k) {
        ++out.iterations;
        linearize_shared(out.state, factor, out.lin, out.shared);
        const Matrix6 b = xi_from_parameters(out.state);
        Matrix6 h = all_free_ ? out.lin.information : Matrix6(b.transpose() * out.lin.information * b);
        const Vector6 g = all_free_ ? out.lin.gradient : Vector6(b.transpose() * out.lin.gradient);
        Vector6 scale;
        for (int i = 0; i < 6; ++i) {
            if (!options_.free[static_cast<std::size_t>(i)]) h(i, i) = 1;
            scale[i] = h(i, i) > 0 ? 1 / std::sqrt(h(i, i)) : 1.0;
        }
        Matrix6 lower;
        if (!factorise(scale.asDiagonal() * h * scale.asDiagonal(), lower)) return;
        const Vector6 theta = -(scale.asDiagonal() * solve_factorised(lower, scale.asDiagonal() * g));
        const Vector6 xi = all_free_ ? theta : Vector6(b * theta);
        step(out.state, theta, xi);
        for (SharedBlock& block : out.shared.sensors) block.value -= block.gain.transpose().lazyProduct(xi);
        for (SharedSpot& spot : out.shared.spots) spot.e += spot.rows.lazyProduct(xi);
        const double size =
            std::max(xi.head<3>().norm() / kStepMm, xi.tail<3>().norm() / (kStepRad * spread_));
        out.converged = size < kRough;
    }
}

State RegionSystem::shifted(State state, const Vector6& xi) const {
    const Matrix6 b = xi_from_parameters(state);
    step(state, all_free_ ? xi : Vector6(least_squares(b, xi).x), xi);
    return state;
}

void RegionSystem::fit(std::span<const double> factor, Fit& out, const State& from) const {
    out.clear();
    out.state = from;
    linearize(out.state, factor, out.lin);
    double damping = 0;
    double last_gain = std::numeric_limits<double>::infinity(), last_size = 0;
    Linearization trial_lin;
    Matrix6 lower;
    while (out.iterations < options_.max_iterations && std::isfinite(out.lin.cost)) {
        ++out.iterations;
        const Matrix6 b = xi_from_parameters(out.state);
        Matrix6 h = all_free_ ? out.lin.information : Matrix6(b.transpose() * out.lin.information * b);
        const Vector6 g = all_free_ ? out.lin.gradient : Vector6(b.transpose() * out.lin.gradient);
        Vector6 scale;
        for (int i = 0; i < 6; ++i) {
            if (!options_.free[static_cast<std::size_t>(i)]) h(i, i) = 1;
            scale[i] = h(i, i) > 0 ? 1 / std::sqrt(h(i, i)) : 1.0;
        }
        Matrix6 scaled = scale.asDiagonal() * h * scale.asDiagonal();
        scaled.diagonal().array() += damping;
        if (!factorise(scaled, lower)) {
            damping = std::max(kDampingRises * damping, kSingularDamping);
            if (damping > kMostSingularDamping) return;
            continue;
        }
        const Vector6 theta = -(scale.asDiagonal() * solve_factorised(lower, scale.asDiagonal() * g));
        const Vector6 xi = all_free_ ? theta : Vector6(b * theta);
        const double gain = -g.dot(theta);  // predicted decrease of the cost
        State trial = out.state;
        step(trial, theta, xi);
        // In units of the step that counts as none. Steps shrink at least linearly near the minimum, so the
        // next one is known: when it would be none, this one is the last.
        const double size =
            std::max(xi.head<3>().norm() / kStepMm, xi.tail<3>().norm() / (kStepRad * spread_));
        // Steps with the sensors' errors follow, which leave the square of it.
        const bool small =
            size < (shares() ? kRough : 1) || (size < kNear && size * size < kShrinks * last_size);
        if (damping == 0 && small) {
            out.state = trial;
            out.converged = true;
            break;
        }
        linearize(trial, factor, trial_lin);
        // Near the minimum the change of the cost drowns in its rounding, which grows with the distance of
        // the origin: there the step is trusted.
        const double slack = gain < kDrowns * (1 + out.lin.cost) ? kDrownedRise : kRise;
        if (std::isfinite(trial_lin.cost) && trial_lin.cost <= out.lin.cost + slack * (1 + out.lin.cost)) {
            out.state = trial;
            out.lin = trial_lin;
            damping = damping < kLeastDamping ? 0 : kDampingFalls * damping;
            // Rounding keeps the step from shrinking further although it no longer matters (1e-7 of a sigma).
            if (damping == 0 && gain < kNoGain * (1 + out.lin.cost) && gain > kStalls * last_gain) {
                out.converged = true;
                break;
            }
            last_gain = gain;
            last_size = damping == 0 ? size : 0;
        } else {
            damping = std::max(kDampingRises * damping, kWorseDamping);
            if (damping > kMostWorseDamping) return;
        }
    }
    if (out.converged && shares()) fit_shared(factor, out);
}

}  // namespace seamwright::correction
