#include "core/calibration/pose/hand_eye/hand_eye_solve.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/geometry/decompositions.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright::hand_eye {
namespace {

using Vector12 = Eigen::Matrix<double, 12, 1>;

constexpr double kSmallest_mm = 1e-6, kSmallest_rad = 1e-8;  // weights of exact data stay finite
constexpr double kOpenInformation = 1e-15;  // of the scaled information: no direction is more open
// Levenberg and Marquardt; kFailedDamping: the least after a step that was none.
constexpr double kDampingStart = 1e-6, kDampingDown = 0.1, kDampingUp = 10;
constexpr double kLeastDamping = 1e-12, kFailedDamping = 1e-9;
constexpr double kCostSettled = 1e-12;  // relative gain that ends it
constexpr double kChiSquared3Median = 2.366;
constexpr double kRatioSettled = 1e-4;  // of the scales' ratio: a smaller change moves nothing

// Both scales of few pairs, from one that counts for millimetres.
Scales shared(double sigma_mm, double lever_mm) {
    const double sigma = std::max(sigma_mm, kFloor_mm);
    return {sigma, sigma / lever_mm};
}

double cost_of(const Chain& chain, const Pose& x, const Pose& y, const Scales& s, double k) {
    double cost = 0;
    for (std::size_t i = 0; i < chain.size(); ++i) {
        if (!chain.used[i]) continue;
        const double q = pair_square(chain, i, x, y, s);
        cost += std::isinf(k) ? q : q * k / (q + k);
    }
    return cost;
}

// Variance components by the hat matrix' share of each group: s^2 = sum r^2 / (3 n - tr(H^-1 H_group)).
Scales estimated_scales(const Chain& chain, const Pose& x, const Pose& y, const Scales& s) {
    const Linear at = linearise_pairs(chain, x, y, s);
    Matrix12 mm = Matrix12::Zero(), rad = Matrix12::Zero();
    double squares_mm = 0, squares_rad = 0;
    for (Eigen::Index row = 0; row < at.residuals.size(); row += 6) {
        const auto t = at.jacobian.middleRows<3>(row), r = at.jacobian.middleRows<3>(row + 3);
        mm.noalias() += t.transpose() * t;
        rad.noalias() += r.transpose() * r;
        squares_mm += at.residuals.segment<3>(row).squaredNorm();
        squares_rad += at.residuals.segment<3>(row + 3).squaredNorm();
    }
    const double rows = 3 * static_cast<double>(chain.used_count());
    if (chain.used_count() < kFewestForScales) {
        const double lever = shared_lever_mm(chain);
        return shared(std::sqrt((s.mm * s.mm * squares_mm + std::pow(lever * s.rad, 2) * squares_rad) /
                                (2 * rows - 12)),
                      lever);
    }
    const auto sigma = [&](const Matrix12& own, double squares) {
        return std::sqrt(squares / std::max(1.0, rows - solve_symmetric(mm + rad, own).trace()));
    };
    return {std::max(kSmallest_mm, s.mm * sigma(mm, squares_mm)),
            std::max(kSmallest_rad, s.rad * sigma(rad, squares_rad))};
}

// By eigenvalues of the scaled matrix, so that an open direction comes out as large as it is.
Matrix12 inverse_information(const Linear& at) {
    const Matrix12 h = at.jacobian.transpose() * at.jacobian;
    const Vector12 scale = h.diagonal().cwiseMax(kUntold).cwiseSqrt().cwiseInverse();
    const SymmetricEigen eigen = symmetric_eigen(scale.asDiagonal() * h * scale.asDiagonal());
    const Vector12 inverse = eigen.values.cwiseMax(kOpenInformation).cwiseInverse();
    return scale.asDiagonal() * eigen.vectors * inverse.asDiagonal() * eigen.vectors.transpose() *
           scale.asDiagonal();
}

double largest_sigma(const Matrix12& covariance, Eigen::Index at) {
    const SymmetricEigen eigen = symmetric_eigen(covariance.block<3, 3>(at, at));
    return std::sqrt(std::max(0.0, eigen.values(2)));
}

}  // namespace

std::size_t Chain::used_count() const {
    return static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
}

double shared_lever_mm(const Chain& chain) {
    constexpr double kOfDistance = 0.4, kLeast_mm = 20;
    double sum = 0;
    for (std::size_t i = 0; i < chain.size(); ++i)
        if (chain.used[i]) sum += chain.c[i].translation().norm();
    return std::max(kLeast_mm, kOfDistance * sum / static_cast<double>(chain.used_count()));
}

Eigen::Vector3d residual_mm(const Chain& chain, std::size_t i, const Pose& x, const Pose& y) {
    return chain.a[i] * (x * chain.c[i].translation()) - y.translation();
}
Eigen::Vector3d residual_rad(const Chain& chain, std::size_t i, const Pose& x, const Pose& y) {
    return rotation_log(y.linear().transpose() * chain.a[i].linear() * x.linear() * chain.c[i].linear());
}
double pair_square(const Chain& chain, std::size_t i, const Pose& x, const Pose& y, const Scales& s) {
    return residual_mm(chain, i, x, y).squaredNorm() / (s.mm * s.mm) +
           residual_rad(chain, i, x, y).squaredNorm() / (s.rad * s.rad);
}

