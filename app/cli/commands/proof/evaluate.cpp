// seamwright evaluate: the thesis's experiments on the simulated cell, our table beside the thesis's.

#include <fmt/format.h>

#include "app/cli/batch_command.h"
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

BatchJob evaluation_job(const std::string& experiment, const EvaluationSettings& s) {
    BatchJob job;
    job.name = "evaluate";
    job.what = {{"experiment", experiment}, {"trials", s.trials},       {"seed", s.seed},
                {"noise_mm", s.noise_mm},   {"jitter_mm", s.jitter_mm}, {"bend_mm", s.bend_mm}};
    job.threads = std::max(1, s.jobs);  // all cores of its computer is what a task does not take
    job.words = {"evaluate",
                 "--experiment",
                 experiment,
                 "--trials",
                 fmt::format("{}", s.trials),
                 "--seed",
                 fmt::format("{}", s.seed),
                 "--noise-mm",
                 fmt::format("{}", s.noise_mm),
                 "--jitter-mm",
                 fmt::format("{}", s.jitter_mm),
                 fmt::format("--bend-mm={}", s.bend_mm),
                 "--jobs",
                 fmt::format("{}", job.threads)};
    return job;
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
        BatchArguments batch;
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
    add_batch_options(command, a->batch);
    command->add_option("--report", a->report, "HTML report with histograms and curves")
        ->type_name("FILE.html");
    line.on(command, [a]() -> Expected<Answer> {
        if ((a->experiment == "panel" || a->experiment == "elastic") &&
            (a->batch.is_split() || a->batch.is_task()))
            return usage_error(Text("the experiment {} is not split", a->experiment), "--engine",
                               "leave it out");
        if (a->experiment == "panel") return panel_answer(a->settings.trials, a->settings.seed);
        if (a->experiment == "elastic") {
            SEAM_TRY(const auto elastic, elastic_experiment(a->settings));
            return Answer{elastic_json(elastic), elastic_text(elastic), kExitOk};
        }
        a->settings.experiment = a->experiment == "all"      ? 0
                                 : a->experiment == "online" ? kOnline
                                                             : a->experiment[0] - '0';
        const auto told = [](const std::string& s) { fmt::print(stderr, "{}\n", s); };
        if (a->batch.is_task()) {
            SEAM_TRY(const auto portion, portion_from(a->batch.task, "--task"));
            Parts part(portion);
            a->settings.parts = &part;
            SEAM_OK(evaluate(a->settings, told).map([](const auto&) {}));
            return part_answer(a->batch, part.json());
        }
        std::optional<Parts> parts;
        if (a->batch.is_split()) {
            SEAM_TRY(auto collected, collect(a->batch, evaluation_job(a->experiment, a->settings)));
            if (collected.incomplete) return std::move(*collected.incomplete);
            SEAM_TRY(parts, Parts::collected(collected.parts));
            a->settings.parts = &*parts;
        }
        SEAM_TRY(auto result, evaluate(a->settings, told));
        if (!a->report.empty()) SEAM_OK(write_text_file(a->report, evaluation_html(result)));
        return Answer{evaluation_json(result), evaluation_text(result), kExitOk};
    });
}

}  // namespace seamwright::cli
