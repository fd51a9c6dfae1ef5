#include "core/calibration/nozzle/touch_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/decompositions.h"

namespace seamwright::nozzle {
namespace {

using Row7 = Eigen::Matrix<double, 1, 7>;
using Rows7 = Eigen::Matrix<double, 3, 7>;

constexpr double kLeastVariance = 1e-8, kMostVariance = 1e4;  // mm^2: 0.1 um and 100 mm
constexpr double kApart_mm = 0.5;      // two starts that end nearer found the same place
constexpr double kAtCentre_mm = 1e-9;  // a tip nearer to the centre has no normal
// Levenberg and Marquardt.
constexpr double kDampingStart = 1e-6, kDampingDown = 0.1, kDampingUp = 10, kLeastDamping = 1e-12;
constexpr double kDampedFloor = 1e-9;  // of the diagonal that is damped
// A step, or a gain, relative to one and what it changes, that ends it.
constexpr double kStepSettled = 1e-9, kCostSettled = 1e-13;

// Derivatives of one touch and its weight; of a sphere the first row alone.
struct Linear {
    Rows7 j = Rows7::Zero();
    Eigen::Vector3d e = Eigen::Vector3d::Zero();
    Eigen::Matrix3d weight = Eigen::Matrix3d::Zero();
};

Linear linear_of(const TouchSet& set, const Eigen::Matrix3d& attitude, const Eigen::Vector3d& normal,
                 const Eigen::Vector3d& tip, double variance) {
    Linear out;
    const Eigen::Vector3d arm = attitude * tip;
    const double own = variance + set.robot_mm * set.robot_mm, turn = set.robot_rad * set.robot_rad;
    if (set.sphere) {
        out.j.row(0) << normal.transpose() * attitude, -normal.transpose() * set.half, -set.spread_mm;
        out.weight(0, 0) = 1 / (own + turn * arm.cross(normal).squaredNorm());
    } else {
        out.j << attitude, -set.half, Eigen::Vector3d::Zero();
        const Eigen::Matrix3d covariance =
            (own + turn * arm.squaredNorm()) * Eigen::Matrix3d::Identity() - turn * arm * arm.transpose();
        out.weight = covariance.inverse();
    }
    return out;
}

Eigen::Vector3d centre_at(const TouchSet& set, const Vector7& state) {
    return set.place_mm + set.half * state.segment<3>(3);
}

Linear linear_at(const TouchSet& set, const Pose& pose, const Vector7& state, double variance) {
    const Eigen::Vector3d off = pose * Eigen::Vector3d(state.head<3>()) - centre_at(set, state);
    const double length = off.norm();
    const Eigen::Vector3d normal =
        length > kAtCentre_mm ? Eigen::Vector3d(off / length) : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
    Linear out = linear_of(set, pose.linear(), normal, state.head<3>(), variance);
    out.e = residual(set, pose, state);
    return out;
}

double cost_at(const TouchSet& set, const Vector7& state, double variance) {
    double cost = state.tail<4>().squaredNorm();
    for (const Pose& pose : set.poses) {
        const Linear l = linear_at(set, pose, state, variance);
        cost += l.e.dot(l.weight * l.e);
    }
    return cost;
}

Matrix7 prior() {
    Matrix7 p = Matrix7::Zero();
    p.diagonal().tail<4>().setOnes();
    return p;
}

// Levenberg-Marquardt; false: it does not come to rest.
bool descend(const TouchSet& set, double variance, Vector7& state, double& cost) {
    cost = cost_at(set, state, variance);
    double damping = kDampingStart;
    for (int iteration = 0; iteration < 100; ++iteration) {
        Matrix7 h = prior();
        Vector7 g = Vector7::Zero();
        g.tail<4>() = state.tail<4>();
        for (const Pose& pose : set.poses) {
            const Linear l = linear_at(set, pose, state, variance);
            h.noalias() += l.j.transpose() * l.weight * l.j;
            g.noalias() += l.j.transpose() * l.weight * l.e;
        }
        bool better = false;
        for (int attempt = 0; attempt < 12 && !better; ++attempt) {
            Matrix7 damped = h;
            damped.diagonal() += damping * (h.diagonal().array() + kDampedFloor).matrix();
            const Vector7 step = -damped.ldlt().solve(g);
            if (!step.allFinite()) return false;
            const Vector7 next = state + step;
            const double then = cost_at(set, next, variance);
            if (then <= cost) {
                better = true;
                const bool still = step.norm() < kStepSettled * (1 + state.norm()) ||
                                   cost - then < kCostSettled * (1 + cost);
                state = next;
                cost = then;
                damping = std::max(damping * kDampingDown, kLeastDamping);
                if (still) return true;
            } else {
                damping *= kDampingUp;
            }
        }
        if (!better) return true;  // nothing is downhill any more
    }
    return false;
}

// |t + q|^2 = rho^2 is linear in t and |t|^2; of places in a plane the two that |t|^2 leaves.
std::vector<Eigen::Vector3d> linear_starts(const TouchSet& set) {
    std::vector<Eigen::Vector3d> starts;
    const auto n = static_cast<Eigen::Index>(set.poses.size());
    Eigen::MatrixXd d(n, 3);
    for (Eigen::Index i = 0; i < n; ++i) {
        const Pose& pose = set.poses[static_cast<std::size_t>(i)];
        d.row(i) = (pose.linear().transpose() * (pose.translation() - set.place_mm)).transpose();
    }
    const Eigen::RowVector3d mean = d.colwise().mean();
    if (!set.sphere) return {-mean.transpose()};
    d.rowwise() -= mean;
    Eigen::MatrixXd a(n, 4);
    a.leftCols<3>() = 2 * d;
    a.col(3).setOnes();
    const Eigen::VectorXd b = set.rho_mm * set.rho_mm - d.rowwise().squaredNorm().array();
    if (n >= 4) {
        const Eigen::Vector4d x = a.completeOrthogonalDecomposition().solve(b);
        starts.emplace_back(x.head<3>() - mean.transpose());
    }
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(d, Eigen::ComputeFullV);
    const Eigen::Matrix3d v = svd.matrixV();
    Eigen::MatrixXd flat(n, 3);
    flat.leftCols<2>() = a.leftCols<3>() * v.leftCols<2>();
    flat.col(2).setOnes();
    const Eigen::Vector3d x = flat.completeOrthogonalDecomposition().solve(b);
    const Eigen::Vector3d in_plane = v.leftCols<2>() * x.head<2>();
    const double height = std::sqrt(std::max(0.0, x[2] - in_plane.squaredNorm()));
    for (const double side : {-1.0, 1.0})
        starts.emplace_back(in_plane + side * height * v.col(2) - mean.transpose());
    return starts;
}

struct Place {
    Vector7 state;
    double cost;
};

// The places that the starts lead to, best first.
std::vector<Place> places(const TouchSet& set, double variance, const std::vector<Eigen::Vector3d>& starts) {
    std::vector<Place> all;
    for (const Eigen::Vector3d& start : starts) {
        if (!start.allFinite()) continue;
        Place p{Vector7::Zero(), 0};
        p.state.head<3>() = start;
        if (!descend(set, variance, p.state, p.cost) || !std::isfinite(p.cost)) continue;
        const bool known = std::any_of(all.begin(), all.end(), [&](const Place& other) {
            return (other.state.head<3>() - p.state.head<3>()).norm() < kApart_mm;
        });
        if (!known) all.push_back(p);
    }
    std::stable_sort(all.begin(), all.end(), [](const Place& a, const Place& b) { return a.cost < b.cost; });
    return all;
}

// Chi squared of the touches, its expectation, and the covariance, where the state stands.
void state_spread(const TouchSet& set, TouchFit& fit) {
    const Matrix7 of_touches = information_at(set, fit.state, fit.variance);
    fit.information = information_of_tip(of_touches);
    fit.covariance.setZero();
    fit.misfit = 0;
    for (const Pose& pose : set.poses) {
        const Linear l = linear_at(set, pose, fit.state, fit.variance);
        fit.misfit += l.e.dot(l.weight * l.e);
    }
    fit.freedom = 0;
    if (!fit.determined()) return;
    fit.covariance = (of_touches + prior()).ldlt().solve(Matrix7::Identity());
    fit.freedom = set.rows() - (of_touches * fit.covariance).trace();
    fit.random = (fit.covariance * of_touches * fit.covariance).topLeftCorner<3, 3>();
    fit.systematic = (fit.covariance * prior() * fit.covariance).topLeftCorner<3, 3>();
}

// Of a touch such that its chi squared is as large as expected; nullopt: nothing is left to tell.
std::optional<double> estimate_variance(const TouchSet& set, TouchFit fit) {
    constexpr double kLeastFreedom = 0.9;
    double low = std::log(kLeastVariance), high = std::log(kMostVariance);
    for (int i = 0; i < 26; ++i) {
        const double middle = 0.5 * (low + high);
        fit.variance = std::exp(middle);
        if (!descend(set, fit.variance, fit.state, fit.cost)) return std::nullopt;
        state_spread(set, fit);
        // What is not determined at a large variance is asked at a smaller one.
        if (fit.freedom < kLeastFreedom && fit.determined()) return std::nullopt;
        (fit.determined() && fit.misfit > fit.freedom ? low : high) = middle;
    }
    return std::exp(0.5 * (low + high));
}

}  // namespace

TouchSet TouchSet::without(std::size_t i) const {
    TouchSet rest = *this;
    rest.poses.erase(rest.poses.begin() + static_cast<std::ptrdiff_t>(i));
    return rest;
}

bool TouchFit::determined() const {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information, Eigen::EigenvaluesOnly);
    return eigen.eigenvalues()[0] >= 1 / (kOpen_mm * kOpen_mm);
}

