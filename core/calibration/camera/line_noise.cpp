#include "core/calibration/camera/line_noise.h"
#include "core/acceptance/distributions.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/calibration/camera/f_test.h"

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
