// seamwright demo: the whole job on the simulated cell.

#include "app/cli/demo/demo.h"

#include <fmt/format.h>

#include <cstdio>

#include "app/cli/command.h"
#include "devices/exchange/files.h"

namespace seamwright::cli {
namespace {

nlohmann::json statistic_json(const std::vector<DemoStatistic>& rows) {
    nlohmann::json list = nlohmann::json::array();
    for (const DemoStatistic& s : rows)
        list.push_back({{"region", s.region_id},
                        {"before_max_mm", s.before_max_mm},
                        {"after_mean_mm", s.after_mean_mm},
                        {"after_three_sigma_mm", s.after_three_sigma_mm},
                        {"after_max_mm", s.after_max_mm}});
    return list;
}

std::string statistic_text(const char* title, const std::vector<DemoStatistic>& rows) {
    std::string text = fmt::format("\n{}\n  {:<10} {:>14} {:>12} {:>14} {:>12}\n", title, "region",
                                   "before max mm", "after mean", "after 3 sigma", "after max");
    for (const DemoStatistic& s : rows)
        text += fmt::format("  {:<10} {:>14.3f} {:>12.3f} {:>14.3f} {:>12.3f}\n", s.region_id,
                            s.before_max_mm, s.after_mean_mm, s.after_three_sigma_mm, s.after_max_mm);
    return text;
}

Expected<Answer> demo(const DemoOptions& options) {
    auto outcome = run_demo(options, [](const std::string& step) { fmt::print(stderr, "{}\n", step); });
    if (!outcome) return tl::unexpected(outcome.error());
    if (auto written = write_text_file(outcome->report_file, demo_report(*outcome)); !written)
        return tl::unexpected(written.error());
    int pushed = 0;
    for (const DemoPart& part : outcome->parts) pushed += part.pushed();
    const auto spots = statistics(*outcome, &DemoPart::spots), path = statistics(*outcome, &DemoPart::path);
    const bool ok = pushed == static_cast<int>(outcome->parts.size());
    Answer answer;
    answer.exit_code = ok ? kExitOk : kExitVerdict;
    answer.json = {{"status", ok ? "ok" : "refused"},
                   {"project", outcome->project_file.string()},
                   {"report", outcome->report_file.string()},
                   {"seed", options.seed},
                   {"parts", outcome->parts.size()},
                   {"pushed", pushed},
                   {"calibration_verdict", outcome->calibration.calibration.verdict},
                   {"calibration_error_mm", outcome->calibration.truth_mm},
                   {"spots", statistic_json(spots)},
                   {"path", statistic_json(path)},
                   {"cell", outcome->cell},
                   {"seconds", outcome->seconds}};
    for (const DemoCalibrationStep& step : outcome->calibration.steps)
        answer.text += fmt::format("calibration {:<14} {}: {}\n", step.name,
                                   name_of(step.report.judgement.verdict), step.summary);
    answer.text +=
        fmt::format("calibrated chain against the cell's truth: {:.3f} mm\n", outcome->calibration.truth_mm);
    answer.text += fmt::format("{} of {} parts corrected and pushed\n", pushed, outcome->parts.size());
    for (const DemoPart& part : outcome->parts)
        if (!part.pushed()) answer.text += fmt::format("  {}: {}\n", part.run.part_id, part.run.message);
    if (pushed > 0) {
        answer.text += statistic_text("deviation at the spots, pushed parts", spots);
        answer.text += statistic_text("deviation along the bead, pushed parts", path);
    }
    answer.text += fmt::format(
        "\nsimulated (noise, jitter, repeatability and seed are stated in the report), {:.1f} s\nproject "
        "{}\nreport  {}\n",
        outcome->seconds, outcome->project_file.string(), outcome->report_file.string());
    return answer;
}

}  // namespace

void add_demo(CommandLine& line) {
    auto options = std::make_shared<DemoOptions>();
    CLI::App* command =
        line.add("demo", "The whole job on the simulated cell; writes demo.seam and report.html.",
                 "seamwright demo --dir demo --seed 7");
    command->add_option("--dir", options->folder, "Folder for project and report")->capture_default_str();
    command->add_option("--seed", options->seed, "Every random number follows from it")
        ->capture_default_str();
    command->add_option("--parts", options->parts, "Displaced parts")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command->add_flag("!--in-process", options->loopback,
                      "Without the GigE Vision camera and the KUKA controller on the loopback address");
    command
        ->add_option("--camera", options->camera_address,
                     "Loopback address of the served camera; free: one that is found free")
        ->capture_default_str();
    command
        ->add_option("--robot-port", options->robot_port,
                     "Where the simulated KUKA controller connects to; 0: a port that is found free")
        ->check(CLI::Range(0, 65535))
        ->capture_default_str();
    line.on(command, [options] { return demo(*options); });
}

}  // namespace seamwright::cli
