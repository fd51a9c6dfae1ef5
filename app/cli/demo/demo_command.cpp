// seamwright demo: the whole job on the simulated cell.

#include "app/cli/demo/demo.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <map>
#include <utility>
#include <vector>

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

nlohmann::json offline_json(const DemoOutcome& outcome) {
    const DemoOffline& o = *outcome.offline;
    const DemoStatistic hand = statistic_of(outcome.parts, o.region_id, &DemoPart::path);
    nlohmann::json j = {{"project", o.project_file.string()},
                        {"region", o.region_id},
                        {"edge", o.edge},
                        {"spots", o.proposal.spots.size()},
                        {"forecast_three_sigma_mm", o.proposal.set.three_sigma_mm},
                        {"hand_forecast_three_sigma_mm", o.hand.three_sigma_mm},
                        {"refused_before", o.refused_before.english()},
                        {"confirmation", confirmation_json(o.confirmation)},
                        {"hand_path", statistic_json({hand})},
                        {"seconds", o.seconds}};
    int pushed = 0;
    for (const DemoPart& part : o.parts) pushed += part.pushed();
    j["pushed"] = pushed;
    if (pushed > 0) j["path"] = statistic_json({statistic_of(o.parts, o.region_id, &DemoPart::path)});
    return j;
}

std::string offline_text(const DemoOutcome& outcome) {
    const DemoOffline& o = *outcome.offline;
    int pushed = 0;
    for (const DemoPart& part : o.parts) pushed += part.pushed();
    std::string text = fmt::format(
        "\nfrom the drawing: region {}, edge {} of door.step, {} spots proposed, forecast 3 sigma of the "
        "bead {:.3f} mm "
        "(by hand {:.3f})\n  before: {}\n  then: {}\n",
        o.region_id, o.edge, o.proposal.spots.size(), o.proposal.set.three_sigma_mm, o.hand.three_sigma_mm,
        o.refused_before.english(), said_of(o.confirmation).english());
    if (pushed == 0) return text;
    const DemoStatistic now = statistic_of(o.parts, o.region_id, &DemoPart::path),
                        hand = statistic_of(outcome.parts, o.region_id, &DemoPart::path);
    text += fmt::format(
        "  the same parts, {} of {} pushed: bead 3 sigma {:.3f} mm, largest {:.3f} (by hand {:.3f}, "
        "{:.3f}); {:.1f} s\n",
        pushed, o.parts.size(), now.after_three_sigma_mm, now.after_max_mm, hand.after_three_sigma_mm,
        hand.after_max_mm, o.seconds);
    return text;
}

Expected<Answer> demo(const DemoOptions& options) {
    SEAM_TRY(auto outcome,
             run_demo(options, [](const std::string& step) { fmt::print(stderr, "{}\n", step); }));
    SEAM_OK(write_text_file(outcome.report_file, demo_report(outcome)));
    int pushed = 0;
    for (const DemoPart& part : outcome.parts) pushed += part.pushed();
    const auto spots = statistics(outcome, &DemoPart::spots), path = statistics(outcome, &DemoPart::path);
    const bool ok = pushed == static_cast<int>(outcome.parts.size()) &&
                    (!outcome.offline || outcome.offline->confirmation.ok);
    Answer answer;
    answer.exit_code = ok ? kExitOk : kExitVerdict;
    answer.json = {{"status", ok ? "ok" : "refused"},
                   {"project", outcome.project_file.string()},
                   {"report", outcome.report_file.string()},
                   {"seed", options.seed},
                   {"parts", outcome.parts.size()},
                   {"pushed", pushed},
                   {"calibration_verdict", name_of(outcome.calibration.calibration.verdict)},
                   {"calibration_error_mm", outcome.calibration.truth_mm},
                   {"spots", statistic_json(spots)},
                   {"path", statistic_json(path)},
                   {"cell", outcome.cell},
                   {"seconds", outcome.seconds}};
    for (const DemoCalibrationStep& step : outcome.calibration.steps)
        answer.text += fmt::format("calibration {:<14} {}: {}\n", step.name,
                                   name_of(step.report.judgement.verdict), step.summary);
    answer.text +=
        fmt::format("calibrated chain against the cell's truth: {:.3f} mm\n", outcome.calibration.truth_mm);
    answer.text += fmt::format("{} of {} parts corrected and pushed\n", pushed, outcome.parts.size());
    for (const DemoPart& part : outcome.parts)
        if (!part.pushed()) answer.text += fmt::format("  {}: {}\n", part.run.part_id, part.run.message);
    if (pushed > 0) {
        answer.text += statistic_text("deviation at the spots, pushed parts", spots);
        answer.text += statistic_text("deviation along the bead, pushed parts", path);
    }
    if (outcome.offline) {
        answer.json["offline"] = offline_json(outcome);
        answer.text += offline_text(outcome);
    }
    answer.text += fmt::format(
        "\nsimulated (noise, jitter, repeatability and seed are stated in the report), {:.1f} s\nproject "
        "{}\nreport  {}\n",
        outcome.seconds, outcome.project_file.string(), outcome.report_file.string());
    return answer;
}

std::string sweep_text(const SweepRow& row) {
    std::string text = fmt::format("seed {:>4}: {:<8}", row.seed, row.outcome);
    if (row.outcome != "failed")
        text += fmt::format("calibration {} {:.3f} mm, looked again {}",
                            name_of(row.calibration_verdict.value_or(Verdict::undetermined)),
                            row.calibration_error_mm, row.looks_again);
    if (!row.path.empty()) {
        text += fmt::format("; {} pushed, 3 sigma", row.pushed);
        for (const DemoStatistic& s : row.path)
            text += fmt::format(" {} {:.3f}", s.region_id, s.after_three_sigma_mm);
        text += fmt::format(", worst {:.3f} mm", row.path.back().after_max_mm);
    }
    if (!row.reason.empty()) text += fmt::format(" ({})", row.reason);
    return text;
}

