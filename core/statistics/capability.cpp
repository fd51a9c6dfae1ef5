#include "core/statistics/capability.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/acceptance/distributions.h"
#include "core/acceptance/levels.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

// Shares of a normal variable below 3 standard deviations to either side of its mean.
constexpr double kBelowLow3Sigma = 0.00135, kBelowHigh3Sigma = 0.99865;
constexpr double kLeastChance = 1e-300;  // whose logarithm is taken
constexpr double kSumsRounding = 1e-15;  // of the sum of squares about 0

struct Effective {
    double n = 0, degrees = 0;
};

Capability capability(const ProcessLimits& limits, double mean, double sigma, const Effective& data) {
    Capability c;
    if (!(sigma > 0) || !limits.any() || data.degrees < 1) return c;
    if (limits.lower && limits.upper) {
        const double width = *limits.upper - *limits.lower;
        const Interval of_sigma = sigma_limits(sigma, data.degrees);
        c.spread = Index{width / (6 * sigma), {width / (6 * of_sigma.high), width / (6 * of_sigma.low)}};
    }
    double side = std::numeric_limits<double>::infinity();
    if (limits.upper) side = std::min(side, *limits.upper - mean);
    if (limits.lower) side = std::min(side, mean - *limits.lower);
    const double k = side / (3 * sigma);
    const double by = kNormal95 * std::sqrt(1 / (9 * data.n) + k * k / (2 * data.degrees));
    c.worst_side = Index{k, {k - by, k + by}};
    return c;
}

double quantile(const std::vector<double>& sorted, double p) {
    const double at = p * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(at);
    const std::size_t above = std::min(below + 1, sorted.size() - 1);
    return sorted[below] + (at - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

std::optional<Capability> quantile_capability(const ProcessLimits& limits,
                                              const std::vector<double>& sorted) {
    if (sorted.size() < kQuantileValues || !limits.any()) return std::nullopt;
    const double low = quantile(sorted, kBelowLow3Sigma), middle = quantile(sorted, 0.5),
                 high = quantile(sorted, kBelowHigh3Sigma);
    if (!(low < middle && middle < high)) return std::nullopt;
    Capability c;
    if (limits.lower && limits.upper) c.spread = Index{(*limits.upper - *limits.lower) / (high - low), {}};
    double side = std::numeric_limits<double>::infinity();
    if (limits.upper) side = std::min(side, (*limits.upper - middle) / (high - middle));
    if (limits.lower) side = std::min(side, (middle - *limits.lower) / (middle - low));
    c.worst_side = Index{side, {}};
    return c;
}

Expected<void> check_limits(const ProcessLimits& limits) {
    for (const auto& limit : {limits.lower, limits.upper})
        if (limit && !std::isfinite(*limit)) return input_error("a limit is not finite", "statistics");
    if (limits.lower && limits.upper && !(*limits.lower < *limits.upper))
        return input_error("the lower limit is not below the upper one", "statistics");
    return {};
}

// From n, mean, s, sigma_within and the correlation.
void say_capability(ProcessSummary& r, const ProcessLimits& limits) {
    const double n = r.n;
    r.correlated = r.correlation > 2 / std::sqrt(n);
    const double c = r.correlated ? r.correlation : 0;
    const double alike = (1 - c * c) / (1 + c * c);
    Effective total{n * (1 - c) / (1 + c), (n - 1) * alike}, within = total;
    constexpr double kMovingRanges = 2 * std::numbers::pi / 3 + std::numbers::sqrt3 - 3;
    within.degrees = (n - 1) / (2 * kMovingRanges) * alike;
    const double by = t_quantile(std::max(1.0, total.n - 1), kBelowHigh95) * r.s / std::sqrt(total.n);
    r.mean_limits = {r.mean - by, r.mean + by};
    r.total = capability(limits, r.mean, r.s, total);
    r.within = capability(limits, r.mean, r.sigma_within, within);
}

}  // namespace

double lag1_correlation(std::span<const double> values) {
    if (values.size() < 3) return 0;
    const Moments m = moments(values);
    if (all_equal(m)) return 0;
    double together = 0, squares = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        squares += (values[i] - m.mean) * (values[i] - m.mean);
        if (i > 0) together += (values[i] - m.mean) * (values[i - 1] - m.mean);
    }
    return together / squares;
}

