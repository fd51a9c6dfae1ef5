#include "core/acceptance/linearity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>

#include "core/acceptance/distributions.h"
#include "core/acceptance/levels.h"

namespace seamwright {

Line fit_line(std::span<const double> x, std::span<const double> y) {
    assert(x.size() == y.size() && x.size() >= 3);
    Line l;
    l.n = static_cast<int>(x.size());
    const double n = l.n;
    l.mean_x = moments(x).mean;
    const double mean_y = moments(y).mean;
    double xy = 0, yy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double dx = x[i] - l.mean_x, dy = y[i] - mean_y;
        l.sum_x2 += dx * dx;
        xy += dx * dy;
        yy += dy * dy;
    }
    assert(l.sum_x2 > 0);
    l.slope = xy / l.sum_x2;
    l.intercept = mean_y - l.slope * l.mean_x;
    double rest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) rest += std::pow(y[i] - l.at(x[i]), 2);
    l.s = std::sqrt(rest / (n - 2));
    l.r2 = yy > 0 ? std::clamp(1 - rest / yy, 0.0, 1.0) : 1;
    const double u_slope = l.s / std::sqrt(l.sum_x2),
                 u_intercept = l.s * std::sqrt(1 / n + l.mean_x * l.mean_x / l.sum_x2);
    l.t_slope = l.slope / u_slope;
    l.t_intercept = l.intercept / u_intercept;
    if (l.s > 0) {
        l.p_slope = student_two_sided_p(n - 2, l.t_slope);
        l.p_intercept = student_two_sided_p(n - 2, l.t_intercept);
    }
    const double t = t_quantile(n - 2, kBelowHigh95);
    l.slope_limits = {l.slope - t * u_slope, l.slope + t * u_slope};
    l.intercept_limits = {l.intercept - t * u_intercept, l.intercept + t * u_intercept};
    return l;
}

Interval Line::band(double x) const {
    const double by =
        t_quantile(n - 2, kBelowHigh95) * s * std::sqrt(1.0 / n + (x - mean_x) * (x - mean_x) / sum_x2);
    return {at(x) - by, at(x) + by};
}

Expected<Linearity> linearity_study(std::span<const StudyValue> values) {
    std::vector<double> x, bias;
    std::map<double, std::vector<double>> levels;
    for (const StudyValue& v : values) {
        if (!v.reference_mm)
            return input_error(Text("part {}, run {} has no reference", v.part, v.run), "linearity",
                               "give the column reference for every value");
        if (!std::isfinite(v.value_mm) || !std::isfinite(*v.reference_mm))
            return input_error(Text("part {}, run {} is not finite", v.part, v.run), "linearity");
        x.push_back(*v.reference_mm);
        bias.push_back(v.value_mm - *v.reference_mm);
        levels[x.back()].push_back(bias.back());
    }
    if (levels.size() < 2 || x.size() < 3)
        return input_error(Text("{} value(s) at {} different reference(s)", x.size(), levels.size()),
                           "linearity",
                           Text("measure {} levels {} times each", kLinearityLevels, kLinearityRepeats));
    Linearity r;
    r.line = fit_line(x, bias);
    if (r.line.s <= kRoundedScatter)
        return input_error("the values lie on a line exactly, so they tell nothing of the scatter",
                           "linearity", "give them with more digits");
    std::size_t most = 0;
    for (const auto& [reference, biases] : levels) {
        most = std::max(most, biases.size());
        r.levels.push_back({reference, static_cast<int>(biases.size()), moments(biases).mean,
                            r.line.at(reference), r.line.band(reference)});
    }
    const bool enough = levels.size() >= kLinearityLevels &&
                        x.size() >= kLinearityLevels * kLinearityRepeats && 2 * most <= x.size();
    const double from = levels.begin()->first, to = levels.rbegin()->first;
    constexpr int kSteps = 200;
    r.zero_inside = true;
    for (int i = 0; i <= kSteps; ++i)
        r.zero_inside = r.zero_inside && r.line.band(from + (to - from) * i / kSteps).contains(0);
    r.verdict = !enough         ? AcceptanceVerdict::too_little_data
                : r.zero_inside ? AcceptanceVerdict::ok
                                : AcceptanceVerdict::not_ok;
    return r;
}

}  // namespace seamwright
