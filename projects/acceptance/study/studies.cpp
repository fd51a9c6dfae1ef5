#include "projects/acceptance/study/studies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "projects/measure/fields.h"

namespace seamwright {
namespace {

constexpr std::string_view kStudyNames[] = {"type1",     "type3",       "linearity",
                                            "stability", "correlation", "vda5"};

std::map<std::string, std::size_t> counts(const std::vector<StudyValue>& values) {
    std::map<std::string, std::size_t> out;
    for (const StudyValue& v : values) ++out[v.part];
    return out;
}

Expected<std::string> reference_part(const std::vector<StudyValue>& values, const std::string& wanted) {
    const auto parts = counts(values);
    if (!wanted.empty()) {
        if (!parts.contains(wanted))
            return input_error(Text("there are no values of part \"{}\"", wanted), "--part");
        return wanted;
    }
    if (parts.empty()) return input_error("there are no values of a reference part");
    std::vector<std::string> often;
    for (const auto& [part, n] : parts)
        if (parts.size() == 1 || n >= kType1Values) often.push_back(part);
    if (often.size() != 1)
        return input_error(Text("the values are of {} parts, {} of them measured {} times or more",
                                parts.size(), often.size(), kType1Values),
                           "reference part",
                           often.empty() ? Text("measure one of them {} times or more", kType1Values)
                                         : Text("say which of them is the reference part"));
    return often.front();
}

std::vector<StudyValue> only(const std::vector<StudyValue>& values, const std::string& part) {
    std::vector<StudyValue> out;
    std::copy_if(values.begin(), values.end(), std::back_inserter(out),
                 [&](const StudyValue& v) { return v.part == part; });
    return out;
}

class Judge {
  public:
    explicit Judge(Acceptance& answer) : a_(answer) {}

    Expected<void> type1() {
        SEAM_TRY(auto part, reference_part(a_.values.type1, a_.settings.part));
        a_.type1_values = only(a_.values.type1, part);
        std::optional<double> reference = a_.settings.reference_mm;
        std::vector<double> mm;
        for (const StudyValue& v : a_.type1_values) {
            mm.push_back(v.value_mm);
            if (a_.settings.reference_mm || !v.reference_mm) continue;
            if (reference && *reference != *v.reference_mm)
                return input_error(
                    Text("part {} has the references {} and {}", part, *reference, *v.reference_mm), "type 1",
                    "one part has one reference; give it with --reference");
            reference = v.reference_mm;
        }
        if (!reference)
            return input_error(Text("the reference of part {} is not known", part), "type 1",
                               "give it with --reference, or in a column reference");
        const AcceptanceSettings& s = a_.settings;
        auto made =
            type1_study(mm, *reference, {s.tolerance_mm, s.share, s.width, s.required, s.required_cgk});
        if (!made) return tl::unexpected(made.error());
        a_.type1_part = part;
        a_.type1 = *made;
        const std::optional<StudyForecast>& forecast = a_.source.forecast;
        // Of another part than the unmoved one neither the place nor the reference is the forecast's.
        if (!forecast || !(forecast->type1_s_mm > 0) || !a_.source.unmoved_part_is(part)) return {};
        const Type1& r = *a_.type1;
        a_.type1_check = check_scatter(forecast->type1_s_mm, r.s_mm, r.n - 1);
        a_.bias_check =
            check_bias(std::hypot(forecast->bias_u_mm, forecast->type1_s_mm / std::sqrt(r.n)), r.bias_mm);
        return {};
    }

    Expected<void> type3() {
        a_.type3_values = a_.values.type3;
        // A reference part measured unlike the others is no production part.
        const auto parts = counts(a_.type3_values);
        const auto part = reference_part(a_.type3_values, a_.settings.part);
        a_.type1_part_left_out =
            part && parts.size() > 2 && std::all_of(parts.begin(), parts.end(), [&](const auto& p) {
                return (p.first == *part) == (p.second == parts.at(*part));
            });
        if (a_.type1_part_left_out)
            std::erase_if(a_.type3_values, [&](const StudyValue& v) { return v.part == *part; });
        const AcceptanceSettings& s = a_.settings;
        SEAM_TRY(auto made, type3_study(a_.type3_values, {s.tolerance_mm, 6, s.grr_accepted_percent,
                                                          s.grr_refused_percent, s.ndc}));
        a_.type3 = std::move(made);
        // Where repeat and rehang cannot be told apart the forecast, which knows no rehang, is of neither.
        if (const auto& forecast = a_.source.forecast;
            forecast && forecast->ev_mm > 0 && !a_.type3->rehang_in_repeat)
            for (const AnovaRow& row : a_.type3->anova)
                if (row.source == std::string("repeat"))
                    a_.type3_check = check_scatter(forecast->ev_mm, a_.type3->ev_mm, row.df);
        return {};
    }