std::optional<double> anderson_darling_p(std::span<const double> values) {
    const Moments m = values.empty() ? Moments{} : moments(values);
    if (values.size() < 8 || all_equal(m)) return std::nullopt;
    std::vector<double> sorted(values.begin(), values.end());
    std::sort(sorted.begin(), sorted.end());
    const double n = static_cast<double>(sorted.size());
    double sum = 0;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        // Both tails by the lower one: 1 - cdf(z) loses all its digits beyond z = 8.
        const double lower = normal_cdf((sorted[i] - m.mean) / m.s);
        const double upper = normal_cdf(-(sorted[sorted.size() - 1 - i] - m.mean) / m.s);
        sum += (2 * static_cast<double>(i) + 1) *
               (std::log(std::max(lower, kLeastChance)) + std::log(std::max(upper, kLeastChance)));
    }
    const double a = (-n - sum / n) * (1 + 0.75 / n + 2.25 / (n * n));
    if (a >= 10) return 0.0;  // the fit turns round beyond 13
    const double p = a >= 0.6    ? std::exp(1.2937 - 5.709 * a + 0.0186 * a * a)
                     : a >= 0.34 ? std::exp(0.9177 - 4.279 * a - 1.38 * a * a)
                     : a >= 0.2  ? 1 - std::exp(-8.318 + 42.796 * a - 59.938 * a * a)
                                 : 1 - std::exp(-13.436 + 101.14 * a - 223.73 * a * a);
    return std::clamp(p, 0.0, 1.0);
}

Expected<ProcessSummary> summarise_process(std::span<const double> values, const ProcessLimits& limits) {
    if (values.empty()) return input_error("there are no values", "statistics");
    if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
        return input_error("a value is not finite", "statistics");
    SEAM_OK(check_limits(limits));
    ProcessSummary r;
    r.n = static_cast<int>(values.size());
    std::vector<double> sorted(values.begin(), values.end());
    std::sort(sorted.begin(), sorted.end());
    r.lowest = sorted.front();
    r.highest = sorted.back();
    r.median = quantile(sorted, 0.5);
    for (const double v : values)
        r.beyond += (limits.lower && v < *limits.lower) || (limits.upper && v > *limits.upper);
    if (r.n == 1) {
        r.mean = values.front();
        r.mean_limits = {-kInfinity, kInfinity};
        return r;
    }
    const Moments m = moments(values);
    r.mean = m.mean;
    r.s = all_equal(m) ? 0 : m.s;
    for (std::size_t i = 1; i < values.size(); ++i) r.sigma_within += std::abs(values[i] - values[i - 1]);
    r.sigma_within = r.s > 0 ? r.sigma_within / (r.n - 1) / kMeanRange : 0;
    r.correlation = lag1_correlation(values);
    r.normal_p = anderson_darling_p(values);
    say_capability(r, limits);
    r.by_quantiles = quantile_capability(limits, sorted);
    return r;
}

Expected<ProcessSummary> summarise_sums(const RowSums& sums, const ProcessLimits& limits) {
    if (sums.values() < 1) return input_error("there are no values", "statistics");
    if (!sums.own.allFinite() || !sums.pairs.allFinite() || !std::isfinite(sums.ranges))
        return input_error("a value is not finite", "statistics");
    SEAM_OK(check_limits(limits));
    ProcessSummary r;
    r.n = static_cast<int>(sums.values());
    r.lowest = sums.lowest;
    r.highest = sums.highest;
    r.mean = sums.mean();
    if (r.n == 1) {
        r.mean_limits = {-kInfinity, kInfinity};
        return r;
    }
    const Eigen::Vector3d off_mean(-r.mean, 1, 0);
    const double squares = std::max(0.0, sums.squares(off_mean));
    // No scatter but the sums' own rounding.
    const bool equal = sums.lowest == sums.highest || squares <= kSumsRounding * sums.own(1, 1);
    if (!equal) {
        r.s = std::sqrt(squares / (r.n - 1));
        if (sums.neighbours() > 0)
            r.sigma_within = sums.ranges / static_cast<double>(sums.neighbours()) / kMeanRange;
        if (r.n > 2) r.correlation = sums.products(off_mean) / squares;
    }
    say_capability(r, limits);
    return r;
}

}  // namespace seamwright
