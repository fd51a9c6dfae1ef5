#include "core/statistics/trend.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/acceptance/distributions.h"
#include "core/acceptance/levels.h"

namespace seamwright {
namespace {

constexpr double kMostCorrelated = 0.99;

std::optional<Crossing> crossing_of(const Trend& t, const ProcessLimits& limits) {
    const bool up = t.slope_per_day > 0;
    const std::optional<double>& limit = up ? limits.upper : limits.lower;
    if (!limit) return std::nullopt;
    const double furthest = kTrendAhead * t.span_days;
    const double way = *limit - t.level;
    const double fast = up ? t.slope_limits.high : t.slope_limits.low;
    const double slow = up ? t.slope_limits.low : t.slope_limits.high;
    Crossing c{up, *limit, way / t.slope_per_day, way / fast, way / slow};
    if (c.days > furthest) return std::nullopt;
    // Beyond already, the steeper line left the limits later.
    if (c.days < 0) std::swap(c.earliest_days, *c.latest_days);
    if (*c.latest_days > furthest) c.latest_days.reset();
    return c;
}

// From n, span, slope, level, residuals' scatter and correlation; `xx` the times' sum of squares about their mean.
void judge(Trend& t, double xx, const ProcessLimits& limits) {
    const double n = t.n;
    const double r = std::clamp(t.correlation, 0.0, kMostCorrelated);
    const double by =
        t_quantile(n - 2, kBelowHigh95) * t.residual_s / std::sqrt(xx) * std::sqrt((1 + r) / (1 - r));
    t.slope_limits = {t.slope_per_day - by, t.slope_per_day + by};
    // A scatter that is rounding alone is no slope.
    t.significant = !t.slope_limits.contains(0) && std::abs(t.slope_per_day) * t.span_days >
                                                       kRoundedScatter * std::max(1.0, std::abs(t.level));
    if (t.significant) t.crossing = crossing_of(t, limits);
}

}  // namespace

Expected<std::optional<Trend>> trend_of(std::span<const double> days, std::span<const double> values,
                                        const ProcessLimits& limits) {
    if (days.size() != values.size())
        return input_error(Text("{} times and {} values", days.size(), values.size()), "trend");
    for (std::size_t i = 0; i < days.size(); ++i) {
        if (!std::isfinite(days[i]) || !std::isfinite(values[i]))
            return input_error("a value or its time is not finite", "trend");
        if (i > 0 && days[i] < days[i - 1]) return input_error("the times go back", "trend");
    }
    if (days.size() < kTrendValues || !(days.back() > days.front())) return std::optional<Trend>();
    Trend t;
    t.n = static_cast<int>(days.size());
    t.span_days = days.back() - days.front();
    const double n = t.n;
    double at = 0, mean = 0;
    for (std::size_t i = 0; i < days.size(); ++i) {
        at += (days[i] - days.back()) / n;
        mean += values[i] / n;
    }
    double xx = 0, xy = 0;
    for (std::size_t i = 0; i < days.size(); ++i) {
        const double x = days[i] - days.back() - at;
        xx += x * x;
        xy += x * (values[i] - mean);
    }
    t.slope_per_day = xy / xx;
    t.level = mean - t.slope_per_day * at;
    std::vector<double> residuals;
    double squares = 0;
    for (std::size_t i = 0; i < days.size(); ++i) {
        residuals.push_back(values[i] - t.level - t.slope_per_day * (days[i] - days.back()));
        squares += residuals.back() * residuals.back();
    }
    t.residual_s = std::sqrt(squares / (n - 2));
    t.correlation = lag1_correlation(residuals);
    judge(t, xx, limits);
    return std::optional(t);
}

std::optional<Trend> trend_of(const RowSums& sums, const ProcessLimits& limits) {
    const double span = sums.last.z() - sums.first.z();
    if (sums.values() < kTrendValues || !(span > 0)) return std::nullopt;
    Trend t;
    t.n = static_cast<int>(sums.values());
    t.span_days = span;
    const double n = t.n;
    const double mean_day = sums.own(0, 2) / n;
    const double xx = sums.squares({-mean_day, 0, 1});
    if (!(xx > 0)) return std::nullopt;
    const Eigen::Vector3d off_mean(-sums.mean(), 1, 0), off_day(-mean_day, 0, 1);
    t.slope_per_day = off_day.dot(sums.own * off_mean) / xx;
    t.level = sums.mean() + t.slope_per_day * (sums.last.z() - mean_day);
    const Eigen::Vector3d residual(-(sums.mean() - t.slope_per_day * mean_day), 1, -t.slope_per_day);
    const double squares = std::max(0.0, sums.squares(residual));
    t.residual_s = std::sqrt(squares / (n - 2));
    if (squares > 0) t.correlation = sums.products(residual) / squares;
    judge(t, xx, limits);
    return t;
}

}  // namespace seamwright
