#include "core/acceptance/stability.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/acceptance/distributions.h"
#include "core/acceptance/levels.h"

namespace seamwright {
namespace {

// How many of the last `window` points up to `at` hold; -1 where there are not as many.
template <class Holds>
int count_of_last(std::size_t at, std::size_t window, const Holds& holds) {
    if (at + 1 < window) return -1;
    int count = 0;
    for (std::size_t i = at + 1 - window; i <= at; ++i) count += holds(i);
    return count;
}

}  // namespace

double c4(int n) {
    return std::sqrt(2.0 / (n - 1)) * std::exp(std::lgamma(n / 2.0) - std::lgamma((n - 1) / 2.0));
}

std::vector<StabilityAlarm> nelson_rules(std::span<const double> means, double centre, double sigma) {
    std::vector<StabilityAlarm> out;
    const auto z = [&](std::size_t i) { return (means[i] - centre) / sigma; };
    const auto step = [&](std::size_t i) { return means[i] - means[i - 1]; };
    for (std::size_t i = 0; i < means.size(); ++i) {
        const auto fires = [&](int rule) { out.push_back({0, rule, false, i}); };
        const double side = z(i) < 0 ? -1 : 1;
        const auto beyond = [&](double limit) {
            return [&z, side, limit](std::size_t j) { return side * z(j) > limit; };
        };
        if (std::abs(z(i)) > 3) fires(1);
        if (count_of_last(i, 9, beyond(0)) == 9) fires(2);
        // Patterns of steps: n points are n - 1 steps.
        if (i >= 5 && (count_of_last(i, 5, [&](std::size_t j) { return step(j) > 0; }) == 5 ||
                       count_of_last(i, 5, [&](std::size_t j) { return step(j) < 0; }) == 5))
            fires(3);
        if (i >= 13 && count_of_last(i, 12, [&](std::size_t j) { return step(j) * step(j - 1) < 0; }) == 12)
            fires(4);
        if (beyond(2)(i) && count_of_last(i, 3, beyond(2)) >= 2) fires(5);
        if (beyond(1)(i) && count_of_last(i, 5, beyond(1)) >= 4) fires(6);
        if (count_of_last(i, 15, [&](std::size_t j) { return std::abs(z(j)) < 1; }) == 15) fires(7);
        if (count_of_last(i, 8, [&](std::size_t j) { return std::abs(z(j)) > 1; }) == 8) fires(8);
    }
    return out;
}

Expected<Subgroups> subgroups_of(std::span<const StudyValue> values, int size) {
    if (size < 1 || size > 1000)
        return input_error(Text("a subgroup of {} values is none", size), "stability", "give 1 to 1000");
    std::map<long, std::vector<double>> runs;
    for (const StudyValue& v : values) runs[v.run].push_back(v.value_mm);
    Subgroups out;
    if (runs.empty()) return out;
    const std::size_t in_run = runs.begin()->second.size();
    for (const auto& [run, of_run] : runs)
        if (of_run.size() != in_run)
            return input_error(Text("run {} holds {} values and run {} holds {}", runs.begin()->first, in_run,
                                    run, of_run.size()),
                               "stability", "measure as many in every run");
    const std::size_t wanted = in_run > 1 ? in_run : static_cast<std::size_t>(size);
    Subgroup group;
    for (const auto& [run, of_run] : runs) {
        group.run = run;
        group.values_mm.insert(group.values_mm.end(), of_run.begin(), of_run.end());
        if (group.values_mm.size() < wanted) continue;
        out.groups.push_back(std::move(group));
        group = {};
    }
    out.left_out = static_cast<int>(group.values_mm.size());
    return out;
}

Expected<Stability> stability_study(std::span<const Subgroup> subgroups) {
    if (subgroups.size() < 2)
        return input_error(Text("{} subgroup(s)", subgroups.size()), "stability",
                           Text("measure at least {} subgroups", kStabilitySubgroups));
    Stability r;
    r.size = static_cast<int>(subgroups.front().values_mm.size());
    for (const Subgroup& g : subgroups) {
        if (g.values_mm.empty() || static_cast<int>(g.values_mm.size()) != r.size)
            return input_error(Text("the subgroup of run {} holds {} values where others hold {}", g.run,
                                    g.values_mm.size(), r.size),
                               "stability", "measure as many in every subgroup");
        if (!std::all_of(g.values_mm.begin(), g.values_mm.end(), [](double v) { return std::isfinite(v); }))
            return input_error(Text("a value of run {} is not finite", g.run), "stability");
        const Moments m = moments(g.values_mm);
        r.s_mm.push_back(r.size > 1 ? m.s : r.means_mm.empty() ? 0.0 : std::abs(m.mean - r.means_mm.back()));
        r.means_mm.push_back(m.mean);
    }
    const Moments of_means = moments(r.means_mm);
    const double count = static_cast<double>(subgroups.size());
    r.centre_mm = of_means.mean;
    for (const double s : r.s_mm) r.mean_s_mm += s / (r.size > 1 ? count : count - 1);
    if (r.mean_s_mm <= kRoundedScatter * std::max(1.0, std::abs(r.centre_mm)))
        return input_error("the values of every subgroup are equal, so they tell nothing of the scatter",
                           "stability", "give them with more digits");
    double of_mean = 0;
    if (r.size > 1) {
        const double c = c4(r.size), by = 3 * std::sqrt(1 - c * c) / c;
        r.sigma_mm = r.mean_s_mm / c;
        of_mean = r.sigma_mm / std::sqrt(static_cast<double>(r.size));
        r.s_chart = {std::max(0.0, r.mean_s_mm * (1 - by)), r.mean_s_mm * (1 + by)};
    } else {
        r.sigma_mm = of_mean = r.mean_s_mm / kMeanRange;
        r.s_chart = {0, kMostRange * r.mean_s_mm};
    }
    r.mean_chart = {r.centre_mm - 3 * of_mean, r.centre_mm + 3 * of_mean};
    const double by = t_quantile(count - 1, kBelowHigh95) * of_means.s / std::sqrt(count);
    r.centre_limits = {r.centre_mm - by, r.centre_mm + by};

    r.alarms = nelson_rules(r.means_mm, r.centre_mm, of_mean);
    for (std::size_t i = r.size > 1 ? 0 : 1; i < r.s_mm.size(); ++i)
        if (!r.s_chart.contains(r.s_mm[i])) r.alarms.push_back({0, 1, true, i});
    std::stable_sort(r.alarms.begin(), r.alarms.end(), [](const StabilityAlarm& a, const StabilityAlarm& b) {
        return a.subgroup < b.subgroup;
    });
    bool beyond = false;
    for (StabilityAlarm& a : r.alarms) {
        a.run = subgroups[a.subgroup].run;
        beyond = beyond || a.rule == 1;
    }
    r.verdict = beyond                                   ? AcceptanceVerdict::not_ok
                : subgroups.size() < kStabilitySubgroups ? AcceptanceVerdict::too_little_data
                : r.alarms.empty()                       ? AcceptanceVerdict::ok
                                                         : AcceptanceVerdict::conditional;
    return r;
}

}  // namespace seamwright