    Expected<void> linearity() {
        SEAM_TRY(auto made, linearity_study(a_.values.linearity));
        a_.linearity = std::move(made);
        return {};
    }

    Expected<void> stability() {
        SEAM_TRY(auto part, reference_part(a_.values.stability, a_.settings.part));
        const std::vector<StudyValue> values = only(a_.values.stability, part);
        SEAM_TRY(auto groups, subgroups_of(values, a_.settings.subgroup));
        SEAM_TRY(auto made, stability_study(groups.groups));
        a_.stability_left_out = groups.left_out;
        a_.stability = std::move(made);
        return {};
    }

    Expected<void> correlation() {
        SEAM_TRY(auto made, correlation_study(a_.values.correlation));
        a_.correlation = std::move(made);
        return {};
    }

    Expected<void> vda5() {
        std::vector<StudyValue> references = a_.values.type1;
        if (!a_.settings.part.empty() || a_.settings.reference_mm) {
            SEAM_TRY(auto part, reference_part(references, a_.settings.part));
            references = only(references, part);
            if (a_.settings.reference_mm)
                for (StudyValue& v : references) v.reference_mm = a_.settings.reference_mm;
        }
        if (!a_.type3) {
            Acceptance other;  // may fail: then the process is known by its reference part alone
            other.settings = a_.settings;
            other.values = a_.values;
            if (Judge(other).type3()) production_ = other.type3;
        } else {
            production_ = a_.type3;
        }
        const AcceptanceSettings& s = a_.settings;
        ProcessSettings settings;
        settings.lower_mm = s.nominal_mm - s.tolerance_mm / 2;
        settings.upper_mm = s.nominal_mm + s.tolerance_mm / 2;
        settings.reference_u_mm = s.reference_u_mm;
        settings.resolution_mm = s.resolution_mm;
        settings.system_percent = s.system_percent;
        settings.process_percent = s.process_percent;
        SEAM_TRY(auto made, process_uncertainty(references, production_, settings));
        a_.vda5 = std::move(made);
        return {};
    }

    Expected<void> make(Study study) {
        switch (study) {
            case Study::type1:
                return type1();
            case Study::type3:
                return type3();
            case Study::linearity:
                return linearity();
            case Study::stability:
                return stability();
            case Study::correlation:
                return correlation();
            default:
                return vda5();
        }
    }