Linear linearise_pairs(const Chain& chain, const Pose& x, const Pose& y, const Scales& s) {
    const auto rows = static_cast<Eigen::Index>(6 * chain.used_count());
    Linear at{Eigen::VectorXd(rows), Eigen::MatrixXd::Zero(rows, 12)};
    Eigen::Index row = 0;
    for (std::size_t i = 0; i < chain.size(); ++i) {
        if (!chain.used[i]) continue;
        const Eigen::Matrix3d ra = chain.a[i].linear();
        const Eigen::Vector3d turn = residual_rad(chain, i, x, y);
        at.residuals.segment<3>(row) = residual_mm(chain, i, x, y) / s.mm;
        at.residuals.segment<3>(row + 3) = turn / s.rad;
        auto j = at.jacobian.middleRows<6>(row);
        j.block<3, 3>(0, 0) = ra / s.mm;
        j.block<3, 3>(0, 3) = -ra * skew(x.linear() * chain.c[i].translation()) / s.mm;
        j.block<3, 3>(0, 6) = -Eigen::Matrix3d::Identity() / s.mm;
        // log(Exp(d) E) = r + J_l^-1(r) d, J_l^-1 = I - [r]x / 2 to first order in the residual r.
        const Eigen::Matrix3d left =
            (Eigen::Matrix3d::Identity() - 0.5 * skew(turn)) * y.linear().transpose() / s.rad;
        j.block<3, 3>(3, 3) = left * ra;
        j.block<3, 3>(3, 9) = -left;
        row += 6;
    }
    return at;
}

void refine(const Chain& chain, Pose& x, Pose& y, const Scales& s, double k, int most_iterations) {
    double cost = cost_of(chain, x, y, s, k), lambda = kDampingStart;
    for (int iteration = 0; iteration < most_iterations; ++iteration) {
        Linear at = linearise_pairs(chain, x, y, s);
        if (!std::isinf(k))
            for (Eigen::Index row = 0; row < at.residuals.size(); row += 6) {
                const double root = k / (at.residuals.segment<6>(row).squaredNorm() + k);  // of the weight
                at.residuals.segment<6>(row) *= root;
                at.jacobian.middleRows<6>(row) *= root;
            }
        const Matrix12 h = at.jacobian.transpose() * at.jacobian;
        const Vector12 gradient = at.jacobian.transpose() * at.residuals;
        const Vector12 scale = h.diagonal().cwiseMax(kUntold).cwiseSqrt().cwiseInverse();
        bool moved = false;
        double gain = 0;
        for (int attempt = 0; attempt < 10 && !moved; ++attempt) {
            Matrix12 damped = scale.asDiagonal() * h * scale.asDiagonal();
            damped.diagonal().array() += lambda + kRidge;
            const Vector12 step =
                -(scale.asDiagonal() * solve_symmetric(damped, scale.asDiagonal() * gradient));
            const Pose next_x = retract(x, step.head<6>()), next_y = retract(y, step.tail<6>());
            const double next = cost_of(chain, next_x, next_y, s, k);
            moved = next <= cost;
            lambda = moved ? std::max(kLeastDamping, lambda * kDampingDown)
                           : std::max(kFailedDamping, lambda * kDampingUp);
            if (!moved) continue;
            gain = cost - next;
            x = next_x;
            y = next_y;
            cost = next;
        }
        if (!moved || gain <= kCostSettled * cost) break;
    }
}

// The squares of three numbers are chi-squared.
Scales scales_from_medians(const Chain& chain, const Pose& x, const Pose& y) {
    std::vector<double> t, r;
    for (size_t i = 0; i < chain.size(); ++i) {
        if (!chain.used[i]) continue;
        t.push_back(residual_mm(chain, i, x, y).squaredNorm());
        r.push_back(residual_rad(chain, i, x, y).squaredNorm());
    }
    if (chain.used_count() < kFewestForScales) {
        // The start fits some pairs exactly: all count.
        const double lever = shared_lever_mm(chain);
        double sum = 0;
        for (std::size_t i = 0; i < t.size(); ++i) sum += t[i] + lever * lever * r[i];
        return shared(std::sqrt(sum / (6 * static_cast<double>(t.size()) - 12)), lever);
    }
    return {std::max(kSmallest_mm, std::sqrt(median(t) / kChiSquared3Median)),
            std::max(kSmallest_rad, std::sqrt(median(r) / kChiSquared3Median))};
}

Scales solve(const Chain& chain, Pose& x, Pose& y, Scales scales) {
    for (int round = 0; round < 8; ++round) {
        refine(chain, x, y, scales, kInfinity, 30);
        const Scales next = estimated_scales(chain, x, y, scales);
        const double change = std::abs(
            std::log((next.mm / next.rad) / (scales.mm / scales.rad)));  // only the ratio moves the solution
        scales = next;
        if (change < kRatioSettled) break;
    }
    return scales;
}

Determination determination(const Chain& chain, const Pose& x, const Pose& y, const Scales& scales) {
    const Scales floor{std::max(scales.mm, kFloor_mm), std::max(scales.rad, kFloor_rad)};
    const Matrix12 floored = inverse_information(linearise_pairs(chain, x, y, floor));
    return {largest_sigma(floored, 0), largest_sigma(floored, 3)};
}

}  // namespace seamwright::hand_eye
