#include <cmath>
#include <limits>

#include "widgets/charts/histogram.h"

namespace seamwright {

ShownCapability capability(const std::vector<double>& values, const TrendLimits& limits) {
    ShownCapability result;
    double sum = 0;
    for (const double v : values)
        if (std::isfinite(v)) {
            sum += v;
            ++result.count;
        }
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    result.mean = result.count > 0 ? sum / result.count : kNone;
    result.standard_deviation = kNone;
    if (result.count < 2) return result;
    double square = 0;
    for (const double v : values)
        if (std::isfinite(v)) square += (v - result.mean) * (v - result.mean);
    const double s = result.standard_deviation = std::sqrt(square / (result.count - 1));
    if (!(s > 0)) return result;
    if (limits.lower && limits.upper) result.cp = (*limits.upper - *limits.lower) / (6 * s);
    if (limits.upper) result.cpk = (*limits.upper - result.mean) / (3 * s);
    if (limits.lower) {
        const double below = (result.mean - *limits.lower) / (3 * s);
        result.cpk = result.cpk ? std::min(*result.cpk, below) : below;
    }
    return result;
}

}  // namespace seamwright
