#include "core/calibration/table/wrong_pairs.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>

#include "core/calibration/camera/camera.h"
#include "core/calibration/table/wrong_groups.h"
#include "core/numbers.h"

namespace seamwright::lookup_table {

using Eigen::Matrix2d;
using Eigen::Vector2d;

namespace {

constexpr int kHighestDegree = 5;
constexpr double kHarmless_px = 0.25;  // a pair this close is not wrong, however exact the others are
constexpr double kRoughTimes = 12;  // the median, from a robust homography: what is farther is wrong at once
constexpr double kChance = 0.001;   // that the largest of sound pairs is called wrong
// Keep a covariance invertible: of its trace, and where that is zero.
constexpr double kRidge = 1e-12, kLeastRidge_px2 = 1e-30;
constexpr double kFewPairs = 20;       // their median tells no noise
constexpr double kLeastRobust = 1e-9;  // of the noise, by the median
constexpr double kMostF = 1e12;        // of a pair that the others leave no room
constexpr double kWithWorst = 0.25;    // of the worst F: what is beyond goes with it

// Pixel to laser, least median of squares and concentration on the better half; nullopt: none.
std::optional<Eigen::Matrix3d> robust_homography(const Samples& s) {
    const std::size_t n = s.pixel.size();
    std::mt19937 random(20260101);
    std::vector<std::size_t> judges(n);
    std::iota(judges.begin(), judges.end(), 0);
    std::shuffle(judges.begin(), judges.end(), random);
    if (judges.size() > 1000) judges.resize(1000);
    std::vector<double> error(judges.size());
    const auto middle = static_cast<std::ptrdiff_t>(judges.size() / 2);
    const auto median_of = [&](const Eigen::Matrix3d& h) {
        for (std::size_t k = 0; k < judges.size(); ++k) {
            const double e = (through(h, s.pixel[judges[k]]) - s.laser[judges[k]]).squaredNorm();
            error[k] = std::isfinite(e) ? e : kInfinity;
        }
        std::nth_element(error.begin(), error.begin() + middle, error.end());
        return error[static_cast<std::size_t>(middle)];
    };
    std::optional<Eigen::Matrix3d> best;
    double best_median = kInfinity;
    const auto offer = [&](const std::optional<Eigen::Matrix3d>& h) {
        if (!h) return;
        const double m = median_of(*h);
        if (m < best_median) best_median = m, best = h;
    };
    offer(homography_dlt(s.pixel, s.laser));
    std::uniform_int_distribution<std::size_t> any(0, n - 1);
    for (int trial = 0; trial < 400; ++trial) {
        std::vector<Vector2d> from, to;
        for (int k = 0; k < 4; ++k) {
            const std::size_t i = any(random);
            from.push_back(s.pixel[i]);
            to.push_back(s.laser[i]);
        }
        offer(homography_dlt(from, to));
    }
    for (int round = 0; best && round < 5; ++round) {
        std::vector<Vector2d> from, to;
        for (std::size_t i = 0; i < n; ++i)
            if ((through(*best, s.pixel[i]) - s.laser[i]).squaredNorm() <= best_median) {
                from.push_back(s.pixel[i]);
                to.push_back(s.laser[i]);
            }
        const double before = best_median;
        offer(homography_dlt(from, to));
        if (!(best_median < before)) break;
    }
    return best;
}

// Limit of F(2, freedom) that the largest of n passes with probability 0.001; exact for two numbers.
double largest_limit(double n, double freedom) {
    return 0.5 * freedom * (std::pow(kChance / n, -2 / freedom) - 1);
}

Matrix2d invertible(Matrix2d m) {
    m += (kRidge * m.trace() + kLeastRidge_px2) * Matrix2d::Identity();
    return m.inverse();
}

}  // namespace

bool fit_without_wrong(const std::vector<LaserPair>& pairs, const std::vector<char>& allowed,
                       std::vector<char>& used, SmoothMap& map) {
    // What lies far from a robust homography; the lens may bend by several times the median.
    const Samples all = chosen(pairs, allowed);
    const auto rough = robust_homography(all);
    if (!rough) return false;
    const Eigen::Matrix3d back_to_pixel = rough->inverse();
    std::vector<double> error;
    for (std::size_t i = 0; i < all.pixel.size(); ++i) {
        const double e = (through(back_to_pixel, all.laser[i]) - all.pixel[i]).norm();
        error.push_back(std::isfinite(e) ? e : kInfinity);
    }
    std::vector<double> sorted = error;
    std::sort(sorted.begin(), sorted.end());
    const double limit = std::max(kRoughTimes * sorted[sorted.size() / 2], kHarmless_px);
    used = allowed;
    for (std::size_t i = 0, k = 0; i < pairs.size(); ++i)
        if (allowed[i] && error[k++] > limit) used[i] = 0;

    for (int round = 0; round < 4; ++round) {
        for (int pass = 0; pass < 200; ++pass) {
            const Samples s = chosen(pairs, used);
            if (s.pixel.size() < 6) return false;
            const bool first = pass == 0;
            if (!map.fit(s, first ? 1 : map.degree(), first ? kHighestDegree : map.degree())) return false;
            const double n = static_cast<double>(s.pixel.size()), freedom = map.freedom();
            if (freedom < 4) break;
            const Matrix2d inverse = invertible(map.noise());
            std::vector<double> square;
            for (std::size_t i = 0; i < s.pixel.size(); ++i) square.push_back(map.studentised(i, inverse));
            std::vector<double> order = square;
            std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2),
                             order.end());
            // The median of chi-squared with two degrees of freedom is 2 ln 2; many wrong pairs blow up the
            // noise but not the median.
            const double robust =
                n < kFewPairs ? 1
                              : std::clamp(order[order.size() / 2] / (2 * std::log(2.0)), kLeastRobust, 1.0);
            std::vector<double> f(square.size());
            double worst = 0;
            for (std::size_t i = 0; i < f.size(); ++i) {
                const double deleted = square[i] < 2 * freedom
                                           ? square[i] * (freedom - 1) / (2 * freedom - square[i])
                                           : kInfinity;
                f[i] = std::max(std::min(deleted, kMostF), square[i] / (2 * robust));
                if (!(f[i] > largest_limit(n, freedom - 1))) f[i] = 0;
                if (f[i] > 0 && map.left_out_error(i).norm() < kHarmless_px) f[i] = 0;
                worst = std::max(worst, f[i]);
            }
            if (!(worst > 0)) break;
            for (std::size_t i = 0, k = 0; i < pairs.size(); ++i)
                if (used[i]) used[i] = !(f[k++] > kWithWorst * worst);
        }
        // A pair that the clean map predicts was wronged by its wrong neighbours.
        bool back = false;
        const double n = static_cast<double>(std::count(used.begin(), used.end(), 1));
        for (std::size_t i = 0; round < 3 && i < pairs.size(); ++i) {
            if (!allowed[i] || used[i]) continue;
            const Vector2d e = map.miss(pairs[i].pixel, pairs[i].laser_mm);
            if (!e.allFinite()) continue;
            const auto known = map.known(pairs[i].pixel);
            const Matrix2d expected = map.noise() + known.with(known, map.noise());
            if (e.dot(invertible(expected) * e) / 2 < largest_limit(n, std::max(1.0, map.freedom() - 1)) ||
                e.norm() < kHarmless_px)
                used[i] = 1, back = true;
        }
        if (!back) break;
    }
    const Samples s = chosen(pairs, used);
    return s.pixel.size() >= 6 && map.fit(s, 1, kHighestDegree, stage_rows(s));
}

}  // namespace seamwright::lookup_table