Eigen::Vector3d residual(const TouchSet& set, const Pose& pose, const Vector7& state) {
    const Eigen::Vector3d off = pose * Eigen::Vector3d(state.head<3>()) - centre_at(set, state);
    if (!set.sphere) return off;
    return {off.norm() - set.rho_mm - set.spread_mm * state[6], 0, 0};
}

Matrix7 information_of(const TouchSet& set, const Eigen::Matrix3d& attitude, const Eigen::Vector3d& normal,
                       const Eigen::Vector3d& tip, double variance) {
    const Linear l = linear_of(set, attitude, normal, tip, variance);
    return l.j.transpose() * l.weight * l.j;
}

Matrix7 information_at(const TouchSet& set, const Vector7& state, double variance) {
    Matrix7 all = Matrix7::Zero();
    for (const Pose& pose : set.poses) {
        const Linear l = linear_at(set, pose, state, variance);
        all.noalias() += l.j.transpose() * l.weight * l.j;
    }
    return all;
}

Eigen::Matrix3d information_of_tip(const Matrix7& of_touches) {
    const Matrix7 all = of_touches + prior();
    const Eigen::Matrix4d rest = all.bottomRightCorner<4, 4>();
    const Eigen::Matrix<double, 3, 4> cross = all.topRightCorner<3, 4>();
    const Eigen::Matrix3d m =
        all.topLeftCorner<3, 3>() - cross * rest.ldlt().solve(Eigen::Matrix<double, 4, 3>(cross.transpose()));
    return 0.5 * (m + m.transpose());
}

TouchFit fit_touches(const TouchSet& set, std::optional<double> variance) {
    TouchFit fit;
    std::vector<Eigen::Vector3d> starts = linear_starts(set);
    if (set.near) starts.push_back(*set.near);
    if (!variance && set.sigma_mm) variance = *set.sigma_mm * *set.sigma_mm;
    fit.variance = variance.value_or(kUnstatedTouch_mm * kUnstatedTouch_mm);
    const auto found = places(set, fit.variance, starts);
    if (found.empty()) return fit;
    fit.solved = true;
    fit.state = found.front().state;
    state_spread(set, fit);
    if (!variance) {
        if (const auto estimated = estimate_variance(set, fit)) {
            fit.variance = *estimated;
            fit.estimated = true;
        }
    }
    if (!descend(set, fit.variance, fit.state, fit.cost)) fit.solved = false;
    state_spread(set, fit);
    for (const Place& p : found) {
        Place again = p;
        if (!descend(set, fit.variance, again.state, again.cost)) continue;
        if ((again.state.head<3>() - fit.state.head<3>()).norm() < kApart_mm) continue;
        if (again.cost < fit.cost + kAlike) fit.other = again.state.head<3>();
    }
    return fit;
}

}  // namespace seamwright::nozzle
