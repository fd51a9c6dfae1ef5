#include "projects/evaluate/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "projects/evaluate/online_report.h"
#include "projects/report/html.h"
#include "projects/report/svg_plot.h"

namespace seamwright::evaluation {
namespace {

using nlohmann::json;
using Rows = std::vector<std::vector<std::string>>;

// 3 sigma of tables 5.1 to 5.5, mm.
constexpr double kThesis[5][3] = {{0.3284, 0.3672, 0.3274},
                                  {0.4157, 0.4177, 0.3670},
                                  {0.0769, 0.0864, 0.0527},
                                  {1.1493, 1.6133, 1.5466},
                                  {1.0189, 1.5229, 1.5012}};
constexpr const char* kColumns[3] = {"translation", "rotation", "both"};
constexpr double kTargetMm = 0.05, kTargetImprovement = 4, kTargetEfficiency = 0.9, kTargetBiasMm = 0.01;
constexpr double kWheelhouseMm = 350, kSlideMm = 10;

std::string conditions(const EvaluationResult& r) {
    const EvaluationSettings& s = r.settings;
    return fmt::format(
        "Simulated, not measured on a machine: procedural door, 12 spots in one region; profiles cut from "
        "the "
        "mesh (no images rendered), sensor noise {:g} mm per point (1 sigma, x and z), robot repeatability "
        "{:g} "
        "mm (3 sigma per axis), trigger jitter +-{:g} mm when in motion and not reported, sensors turned by "
        "{:g} "
        "deg in experiments 4 and 5, door bent by {:g} mm, no reflections, calibration exact unless said "
        "otherwise, seed {}. Deviations: x, y and z of the found against the true place of each spot's "
        "landmark.",
        s.noise_mm, 3 * s.repeatability_mm, s.jitter_mm, s.misalignment_deg, s.bend_mm, s.seed);
}

Rows table(const EvaluationResult& r) {
    Rows rows{{"experiment", "column", "mean", "min", "max", "variance", "3 sigma", "stated 3 sigma",
               "thesis 3 sigma", "refused"}};
    for (const ExperimentResult& e : r.experiments)
        for (std::size_t c = 0; c < 3; ++c) {
            const Summary& s = e.summary[c];
            rows.push_back({std::to_string(e.method.number), kColumns[c], fmt::format("{:.4f}", s.mean),
                            fmt::format("{:.4f}", s.minimum), fmt::format("{:.4f}", s.maximum),
                            fmt::format("{:.5f}", s.variance), fmt::format("{:.4f}", s.three_sigma),
                            fmt::format("{:.4f}", e.stated_three_sigma[c]),
                            fmt::format("{:.4f}", kThesis[e.method.number - 1][c]),
                            std::to_string(e.refused[c])});
        }
    return rows;
}

Rows budget_table(const EvaluationResult& r) {
    Rows rows{{"source", "3 sigma alone", "stated 3 sigma", "adds"}};
    for (const BudgetLine& b : r.budget)
        rows.push_back({b.name, fmt::format("{:.4f}", b.three_sigma_mm),
                        std::isfinite(b.stated_mm) ? fmt::format("{:.4f}", b.stated_mm) : "-",
                        fmt::format("{:.4f}", b.adds_mm)});
    return rows;
}

const CurveStep* step_at(const CurvedContour& c, double displacement_mm) {
    for (const CurveStep& s : c.steps)
        if (std::abs(s.displacement_mm - displacement_mm) < 1e-9) return &s;
    return nullptr;
}

Rows curve_table(const EvaluationResult& r) {
    Rows rows{{"radius", "line errs by (5.1)", "straight line", "learnt curve", "sigma", "learnt, worst spot",
               "region, straight", "region, learnt"}};
    for (const CurvedContour& c : r.curved)
        if (const CurveStep* s = step_at(c, kSlideMm))
            rows.push_back({fmt::format("{:g}", c.radius_mm), fmt::format("{:.4f}", s->expected_mm),
                            fmt::format("{:.4f}", s->straight_mm), fmt::format("{:.4f}", s->learnt_mm),
                            fmt::format("{:.4f}", s->sigma_mm), fmt::format("{:.4f}", s->learnt_worst_mm),
                            fmt::format("{:.4f}", s->region_straight_mm),
                            fmt::format("{:.4f}", s->region_learnt_mm)});
    return rows;
}

int solved_trials(const ExperimentResult& e) {
    return static_cast<int>(3 * e.trials[0].size()) - e.refused[0] - e.refused[1] - e.refused[2];
}

bool nees_holds(double value, int trials) {
    const NeesInterval i = nees_interval(6, std::max(1, trials));
    return value >= i.low && value <= i.high;
}

std::string nees_words(double value, int trials) {
    const NeesInterval i = nees_interval(6, std::max(1, trials));
    return fmt::format("{:.2f}, 95 % interval {:.2f} .. {:.2f}", value, i.low, i.high);
}

// Where the stated covariance is not the truth: which assumption is broken.
std::string why_not(const EvaluationResult& r, const ExperimentResult& e) {
    if (r.settings.bend_mm != 0) return "the model does not hold here: the part is not rigid";
    if (e.method.misaligned)
        return "the model does not hold here: the contour does not run along the sensor's Y, so that it "
               "seems to "
               "move across when the part or the trigger slides along it";
    if (!e.method.matched)
        return "the model does not hold here: the contour's last point lies on the rounded fold, and which "
               "point "
               "of the fold is the last one changes with the place from which the sensor sees it. Teaching, "
               "always at the same place, does not see that";
    return "the model does not hold everywhere here: it is of first order in the jitter and knows the "
           "contour's "
           "curve only as a cubic at the taught place; on straight contours it holds (below)";
}

std::string remark(const EvaluationResult& r, const ExperimentResult& e) {
    const int trials = solved_trials(e);
    const Growth& g = e.growth;
    std::string text = fmt::format(
        "{} {}: frozen-contour check calls {} of {} spots drifting beforehand (worst yaw {:.2f} deg); spread "
        "of "
        "a measure {:.4f} mm. ",
        e.method.number, e.method.name, e.flagged, e.spots, e.worst_yaw_deg, e.sigma_mm);
    if (g.grows())
        text += fmt::format(
            "Deviation grows by {:.4f} mm per mm along {}; a straight line explains {:.0f} % of it, squares "
            "and "
            "cubes {:.1f} % more: {}. ",
            g.slope_mm_per_mm, g.axis, 100 * g.linear_share, 100 * g.bend_share,
            g.linear() ? "it grows linearly" : "it does not grow linearly");
    else
        text += fmt::format("Deviation does not grow with the displacement ({:.4f} mm per mm along {}). ",
                            g.slope_mm_per_mm, g.axis);
    text += fmt::format("NEES {}: {}.", nees_words(e.nees, trials),
                        nees_holds(e.nees, trials) ? "the stated covariance holds" : why_not(r, e));
    return text;
}

std::string straight_text(const EvaluationResult& r) {
    const StraightTrials& s = r.straight;
    return fmt::format(
        "Straight pieces of the door's rim at the same 12 spots. Sensor noise alone, part in its place, {} "
        "trials: displacement of the spots {:.5f} mm rms, Cramer-Rao bound {:.5f} mm, efficiency {:.2f}; of "
        "a "
        "single landmark {:.2f}. Had each spot stated one sigma for x and z instead of their covariance: "
        "{:.2f}. "
        "With the robot's repeatability and displacements up to 10 mm and 1 degree about every axis, {} "
        "trials: "
        "NEES standing still {}; in motion, with the jitter {}: {}. 3 sigma in motion {:.4f} mm.",
        s.trials, s.found_mm, s.bound_mm, s.efficiency, s.landmark_efficiency, s.efficiency_one_sigma,
        s.trials, nees_words(s.nees_still, s.trials), nees_words(s.nees_in_motion, s.trials),
        nees_holds(s.nees_still, s.trials) && nees_holds(s.nees_in_motion, s.trials)
            ? "the stated covariance holds"
            : "the stated covariance does not hold",
        s.three_sigma_mm);
}

std::string budget_caption() {
    return fmt::format(
        "Error budget of experiment 3, each source alone, column \"both\", mm. Calibration error {:g} mm and "
        "{:g} "
        "deg per axis (1 sigma) of every sensor; part deformed by {:g} mm at its far side. Every line holds "
        "what "
        "the first one leaves; \"adds\" is without it.",
        kBudgetCalibrationMm, kBudgetCalibrationDeg, kBudgetBendMm);
}

std::string curve_caption() {
    return "Curved contours: bias in mm when the part slides by 10 mm along six of twelve contours, means "
           "over "
           "noisy measures with their standard error sigma. Opposite sides bend the same way, so that the "
           "region cannot average it out";
}

std::string aligned(const Rows& rows) {
    std::vector<std::size_t> width;
    for (const auto& row : rows)
        for (std::size_t k = 0; k < row.size(); ++k) {
            if (width.size() <= k) width.push_back(0);
            width[k] = std::max(width[k], row[k].size());
        }
    std::string text;
    for (const auto& row : rows) {
        std::string line;
        for (std::size_t k = 0; k < row.size(); ++k)
            line +=
                k == 0 ? fmt::format("{:<{}}", row[k], width[k]) : fmt::format("  {:>{}}", row[k], width[k]);
        text += line + "\n";
    }
    return text;
}

std::string wrapped(const std::string& text, std::size_t columns = 118) {
    std::string out, line;
    std::size_t from = 0;
    while (from < text.size()) {
        const std::size_t to = std::min(text.find(' ', from), text.size());
        const std::string word = text.substr(from, to - from);
        if (!line.empty() && line.size() + 1 + word.size() > columns) {
            out += line + "\n";
            line.clear();
        }
        line += (line.empty() ? "" : " ") + word;
        from = to + 1;
    }
    return out + line + "\n";
}

std::string histogram(const Summary& s, const std::vector<EvaluationTrial>& trials,
                      const std::string& title) {
    constexpr int kBins = 41;
    const double reach = std::max({std::abs(s.minimum), std::abs(s.maximum), 1e-6});
    report::Series bars{"deviations", {}, {}, report::Mark::bars, report::colour::kBlue};
    report::Series gauss{"normal", {}, {}, report::Mark::line, report::colour::kVermilion};
    const double width = 2 * reach / kBins, sigma = std::max(1e-9, s.three_sigma / 3);
    std::vector<double> counts(kBins, 0.0);
    for (const EvaluationTrial& t : trials)
        for (double v : t.deviations_mm)
            ++counts[static_cast<std::size_t>(
                std::clamp(static_cast<int>((v + reach) / width), 0, kBins - 1))];
    for (int b = 0; b < kBins; ++b) {
        const double x = -reach + (b + 0.5) * width;
        bars.x.push_back(x);
        bars.y.push_back(counts[static_cast<std::size_t>(b)]);
        gauss.x.push_back(x);
        gauss.y.push_back(static_cast<double>(s.count) * width / (sigma * std::sqrt(2 * kPi)) *
                          std::exp(-0.5 * std::pow((x - s.mean) / sigma, 2)));
    }
    report::Plot plot;
    plot.title = title;
    plot.x_label = "deviation (mm)";
    plot.y_label = "count";
    plot.series = {bars, gauss};
    return report::svg(plot);
}

std::string deviation_plot(const std::vector<EvaluationTrial>& trials, std::size_t column,
                           const std::string& title, double stated_three_sigma) {
    report::Plot plot;
    plot.title = title;
    plot.x_label = column == 1 ? "displacement (degree)" : "displacement (mm)";
    plot.y_label = "mean deviation (mm)";
    plot.bands = {{0, stated_three_sigma, "stated 3 sigma"}};
    const char* colours[3] = {report::colour::kBlue, report::colour::kVermilion, report::colour::kGreen};
    const std::size_t steps = trials.size() / 3;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        report::Series s{std::string("along ") + "XYZ" [axis], {}, {}, report::Mark::line, colours[axis]};
        for (std::size_t i = steps * axis; i < steps * (axis + 1); ++i) {
            s.x.push_back(trials[i].displacement);
            s.y.push_back(trials[i].ok ? trials[i].mean_abs_mm : std::nan(""));
        }
        plot.series.push_back(std::move(s));
    }
    return report::svg(plot);
}

std::string curve_plot(const EvaluationResult& r, bool learnt) {
    const char* colours[] = {report::colour::kVermilion, report::colour::kBlue,   report::colour::kGreen,
                             report::colour::kAmber,     report::colour::kPurple, report::colour::kGrey};
    report::Plot plot;
    plot.title = learnt ? "Curve learnt from entry to exit" : "Straight line";
    plot.x_label = "displacement along the contour (mm)";
    plot.y_label = "bias (mm)";
    plot.bands = {{-kTargetBiasMm, kTargetBiasMm, "+-0.01 mm"}};
    std::size_t k = 0;
    for (const CurvedContour& c : r.curved) {
        report::Series s{fmt::format("R {:g}", c.radius_mm),
                         {},
                         {},
                         report::Mark::line,
                         colours[k++ % std::size(colours)]};
        if (k > std::size(colours)) s.mark = report::Mark::dashed;
        for (const CurveStep& step : c.steps) {
            s.x.push_back(step.displacement_mm);
            s.y.push_back(learnt ? step.learnt_mm : step.straight_mm);
        }
        plot.series.push_back(std::move(s));
    }
    return report::svg(plot);
}

std::string budget_plot(const EvaluationResult& r) {
    report::Plot plot;
    plot.title = "What each source adds";
    plot.y_label = "3 sigma (mm)";
    report::Series bars{"adds", {}, {}, report::Mark::bars, report::colour::kBlue};
    const char* shorter[] = {"curvature", "noise", "robot", "jitter", "calibration", "deformation", "all"};
    for (std::size_t i = 0; i < r.budget.size() && i < std::size(shorter); ++i) {
        plot.categories.push_back(shorter[i]);
        bars.x.push_back(static_cast<double>(i));
        bars.y.push_back(r.budget[i].adds_mm);
    }
    plot.series = {bars};
    return report::svg(plot);
}

const ExperimentResult* find(const EvaluationResult& r, int number) {
    for (const ExperimentResult& e : r.experiments)
        if (e.method.number == number) return &e;
    return nullptr;
}

}  // namespace