  private:
    Acceptance& a_;
    std::optional<Type3> production_;
};

}  // namespace

void require(AcceptanceSettings& s, const AcceptanceRequirements& r) {
    s.tolerance_mm = r.tolerance_mm;
    s.nominal_mm = r.nominal_mm;
    s.share = r.cg_share;
    s.width = r.cg_width;
    s.required = r.cg;
    s.required_cgk = r.cgk;
    s.grr_accepted_percent = r.grr_accepted_percent;
    s.grr_refused_percent = r.grr_refused_percent;
    s.ndc = static_cast<int>(std::lround(r.ndc));
    s.system_percent = r.system_percent;
    s.process_percent = r.process_percent;
    for (const auto& field : acceptance_fields())
        if (field.get(r) != field.get(AcceptanceRequirements{}))
            s.from[field.info.name] = RequirementFrom::project;
}

AcceptanceRequirements requirements_of(const AcceptanceSettings& s) {
    return {s.tolerance_mm,
            s.nominal_mm,
            s.share,
            s.width,
            s.required,
            s.required_cgk.value_or(s.required),
            s.grr_accepted_percent,
            s.grr_refused_percent,
            static_cast<double>(s.ndc),
            s.system_percent,
            s.process_percent};
}

RequirementFrom from_of(const AcceptanceSettings& settings, const std::string& name) {
    const auto at = settings.from.find(name);
    return at == settings.from.end() ? RequirementFrom::standard : at->second;
}

double predicted_cg(const StudyForecast& f, const AcceptanceSettings& s) {
    return s.share * s.tolerance_mm / (s.width * f.type1_s_mm);
}
double predicted_grr_percent(const StudyForecast& f, const AcceptanceSettings& s) {
    return 100 * 6 * f.ev_mm / s.tolerance_mm;
}

std::string_view to_string(Study study) {
    return kStudyNames[static_cast<std::size_t>(study)];
}

std::optional<Study> study_from(std::string_view name) {
    for (const Study study : kStudies)
        if (to_string(study) == name) return study;
    return std::nullopt;
}

std::vector<StudyValue> StudyValues::all() const {
    std::vector<StudyValue> out;
    std::set<std::tuple<std::string, std::string, long>> seen;
    for (const auto* values : {&type1, &type3, &linearity, &stability, &correlation})
        for (const StudyValue& v : *values)
            if (seen.emplace(v.part, v.rehang, v.run).second) out.push_back(v);
    return out;
}

AcceptanceVerdict Acceptance::verdict() const {
    using enum AcceptanceVerdict;
    std::vector<AcceptanceVerdict> made;
    if (type1) made.push_back(type1->verdict);
    if (type3) made.push_back(type3->verdict);
    if (linearity) made.push_back(linearity->verdict);
    if (stability) made.push_back(stability->verdict);
    if (correlation) made.push_back(correlation->verdict);
    if (vda5) made.push_back(vda5->verdict);
    for (const AcceptanceVerdict worst : {not_ok, too_little_data, conditional})
        if (std::find(made.begin(), made.end(), worst) != made.end()) return worst;
    return made.empty() ? too_little_data : ok;
}

Text what_lacks(const Acceptance& a, Study study) {
    const auto lacks = [](const auto& made) {
        return made && made->verdict == AcceptanceVerdict::too_little_data;
    };
    if (study == Study::type1 && lacks(a.type1))
        return Text("{} values; {} are needed at least", a.type1->n, kType1Values);
    if (study == Study::type3 && lacks(a.type3))
        return Text("{} parts; {} are needed at least", a.type3->parts, kType3Parts);
    if (study == Study::linearity && lacks(a.linearity))
        return Text(
            "{} values at {} levels; needed are 5 levels and 50 values, none of the levels with more than "
            "half of them",
            a.linearity->line.n, a.linearity->levels.size());
    if (study == Study::stability && lacks(a.stability))
        return Text("{} subgroups; {} are needed at least", a.stability->means_mm.size(),
                    kStabilitySubgroups);
    if (study == Study::correlation && lacks(a.correlation))
        return Text("{} parts; {} are needed at least", a.correlation->pairs.size(), kCorrelationPairs);
    if (study == Study::vda5 && lacks(a.vda5))
        return Text("{} values; {} are needed at least", a.vda5->reference_values, kProcessValues);
    return {};
}

Expected<void> check_settings(const AcceptanceSettings& settings) {
    SEAM_OK(check_positive(settings.tolerance_mm, "tolerance"));
    if (!std::isfinite(settings.nominal_mm) || std::abs(settings.nominal_mm) > 1e6 ||
        (settings.reference_mm && !(std::abs(*settings.reference_mm) <= 1e6)))
        return input_error("nominal and reference must be finite and within 1 km", "acceptance");
    return {};
}

Expected<Acceptance> judge_acceptance(StudyValues values, StudySource source,
                                      const AcceptanceSettings& settings, std::span<const Study> studies) {
    SEAM_OK(check_settings(settings));
    Acceptance answer;
    answer.settings = settings;
    answer.source = std::move(source);
    answer.values = std::move(values);
    Judge judge(answer);
    bool any = false;
    for (const Study study : studies) {
        if (const auto made = judge.make(study)) {
            any = true;
        } else if (studies.size() == 1) {
            return tl::unexpected(made.error());
        } else {
            answer.not_done.emplace(study, made.error());
        }
    }
    if (!any) return tl::unexpected(answer.not_done.begin()->second);
    return answer;
}

}  // namespace seamwright
