#pragma once
// Stability: the same part measured over time, as a chart of subgroup means and standard deviations (Shewhart;
// ISO 7870-2), and Nelson's rules (1984) on the means.
//     c4 = sqrt(2 / (n - 1)) Gamma(n / 2) / Gamma((n - 1) / 2),    sigma = mean(s) / c4
//     means: centre +- 3 sigma / sqrt(n),   s: mean(s) (1 -+ 3 sqrt(1 - c4^2) / c4), not below 0
// A subgroup of one value: its chart is that of the values, sigma = mean moving range / 1.128, and the s chart
// is that of the moving ranges (0 to 3.267 times their mean).
// Rules: 1 one point beyond 3 sigma; 2 nine in a row on one side; 3 six in a row rising or falling; 4 fourteen
// alternating; 5 two of three beyond 2 sigma on one side; 6 four of five beyond 1 sigma on one side; 7 fifteen
// in a row within 1 sigma; 8 eight in a row beyond 1 sigma on either side. The point that completes a pattern
// is named. On the s chart rule 1 alone.
// Of 25 means of a process that stands still, 6 % hold a point of rule 1 and a quarter one of any rule: rule 1
// refuses, the others ask for a look (conditional).
// Limits of the centre: Student's t over the subgroup means, exact for independent ones.

#include <span>
#include <vector>

#include "core/acceptance/acceptance.h"
#include "core/error.h"

namespace seamwright {

inline constexpr int kStabilitySubgroups = 20;  // fewer give limits that do not hold

struct Subgroup {
    long run = 0;  // the last of its runs
    std::vector<double> values_mm;
};

struct StabilityAlarm {
    long run = 0;
    int rule = 0;
    bool spread = false;  // on the s chart
    std::size_t subgroup = 0;
};

struct Stability {
    int size = 0;  // of a subgroup
    double centre_mm = 0, sigma_mm = 0, mean_s_mm = 0;
    Interval centre_limits;              // 95 % confidence
    Interval mean_chart, s_chart;        // control limits
    std::vector<double> means_mm, s_mm;  // of the subgroups; s of single values: moving ranges, the first 0
    std::vector<StabilityAlarm> alarms;  // by subgroup, then by rule
    AcceptanceVerdict verdict = AcceptanceVerdict::not_ok;
};

// Error (input): fewer than 2 subgroups, subgroups of different sizes, values not finite or without scatter.
Expected<Stability> stability_study(std::span<const Subgroup> subgroups);

// Subgroups of one part: where a run holds several values (of rehangs) each run is one; else `size`
// runs that follow each other, a rest at the end being left out (`left_out` values). Runs ascending.
// Error (input): runs of different sizes, a size below 1.
struct Subgroups {
    std::vector<Subgroup> groups;
    int left_out = 0;
};
Expected<Subgroups> subgroups_of(std::span<const StudyValue> values, int size);

double c4(int n);
// Points of `means` that complete a pattern, with centre and sigma of a mean given.
std::vector<StabilityAlarm> nelson_rules(std::span<const double> means, double centre, double sigma);

}  // namespace seamwright