std::vector<EvaluationCheck> evaluation_checks(const EvaluationResult& r) {
    std::vector<EvaluationCheck> checks;
    const ExperimentResult *first = find(r, 1), *third = find(r, 3);
    if (third) {
        double worst = 0;
        for (const Summary& s : third->summary) worst = std::max(worst, s.three_sigma);
        checks.push_back({fmt::format("experiment 3: 3 sigma at most {:g} mm in all columns", kTargetMm),
                          fmt::format("{:.4f} mm at worst", worst), worst <= kTargetMm});
    }
    if (first && third) {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t c = 0; c < 3; ++c)
            least = std::min(least, first->summary[c].three_sigma / third->summary[c].three_sigma);
        checks.push_back({fmt::format("experiment 3 at least {:g} times better than 1", kTargetImprovement),
                          fmt::format("{:.1f} times at least", least), least >= kTargetImprovement});
    }
    for (const ExperimentResult& e : r.experiments) {
        if (e.method.misaligned) {
            checks.push_back(
                {fmt::format("experiment {}: deviation grows linearly with the displacement",
                             e.method.number),
                 fmt::format("{:.4f} mm per mm, straight line {:.0f} %, squares and cubes {:.1f} %",
                             e.growth.slope_mm_per_mm, 100 * e.growth.linear_share,
                             100 * e.growth.bend_share),
                 e.growth.grows() && e.growth.linear()});
            checks.push_back(
                {fmt::format("experiment {}: frozen contour flags its spots beforehand", e.method.number),
                 fmt::format("{} of {}", e.flagged, e.spots), e.flagged == e.spots});
        } else {
            checks.push_back(
                {fmt::format("experiment {}: frozen contour passes aligned spots", e.method.number),
                 fmt::format("{} of {} flagged", e.flagged, e.spots), e.flagged == 0});
        }
    }
    if (r.straight.trials > 0) {
        const StraightTrials& s = r.straight;
        checks.push_back({fmt::format("straight contours: efficiency at least {:g}", kTargetEfficiency),
                          fmt::format("{:.2f}", s.efficiency), s.efficiency >= kTargetEfficiency});
        checks.push_back({"straight contours, standing still: NEES within its 95 % interval",
                          nees_words(s.nees_still, s.trials), nees_holds(s.nees_still, s.trials)});
        checks.push_back({"straight contours, in motion: NEES within its 95 % interval",
                          nees_words(s.nees_in_motion, s.trials), nees_holds(s.nees_in_motion, s.trials)});
    }
    for (const CurvedContour& c : r.curved)
        if (c.radius_mm == kWheelhouseMm) {
            double learnt = 0, straight = 0;
            for (const double e : {-kSlideMm, kSlideMm})
                if (const CurveStep* s = step_at(c, e)) {
                    learnt = std::max(learnt, std::abs(s->learnt_mm));
                    straight = std::max(straight, std::abs(s->straight_mm));
                }
            checks.push_back({fmt::format("radius {:g}, {:g} mm along the contour: bias at most {:g} mm",
                                          kWheelhouseMm, kSlideMm, kTargetBiasMm),
                              fmt::format("{:.4f} mm, straight line {:.4f} mm", learnt, straight),
                              learnt <= kTargetBiasMm});
        }
    return checks;
}

