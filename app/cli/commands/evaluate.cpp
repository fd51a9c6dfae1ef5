// seamwright evaluate: the thesis's experiments on the simulated cell, our table beside the thesis's.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/cli/command.h"
#include "app/cli/evaluate/experiments.h"
#include "app/cli/evaluate/panel_experiment.h"
#include "devices/exchange/files.h"
#include "projects/report/html.h"
#include "projects/report/svg_plot.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

// 3 sigma of tables 5.1 to 5.5, mm.
constexpr double kThesis[5][3] = {{0.3284, 0.3672, 0.3274},
                                  {0.4157, 0.4177, 0.3670},
                                  {0.0769, 0.0864, 0.0527},
                                  {1.1493, 1.6133, 1.5466},
                                  {1.0189, 1.5229, 1.5012}};
constexpr const char* kColumns[3] = {"translation", "rotation", "both"};

std::string conditions(const EvaluationResult& r) {
    const EvaluationSettings& s = r.settings;
    return fmt::format(
        "Simulated, not measured on a machine: procedural door, 12 spots in one region; profiles cut from "
        "the "
        "mesh (no images rendered),\nsensor noise {:g} mm per point (1 sigma, x and z), robot repeatability "
        "{:g} mm (3 sigma per axis), trigger jitter +-{:g} mm when in\nmotion and not reported, sensors "
        "turned "
        "by {:g} deg in experiments 4 and 5, door bent by {:g} mm, no reflections, calibration exact,\nseed "
        "{}. Deviations: x, y and z of the found against the true place of each spot's landmark.",
        s.noise_mm, 3 * s.repeatability_mm, s.jitter_mm, s.misalignment_deg, s.bend_mm, s.seed);
}

std::vector<std::vector<std::string>> table(const EvaluationResult& r) {
    std::vector<std::vector<std::string>> rows{
        {"experiment", "column", "mean", "min", "max", "variance", "3 sigma", "thesis 3 sigma", "refused"}};
    for (const ExperimentResult& e : r.experiments)
        for (std::size_t c = 0; c < 3; ++c) {
            const Summary& s = e.summary[c];
            rows.push_back({std::to_string(e.number), kColumns[c], fmt::format("{:.4f}", s.mean),
                            fmt::format("{:.4f}", s.minimum), fmt::format("{:.4f}", s.maximum),
                            fmt::format("{:.5f}", s.variance), fmt::format("{:.4f}", s.three_sigma),
                            fmt::format("{:.4f}", kThesis[e.number - 1][c]), std::to_string(e.refused[c])});
        }
    return rows;
}

std::string remark(const EvaluationResult& r, const ExperimentResult& e) {
    const int trials = static_cast<int>(3 * e.trials[0].size()) - e.refused[0] - e.refused[1] - e.refused[2];
    const NeesInterval i = nees_interval(6, std::max(1, trials));
    const bool holds = e.nees >= i.low && e.nees <= i.high;
    return fmt::format(
        "{} {}: frozen-contour check calls {} of {} spots drifting (worst yaw {:.2f} deg); stated sigma "
        "{:.4f} "
        "mm; deviation grows by {:.4f} mm per mm along {},\n   a straight line explains {:.0f} %; NEES "
        "{:.2f}, 95 % "
        "interval {:.2f} .. {:.2f}: {}",
        e.number, e.name, e.flagged, e.spots, e.worst_yaw_deg, e.sigma_mm, e.slope_mm_per_mm, e.steepest,
        100 * e.linear_share, e.nees, i.low, i.high,
        holds ? "the stated covariance holds"
              : (e.number == 3 && r.settings.bend_mm == 0
                     ? "the model leaves out jitter along the contour and curvature beyond the learnt curve"
                     : "the model (straight or learnt contour, rigid part, aligned travel) does not hold "
                       "here"));
}