// How many of the seeds, in order, have a 3 sigma of at most `limit_mm` in a region.
int within(const DemoSweep& sweep, std::size_t region, double limit_mm) {
    return static_cast<int>(std::count_if(sweep.rows.begin(), sweep.rows.end(), [&](const SweepRow& row) {
        return region < row.path.size() && row.path[region].after_three_sigma_mm <= limit_mm;
    }));
}

Expected<Answer> sweep(const DemoOptions& options, std::uint64_t first, std::uint64_t last) {
    const DemoSweep result = sweep_demo(
        options, first, last, [](const SweepRow& row) { fmt::print(stderr, "{}\n", sweep_text(row)); });
    Answer answer;
    std::map<std::string, int> outcomes;
    nlohmann::json rows = nlohmann::json::array(), pooled = nlohmann::json::array();
    int measured = 0;
    for (const SweepRow& row : result.rows) {
        ++outcomes[row.outcome];
        measured += !row.path.empty();
        if (row.outcome == "failed") answer.exit_code = kExitVerdict;
        rows.push_back(
            {{"seed", row.seed},
             {"outcome", row.outcome},
             {"reason", row.reason},
             {"pushed", row.pushed},
             {"calibration_verdict", row.calibration_verdict ? name_of(*row.calibration_verdict) : ""},
             {"calibration_error_mm", row.calibration_error_mm},
             {"looks_again", row.looks_again},
             {"path", statistic_json(row.path)},
             {"seconds", row.seconds}});
    }
    for (const auto& [outcome, count] : outcomes)
        answer.text += fmt::format("{} of {} seeds: {}\n", count, result.rows.size(), outcome);
    if (!result.pooled.empty()) {
        answer.text += statistic_text("deviation along the bead, pushed parts of all seeds", result.pooled);
        answer.text +=
            fmt::format("\nseeds of {} whose 3 sigma is at most\n  {:<10} {:>9} {:>9} {:>9} {:>11}\n",
                        measured, "region", "0.10 mm", "0.12 mm", "0.15 mm", "largest mm");
    }
    for (std::size_t r = 0; r < result.pooled.size(); ++r) {
        double largest = 0;
        for (const SweepRow& row : result.rows)
            if (r < row.path.size()) largest = std::max(largest, row.path[r].after_three_sigma_mm);
        answer.text +=
            fmt::format("  {:<10} {:>9} {:>9} {:>9} {:>11.3f}\n", result.pooled[r].region_id,
                        within(result, r, 0.10), within(result, r, 0.12), within(result, r, 0.15), largest);
        pooled.push_back(statistic_json({result.pooled[r]}).front());
        pooled.back()["seeds"] = measured;
        pooled.back()["seeds_within_a_tenth"] = within(result, r, 0.10);
        pooled.back()["largest_three_sigma_mm"] = largest;
    }
    answer.json = {{"outcomes", outcomes}, {"seeds", rows}, {"pooled", pooled}};
    return answer;
}

// "1..300", or one number.
Expected<std::pair<std::uint64_t, std::uint64_t>> seed_range(const std::string& text) {
    std::uint64_t first = 0, last = 0;
    const char* const end = text.data() + text.size();
    auto read = std::from_chars(text.data(), end, first);
    bool ok = read.ec == std::errc();
    last = first;
    if (ok && read.ptr != end) {
        ok = end - read.ptr > 2 && read.ptr[0] == '.' && read.ptr[1] == '.';
        if (ok) read = std::from_chars(read.ptr + 2, end, last);
    }
    if (!ok || read.ec != std::errc() || read.ptr != end || last < first || last - first >= 1000000)
        return usage_error(Text("\"{}\" is no range of seeds", text), "--seeds",
                           "write 1..300: first and last");
    return std::pair(first, last);
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
        ->check(CLI::Range(0, 1000))
        ->capture_default_str();
    auto seeds = std::make_shared<std::string>();
    auto without = std::make_shared<std::vector<std::string>>();
    command->add_option("--seeds", *seeds,
                        "FIRST..LAST: the demo in-process with each of these seeds, one line each and what "
                        "they have in\ncommon; with --parts 0 the calibrations alone");
    std::vector<std::string> sources;
    for (const DemoSource source : kDemoSources) sources.emplace_back(to_string(source));
    command
        ->add_option("--without", *without,
                     "Takes sources of error out of the cell, to see what the others bring")
        ->delimiter(',')
        ->check(CLI::IsMember(sources));
    command->add_flag("!--in-process", options->loopback,
                      "Without the GigE Vision camera and the KUKA controller on the loopback address");
    command->add_flag("!--no-offline", options->offline, "Without the chapter from the drawing");
    command
        ->add_option("--camera", options->camera_address,
                     "Loopback address of the served camera; free: one that is found free")
        ->capture_default_str();
    command
        ->add_option("--robot-port", options->robot_port,
                     "Where the simulated KUKA controller connects to; 0: a port that is found free")
        ->check(CLI::Range(0, 65535))
        ->capture_default_str();
    line.on(command, [options, seeds, without]() -> Expected<Answer> {
        for (const DemoSource source : kDemoSources)
            if (std::count(without->begin(), without->end(), to_string(source)) > 0)
                options->without.insert(source);
        if (!seeds->empty()) {
            SEAM_TRY(const auto range, seed_range(*seeds));
            return sweep(*options, range.first, range.second);
        }
        if (options->parts == 0)
            return usage_error("no part is no demo", "--parts", "give 1 or more, or --seeds");
        return demo(*options);
    });
}

}  // namespace seamwright::cli
