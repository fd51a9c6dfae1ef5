// seamwright evaluate: the thesis's experiments on the simulated cell, our table beside the thesis's.

#include <fmt/format.h>

#include "app/cli/command.h"
#include "devices/exchange/files.h"
#include "projects/evaluate/elastic_experiment.h"
#include "projects/evaluate/panel_experiment.h"
#include "projects/evaluate/report.h"

namespace seamwright::cli {
namespace {

using namespace evaluation;

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
        answer.text += fmt::format(
            "{:<12} rms {:.4f} mm   worst {:.4f} mm   within 3 sigma {:.1f} %   {:.1f} moves ({} to {}) "
            "  {:.2f} ms   failed {}\n",
            name, way->rms_mm, way->worst_mm, 100 * way->within_three_sigma, way->moves, way->fewest_moves,
            way->most_moves, way->compute_ms, way->failed);
        answer.json[name] = {{"rms_mm", way->rms_mm},
                             {"worst_mm", way->worst_mm},
                             {"within_three_sigma", way->within_three_sigma},
                             {"moves", way->moves},
                             {"fewest_moves", way->fewest_moves},
                             {"most_moves", way->most_moves},
                             {"failed", way->failed}};
    }
    answer.text += fmt::format("servoing needed {} training moves beforehand\n", c.training_moves);
    return answer;
}

}  // namespace

void add_evaluate(CommandLine& line) {
    CLI::App* command =
        line.add("evaluate",
                 "The thesis's five experiments on the simulated cell: our table beside the thesis's. With "
                 "experiment 3 also\nthe error budget, Cramer-Rao bound and NEES on "
                 "straight contours, and curved contours. The same for a seed\nwhatever the "
                 "number of jobs.",
                 "seamwright evaluate --experiment all --seed 1 --report evaluation.html");
    struct Arguments {
        EvaluationSettings settings;
        std::string experiment = "all", report;
    };
    auto a = std::make_shared<Arguments>();
    command
        ->add_option(
            "--experiment", a->experiment,
            "1 to 5, online (against offline), all, panel (single step against servoing), or elastic "
            "(bent doors: rigid regions against learnt modes)")
        ->check(CLI::IsMember({"1", "2", "3", "4", "5", "online", "all", "panel", "elastic"}));
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
        if (a->experiment == "elastic") {
            SEAM_TRY(const auto elastic, elastic_experiment(a->settings));
            return Answer{elastic_json(elastic), elastic_text(elastic), kExitOk};
        }
        a->settings.experiment = a->experiment == "all"      ? 0
                                 : a->experiment == "online" ? kOnline
                                                             : a->experiment[0] - '0';
        SEAM_TRY(auto result,
                 evaluate(a->settings, [](const std::string& s) { fmt::print(stderr, "{}\n", s); }));
        if (!a->report.empty()) SEAM_OK(write_text_file(a->report, evaluation_html(result)));
        return Answer{evaluation_json(result), evaluation_text(result), kExitOk};
    });
}

}  // namespace seamwright::cli
