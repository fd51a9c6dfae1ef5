#include "projects/proof/budget/budget_page.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/notation.h"
#include "projects/file/project_file.h"
#include "projects/proof/budget/budget_advice.h"
#include "projects/report/svg_bars.h"
#include "projects/report/svg_plot.h"

namespace seamwright {
namespace {

using report::Rows;
using report::Tone;
namespace colour = report::colour;

struct BudgetWriter {
    Language language;
    report::Page& page;

    template <class... A>
    std::string t(const char* english, const A&... arguments) const {
        return Text::chosen(english, arguments...).in(language);
    }
    static std::string number(double value, int decimals = 4) {
        return std::isfinite(value) ? fmt::format("{:.{}f}", value + 0.0, decimals) : "∞";
    }
    // So many that they count as infinite.
    static std::string degrees(double value) { return value < 1e5 ? number(value, 0) : "∞"; }
    std::string label(const BudgetRow& row) const {
        return name_of(row.source).in(language) + (row.owner.empty() ? "" : " " + row.owner);
    }
};

// Scale, shear and change of speed in parts of a thousand (of scale: mm on a metre).
constexpr double kPerMetre = 1000;
bool is_relative(const BudgetRow& row) {
    return is_share(row.source);
}

void table(const BudgetWriter& w, const MeasurandBudget& m) {
    const std::string unit = is_angle(m.quantity) ? "°" : "mm";
    Rows rows{{w.t("Contribution"), w.t("Spot"), "u(x)", w.t("Unit"), w.t("Type"), "ν", w.t("Sensitivity"),
               fmt::format("u ({})", unit), w.t("Share %"), w.t("Part")}};
    for (const BudgetRow& row : m.rows) {
        const double scale = is_relative(row) ? kPerMetre : 1;
        rows.push_back({w.label(row), row.spot_id, w.number(scale * row.input_u),
                        is_relative(row) ? "1/1000" : "mm", row.type_a ? "A" : "B", w.degrees(row.degrees),
                        w.number(row.sensitivity / scale), w.number(row.u), w.number(100 * row.share, 1),
                        is_systematic(row.source) ? w.t("systematic") : w.t("random")});
    }
    w.page.table(rows);
    w.page.paragraph(w.t("u = {} {} (random {}, systematic {}), ν = {}, k = {}, U = {} {} (95 %).",
                         w.number(m.u), unit, w.number(m.u_random), w.number(m.u_systematic),
                         w.degrees(m.degrees), w.number(m.k, 2), w.number(m.expanded), unit));
}

std::string bars(const BudgetWriter& w, const MeasurandBudget& m) {
    std::vector<report::ShareBar> all;
    for (const BudgetRow& row : m.rows) {
        const bool systematic = is_systematic(row.source);
        all.push_back({w.label(row), 100 * row.share, systematic ? colour::kVermilion : colour::kBlue,
                       systematic ? w.t("systematic") : w.t("random")});
    }
    return report::svg_bars(w.t("Shares of the variance: {}", name_of(m.quantity)), all);
}

void monte_carlo_chapter(const BudgetWriter& w, const RegionBudget& b) {
    w.page.heading(w.t("Monte Carlo beside the first order (JCGM 101)"), 3);
    if (b.first_order_holds())
        w.page.verdict(w.t("the first order holds"), Tone::good,
                       w.t("the 95 % limits of both agree within {} % of u", 100 * kAgreement));
    else
        w.page.verdict(
            w.t("the first order does not hold"), Tone::alarm,
            w.t("the 95 % limits differ by more than {} % of u, or the correction refuses too many "
                "draws: the Monte Carlo figures count",
                100 * kAgreement));
    w.page.paragraph(w.t("{} trials of the whole correction, seed {}, {} without an answer.", b.drawn->trials,
                         static_cast<std::int64_t>(b.seed), b.drawn->failed) +
                     " " +
                     (b.drawn->settled
                          ? w.t("The 95 % limits stand to 1 % of u.")
                          : w.t("The 95 % limits do not yet stand to 1 % of u: allow more trials.")));
    Rows rows{{w.t("Measurand"), w.t("Unit"), w.t("u, first order"), w.t("u, Monte Carlo"), w.t("mean"), "-U",
               w.t("low"), "+U", w.t("high"), w.t("Agree")}};
    for (const MeasurandBudget& m : b.measurands)
        rows.push_back({name_of(m.quantity).in(w.language), is_angle(m.quantity) ? "°" : "mm", w.number(m.u),
                        w.number(m.drawn->u), w.number(m.drawn->mean), w.number(-m.expanded),
                        w.number(m.drawn->low), w.number(m.expanded), w.number(m.drawn->high),
                        m.agrees ? w.t("yes") : w.t("no")});
    w.page.table(rows);
}

void region_chapter(const BudgetWriter& w, const RegionBudget& b) {
    w.page.heading(w.t("Region {}", b.region_id));
    if (b.status != CorrectionStatus::ok) {
        w.page.verdict(w.t("under-determined"), Tone::alarm, b.message.in(w.language));
        return;
    }
    const Pose& d = b.displacement.workobject_from_movedworkobject;
    const KukaAbc abc = kuka_from_rotation(d.linear());
    w.page.paragraph(w.t("Part displaced by X {} Y {} Z {} mm, A {} B {} C {} degrees; worst path point: {}.",
                         w.number(d.translation().x(), 3), w.number(d.translation().y(), 3),
                         w.number(d.translation().z(), 3), w.number(abc.a_deg), w.number(abc.b_deg),
                         w.number(abc.c_deg), b.spot_id));
    w.page.paragraph(w.t("3 u across the bead: {} mm; the project requires {} mm.",
                         w.number(3 * b.bead_u_mm(), 3), w.number(b.required_sigma3_mm, 3)));
    for (const MeasurandBudget& m : b.measurands) {
        w.page.heading(name_of(m.quantity).in(w.language), 3);
        table(w, m);
        if (m.quantity <= Quantity::binormal) w.page.figure(bars(w, m));
    }
    if (const auto all = mendings(b); !all.empty()) {
        w.page.heading(w.t("What to mend"), 3);
        Rows rows{{w.t("Contribution"), w.t("Share %"), w.t("u without it (mm)"), w.t("What helps")}};
        for (const Mending& m : all)
            rows.push_back({name_of(m.source).in(w.language), w.number(100 * m.share, 1), w.number(m.u_mm),
                            m.what.in(w.language)});
        w.page.table(rows);
    }
    if (b.drawn) monte_carlo_chapter(w, b);
    if (!b.remarks.empty()) w.page.heading(w.t("Not stated, therefore not in the budget"), 3);
    for (const Text& remark : b.remarks) w.page.paragraph(remark.in(w.language));
}

}  // namespace

Text name_of(ErrorSource source) {
    switch (source) {
        case ErrorSource::feature:
            return Text("feature noise");
        case ErrorSource::stated:
            return Text("spot's sigma");
        case ErrorSource::travel:
            return Text("trigger jitter");
        case ErrorSource::robot_run:
            return Text("arrival, run");
        case ErrorSource::reference:
            return Text("reference");
        case ErrorSource::robot_taught:
            return Text("arrival, taught");
        case ErrorSource::nozzle:
            return Text("nozzle");
        case ErrorSource::offset:
            return Text("kept offset");
        case ErrorSource::workobject:
            return Text("work object");
        case ErrorSource::robot_drift:
            return Text("drift of the robot");
        case ErrorSource::hand_eye:
            return Text("hand-eye");
        case ErrorSource::scale_x:
            return Text("scale of x");
        case ErrorSource::scale_z:
            return Text("scale of z");
        case ErrorSource::shear:
            return Text("shear");
        case ErrorSource::latency:
            return Text("latency");
        case ErrorSource::speed:
            return Text("change of speed");
        case ErrorSource::sensor_drift:
            return Text("drift of the sensor");
    }
    return {};
}

Text name_of(Quantity quantity) {
    switch (quantity) {
        case Quantity::normal:
            return Text("across the bead, normal");
        case Quantity::binormal:
            return Text("across the bead, binormal");
        default:
            return std::string(1, "XYZABC"[static_cast<int>(quantity) - static_cast<int>(Quantity::x)]);
    }
}

report::Page budget_page(std::span<const RegionBudget> budgets, const BudgetPageOptions& options) {
    report::Page page(Text("Uncertainty budget: {}", options.file).in(options.language),
                      std::string(code_of(options.language)));
    const BudgetWriter w{options.language, page};
    const std::string now = options.now_utc.empty() ? utc_now() : options.now_utc;
    page.paragraph(w.t("File {}, {} UTC, {}.", options.file, now.substr(0, 10) + " " + now.substr(11, 5),
                       options.program.empty() ? "Seamwright" : options.program));
    page.paragraph(w.t(
        "After the GUM (JCGM 100): u(x) is the standard uncertainty of the input, the sensitivity u / u(x), "
        "the shares are of the variance. Random is what differs from part to part, systematic what all "
        "parts share. A spot is named where it contributes most of its row."));
    for (const RegionBudget& b : budgets) region_chapter(w, b);
    return page;
}

}  // namespace seamwright
