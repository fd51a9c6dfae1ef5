#pragma once
// Whether values wander with time, how fast, and when they would leave their limits.
//
// A straight line by least squares, value = level + slope (day - last day). Its slope's 95 % limits are Student's t, the
// standard error being multiplied by sqrt((1 + r) / (1 - r)) where the residuals' lag-1 correlation r is positive. A
// trend is one where those limits leave out 0.
//
// The crossing is where the line, not the single value, meets the limit that it heads for: (limit - level) / slope days
// after the last value, and with the slope's limits the earliest and latest day. It is told no further ahead than
// kTrendAhead times the time that was seen: a line says nothing of the year after next.

#include <optional>
#include <span>

#include "core/statistics/capability.h"

namespace seamwright {

inline constexpr double kTrendAhead = 3;
inline constexpr int kTrendValues = 10;

struct Crossing {
    bool upper = false;  // which limit
    double limit = 0;
    // After the last value; negative: the line is beyond already. `latest` none: the slower slope does not
    // reach it within what can be told.
    double days = 0, earliest_days = 0;
    std::optional<double> latest_days;
};
struct Trend {
    int n = 0;
    double span_days = 0;
    double slope_per_day = 0;
    Interval slope_limits;
    double level = 0;  // of the line at the last value
    double residual_s = 0;
    double correlation = 0;  // of the residuals, lag 1
    bool significant = false;
    std::optional<Crossing> crossing;  // of a significant one, within what can be told
};

// `days` ascending or equal, of any origin. nullopt: fewer than kTrendValues values, or no time between them.
// Error (input): unequal lengths, not finite, days that go back.
Expected<std::optional<Trend>> trend_of(std::span<const double> days, std::span<const double> values,
                                        const ProcessLimits& limits);
// The same from sums whose times are days; of several rows, residuals are followed within each.
std::optional<Trend> trend_of(const RowSums& sums, const ProcessLimits& limits);

}  // namespace seamwright
