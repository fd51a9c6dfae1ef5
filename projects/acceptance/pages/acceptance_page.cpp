#include "projects/acceptance/pages/acceptance_page.h"

#include <algorithm>
#include <cmath>

#include "core/acceptance/distributions.h"
#include "projects/acceptance/pages/acceptance_page_detail.h"
#include "projects/file/project_file.h"
#include "projects/report/svg_plot.h"

namespace seamwright {
namespace {

using report::Band;
using report::Mark;
using report::Plot;
using report::Rows;
using report::Series;
namespace colour = report::colour;

std::string probability(double p) {
    return p < 0.0001 ? std::string("< 0.0001") : fmt::format("= {:.2g}", p);
}

void type1_chapter(AcceptanceWriter& w) {
    const Type1& r = *w.a.type1;
    const AcceptanceSettings& s = w.a.settings;
    w.heading(w.t("Type 1: capability on a reference part"));
    const double required_cgk = s.required_cgk.value_or(s.required);
    w.verdict(Study::type1, r.verdict,
              required_cgk == s.required
                  ? w.t("Cg and Cgk must reach {}", w.number(s.required, 2))
                  : w.t("Cg must reach {} and Cgk {}", w.number(s.required, 2), w.number(required_cgk, 2)));
    w.page.paragraph(
        w.t("Part {}, {} values, reference {} mm. Cg = {} T / ({} s).",
            w.a.source.unmoved_part_is(w.a.type1_part) ? w.t("as taught, unmoved") : w.a.type1_part, r.n,
            w.number(r.reference_mm, 4), s.share, s.width));
    Rows rows = w.head();
    w.index(rows, w.t("mean (mm)"), r.mean_mm, r.mean_limits, 4);
    w.index(rows, w.t("s (mm)"), r.s_mm, r.s_limits, 4);
    w.index(rows, w.t("bias (mm)"), r.bias_mm, r.bias_limits, 4);
    w.index(rows, "Cg", r.cg, r.cg_limits, 2, w.number(s.required, 2));
    w.index(rows, "Cgk", r.cgk, r.cgk_limits, 2, w.number(required_cgk, 2));
    w.page.table(rows);
    w.page.paragraph(r.bias_p < 0.05 ? w.t("The bias is no chance (t-test, p {}).", probability(r.bias_p))
                                     : w.t("The bias may be chance (t-test, p {}).", probability(r.bias_p)));
    w.page.figures({run_chart(w), histogram(w)});
}

void type3_chapter(AcceptanceWriter& w) {
    const Type3& r = *w.a.type3;
    const AcceptanceSettings& s = w.a.settings;
    w.heading(w.t("Type 3: repeatability and reproducibility"));
    w.verdict(Study::type3, r.verdict,
              w.t("up to {:g} % of the tolerance with ndc of {} is accepted, beyond {:g} % not",
                  s.grr_accepted_percent, s.ndc, s.grr_refused_percent));
    w.page.paragraph(
        w.t("{} parts, each hung {} times, each time measured {} times.", r.parts, r.rehangs, r.runs));
    Rows rows = w.head();
    w.index(rows, w.t("EV, repeat (mm)"), r.ev_mm, r.ev_limits, 4);
    if (r.nested) w.index(rows, w.t("rehang (mm)"), r.rehang_mm, r.rehang_limits, 4);
    w.index(rows, "GRR (mm)", r.grr_mm, r.grr_limits, 4);
    w.index(rows, w.t("PV, parts (mm)"), r.pv_mm, r.pv_limits, 4);
    w.index(rows, w.t("GRR of the tolerance (%)"), r.grr_percent_tolerance, r.tolerance_limits, 1,
            fmt::format("{:g} / {:g}", s.grr_accepted_percent, s.grr_refused_percent));
    w.index(rows, w.t("GRR of the total variation (%)"), r.grr_percent_total, r.total_limits, 1);
    w.index(rows, "ndc", r.ndc, r.ndc_limits, 0, std::to_string(s.ndc));
    w.page.table(rows);
    Rows anova{{w.t("Source"), "df", "SS (mm²)", "MS (mm²)"}};
    for (const AnovaRow& row : r.anova) {
        const std::string source = row.source;
        anova.push_back({source == "part"     ? w.t("part")
                         : source == "rehang" ? w.t("rehang")
                         : source == "repeat" ? w.t("repeat")
                                              : w.t("total"),
                         w.number(row.df, 0), w.number(row.ss, 6),
                         source == "total" ? std::string() : w.number(row.ms, 6)});
    }
    w.page.table(anova, w.t("Analysis of variance"));
    if (r.rehang_negative) w.page.paragraph(w.t("The component of the rehang came out negative and is 0."));
    if (r.pv_negative) w.page.paragraph(w.t("The component of the parts came out negative and is 0."));
    if (r.rehang_in_repeat)
        w.page.paragraph(w.t("Each rehang was measured once: repeat and rehang cannot be told apart."));
    if (w.a.type1_part_left_out)
        w.page.paragraph(w.t("The reference part was measured unlike the others and is left out here."));
    w.page.figures(parts_plots(w));
}

void linearity_chapter(AcceptanceWriter& w) {
    const Linearity& r = *w.a.linearity;
    w.heading(w.t("Linearity"));
    w.verdict(Study::linearity, r.verdict,
              r.zero_inside ? w.t("the line of no bias lies inside the 95 % band")
                            : w.t("the line of no bias leaves the 95 % band"));
    Rows rows = w.head();
    w.index(rows, w.t("slope (mm per m)"), 1000 * r.line.slope,
            {1000 * r.line.slope_limits.low, 1000 * r.line.slope_limits.high}, 3);
    w.index(rows, w.t("intercept (mm)"), r.line.intercept, r.line.intercept_limits, 4);
    w.page.table(rows);
    Plot plot;
    plot.title = w.t("Bias against the reference");
    plot.x_label = w.t("reference (mm)");
    plot.y_label = w.t("bias (mm)");
    plot.width_px = 800;
    Series dots{w.t("value"), {}, {}, Mark::dots, colour::kBlue},
        line{w.t("line"), {}, {}, Mark::line, colour::kGreen},
        low{w.t("95 % band"), {}, {}, Mark::dashed, colour::kVermilion},
        high{"", {}, {}, Mark::dashed, colour::kVermilion};
    for (const StudyValue& v : w.a.values.linearity) {
        dots.x.push_back(*v.reference_mm);
        dots.y.push_back(v.value_mm - *v.reference_mm);
    }
    const double from = r.levels.front().reference_mm, to = r.levels.back().reference_mm;
    for (int i = 0; i <= 40; ++i) {
        const double x = from + (to - from) * i / 40;
        const Interval band = r.line.band(x);
        for (Series* s : {&line, &low, &high}) s->x.push_back(x);
        line.y.push_back(r.line.at(x));
        low.y.push_back(band.low);
        high.y.push_back(band.high);
    }
    plot.series = {dots, line, low, high};
    w.page.figure(report::svg(plot));
}

void stability_chapter(AcceptanceWriter& w) {
    const Stability& r = *w.a.stability;
    w.heading(w.t("Stability"));
    w.verdict(Study::stability, r.verdict,
              r.alarms.empty() ? w.t("{} subgroups, no alarm", r.means_mm.size())
                               : w.t("{} subgroups, {} alarms", r.means_mm.size(), r.alarms.size()));
    w.page.paragraph(w.t("Subgroups of {} values; {} values that fill none are left out.", r.size,
                         w.a.stability_left_out));
    Rows rows = w.head();
    w.index(rows, w.t("centre (mm)"), r.centre_mm, r.centre_limits, 4);
    w.page.table(rows);
    w.page.table({{w.t("Control limits"), w.t("lower (mm)"), w.t("upper (mm)")},
                  {w.t("Means"), w.number(r.mean_chart.low, 4), w.number(r.mean_chart.high, 4)},
                  {w.t("Standard deviations"), w.number(r.s_chart.low, 4), w.number(r.s_chart.high, 4)}});
    if (!r.alarms.empty()) {
        Rows alarms{{w.t("Run"), w.t("Nelson's rule"), w.t("Chart")}};
        for (const StabilityAlarm& a : r.alarms)
            alarms.push_back({std::to_string(a.run), std::to_string(a.rule),
                              a.spread ? w.t("Standard deviations") : w.t("Means")});
        w.page.table(alarms, w.t("Alarms"));
    }
    w.page.figures({control_chart(w, r, false), control_chart(w, r, true)});
}

void correlation_chapter(AcceptanceWriter& w) {
    const Correlation& r = *w.a.correlation;
    w.heading(w.t("Correlation with the reference instrument"));
    w.verdict(Study::correlation, r.verdict,
              w.t("0 must lie inside the offset's limits and 1 inside the slope's"));
    Rows rows = w.head();
    w.index(rows, w.t("offset (mm)"), r.offset_mm, r.offset_limits, 4, "0");
    w.index(rows, w.t("slope"), r.line.slope, r.line.slope_limits, 4, "1");
    w.page.table(rows);
    w.page.paragraph(w.t("{} parts, correlation coefficient {}. The offset is stated, not applied.",
                         r.pairs.size(), w.number(r.r, 4)));
    Plot plot;
    plot.title = w.t("Difference against the reference");
    plot.x_label = w.t("reference (mm)");
    plot.y_label = w.t("value minus reference (mm)");
    plot.width_px = 800;
    Series dots{w.t("part"), {}, {}, Mark::dots, colour::kBlue};
    for (const CorrelationPair& p : r.pairs) {
        dots.x.push_back(p.reference_mm);
        dots.y.push_back(p.value_mm - p.reference_mm);
    }
    plot.bands = {{r.offset_limits.low, r.offset_limits.high, w.t("offset (mm)")}};
    plot.series = {dots};
    w.page.figure(report::svg(plot));
}

void vda5_chapter(AcceptanceWriter& w) {
    const ProcessUncertainty& r = *w.a.vda5;
    w.heading(w.t("Uncertainty of the measuring process (VDA 5, ISO 22514-7)"));
    const AcceptanceSettings& s = w.a.settings;
    w.verdict(Study::vda5, r.verdict,
              w.t("Q of the system up to {:g} %, of the process up to {:g} %", s.system_percent,
                  s.process_percent));
    Rows rows = w.head();
    w.index(rows, "u_MS (mm)", r.u_ms_mm, r.u_ms_limits, 4);
    w.index(rows, "u_MP (mm)", r.u_mp_mm, r.u_mp_limits, 4);
    w.index(rows, "Q_MS (%)", r.q_ms_percent, r.q_ms_limits, 1, fmt::format("{:g}", s.system_percent));
    w.index(rows, "Q_MP (%)", r.q_mp_percent, r.q_mp_limits, 1, fmt::format("{:g}", s.process_percent));
    w.index(rows, w.t("conformity zone, lower (mm)"), r.conformity_zone.low, r.conformity_low_limits, 4);
    w.index(rows, w.t("conformity zone, upper (mm)"), r.conformity_zone.high, r.conformity_high_limits, 4);
    w.page.table(rows);
    const auto meaning = [&](const std::string& name) {
        return name == "u_CAL"   ? w.t("reference of the part")
               : name == "u_BI"  ? w.t("bias")
               : name == "u_RE"  ? w.t("resolution")
               : name == "u_EVR" ? w.t("repeat on the reference part")
               : name == "u_EVO" ? w.t("repeat on the parts")
               : name == "u_REH" ? w.t("rehang")
                                 : std::string();
    };
    Rows terms{{w.t("Contribution"), w.t("of what"), "u (mm)", w.t("degrees of freedom"), w.t("counts in")}};
    for (const UncertaintyTerm& t : r.terms)
        terms.push_back({t.name, meaning(t.name), w.number(t.u_mm, 4),
                         t.degrees >= 0.05 ? w.number(t.degrees, 1) : "-",
                         t.in_system && t.in_process ? "MS, MP"
                         : t.in_system               ? "MS"
                         : t.in_process              ? "MP"
                                                     : "-"});
    w.page.table(terms);
    if (!r.type3)
        w.page.paragraph(w.t("Without production parts the process is known by its reference part alone."));
    if (r.conformity_zone.low > r.conformity_zone.high)
        w.page.paragraph(w.t("The uncertainty leaves nothing of the tolerance: no value proves conformity."));
}

void overview(AcceptanceWriter& w) {
    Rows rows{{w.t("Study"), w.t("Result"), w.t("Verdict")}};
    const auto row = [&](Study study, AcceptanceVerdict v, const std::string& result) {
        rows.push_back({title_of(study).in(w.language), result, name_of(v).in(w.language)});
    };
    const Acceptance& a = w.a;
    if (a.type1)
        row(Study::type1, a.type1->verdict,
            fmt::format("Cg {}, Cgk {}", w.number(a.type1->cg, 2), w.number(a.type1->cgk, 2)));
    if (a.type3)
        row(Study::type3, a.type3->verdict,
            fmt::format("%GRR {}, ndc {}", w.number(a.type3->grr_percent_tolerance, 1), a.type3->ndc));
    if (a.linearity)
        row(Study::linearity, a.linearity->verdict,
            w.t("{} mm per m", w.number(1000 * a.linearity->line.slope, 3)) + ", " +
                w.number(a.linearity->line.intercept, 4) + " mm");
    if (a.stability)
        row(Study::stability, a.stability->verdict, w.t("{} alarms", a.stability->alarms.size()));
    if (a.correlation)
        row(Study::correlation, a.correlation->verdict,
            w.t("offset {} mm", w.number(a.correlation->offset_mm, 4)));
    if (a.vda5)
        row(Study::vda5, a.vda5->verdict,
            fmt::format("Q_MS {} %, Q_MP {} %", w.number(a.vda5->q_ms_percent, 1),
                        w.number(a.vda5->q_mp_percent, 1)));
    w.page.table(rows);
}

void source_chapter(AcceptanceWriter& w) {
    const StudySource& s = w.a.source;
    if (s.simulated) w.page.verdict(w.t("simulated"), report::Tone::attention, w.t("the cell was simulated"));
    const AcceptanceSettings& r = w.a.settings;
    const auto from = [&](const char* name) {
        const RequirementFrom where = from_of(r, name);
        return where == RequirementFrom::given     ? w.t("given with the command")
               : where == RequirementFrom::project ? w.t("of the project")
                                                   : w.t("default");
    };
    w.page.table(
        {{w.t("Requirement"), w.t("Value"), w.t("from where")},
         {w.t("tolerance T"), w.number(r.tolerance_mm, 4) + " mm", from("tolerance_mm")},
         {w.t("limits"), w.number(w.lower(), 4) + " .. " + w.number(w.upper(), 4) + " mm",
          from(from_of(r, "nominal_mm") == RequirementFrom::standard ? "tolerance_mm" : "nominal_mm")},
         {w.t("share of the tolerance in Cg"), fmt::format("{:g}", r.share), from("cg_share")},
         {w.t("standard deviations in Cg"), fmt::format("{:g}", r.width), from("cg_width")},
         {w.t("Cg, at least"), w.number(r.required, 2), from("cg")},
         {w.t("Cgk, at least"), w.number(r.required_cgk.value_or(r.required), 2), from("cgk")},
         {w.t("%GRR accepted"), fmt::format("{:g} %", r.grr_accepted_percent), from("grr_accepted_percent")},
         {w.t("%GRR refused beyond"), fmt::format("{:g} %", r.grr_refused_percent),
          from("grr_refused_percent")},
         {w.t("ndc, at least"), std::to_string(r.ndc), from("ndc")},
         {w.t("Q of the system, at most"), fmt::format("{:g} %", r.system_percent), from("system_percent")},
         {w.t("Q of the process, at most"), fmt::format("{:g} %", r.process_percent),
          from("process_percent")}});
    Rows rows{{w.t("Source"), w.t("Value")}, {w.t("File"), s.file}};
    if (!s.measurand.empty())
        rows.push_back({w.t("measurand"), w.t("deviation of the bead across its path, {}", s.measurand)});
    if (!s.part_name.empty()) rows.push_back({w.t("part"), s.part_name});
    if (!s.sensor.empty())
        rows.push_back({w.t("Sensor"), s.sensor + ", " + w.t("serial {}", s.sensor_serial)});
    if (!s.robot.empty()) rows.push_back({w.t("Robot"), s.robot + ", " + w.t("serial {}", s.robot_serial)});
    if (s.runs > 0) rows.push_back({w.t("stored runs"), std::to_string(s.runs)});
    w.page.table(rows);
    for (const Text& remark : s.remarks) w.page.paragraph(remark.in(w.language));
}

// What the stated covariance predicted, beside what came out.
void forecast_chapter(AcceptanceWriter& w) {
    const StudyForecast& f = *w.a.source.forecast;
    w.heading(w.t("Forecast and measurement"));
    bool beyond = false, measured = false;
    const auto finding = [&](const std::optional<ForecastCheck>& check) {
        if (!check) return w.t("not compared");
        measured = true;
        beyond = beyond || check->agreement != Agreement::agrees;
        const std::string p = probability(check->p);
        return check->agreement == Agreement::agrees      ? w.t("agree, p {}", p)
               : check->agreement == Agreement::beyond_95 ? w.t("differ beyond chance at 95 %, p {}", p)
                                                          : w.t("differ beyond chance at 99 %, p {}", p);
    };
    Rows rows{{w.t("Index"), w.t("predicted"), w.t("measured"), w.t("Finding")}};
    const auto row = [&](const std::string& name, double predicted, std::optional<double> value, int decimals,
                         const std::string& says) {
        rows.push_back({name, w.number(predicted, decimals), value ? w.number(*value, decimals) : "-", says});
    };
    const auto of = [](const auto& study, auto member) {
        return study ? std::optional<double>((*study).*member) : std::nullopt;
    };
    const std::string s_says = finding(w.a.type1_check);
    row(w.t("s (mm)"), f.type1_s_mm, of(w.a.type1, &Type1::s_mm), 4, s_says);
    row("Cg", predicted_cg(f, w.a.settings), of(w.a.type1, &Type1::cg), 2, "");
    row(w.t("bias (mm), standard uncertainty"), f.bias_u_mm, of(w.a.type1, &Type1::bias_mm), 4,
        finding(w.a.bias_check));
    if (f.ev_mm > 0) {
        row(w.t("EV, repeat (mm)"), f.ev_mm, of(w.a.type3, &Type3::ev_mm), 4, finding(w.a.type3_check));
        row(w.t("GRR of the tolerance (%)"), predicted_grr_percent(f, w.a.settings),
            of(w.a.type3, &Type3::grr_percent_tolerance), 1, "");
    }
    if (measured)
        w.page.verdict(beyond ? w.t("they differ") : w.t("they agree"),
                       beyond ? report::Tone::attention : report::Tone::good,
                       beyond ? w.t("the stated uncertainty is not the measured one")
                              : w.t("within what chance allows"));
    w.page.table(rows);
    w.page.paragraph(w.t(
        "Predicted from the covariance that the corrections state, at the measurand; of rehanging it says "
        "nothing. Compared by chi-square (scatter) and the normal distribution (bias), two-sided."));
}

}  // namespace

Text title_of(Study study) {
    switch (study) {
        case Study::type1:
            return Text("Type 1: capability on a reference part");
        case Study::type3:
            return Text("Type 3: repeatability and reproducibility");
        case Study::linearity:
            return Text("Linearity");
        case Study::stability:
            return Text("Stability");
        case Study::correlation:
            return Text("Correlation with the reference instrument");
        default:
            return Text("Uncertainty of the measuring process (VDA 5, ISO 22514-7)");
    }
}

Text name_of(AcceptanceVerdict verdict) {
    switch (verdict) {
        case AcceptanceVerdict::ok:
            return Text("accepted");
        case AcceptanceVerdict::conditional:
            return Text("conditional");
        case AcceptanceVerdict::not_ok:
            return Text("not accepted");
        default:
            return Text("too little data");
    }
}

report::Tone tone_of(AcceptanceVerdict verdict) {
    return verdict == AcceptanceVerdict::ok       ? report::Tone::good
           : verdict == AcceptanceVerdict::not_ok ? report::Tone::alarm
                                                  : report::Tone::attention;
}

void add_chapters(report::Page& page, Language language, const Acceptance& a, int level) {
    AcceptanceWriter w{a, language, page, level};
    w.verdict(a.verdict(), w.t("the worst of the studies below"));
    overview(w);
    source_chapter(w);
    add_forecast_chapter(page, language, a, level);
    for (const Study study : kStudies) add_chapter(page, language, a, study, level);
}

void add_chapter(report::Page& page, Language language, const Acceptance& a, Study study, int level) {
    AcceptanceWriter w{a, language, page, level};
    switch (study) {
        case Study::type1:
            return a.type1 ? type1_chapter(w) : void();
        case Study::type3:
            return a.type3 ? type3_chapter(w) : void();
        case Study::linearity:
            return a.linearity ? linearity_chapter(w) : void();
        case Study::stability:
            return a.stability ? stability_chapter(w) : void();
        case Study::correlation:
            return a.correlation ? correlation_chapter(w) : void();
        default:
            return a.vda5 ? vda5_chapter(w) : void();
    }
}

void add_forecast_chapter(report::Page& page, Language language, const Acceptance& a, int level) {
    AcceptanceWriter w{a, language, page, level};
    if (a.source.forecast) forecast_chapter(w);
}

void add_studies_not_done(report::Page& page, Language language, const Acceptance& a, int level) {
    if (a.not_done.empty()) return;
    AcceptanceWriter w{a, language, page, level};
    w.heading(w.t("Studies that the data do not allow"));
    Rows rows{{w.t("Study"), w.t("Finding")}};
    for (const auto& [study, error] : a.not_done)
        rows.push_back({title_of(study).in(w.language), error.text().in(language)});
    page.table(rows);
}

report::Page begin_acceptance_page(const std::string& file, Language language, const std::string& now_utc,
                                   const std::string& program) {
    report::Page page(Text("Acceptance of the measuring process: {}", file).in(language),
                      std::string(code_of(language)));
    const std::string now = now_utc.empty() ? utc_now() : now_utc;
    page.paragraph(Text("File {}, {} UTC, {}.", file, now.substr(0, 10) + " " + now.substr(11, 5),
                        program.empty() ? "Seamwright" : program)
                       .in(language));
    return page;
}

void add_signatures(report::Page& page, Language language, const Acceptance* a) {
    const auto t = [&](const char* english) { return Text::chosen(english).in(language); };
    page.heading(t("Signatures"));
    if (a) {  // what is signed
        page.verdict(name_of(a->verdict()).in(language), tone_of(a->verdict()),
                     t("the measuring process as reported here"));
        AcceptanceWriter w{*a, language, page, 3};
        overview(w);
    }
    const std::string date = t("Place, date");
    page.signatures(
        {{date, t("Commissioning engineer"), t("Signature")}, {date, t("Customer"), t("Signature")}});
}

report::Page acceptance_page(const Acceptance& a, const AcceptancePageOptions& options) {
    report::Page page =
        begin_acceptance_page(a.source.file, options.language, options.now_utc, options.program);
    add_chapters(page, options.language, a);
    if (options.more) options.more(page, options.language);
    add_studies_not_done(page, options.language, a);
    add_signatures(page, options.language, &a);
    return page;
}

}  // namespace seamwright
