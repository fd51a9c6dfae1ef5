#include <algorithm>
#include <chrono>

#include "app/cli/demo/demo.h"

namespace seamwright::cli {

DemoSweep sweep_demo(DemoOptions options, std::uint64_t first, std::uint64_t last,
                     const std::function<void(const SweepRow&)>& each) {
    DemoSweep sweep;
    std::vector<std::pair<std::string, DeviationTally>> tallies;
    options.loopback = options.offline = false;
    for (options.seed = first; options.seed <= last; ++options.seed) {
        SweepRow row;
        row.seed = options.seed;
        const auto start = std::chrono::steady_clock::now();
        const auto outcome = run_demo(options, [](const std::string&) {});
        row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        if (!outcome) {
            row.outcome = "failed";
            row.reason = outcome.error().sentence();
        } else {
            row.outcome = "ok";
            row.calibration_verdict = outcome->calibration.calibration.verdict;
            row.calibration_error_mm = outcome->calibration.truth_mm;
            row.looks_again = outcome->calibration.looks_again;
            for (const DemoPart& part : outcome->parts) {
                row.pushed += part.pushed();
                if (part.pushed() || row.outcome == "refused") continue;
                row.outcome = "refused";
                row.reason = part.run.part_id + ": " + part.run.message.english();
            }
            if (row.pushed > 0) row.path = statistics(*outcome, &DemoPart::path);
            add(*outcome, &DemoPart::path, tallies);
        }
        each(row);
        sweep.rows.push_back(std::move(row));
    }
    for (const auto& [name, tally] : tallies)
        if (tally.n > 0) sweep.pooled.push_back(tally.statistic(name));
    return sweep;
}

}  // namespace seamwright::cli
