#include "core/calibration/pose/hand_eye/hand_eye_few.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <span>

#include "core/acceptance/distributions.h"
#include "core/calibration/pose/hand_eye/hand_eye_parts.h"
#include "core/calibration/statistics.h"
#include "core/numbers.h"

namespace seamwright::hand_eye {
namespace {

// Standard deviations over that across the sight, turns on the lever of shared_lever_mm(): medians, and one sigma of
// their logarithms. A camera alone has along 2 .. 10, tilt 5 .. 30, turn 4; a robot alone 1 .. 1 and turns of 0.4.
struct Ratio {
    double median, log_sigma;
};
constexpr std::array<Ratio, kErrorKinds> kRatios{{{1, 0}, {1.6, 0.6}, {1.8, 1.0}, {1.2, 0.8}, {0.3, 0.9}}};
constexpr std::size_t kSets = 160, kSetsOfStated = 60;  // of ratios; beside a stated robot times the sizes
constexpr double kSizeStep = 1.5;                       // of the grid of sizes
constexpr double kSizeUpTo = 5;                         // times what is left of the pairs without the robot
constexpr int kRounds = 2;

using Ratios = std::array<double, kErrorKinds>;  // variances

// Halton's points on the normal distribution.
const std::vector<Ratios>& ratio_sets() {
    static const std::vector<Ratios> sets = [] {
        constexpr std::array<int, kErrorKinds> kBase{0, 2, 3, 5, 7};
        std::vector<Ratios> list(kSets);
        for (std::size_t n = 0; n < kSets; ++n)
            for (std::size_t k = 0; k < kErrorKinds; ++k) {
                double sigma = kRatios[k].median;
                if (kBase[k] > 0) {
                    double p = 0, share = 1;
                    for (int left = static_cast<int>(n) + 1; left > 0; left /= kBase[k]) {
                        share /= kBase[k];
                        p += share * (left % kBase[k]);
                    }
                    sigma *= std::exp(kRatios[k].log_sigma * normal_quantile(p));
                }
                list[n][k] = sigma * sigma;
            }
        return list;
    }();
    return sets;
}

// What a covariance of so many degrees of freedom is widened by, so that the ellipse of 95 % of six normal numbers holds as
// many of these.
double six_at_once(double freedom) {
    constexpr double kOfNormal = 12.5916;  // chi squared of six, 95 %
    return 6 * f_quantile(6, freedom, 0.95) / kOfNormal;
}

// One explanation of the pairs.
struct Explained {
    double log_weight = 0;
    Unknowns move;
    UnknownsSquare cover;  // widened for its degrees of freedom
};

struct Solved {
    double log_determinants = 0, squares = 0;
    Unknowns move;
    UnknownsSquare cover;
};

// By Cholesky of its own size: hundreds of these make one answer.
Solved solve_with(const PairLinear& at, const PairParts& errors, const Ratios& variance, double known) {
    const Eigen::Index n = at.jacobian.front().cols();
    Solved s;
    UnknownsSquare information = UnknownsSquare::Zero(n, n);
    Unknowns pull = Unknowns::Zero(n);
    for (std::size_t i = 0; i < at.residual.size(); ++i) {
        Matrix6 cover = known * errors.known[i];
        for (std::size_t k = 0; k < kErrorKinds; ++k) cover += variance[k] * errors.parts[i][k];
        const Eigen::LLT<Matrix6> root(cover);
        const PairRows white = root.matrixL().solve(at.jacobian[i]);
        const Vector6 left = root.matrixL().solve(at.residual[i]);
        information.noalias() += white.transpose() * white;
        pull.noalias() += white.transpose() * left;
        s.squares += left.squaredNorm();
        s.log_determinants += 2 * root.matrixLLT().diagonal().array().log().sum();
    }
    const Unknowns unit = information.diagonal().cwiseMax(kUntold).cwiseSqrt().cwiseInverse();
    UnknownsSquare scaled = unit.asDiagonal() * information * unit.asDiagonal();
    scaled.diagonal().array() += kRidge;
    const Eigen::LLT<UnknownsSquare> root(scaled);
    s.log_determinants += 2 * (root.matrixLLT().diagonal().array().log().sum() - unit.array().log().sum());
    s.cover = unit.asDiagonal() * root.solve(UnknownsSquare::Identity(n, n)) * unit.asDiagonal();
    s.move = -(s.cover * pull);
    s.squares = std::max(0.0, s.squares + s.move.dot(pull));
    return s;
}

}  // namespace

Weighed weigh_few(Chain chain, bool robot_outside, const RobotRepeatability& robot, Pose x, Pose y,
                  bool free_size) {
    const Scales scales = {1, 1 / shared_lever_mm(chain)};
    Weighed found;
    for (int round = 0; round < kRounds; ++round) {
        const PairLinear at = linear_pairs(chain, x, y, scales, free_size);
        const PairParts errors = pair_parts(chain, robot_outside, robot, scales, x, y);
        const Eigen::Index n = at.jacobian.front().cols();
        const double freedom = 6 * static_cast<double>(at.residual.size()) - static_cast<double>(n);
        const double least = freedom * kFloor_mm * kFloor_mm;
        const double wider = six_at_once(freedom);
        std::vector<Explained> list;
        // The first round but finds where to linearise.
        const std::size_t some = (robot.stated() ? kSetsOfStated : kSets) / (round + 1 < kRounds ? 4 : 1);
        const std::span<const Ratios> sets(ratio_sets().data(), some);
        for (const Ratios& ratios : sets) {
            const Solved alone = solve_with(at, errors, ratios, 0);
            const double squares = std::max(alone.squares, least);
            if (!robot.stated()) {
                list.push_back({-0.5 * (alone.log_determinants + freedom * std::log(squares)), alone.move,
                                wider * squares / freedom * alone.cover});
                continue;
            }
            for (double size = kFloor_mm; size < kSizeUpTo * std::sqrt(squares / freedom);
                 size *= kSizeStep) {
                Ratios variance = ratios;
                for (double& v : variance) v *= size * size;
                const Solved with = solve_with(at, errors, variance, 1);
                list.push_back({-0.5 * (with.log_determinants + with.squares), with.move, with.cover});
            }
        }
        double most = -kInfinity, sum = 0;
        for (const Explained& e : list) most = std::max(most, e.log_weight);
        Unknowns mean = Unknowns::Zero(n);
        for (const Explained& e : list) {
            const double w = std::exp(e.log_weight - most);
            if (!std::isfinite(w)) continue;
            sum += w;
            mean += w * e.move;
        }
        mean /= sum;
        found.covariance = UnknownsSquare::Zero(n, n);
        for (const Explained& e : list) {
            const double w = std::exp(e.log_weight - most) / sum;
            if (!std::isfinite(w)) continue;
            const Unknowns off = e.move - mean;
            found.covariance += w * (e.cover + off * off.transpose());
        }
        if (!mean.allFinite()) break;
        move_by(mean, chain, x, y);
        if (free_size) found.size *= 1 + mean(12);
    }
    found.x = x;
    found.y = y;
    return found;
}

}  // namespace seamwright::hand_eye
