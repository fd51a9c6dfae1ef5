#include "core/acceptance/correlation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/acceptance/distributions.h"
#include "core/acceptance/levels.h"

namespace seamwright {

Expected<Correlation> correlation_study(std::span<const StudyValue> values) {
    struct Sums {
        double value = 0, reference = 0, n = 0;
    };
    std::map<std::string, Sums> parts;
    for (const StudyValue& v : values) {
        if (!v.reference_mm) continue;
        if (!std::isfinite(v.value_mm) || !std::isfinite(*v.reference_mm))
            return input_error(Text("part {}, run {} is not finite", v.part, v.run), "correlation");
        Sums& s = parts[v.part];
        s.value += v.value_mm;
        s.reference += *v.reference_mm;
        ++s.n;
    }
    if (parts.size() < 3)
        return input_error(Text("{} part(s) with a reference", parts.size()), "correlation",
                           Text("measure at least {} parts on both", kCorrelationPairs));
    Correlation r;
    std::vector<double> x, y, differences;
    for (const auto& [part, s] : parts) {
        r.pairs.push_back({part, s.value / s.n, s.reference / s.n});
        x.push_back(r.pairs.back().reference_mm);
        y.push_back(r.pairs.back().value_mm);
        differences.push_back(y.back() - x.back());
    }
    if (all_equal(moments(x)))
        return input_error("the references are all equal", "correlation", "take parts that differ");
    const Moments m = moments(differences);
    if (m.s <= kRoundedScatter)
        return input_error("all differences are equal, so they tell nothing of the scatter", "correlation",
                           "give the values with more digits");
    const double n = static_cast<double>(differences.size()), by = m.s / std::sqrt(n);
    r.offset_mm = m.mean;
    r.s_mm = m.s;
    r.offset_p = student_two_sided_p(n - 1, m.mean / by);
    const double t = t_quantile(n - 1, kBelowHigh95);
    r.offset_limits = {m.mean - t * by, m.mean + t * by};
    r.line = fit_line(x, y);
    r.r = std::copysign(std::sqrt(r.line.r2), r.line.slope);
    r.verdict = n < kCorrelationPairs ? AcceptanceVerdict::too_little_data
                : r.offset_limits.contains(0) && r.line.slope_limits.contains(1) ? AcceptanceVerdict::ok
                                                                                 : AcceptanceVerdict::not_ok;
    return r;
}

}  // namespace seamwright
