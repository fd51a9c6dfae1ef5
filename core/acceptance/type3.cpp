#include "core/acceptance/type3.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/acceptance/distributions.h"
#include "core/acceptance/levels.h"
#include "core/acceptance/type1.h"

namespace seamwright {
namespace {

constexpr double kCategories = 1.41;  // ndc = 1.41 PV / GRR
constexpr double kMostCategories = 1e6;

using Parts = std::map<std::string, std::map<std::string, std::vector<double>>>;

Expected<Parts> balanced(std::span<const StudyValue> values) {
    Parts parts;
    for (const StudyValue& v : values) {
        if (!std::isfinite(v.value_mm))
            return input_error(Text("the value of part {}, run {} is not finite", v.part, v.run), "type 3");
        parts[v.part][v.rehang].push_back(v.value_mm);
    }
    if (parts.size() < 2)
        return input_error(Text("the values are of {} part(s)", parts.size()), "type 3",
                           Text("measure at least {} parts", kType3Parts));
    const auto& [first_name, first] = *parts.begin();
    for (const auto& [name, rehangs] : parts) {
        if (rehangs.size() != first.size())
            return input_error(Text("part {} was hung {} times and part {} {} times", first_name,
                                    first.size(), name, rehangs.size()),
                               "type 3", "measure all parts alike, or leave out what some lack");
        for (const auto& [rehang, runs] : rehangs)
            if (runs.size() != first.begin()->second.size())
                return input_error(Text("part {} has {} runs and part {} has {}", first_name,
                                        first.begin()->second.size(), name, runs.size()),
                                   "type 3", "measure all parts alike, or leave out what some lack");
    }
    return parts;
}

std::vector<OtherPivots> offsets(const MeanSquare& below, double scale) {
    std::vector<OtherPivots> out;
    for (const double theta : pivots(below, 100)) out.push_back({theta, scale});
    return out;
}

Interval roots(const Interval& squares) {
    return {std::sqrt(squares.low), std::sqrt(squares.high)};
}

}  // namespace

Expected<Type3> type3_study(std::span<const StudyValue> values, const Type3Settings& settings) {
    for (const auto& [value, word] : {std::pair{settings.tolerance_mm, "tolerance"},
                                      {settings.width, "width"},
                                      {settings.accepted_percent, "limit of %GRR"},
                                      {settings.refused_percent, "limit of %GRR"},
                                      {static_cast<double>(settings.required_ndc), "limit of ndc"}})
        SEAM_OK(check_positive(value, word));
    SEAM_TRY(auto sorted, balanced(values));

    Type3 r;
    r.parts = static_cast<int>(sorted.size());
    r.rehangs = static_cast<int>(sorted.begin()->second.size());
    r.runs = static_cast<int>(sorted.begin()->second.begin()->second.size());
    if (r.rehangs == 1 && r.runs == 1)
        return input_error("every part was measured once", "type 3", "measure each at least twice");
    r.nested = r.rehangs > 1 && r.runs > 1;
    r.rehang_in_repeat = r.rehangs > 1 && r.runs == 1;

    const double k = r.parts, h = r.rehangs, n = r.runs, all = k * h * n;
    for (const StudyValue& v : values) r.mean_mm += v.value_mm / all;
    double ss_part = 0, ss_rehang = 0, ss_within = 0;
    for (const auto& [name, rehangs] : sorted) {
        double part_mean = 0;
        for (const auto& [rehang, runs] : rehangs)
            for (const double v : runs) part_mean += v / (h * n);
        ss_part += h * n * (part_mean - r.mean_mm) * (part_mean - r.mean_mm);
        for (const auto& [rehang, runs] : rehangs) {
            const double mean = moments(runs).mean;
            ss_rehang += n * (mean - part_mean) * (mean - part_mean);
            for (const double v : runs) ss_within += (v - mean) * (v - mean);
        }
    }
    if (!r.nested) ss_within += ss_rehang, ss_rehang = 0;
    const MeanSquare part{ss_part / (k - 1), k - 1};
    const double within_degrees = r.nested ? k * h * (n - 1) : k * (h * n - 1);
    const MeanSquare within{ss_within / within_degrees, within_degrees};
    const MeanSquare rehang{r.nested ? ss_rehang / (k * (h - 1)) : within.value,
                            r.nested ? k * (h - 1) : within.degrees};
    if (std::sqrt(within.value + rehang.value) <= kRoundedScatter * std::max(1.0, std::abs(r.mean_mm)))
        return input_error("the values of every part are all equal, so they tell nothing of the scatter",
                           "type 3", "give them with more digits");
    r.anova.push_back({"part", part.degrees, ss_part, part.value});
    if (r.nested) r.anova.push_back({"rehang", rehang.degrees, ss_rehang, rehang.value});
    r.anova.push_back({"repeat", within.degrees, ss_within, within.value});
    r.anova.push_back({"total", all - 1, ss_part + ss_rehang + ss_within, 0});

    const double rehang2 = r.nested ? (rehang.value - within.value) / n : 0;
    const double pv2 = (part.value - rehang.value) / (n * h);
    r.rehang_negative = rehang2 < 0;
    r.pv_negative = pv2 < 0;
    r.ev_mm = std::sqrt(within.value);
    r.rehang_mm = std::sqrt(std::max(0.0, rehang2));
    r.pv_mm = std::sqrt(std::max(0.0, pv2));
    r.grr_mm = std::hypot(r.ev_mm, r.rehang_mm);
    r.tv_mm = std::hypot(r.grr_mm, r.pv_mm);
    const double to_percent = 100 * settings.width / settings.tolerance_mm;
    r.grr_percent_tolerance = to_percent * r.grr_mm;
    r.grr_percent_total = 100 * r.grr_mm / r.tv_mm;
    r.ndc = static_cast<int>(std::min(kMostCategories, kCategories * r.pv_mm / r.grr_mm));

    r.ev_limits = sigma_limits(r.ev_mm, within.degrees);
    r.grr_degrees = within.degrees;
    if (r.nested && !r.rehang_negative) {
        const MeanSquare terms[] = {{rehang.value / n, rehang.degrees},
                                    {within.value * (n - 1) / n, within.degrees}};
        r.grr_degrees = satterthwaite_degrees(terms);
    }
    r.grr_limits = sigma_limits(r.grr_mm, r.grr_degrees);
    r.tolerance_limits = {to_percent * r.grr_limits.low, to_percent * r.grr_limits.high};
    if (r.nested) r.rehang_limits = roots(generalised_limits(rehang, offsets(within, n)));
    r.pv_limits = roots(generalised_limits(part, offsets(rehang, n * h)));
    // lambda = PV^2 / GRR^2
    Interval lambda;
    if (r.nested) {
        std::vector<OtherPivots> others;
        const std::vector<double> inner = pivots(within, 24);
        for (const double theta : pivots(rehang, 24))
            for (const double theta_within : inner)
                others.push_back(
                    {theta, h * n * std::max(theta_within, (theta + (n - 1) * theta_within) / n)});
        lambda = generalised_limits(part, others);
    } else {
        const double f = part.value / within.value;
        const auto of = [&](double probability) {
            return std::max(0.0, (f / f_quantile(part.degrees, within.degrees, probability) - 1) / (h * n));
        };
        lambda = {of(kBelowHigh95), of(kBelowLow95)};
    }
    r.total_limits = {100 / std::sqrt(1 + lambda.high), 100 / std::sqrt(1 + lambda.low)};
    r.ndc_limits = {std::floor(kCategories * std::sqrt(lambda.low)),
                    std::floor(kCategories * std::sqrt(lambda.high))};

    r.verdict = r.parts < kType3Parts                                ? AcceptanceVerdict::too_little_data
                : r.grr_percent_tolerance > settings.refused_percent ? AcceptanceVerdict::not_ok
                : r.grr_percent_tolerance <= settings.accepted_percent && r.ndc >= settings.required_ndc
                    ? AcceptanceVerdict::ok
                    : AcceptanceVerdict::conditional;
    return r;
}

}  // namespace seamwright