std::string noise_text(const EvaluationResult& r) {
    if (r.noise.trials == 0 || r.budget.empty()) return {};
    const NeesInterval i = nees_interval(6, r.noise.trials);
    std::string text = fmt::format(
        "sensor noise alone ({} trials, door in its place): spots rms {:.5f} mm, Cramer-Rao bound {:.5f} mm, "
        "efficiency {:.2f}\nwith the robot's repeatability: NEES {:.3f}, 95 % interval {:.3f} .. {:.3f}: "
        "{}\n",
        r.noise.trials, r.noise.found_mm, r.noise.bound_mm, r.noise.efficiency, r.noise.nees, i.low, i.high,
        r.noise.nees >= i.low && r.noise.nees <= i.high ? "inside" : "outside");
    text += "error budget of experiment 3, each source alone, 3 sigma of column \"both\":\n";
    for (const BudgetLine& b : r.budget)
        text += fmt::format("  {:<34} {:.4f} mm\n", b.name, b.three_sigma_mm);
    return text;
}

json result_json(const EvaluationResult& r) {
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
                                    {"thesis_three_sigma_mm", kThesis[e.number - 1][c]},
                                    {"refused", e.refused[c]}};
        }
        experiments.push_back({{"experiment", e.number},
                               {"name", e.name},
                               {"columns", columns},
                               {"sigma_mm", e.sigma_mm},
                               {"nees", e.nees},
                               {"spots", e.spots},
                               {"flagged_drifting", e.flagged},
                               {"worst_yaw_deg", e.worst_yaw_deg},
                               {"slope_mm_per_mm", e.slope_mm_per_mm},
                               {"linear_share", e.linear_share}});
    }
    json budget = json::array();
    for (const BudgetLine& b : r.budget)
        budget.push_back({{"source", b.name}, {"three_sigma_mm", b.three_sigma_mm}});
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
                {"budget", budget}};
    if (!r.budget.empty()) {
        const NeesInterval i = nees_interval(6, std::max(1, r.noise.trials));
        out["noise"] = {{"trials", r.noise.trials},     {"bound_mm", r.noise.bound_mm},
                        {"found_mm", r.noise.found_mm}, {"efficiency", r.noise.efficiency},
                        {"nees", r.noise.nees},         {"nees_interval", {i.low, i.high}}};
    }
    return out;
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

std::string curve(const std::vector<EvaluationTrial>& trials, std::size_t column, const std::string& title) {
    report::Plot plot;
    plot.title = title;
    plot.x_label = column == 1 ? "displacement (degree)" : "displacement (mm)";
    plot.y_label = "mean deviation (mm)";
    const char* colours[3] = {report::colour::kBlue, report::colour::kVermilion, report::colour::kGreen};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        report::Series s{std::string("along ") + "XYZ" [axis], {}, {}, report::Mark::line, colours[axis]};
        for (std::size_t i = 41 * axis; i < 41 * (axis + 1); ++i) {
            s.x.push_back(trials[i].displacement);
            s.y.push_back(trials[i].ok ? trials[i].mean_abs_mm : std::nan(""));
        }
        plot.series.push_back(std::move(s));
    }
    return report::svg(plot);
}

std::string html(const EvaluationResult& r) {
    report::Page page("Evaluation: the thesis's five experiments, simulated");
    page.paragraph(conditions(r));
    page.table(table(r), "Deviations at the spots after correction, mm");
    for (const ExperimentResult& e : r.experiments) {
        page.heading(fmt::format("Experiment {}: {}", e.number, e.name));
        page.paragraph(remark(r, e));
        std::vector<std::string> curves, histograms;
        for (std::size_t c = 0; c < 3; ++c) {
            curves.push_back(curve(e.trials[c], c, kColumns[c]));
            histograms.push_back(histogram(e.summary[c], e.trials[c], kColumns[c]));
        }
        page.figures(curves, "Mean deviation at the spots against displacement");
        page.figures(histograms,
                     "Histogram of the deviations, with the normal distribution of their moments");
    }
    if (!r.budget.empty()) {
        page.heading("How good could it be");
        page.paragraph(noise_text(r));
    }
    return page.html();
}