json evaluation_json(const EvaluationResult& r) {
    json experiments = json::array();
    for (const ExperimentResult& e : r.experiments) {
        json columns = json::object();
        for (std::size_t c = 0; c < 3; ++c) {
            const Summary& s = e.summary[c];
            columns[kColumns[c]] = {{"mean_mm", s.mean},
                                    {"min_mm", s.minimum},
                                    {"max_mm", s.maximum},
                                    {"variance_mm2", s.variance},
                                    {"three_sigma_mm", s.three_sigma},
                                    {"stated_three_sigma_mm", e.stated_three_sigma[c]},
                                    {"thesis_three_sigma_mm", kThesis[e.method.number - 1][c]},
                                    {"refused", e.refused[c]}};
        }
        const int trials = solved_trials(e);
        const NeesInterval i = nees_interval(6, std::max(1, trials));
        experiments.push_back({{"experiment", e.method.number},
                               {"name", e.method.name},
                               {"columns", columns},
                               {"sigma_mm", e.sigma_mm},
                               {"nees", e.nees},
                               {"nees_interval", {i.low, i.high}},
                               {"model_holds", nees_holds(e.nees, trials)},
                               {"spots", e.spots},
                               {"flagged_drifting", e.flagged},
                               {"worst_yaw_deg", e.worst_yaw_deg},
                               {"steepest_axis", std::string(1, e.growth.axis)},
                               {"slope_mm_per_mm", e.growth.slope_mm_per_mm},
                               {"linear_share", e.growth.linear_share},
                               {"bend_share", e.growth.bend_share},
                               {"grows_linearly", e.growth.grows() && e.growth.linear()}});
        if (!nees_holds(e.nees, trials)) experiments.back()["why_not"] = why_not(r, e);
    }
    json budget = json::array(), curved = json::array(), checks = json::array();
    for (const BudgetLine& b : r.budget)
        budget.push_back({{"source", b.name},
                          {"three_sigma_mm", b.three_sigma_mm},
                          {"stated_three_sigma_mm", std::isfinite(b.stated_mm) ? json(b.stated_mm) : json()},
                          {"adds_mm", b.adds_mm}});
    for (const CurvedContour& c : r.curved) {
        json steps = json::array();
        for (const CurveStep& s : c.steps)
            steps.push_back({{"displacement_mm", s.displacement_mm},
                             {"expected_mm", s.expected_mm},
                             {"straight_mm", s.straight_mm},
                             {"learnt_mm", s.learnt_mm},
                             {"sigma_mm", s.sigma_mm},
                             {"learnt_worst_mm", s.learnt_worst_mm},
                             {"region_straight_mm", s.region_straight_mm},
                             {"region_learnt_mm", s.region_learnt_mm}});
        curved.push_back({{"radius_mm", c.radius_mm}, {"steps", steps}});
    }
    for (const EvaluationCheck& c : evaluation_checks(r))
        checks.push_back({{"promise", c.promise}, {"found", c.found}, {"kept", c.kept}});
    const EvaluationSettings& s = r.settings;
    json out = {{"conditions",
                 {{"seed", s.seed},
                  {"noise_mm", s.noise_mm},
                  {"repeatability_three_sigma_mm", 3 * s.repeatability_mm},
                  {"jitter_mm", s.jitter_mm},
                  {"misalignment_deg", s.misalignment_deg},
                  {"bend_mm", s.bend_mm},
                  {"simulated", "profiles cut from the procedural door's mesh"}}},
                {"experiments", experiments},
                {"checks", checks}};
    if (r.straight.trials > 0) {
        const NeesInterval i = nees_interval(6, r.straight.trials);
        out["budget"] = budget;
        out["straight"] = {{"trials", r.straight.trials},
                           {"bound_mm", r.straight.bound_mm},
                           {"found_mm", r.straight.found_mm},
                           {"efficiency", r.straight.efficiency},
                           {"landmark_efficiency", r.straight.landmark_efficiency},
                           {"efficiency_one_sigma", r.straight.efficiency_one_sigma},
                           {"nees_still", r.straight.nees_still},
                           {"nees_in_motion", r.straight.nees_in_motion},
                           {"nees_interval", {i.low, i.high}},
                           {"three_sigma_mm", r.straight.three_sigma_mm},
                           {"refused", r.straight.refused}};
        out["curved"] = curved;
    }
    if (r.online) out["online"] = online_json(*r.online);
    return out;
}

