#include "core/acceptance/type1.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/acceptance/distributions.h"
#include "core/acceptance/levels.h"

namespace seamwright {
namespace {

// The deltas with P(T(delta) <= t) = 0.975 and 0.025, T noncentral t: T = (Z + delta) / sqrt(U / nu), so that
// P(T <= t) is the mean of Phi(t sqrt(u / nu) - delta) over chi-square u.
Interval noncentralities(double degrees, double t) {
    std::vector<double> at;
    constexpr int kNodes = 100;
    for (int i = 0; i < kNodes; ++i)
        at.push_back(t * std::sqrt(chi_square_quantile(degrees, (i + 0.5) / kNodes) / degrees));
    const auto [least, most] = std::minmax_element(at.begin(), at.end());
    const auto delta = [&, from = *least - 9, to = *most + 9](double probability) {
        double low = from, high = to;
        for (int step = 0; step < 40; ++step) {
            const double middle = (low + high) / 2;
            double sum = 0;
            for (const double a : at) sum += normal_cdf(a - middle);
            (sum / kNodes > probability ? low : high) = middle;
        }
        return (low + high) / 2;
    };
    return {delta(kBelowHigh95), delta(kBelowLow95)};
}

}  // namespace

Expected<void> check_positive(double value, const char* word) {
    constexpr double kTooLarge = 1e6;
    if (std::isfinite(value) && value > 0 && value < kTooLarge) return {};
    return input_error(Text("the {} of {} is none", word, value), "", "give a positive number");
}

Expected<Type1> type1_study(std::span<const double> values_mm, double reference_mm,
                            const Type1Settings& settings) {
    for (const auto& [value, word] : {std::pair{settings.tolerance_mm, "tolerance"},
                                      {settings.share, "share of the tolerance"},
                                      {settings.width, "width"},
                                      {settings.required, "limit of Cg and Cgk"},
                                      {settings.required_cgk.value_or(1), "limit of Cgk"}})
        SEAM_OK(check_positive(value, word));
    if (values_mm.size() < 2)
        return input_error(Text("{} value(s) of the reference part", values_mm.size()), "type 1",
                           Text("measure it at least {} times", kType1Values));
    if (!std::isfinite(reference_mm) ||
        !std::all_of(values_mm.begin(), values_mm.end(), [](double v) { return std::isfinite(v); }))
        return input_error("a value is not finite", "type 1");
    const Moments m = moments(values_mm);
    if (all_equal(m))
        return input_error("all values are equal, so they tell nothing of the scatter", "type 1",
                           "give them with more digits");
    Type1 r;
    r.n = static_cast<int>(values_mm.size());
    const double n = r.n, nu = n - 1, half = settings.share * settings.tolerance_mm / 2;
    r.mean_mm = m.mean;
    r.s_mm = m.s;
    r.reference_mm = reference_mm;
    r.bias_mm = m.mean - reference_mm;
    r.t = r.bias_mm * std::sqrt(n) / m.s;
    r.bias_p = student_two_sided_p(nu, r.t);
    r.cg = 2 * half / (settings.width * m.s);
    r.cgk = (half - std::abs(r.bias_mm)) / (settings.width / 2 * m.s);

    const double by = t_quantile(nu, kBelowHigh95) * m.s / std::sqrt(n);
    r.mean_limits = {r.mean_mm - by, r.mean_mm + by};
    r.bias_limits = {r.bias_mm - by, r.bias_mm + by};
    r.s_limits = sigma_limits(m.s, nu);
    r.cg_limits = {r.cg * m.s / r.s_limits.high, r.cg * m.s / r.s_limits.low};
    const double to_t = std::sqrt(n) * settings.width / 2;
    const Interval deltas = noncentralities(nu, to_t * r.cgk);
    r.cgk_limits = {deltas.low / to_t, deltas.high / to_t};
    const double required_cgk = settings.required_cgk.value_or(settings.required);
    r.verdict = r.n < kType1Values                                   ? AcceptanceVerdict::too_little_data
                : r.cg >= settings.required && r.cgk >= required_cgk ? AcceptanceVerdict::ok
                                                                     : AcceptanceVerdict::not_ok;
    return r;
}

}  // namespace seamwright