std::string text_of(const EvaluationResult& r) {
    std::string text = conditions(r) + "\n\n";
    for (const auto& row : table(r)) {
        text += fmt::format("{:<11}{:<13}", row[0], row[1]);
        for (std::size_t k = 2; k < row.size(); ++k) text += fmt::format("{:>{}}", row[k], k == 7 ? 16 : 10);
        text += "\n";
    }
    text += "\n";
    for (const ExperimentResult& e : r.experiments) text += remark(r, e) + "\n";
    text += "\n" + noise_text(r);
    text += fmt::format("{} profiles in {:.1f} s with {} threads\n", r.profiles, r.seconds, r.settings.jobs);
    return text;
}

Answer panel_answer(int panels, std::uint64_t seed) {
    const PanelComparison c = compare_panel_fitting(panels, seed);
    Answer answer;
    answer.text = fmt::format(
        "Simulated: {} panels, straight contours, landmark noise {:g} mm, seed {}. Gap and flush after the "
        "last "
        "move, against taught:\n",
        c.panels, c.noise_mm, seed);
    answer.json = {
        {"panels", c.panels}, {"noise_mm", c.noise_mm}, {"seed", seed}, {"training_moves", c.training_moves}};
    for (const auto& [name, way] : {std::pair<const char*, const PanelWay*>{"single_step", &c.single_step},
                                    {"servoing", &c.servoing}}) {
        answer.text +=
            fmt::format("{:<12} rms {:.4f} mm   worst {:.4f} mm   {:.1f} moves   {:.2f} ms   failed {}\n",
                        name, way->rms_mm, way->worst_mm, way->moves, way->compute_ms, way->failed);
        answer.json[name] = {{"rms_mm", way->rms_mm},
                             {"worst_mm", way->worst_mm},
                             {"moves", way->moves},
                             {"failed", way->failed}};
    }
    answer.text += fmt::format("servoing needed {} training moves beforehand\n", c.training_moves);
    return answer;
}

}  // namespace

void add_evaluate(CommandLine& line) {
    CLI::App* command = line.add(
        "evaluate",
        "The thesis's five experiments on the simulated cell: our table beside the thesis's, Cramer-Rao "
        "bound,\nNEES and error budget. The same for a seed whatever the number of jobs.",
        "seamwright evaluate --experiment all --seed 1 --report evaluation.html");
    struct Arguments {
        EvaluationSettings settings;
        std::string experiment = "all", report;
    };
    auto a = std::make_shared<Arguments>();
    command->add_option("--experiment", a->experiment, "1 to 5, all, or panel (single step against servoing)")
        ->check(CLI::IsMember({"1", "2", "3", "4", "5", "all", "panel"}));
    command->add_option("--trials", a->settings.trials, "Trials of efficiency and NEES [2000]")
        ->check(CLI::Range(10, 1000000));
    command->add_option("--seed", a->settings.seed, "Of every random number [1]");
    command->add_option("--jobs", a->settings.jobs, "Threads [all cores]")->check(CLI::Range(0, 1024));
    command->add_option("--noise-mm", a->settings.noise_mm, "Sensor noise per point, 1 sigma [0.03]")
        ->check(CLI::Range(1e-4, 1.0));
    command->add_option("--jitter-mm", a->settings.jitter_mm, "Trigger jitter, half width [3]")
        ->check(CLI::Range(0.0, 10.0));
    command->add_option("--bend-mm", a->settings.bend_mm, "Bend of the measured door [0]")
        ->check(CLI::Range(-5.0, 5.0));
    command->add_option("--report", a->report, "HTML report with histograms and curves")
        ->type_name("FILE.html");
    line.on(command, [a]() -> Expected<Answer> {
        if (a->experiment == "panel") return panel_answer(a->settings.trials, a->settings.seed);
        a->settings.experiment = a->experiment == "all" ? 0 : a->experiment[0] - '0';
        auto result = evaluate(a->settings, [](const std::string& s) { fmt::print(stderr, "{}\n", s); });
        if (!result) return tl::unexpected(result.error());
        if (!a->report.empty())
            if (auto written = write_text_file(a->report, html(*result)); !written)
                return tl::unexpected(written.error());
        return Answer{result_json(*result), text_of(*result), kExitOk};
    });
}

}  // namespace seamwright::cli
