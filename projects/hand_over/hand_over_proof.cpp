#include <algorithm>
#include <map>

#include "projects/hand_over/hand_over_detail.h"
#include "projects/measure/measure.h"
#include "projects/proof/budget/budget_advice.h"
#include "projects/proof/budget/budget_page.h"
#include "projects/proof/forecast.h"
#include "projects/proof/known_shift.h"
#include "projects/proof/present_names.h"
#include "projects/proof/zero_shift.h"

namespace seamwright {
namespace {

using report::Mark;
using report::Plot;
using report::Rows;
using report::Series;
using report::Tone;
namespace colour = report::colour;

std::string name_of(const HandOverWriter& w, ShiftKind kind) {
    switch (kind) {
        case ShiftKind::translation:
            return w.t("translation");
        case ShiftKind::rotation:
            return w.t("rotation");
        case ShiftKind::both:
            break;
    }
    return w.t("both");
}

// Mean length of the deviations against the displacement, a line an axis, as in the figures of chapter 5.
std::string shift_plot(const HandOverWriter& w, const KnownShift& proof, ShiftKind kind) {
    Plot plot;
    plot.title = name_of(w, kind);
    plot.x_label = kind == ShiftKind::rotation ? w.t("displacement (°)") : w.t("displacement (mm)");
    plot.y_label = w.t("mean deviation (mm)");
    plot.width_px = 400;
    plot.height_px = 250;
    plot.y_min = 0;
    constexpr std::array<const char*, 3> kColours{colour::kBlue, colour::kVermilion, colour::kGreen};
    constexpr std::array<Mark, 3> kMarks{Mark::line, Mark::dashed, Mark::dots};
    for (int axis = 0; axis < 3; ++axis) {
        Series s{std::string(1, "XYZ"[axis]),
                 {},
                 {},
                 kMarks[static_cast<std::size_t>(axis)],
                 kColours[static_cast<std::size_t>(axis)]};
        for (const ShiftTest& test : proof.tests) {
            if (test.kind != kind || test.axis != axis) continue;
            double sum = 0;
            int count = 0;
            for (const ShiftOutcome& o : test.regions)
                if (!o.deviations_mm.empty()) sum += o.mean_abs_mm, ++count;
            s.x.push_back(test.amount);
            s.y.push_back(count ? sum / count : std::nan(""));
        }
        plot.series.push_back(std::move(s));
    }
    return report::svg(plot);
}

// All deviations, counted in classes.
std::string histogram(const HandOverWriter& w, const KnownShift& proof) {
    std::vector<double> all;
    for (const ShiftTest& test : proof.tests)
        for (const ShiftOutcome& o : test.regions)
            all.insert(all.end(), o.deviations_mm.begin(), o.deviations_mm.end());
    Plot plot;
    plot.title = w.t("Deviations X, Y, Z at the spots");
    plot.x_label = "mm";
    plot.y_label = w.t("share (%)");
    plot.width_px = 400;
    plot.height_px = 250;
    if (all.empty()) return report::svg(plot);
    double reach = 1e-6;
    for (double d : all) reach = std::max(reach, std::abs(d));
    constexpr int kClasses = 25;
    std::array<double, kClasses> counts{};
    for (double d : all) {
        const int k = static_cast<int>((d + reach) / (2 * reach) * kClasses);
        counts[static_cast<std::size_t>(std::clamp(k, 0, kClasses - 1))] +=
            100.0 / static_cast<double>(all.size());
    }
    Series bars{w.t("share"), {}, {}, Mark::bars, colour::kBlue};
    for (int k = 0; k < kClasses; ++k) {
        bars.x.push_back(k);
        bars.y.push_back(counts[static_cast<std::size_t>(k)]);
        plot.categories.push_back(
            k % 6 == 0 ? fmt::format("{:+.2f}", -reach + (k + 0.5) * 2 * reach / kClasses) : std::string());
    }
    plot.series = {bars};
    return report::svg(plot);
}

// Random and systematic apart, and what they are made of.
void uncertainty_of(HandOverWriter& w, const Region& region) {
    const auto budget = worst_budget(w.project, region);
    const MeasurandBudget* m = budget ? worst_across_bead(*budget) : nullptr;
    if (!m) return;
    w.page.heading(w.t("What region {} is uncertain by", region.id), 3);
    w.page.paragraph(
        w.t("Across the bead at spot {}, where it is worst of the part as taught and as displaced by what is "
            "required: "
            "u = {} mm (random {}, systematic {}), U = {} mm (95 %).",
            budget->spot_id, w.number(m->u, 4), w.number(m->u_random, 4), w.number(m->u_systematic, 4),
            w.number(m->expanded, 4)));
    Rows rows{{w.t("Contribution"), w.t("Part"), "u mm", w.t("Share %")}};
    for (const BudgetRow& row : m->rows)
        rows.push_back(
            {name_of(row.source).in(w.options.language) + (row.owner.empty() ? "" : " " + row.owner),
             is_systematic(row.source) ? w.t("systematic") : w.t("random"), w.number(row.u, 4),
             w.number(100 * row.share, 1)});
    w.page.table(rows);
    for (const Text& remark : budget->remarks) w.page.paragraph(remark.in(w.options.language));
}

}  // namespace

void regions_chapter(HandOverWriter& w) {
    w.page.heading(w.t("Regions"));
    const Evidence* e = newest<KnownShift>(w.facts);
    Rows rows{{w.t("Region"), w.t("Spots"), w.t("Predicted 3 sigma mm"), w.t("Proven 3 sigma mm"),
               w.t("Largest deviation mm"), w.t("Required 3 sigma mm"), w.t("Redundancy"),
               w.t("Weakest direction")}};
    for (const Region& r : w.project.regions) {
        const auto forecast = forecast_region(w.project, r);
        const ProvenAccuracy proven =
            e ? proven_accuracy(in_present_names<KnownShift>(*e, w.facts, w.project), r.id)
              : ProvenAccuracy{};
        std::string spots;
        for (const std::string& id : r.spot_ids) spots += (spots.empty() ? "" : ", ") + id;
        rows.push_back({r.id, spots, forecast ? w.number(3 * forecast->sigma_mm, 3) : "-",
                        proven.tests ? w.number(proven.three_sigma_mm, 3) : "-",
                        proven.tests ? w.number(proven.worst_mm, 3) : "-",
                        w.number(w.project.requirements.sigma3_mm, 3),
                        forecast ? fmt::format("{}", forecast->plan.redundancy) : "-",
                        (forecast ? forecast->plan.weakest : forecast.error().what).in(w.options.language)});
    }
    w.page.table(rows);
    w.page.paragraph(w.t(
        "Predicted: 3 sigma at the worst spot along its worst direction, as the safety gate judges it, over "
        "the part as taught and as displaced by what is required. Proven: 3 times the root mean square of "
        "the deviations of the known shift, bias included."));
    for (const Region& r : w.project.regions) uncertainty_of(w, r);
    for (const Region& r : w.project.regions)
        if (const KeptOffset* kept = acting_offset(r))
            w.page.verdict(
                w.t("offset"), report::Tone::attention,
                w.t("Region {}: {} ({}, {}).", r.id, said_of(ActingOffset{kept->version, kept->offset_mm}),
                    kept->source, w.time_of(kept->utc)));
}

void zero_shift_chapter(HandOverWriter& w) {
    w.page.heading(w.t("Zero shift"));
    const Evidence* e = newest<ZeroShift>(w.facts);
    if (!e) return w.page.verdict(w.t("not proven"), Tone::alarm, w.t("the unmoved part was not measured"));
    const auto zero = in_present_names<ZeroShift>(*e, w.facts, w.project);
    w.stale_note(*e);
    w.page.paragraph(w.t("The part as taught, not touched, measured {} times on {}; {} refused.",
                         zero.runs.size(), w.time_of(e->utc), zero.refused));
    Rows rows{{w.t("Region"), "", "X mm", "Y mm", "Z mm", "A °", "B °", "C °"}};
    for (const ZeroShiftRegion& r : zero.regions)
        for (const auto& [name, values] : {std::pair{w.t("mean"), &r.mean},
                                           {w.t("3 sigma"), &r.three_sigma},
                                           {w.t("stated 3 sigma"), &r.stated_three_sigma}}) {
            std::vector<std::string> row{r.region_id, name};
            for (std::size_t k = 0; k < 6; ++k) row.push_back(w.number((*values)[k], k < 3 ? 3 : 4));
            rows.push_back(std::move(row));
        }
    w.page.table(rows, w.t("Displacement of the work object; its origin may lie far from the spots."));
    rows = {{w.t("Region"), w.t("Mean deviation at its spots, largest, mm")}};
    for (const ZeroShiftRegion& r : zero.regions) rows.push_back({r.region_id, w.number(r.worst_mean_mm, 3)});
    w.page.table(rows);
}

void known_shift_chapter(HandOverWriter& w) {
    w.page.heading(w.t("Known shift"));
    const Evidence* e = newest<KnownShift>(w.facts);
    if (!e)
        return w.page.verdict(w.t("not proven"), Tone::alarm,
                              w.t("the part was not displaced by known amounts"));
    const auto proof = in_present_names<KnownShift>(*e, w.facts, w.project);
    w.stale_note(*e);
    const std::string how = proof.realised_by == ShiftBy::simulated_part ? w.t("the simulated part was moved")
                            : proof.realised_by == ShiftBy::robot_moves
                                ? w.t("the robot's moves were shifted the other way")
                                : w.t("shifted by hand");
    w.page.paragraph(w.t("{} displacements along and about X, Y and Z up to {} mm and {}° on {}; {}.",
                         proof.tests.size(), proof.range_mm, proof.range_deg, w.time_of(e->utc), how));
    Rows rows{{w.t("Region"), w.t("Displacement"), w.t("Tests"), w.t("Refused"), w.t("Mean mm"), "Min mm",
               "Max mm", w.t("Variance mm²"), w.t("3 sigma mm"), w.t("3 rms mm")}};
    for (const ShiftStatistic& s : statistics(proof))
        rows.push_back({s.region_id.empty() ? w.t("all regions") : s.region_id, name_of(w, s.kind),
                        fmt::format("{}", s.tests), fmt::format("{}", s.refused), w.number(s.summary.mean, 4),
                        w.number(s.summary.minimum, 4), w.number(s.summary.maximum, 4),
                        w.number(s.summary.variance, 5), w.number(s.summary.three_sigma, 4),
                        w.number(s.about_truth_mm, 4)});
    w.page.table(
        rows, w.t("Deviation of the spots' reference points: found minus true position, three components."));
    w.page.figures({shift_plot(w, proof, ShiftKind::translation), shift_plot(w, proof, ShiftKind::rotation),
                    shift_plot(w, proof, ShiftKind::both), histogram(w, proof)});
}

void headless_chapter(HandOverWriter& w) {
    w.page.heading(w.t("Run without the screen"));
    const Evidence* e = newest<HeadlessRun>(w.facts);
    if (!e) return w.page.verdict(w.t("not proven"), Tone::alarm);
    const auto& run = std::get<HeadlessRun>(e->what);
    w.page.paragraph(run.push ? w.t("Run {} of part {} on {}: ended ok, pushed and read back, {}.", run.run,
                                    run.part_id, run.host, w.time_of(e->utc))
                              : w.t("Run {} of part {} on {}: ended ok, dry run, {}.", run.run, run.part_id,
                                    run.host, w.time_of(e->utc)));
}

}  // namespace seamwright
