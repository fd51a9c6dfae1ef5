#include "projects/acceptance/pages/acceptance_json.h"

#include "projects/measure/fields.h"

namespace seamwright {
namespace {

using nlohmann::json;

json pair(const Interval& limits) {
    return json::array({limits.low, limits.high});
}

json type1_json(const Type1& r) {
    return {{"n", r.n},
            {"mean", r.mean_mm},
            {"s", r.s_mm},
            {"reference", r.reference_mm},
            {"bias", r.bias_mm},
            {"bias_p", r.bias_p},
            {"cg", r.cg},
            {"cgk", r.cgk},
            {"limits",
             {{"mean", pair(r.mean_limits)},
              {"s", pair(r.s_limits)},
              {"bias", pair(r.bias_limits)},
              {"cg", pair(r.cg_limits)},
              {"cgk", pair(r.cgk_limits)}}},
            {"verdict", to_string(r.verdict)}};
}

json type3_json(const Type3& r) {
    json anova = json::array();
    for (const AnovaRow& row : r.anova)
        anova.push_back({{"source", row.source},
                         {"df", row.df},
                         {"ss", row.ss},
                         {"ms", row.ms > 0 || row.source != std::string("total") ? json(row.ms) : json()}});
    json answer = {{"parts", r.parts},
                   {"rehangs", r.rehangs},
                   {"runs", r.runs},
                   {"ev", r.ev_mm},
                   {"rehang", r.nested ? json(r.rehang_mm) : json()},
                   {"pv", r.pv_mm},
                   {"grr", r.grr_mm},
                   {"grr_percent_tolerance", r.grr_percent_tolerance},
                   {"grr_percent_total", r.grr_percent_total},
                   {"ndc", r.ndc},
                   {"rehang_negative", r.rehang_negative},
                   {"pv_negative", r.pv_negative},
                   {"anova", anova},
                   {"limits",
                    {{"ev", pair(r.ev_limits)},
                     {"pv", pair(r.pv_limits)},
                     {"grr", pair(r.grr_limits)},
                     {"grr_percent_tolerance", pair(r.tolerance_limits)},
                     {"grr_percent_total", pair(r.total_limits)},
                     {"ndc", pair(r.ndc_limits)}}},
                   {"verdict", to_string(r.verdict)}};
    if (r.nested) answer["limits"]["rehang"] = pair(r.rehang_limits);
    return answer;
}

json linearity_json(const Linearity& r) {
    json band = json::array();
    for (const LinearityLevel& level : r.levels)
        band.push_back({{"reference", level.reference_mm},
                        {"n", level.n},
                        {"bias", level.bias_mm},
                        {"fit", level.fit_mm},
                        {"low", level.band.low},
                        {"high", level.band.high}});
    return {{"n", r.line.n},
            {"slope", r.line.slope},
            {"intercept", r.line.intercept},
            {"slope_p", r.line.p_slope},
            {"intercept_p", r.line.p_intercept},
            {"s", r.line.s},
            {"zero_inside", r.zero_inside},
            {"band", band},
            {"limits", {{"slope", pair(r.line.slope_limits)}, {"intercept", pair(r.line.intercept_limits)}}},
            {"verdict", to_string(r.verdict)}};
}

json stability_json(const Stability& r) {
    json alarms = json::array();
    for (const StabilityAlarm& a : r.alarms)
        alarms.push_back({{"run", a.run}, {"rule", a.rule}, {"chart", a.spread ? "s" : "mean"}});
    return {{"subgroups", r.means_mm.size()},
            {"size", r.size},
            {"centre", r.centre_mm},
            {"sigma", r.sigma_mm},
            {"limits",
             {{"centre", pair(r.centre_limits)},
              {"mean_chart", pair(r.mean_chart)},
              {"s_chart", pair(r.s_chart)}}},
            {"alarms", alarms},
            {"verdict", to_string(r.verdict)}};
}

json correlation_json(const Correlation& r) {
    return {{"n", r.pairs.size()},
            {"offset", r.offset_mm},
            {"offset_p", r.offset_p},
            {"s", r.s_mm},
            {"slope", r.line.slope},
            {"r", r.r},
            {"limits", {{"offset", pair(r.offset_limits)}, {"slope", pair(r.line.slope_limits)}}},
            {"verdict", to_string(r.verdict)}};
}

json vda5_json(const ProcessUncertainty& r) {
    json terms = json::array();
    for (const UncertaintyTerm& t : r.terms)
        terms.push_back({{"name", t.name},
                         {"u", t.u_mm},
                         {"degrees", t.degrees},
                         {"in_system", t.in_system},
                         {"in_process", t.in_process}});
    return {{"n", r.reference_values},
            {"bias", r.bias_mm},
            {"type3", r.type3},
            {"u_ms", r.u_ms_mm},
            {"u_mp", r.u_mp_mm},
            {"q_ms_percent", r.q_ms_percent},
            {"q_mp_percent", r.q_mp_percent},
            {"conformity_zone", pair(r.conformity_zone)},
            {"terms", terms},
            {"limits",
             {{"u_ms", pair(r.u_ms_limits)},
              {"u_mp", pair(r.u_mp_limits)},
              {"q_ms_percent", pair(r.q_ms_limits)},
              {"q_mp_percent", pair(r.q_mp_limits)},
              {"conformity_zone", {pair(r.conformity_low_limits), pair(r.conformity_high_limits)}}}},
            {"verdict", to_string(r.verdict)}};
}

const char* word(RequirementFrom from) {
    return from == RequirementFrom::given     ? "given"
           : from == RequirementFrom::project ? "project"
                                              : "default";
}

json check_json(const ForecastCheck& c) {
    return {{"predicted", c.predicted_mm},
            {"measured", c.measured_mm},
            {"p", c.p},
            {"agreement", c.agreement == Agreement::agrees      ? "agrees"
                          : c.agreement == Agreement::beyond_95 ? "beyond_95_percent"
                                                                : "beyond_99_percent"}};
}

json settings_json(const AcceptanceSettings& s) {
    json out = {{"nominal_mm", s.nominal_mm},
                {"share", s.share},
                {"width", s.width},
                {"required_cg", s.required},
                {"required_cgk", s.required_cgk.value_or(s.required)},
                {"grr_accepted_percent", s.grr_accepted_percent},
                {"grr_refused_percent", s.grr_refused_percent},
                {"ndc", s.ndc},
                {"system_percent", s.system_percent},
                {"process_percent", s.process_percent},
                {"subgroup", s.subgroup},
                {"reference_u_mm", s.reference_u_mm},
                {"resolution_mm", s.resolution_mm}};
    for (const auto& field : acceptance_fields())
        out["from"][field.info.name] = word(from_of(s, field.info.name));
    return out;
}

}  // namespace

json forecast_json(const StudyForecast& f, const AcceptanceSettings& s) {
    json out = {{"type1_s", f.type1_s_mm}, {"bias_u", f.bias_u_mm}, {"cg", predicted_cg(f, s)}};
    out["ev"] = f.ev_mm > 0 ? json(f.ev_mm) : json();
    out["grr_percent_tolerance"] = f.ev_mm > 0 ? json(predicted_grr_percent(f, s)) : json();
    return out;
}

json offset_json(const KeptOffset& kept) {
    json covariance = json::array(), offset = json::array();
    for (int i = 0; i < 3; ++i) {
        offset.push_back(kept.offset_mm[i]);
        for (int k = 0; k < 3; ++k) covariance.push_back(kept.covariance_mm2(i, k));
    }
    return {{"version", kept.version},
            {"utc", kept.utc},
            {"source", kept.source.in(Language::english)},
            {"offset_mm", offset},
            {"covariance_mm2", covariance}};
}

json study_progress_json(const StudyProgress& p) {
    json steps = json::array();
    for (const StudyStep& step : p.steps)
        steps.push_back({{"part", step.part.empty() ? json() : json(step.part)},
                         {"rehang", step.rehang},
                         {"wanted", step.wanted},
                         {"made", step.made},
                         {"refused", step.refused}});
    return {{"study", p.plan.study},
            {"region", p.plan.region_id},
            {"runs", p.wanted()},
            {"made", p.made()},
            {"refused", p.refused()},
            {"resumed", p.resumed},
            {"other_setup", p.other_setup},
            {"complete", p.complete()},
            {"stopped", p.stopped.in(Language::english)},
            {"steps", steps}};
}

json acceptance_json(const Acceptance& a) {
    const AcceptanceSettings& s = a.settings;
    json remarks = json::array();
    for (const Text& remark : a.source.remarks) remarks.push_back(remark.in(Language::english));
    json answer = {
        {"status", to_string(a.verdict())},
        {"tolerance_mm", s.tolerance_mm},
        {"settings", settings_json(s)},
        {"source",
         {{"file", a.source.file},
          {"measurand", a.source.measurand.empty() ? json() : json(a.source.measurand.in(Language::english))},
          {"part", a.source.part_name},
          {"sensor_serial", a.source.sensor_serial},
          {"robot_serial", a.source.robot_serial},
          {"simulated", a.source.simulated},
          {"runs", a.source.runs},
          {"remarks", remarks}}}};
    if (a.type1) {
        answer["type1"] = type1_json(*a.type1);
        answer["type1"]["part"] = a.type1_part;
    }
    if (a.type3) answer["type3"] = type3_json(*a.type3);
    if (a.linearity) answer["linearity"] = linearity_json(*a.linearity);
    if (a.stability) answer["stability"] = stability_json(*a.stability);
    if (a.correlation) answer["correlation"] = correlation_json(*a.correlation);
    if (a.vda5) answer["vda5"] = vda5_json(*a.vda5);
    if (a.source.forecast) answer["forecast"] = forecast_json(*a.source.forecast, s);
    if (a.type1_check) answer["type1"]["forecast"]["s"] = check_json(*a.type1_check);
    if (a.bias_check) answer["type1"]["forecast"]["bias"] = check_json(*a.bias_check);
    if (a.type3_check) answer["type3"]["forecast"]["ev"] = check_json(*a.type3_check);
    if (a.source.offset) {
        const auto& acting = a.source.offset->acting;
        answer["source"]["kept_offset"] = acting ? offset_json(*acting) : json();
    }
    for (const Study study : kStudies)
        if (const std::string why = what_lacks(a, study).english(); !why.empty())
            answer[std::string(to_string(study))]["message"] = why;
    for (const auto& [study, error] : a.not_done)
        answer[std::string(to_string(study))] = {{"verdict", "not_done"}, {"message", error.sentence()}};
    return answer;
}

}  // namespace seamwright
