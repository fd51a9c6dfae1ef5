#include "core/calibration/lens/line_noise.h"
#include "core/acceptance/distributions.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/calibration/f_test.h"

namespace seamwright {

void LineNoise::add(const std::vector<Eigen::Vector2d>& all, const std::vector<char>& on,
                    const std::vector<double>& off_px) {
    constexpr std::size_t kPart = 12;
    std::vector<Eigen::Vector2d> points;
    std::vector<double> off;
    for (std::size_t i = 0; i < off_px.size() && i < all.size(); ++i)
        if (on[i]) points.push_back(all[i]), off.push_back(off_px[i]);
    if (points.size() < 3) return;
    Eigen::Vector2d low = points.front(), high = points.front();
    for (const auto& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const Eigen::Index axis = high.x() - low.x() < high.y() - low.y();
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return points[a](axis) < points[b](axis); });
    constexpr std::size_t kLagShare = 3;
    const std::size_t lags = points.size() / kLagShare + 1;
    if (products_.size() < lags) products_.resize(lags, 0), pairs_.resize(lags, 0);
    for (std::size_t lag = 0; lag < lags; ++lag)
        for (std::size_t i = lag; i < order.size(); ++i)
            products_[lag] += off[order[i]] * off[order[i - lag]], ++pairs_[lag];
    ++lines_;
    const std::size_t apart = std::max<std::size_t>(1, points.size() / kPart);
    for (std::size_t i = apart; i + apart < order.size(); ++i) {
        const double second = off[order[i - apart]] - 2 * off[order[i]] + off[order[i + apart]];
        squares_ += second * second / 6;
        ++count_;
    }
}

// Second differences that share points are correlated by -2/3 and 1/6.
double LineNoise::freedom() const {
    constexpr double kShared = 1 + 2 * (4.0 / 9 + 1.0 / 36);
    return count_ / kShared;
}

double LineNoise::sigma_px() const {
    return count_ > 0 ? std::sqrt(squares_ / count_) : 0;
}

double LineNoise::alike_factor(double unknowns) const {
    constexpr double kChance = 2;        // sigma of a sum of two correlations, up to which it is none
    constexpr double kLeastKept = 0.25;  // of what the fit leaves of a long correlation
    if (products_.size() < 3 || !(products_[0] > 0)) return 1;
    const double all = pairs_[0], variance = products_[0] / all;
    double seen = 0, missing = 0;  // sums of the correlations, and of what is missing to one
    for (std::size_t lag = 1; lag + 1 < products_.size(); lag += 2) {
        const double two = (products_[lag] / pairs_[lag] + products_[lag + 1] / pairs_[lag + 1]) / variance;
        if (!(two > kChance * std::sqrt(2 * (1 + 2 * seen) / all))) break;
        seen += two;
        missing += 2 - two;
    }
    if (!(seen > 0)) return 1;
    // The fit takes from each correlation as much as it takes of so many independent points.
    const double fitted = (2 * lines_ + unknowns) / all, most = std::max(1.0, all / (3 * lines_));
    return std::clamp((1 + 2 * seen) / std::max(kLeastKept, 1 - 2 * fitted * missing), 1.0, most);
}

double LineNoise::form_factor(double rms_px, double points, int lines) const {
    constexpr double kParts = 3;
    const double noise2 = sigma_px() * sigma_px(), all2 = rms_px * rms_px;
    if (!(noise2 > 0) || !(all2 > kStraightTimes * kStraightTimes * noise2) ||
        !(f_upper(points, freedom(), all2 / noise2) < kNoAccident))
        return 1;
    const double alike = std::max(1.0, points / (kParts * lines));
    return (noise2 + (all2 - noise2) * alike) / all2;
}

}  // namespace seamwright
