#include "core/acceptance/process_uncertainty.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/acceptance/distributions.h"
#include "core/acceptance/levels.h"
#include "core/acceptance/type1.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr double kLeastDegrees = 1e-9;  // of a term that is next to nothing

struct Standard {
    std::vector<double> biases;
};

// u with the 95 % limits of its random terms; those that are certain stay.
void combine(const std::vector<UncertaintyTerm>& terms, bool UncertaintyTerm::*counts, double& u_mm,
             Interval& limits) {
    double square = 0;
    std::vector<MeanSquare> squares;
    for (const UncertaintyTerm& t : terms) {
        if (!(t.*counts)) continue;
        square += t.u_mm * t.u_mm;
        if (std::isfinite(t.degrees)) squares.push_back({t.u_mm * t.u_mm, t.degrees});
    }
    double random = 0;
    for (const MeanSquare& s : squares) random += s.value;
    u_mm = std::sqrt(square);
    limits = {u_mm, u_mm};
    if (!(random > 0)) return;
    // A squared bias near 0 has next to no degrees of freedom of its own and next to no weight.
    const Interval of_random = sigma_limits(std::sqrt(random), std::max(1.0, satterthwaite_degrees(squares)));
    const double certain = square - random;
    limits = {std::sqrt(certain + of_random.low * of_random.low),
              std::sqrt(certain + of_random.high * of_random.high)};
}

}  // namespace

Expected<ProcessUncertainty> process_uncertainty(std::span<const StudyValue> references,
                                                 const std::optional<Type3>& production,
                                                 const ProcessSettings& settings) {
    const double tolerance = settings.upper_mm - settings.lower_mm;
    SEAM_OK(check_positive(tolerance, "tolerance"));
    for (const auto& [value, word] : {std::pair{settings.reference_u_mm, "uncertainty of the reference"},
                                      {settings.resolution_mm, "resolution"}})
        if (value != 0) SEAM_OK(check_positive(value, word));
    std::map<std::string, Standard> parts;
    for (const StudyValue& v : references) {
        if (!v.reference_mm) continue;
        if (!std::isfinite(v.value_mm) || !std::isfinite(*v.reference_mm))
            return input_error(Text("part {}, run {} is not finite", v.part, v.run), "vda5");
        parts[v.part].biases.push_back(v.value_mm - *v.reference_mm);
    }
    std::erase_if(parts, [](const auto& p) { return p.second.biases.size() < kStandardValues; });
    if (parts.empty())
        return input_error("no part with a reference was measured often enough", "vda5",
                           Text("measure one at least {} times, better {}", kStandardValues, kProcessValues));
    ProcessUncertainty r;
    r.type3 = production.has_value();
    double squares = 0, degrees = 0, worst_n = 1;
    for (const auto& [name, part] : parts) {
        const Moments m = moments(part.biases);
        const double n = static_cast<double>(part.biases.size());
        r.reference_values += static_cast<int>(n);
        squares += (n - 1) * m.s * m.s;
        degrees += n - 1;
        if (std::abs(m.mean) >= std::abs(r.bias_mm)) r.bias_mm = m.mean, worst_n = n;
    }
    const double s = std::sqrt(squares / degrees);
    if (s <= kRoundedScatter)
        return input_error("all values are equal, so they tell nothing of the scatter", "vda5",
                           "give them with more digits");
    const double b2 = r.bias_mm * r.bias_mm, of_mean = s * s / worst_n;
    const double bias_degrees = b2 * b2 / (2 * b2 * of_mean + of_mean * of_mean);
    const double u_re = settings.resolution_mm / std::sqrt(12.0);
    const double ev = production ? production->ev_mm : 0;
    const bool re_in_ms = u_re > s, re_in_mp = u_re > std::max(s, ev), evo_in_mp = !re_in_mp && ev > s;
    r.terms.push_back({"u_CAL", settings.reference_u_mm, kInfinity, true, true});
    r.terms.push_back(
        {"u_BI", std::abs(r.bias_mm) / std::sqrt(3.0), std::max(kLeastDegrees, bias_degrees), true, true});
    r.terms.push_back({"u_RE", u_re, kInfinity, re_in_ms, re_in_mp});
    r.terms.push_back({"u_EVR", s, degrees, !re_in_ms, !re_in_mp && !evo_in_mp});
    if (production) {
        double within = 0, rehang = 0;
        const AnovaRow* of_rehang = nullptr;
        for (const AnovaRow& row : production->anova) {
            if (row.source == std::string("repeat")) within = row.df;
            if (row.source == std::string("rehang")) of_rehang = &row;
        }
        r.terms.push_back({"u_EVO", ev, within, false, evo_in_mp});
        if (of_rehang) {
            const double n = production->runs, ev2 = ev * ev;
            const MeanSquare differences[] = {{of_rehang->ms / n, of_rehang->df}, {-ev2 / n, within}};
            rehang = std::max(kLeastDegrees, satterthwaite_degrees(differences));
            r.terms.push_back({"u_REH", production->rehang_mm, rehang, false, true});
        }
    }
    combine(r.terms, &UncertaintyTerm::in_system, r.u_ms_mm, r.u_ms_limits);
    combine(r.terms, &UncertaintyTerm::in_process, r.u_mp_mm, r.u_mp_limits);
    const auto q = [&](double u) { return 100 * 2 * (2 * u) / tolerance; };
    r.q_ms_percent = q(r.u_ms_mm);
    r.q_mp_percent = q(r.u_mp_mm);
    r.q_ms_limits = {q(r.u_ms_limits.low), q(r.u_ms_limits.high)};
    r.q_mp_limits = {q(r.u_mp_limits.low), q(r.u_mp_limits.high)};
    r.conformity_zone = {settings.lower_mm + 2 * r.u_mp_mm, settings.upper_mm - 2 * r.u_mp_mm};
    r.conformity_low_limits = {settings.lower_mm + 2 * r.u_mp_limits.low,
                               settings.lower_mm + 2 * r.u_mp_limits.high};
    r.conformity_high_limits = {settings.upper_mm - 2 * r.u_mp_limits.high,
                                settings.upper_mm - 2 * r.u_mp_limits.low};
    r.verdict = r.q_ms_percent > settings.system_percent || r.q_mp_percent > settings.process_percent
                    ? AcceptanceVerdict::not_ok
                : r.reference_values < kProcessValues ? AcceptanceVerdict::too_little_data
                                                      : AcceptanceVerdict::ok;
    return r;
}

}  // namespace seamwright
