#pragma once
// What a row of production values says of its process against limits (ISO 22514-2; AIAG SPC 2nd edition).
//     Pp  = (U - L) / (6 s)                 Ppk = min(U - mean, mean - L) / (3 s)          s of all values
//     Cp, Cpk the same with sigma, the scatter from part to part: mean moving range / 1.128. A process that
//     drifts or jumps has a larger s than sigma, so Pp says what was delivered and Cp what a calm process would.
// With one limit alone there is no Pp or Cp, and the side that has none does not count.
//
// Limits (95 %, two-sided). Of Pp by chi-square, of Ppk by Bissell (1990), var = 1 / (9 n) + Ppk^2 / (2 nu), with
// nu = n - 1 for s and nu = (n - 1) / (2 c), c = 2 pi / 3 + sqrt(3) - 3, for moving ranges (Hoel 1946). Values that
// follow each other alike hold less than their number says: where the lag-1 correlation r is beyond chance
// (r > 2 / sqrt(n)), n becomes n (1 - r) / (1 + r) and nu becomes nu (1 - r^2) / (1 + r^2) (first order autoregression);
// moving ranges are too small then, by sqrt(1 - r), and Cp flatters.
//
// Indices are stated as of a normal distribution. Anderson and Darling's test with estimated mean and s (Stephens
// 1974, p by D'Agostino and Stephens 1986) says whether it is one. From 1000 values on Pp and Ppk come by quantiles
// too, which ask for none:
//     (U - L) / (q_99.865 - q_0.135),    min((U - q_50) / (q_99.865 - q_50), (q_50 - L) / (q_50 - q_0.135)).

#include <optional>
#include <span>

#include "core/acceptance/acceptance.h"
#include "core/error.h"
#include "core/statistics/row_sums.h"

namespace seamwright {

inline constexpr int kCapabilityValues = 50;  // with fewer the indices are no statement, only a hint
inline constexpr int kQuantileValues = 1000;  // for quantiles of 0.135 %
inline constexpr double kNormalityLevel = 0.005;

struct ProcessLimits {
    std::optional<double> lower, upper;
    bool any() const { return lower || upper; }
};

struct Index {
    double value = 0;
    Interval limits;  // 95 %
};
struct Capability {
    std::optional<Index> spread;      // Cp or Pp; none without both limits
    std::optional<Index> worst_side;  // Cpk or Ppk; none without limits
};

struct ProcessSummary {
    int n = 0;
    double mean = 0, s = 0;
    Interval mean_limits;  // 95 %, with the correlation
    double lowest = 0, highest = 0;
    double median = 0;
    double sigma_within = 0;         // from moving ranges
    int beyond = 0;                  // values beyond the limits
    double correlation = 0;          // lag 1
    bool correlated = false;         // beyond chance, and positive
    std::optional<double> normal_p;  // of Anderson-Darling; none with fewer than 8 values or no scatter
    bool not_normal() const { return normal_p && *normal_p < kNormalityLevel; }
    Capability total, within;                // P and C
    std::optional<Capability> by_quantiles;  // without confidence limits: `limits` is 0, 0
};

// Values in the order of time. Error (input): none, not finite, limits that are not finite or out of order.
Expected<ProcessSummary> summarise_process(std::span<const double> values, const ProcessLimits& limits);

// The same from the sums of a row, or of several rows that have no neighbours in common. What only the values
// themselves tell is not in it: `beyond`, median, normality and quantiles. Error (input): no value, sums that are
// not finite, limits as above.
Expected<ProcessSummary> summarise_sums(const RowSums& sums, const ProcessLimits& limits);

// Of the row's neighbours; 0 with fewer than 3 values or without scatter.
double lag1_correlation(std::span<const double> values);
// p of the hypothesis that the values are normal; none with fewer than 8 values or without scatter.
std::optional<double> anderson_darling_p(std::span<const double> values);

}  // namespace seamwright