std::string evaluation_html(const EvaluationResult& r) {
    report::Page page("Evaluation: the thesis's five experiments, simulated");
    page.paragraph(conditions(r));
    if (!r.experiments.empty()) page.table(table(r), "Deviations at the spots after correction, mm");
    Rows kept{{"promised", "found", "kept"}};
    for (const EvaluationCheck& c : evaluation_checks(r))
        kept.push_back({c.promise, c.found, c.kept ? "yes" : "no"});
    if (kept.size() > 1) page.table(kept, "What was promised, what was found");
    for (const ExperimentResult& e : r.experiments) {
        page.heading(fmt::format("Experiment {}: {}", e.method.number, e.method.name));
        page.paragraph(remark(r, e));
        std::vector<std::string> curves, histograms;
        for (std::size_t c = 0; c < 3; ++c) {
            curves.push_back(deviation_plot(e.trials[c], c, kColumns[c], e.stated_three_sigma[c]));
            histograms.push_back(histogram(e.summary[c], e.trials[c], kColumns[c]));
        }
        page.figures(curves, "Mean deviation at the spots against displacement");
        page.figures(histograms,
                     "Histogram of the deviations, with the normal distribution of their moments");
    }
    if (r.straight.trials > 0) {
        page.heading("How good could it be");
        page.paragraph(straight_text(r));
        page.table(budget_table(r), budget_caption());
        page.figure(budget_plot(r));
        page.heading("Curved contours");
        page.table(curve_table(r), curve_caption());
        page.figures({curve_plot(r, false), curve_plot(r, true)},
                     "Bias against displacement along the contour");
    }
    if (r.online) {
        page.heading("Online correction, simulated");
        page.table(online_table(*r.online), online_caption(*r.online));
        page.paragraph(online_verdict(*r.online));
        page.figures({online_curve(*r.online, false), online_curve(*r.online, true)},
                     "Error along the path, one part");
        page.figure(online_speeds(*r.online));
    }
    return page.html();
}

std::string evaluation_text(const EvaluationResult& r) {
    std::string text = wrapped(conditions(r)) + "\n";
    if (!r.experiments.empty()) text += aligned(table(r)) + "\n";
    for (const ExperimentResult& e : r.experiments) text += wrapped(remark(r, e));
    if (r.straight.trials > 0)
        text += "\n" + wrapped(straight_text(r)) + "\n" + wrapped(budget_caption()) +
                aligned(budget_table(r)) + "\n" + wrapped(curve_caption()) + aligned(curve_table(r));
    if (r.online)
        text += "\n" + wrapped(online_caption(*r.online)) + aligned(online_table(*r.online)) +
                wrapped(online_verdict(*r.online));
    Rows kept;
    for (const EvaluationCheck& c : evaluation_checks(r))
        kept.push_back({c.promise, c.kept ? "kept" : "NOT KEPT", c.found});
    if (!kept.empty()) text += "\n" + aligned(kept);
    text +=
        fmt::format("\n{} profiles in {:.1f} s with {} threads\n", r.profiles, r.seconds, r.settings.jobs);
    return text;
}

}  // namespace seamwright::evaluation
