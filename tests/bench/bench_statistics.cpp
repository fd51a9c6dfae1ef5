// Statistics of ten thousand runs: by queries on the file, against loading run after run.

#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdio>

#include "projects/statistics/statistics.h"
#include "tests/projects/statistics/production_runs.h"

namespace {

using namespace seamwright;

constexpr int kRuns = 10000;

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void statistics_of_ten_thousand(benchmark::State& state) {
    const TemporaryFolder folder;
    const Project project = production_project();
    auto file = ProjectFile::create(folder / "a.seam", project);
    if (!file) return state.SkipWithError("no file");
    for (int i = 0; i < kRuns; ++i) {
        RunRecord run = production_run(i, {0.1 * (i % 7), 0.2 * (i % 5), 0.1 * (i % 3)}, 0.01 * (i % 11));
        for (const Spot& spot : project.spots) {
            SpotMeasurement m;
            m.spot_id = spot.id;
            m.status = SpotStatus::measured;
            run.spots.push_back(m);
        }
        if (!file->append_run(run, project)) return state.SkipWithError("no run");
    }
    double opened = 0, by_queries = 0, whole = 0, loaded = 0;
    for (auto _ : state) {
        auto start = std::chrono::steady_clock::now();
        auto reader = ProjectFile::open(folder / "a.seam", FileAccess::read_only);
        opened = seconds_since(start);
        start = std::chrono::steady_clock::now();
        benchmark::DoNotOptimize(reader->run_values());
        by_queries = seconds_since(start);
        start = std::chrono::steady_clock::now();
        for (int i = 1; i <= kRuns; ++i) benchmark::DoNotOptimize(reader->load_run(i, false));
        loaded = seconds_since(start);
        start = std::chrono::steady_clock::now();
        benchmark::DoNotOptimize(production_statistics({folder / "a.seam"}, {}));
        whole = seconds_since(start);
    }
    state.counters["open_s"] = opened;
    state.counters["queries_s"] = by_queries;
    state.counters["load_run_s"] = loaded;
    state.counters["statistics_s"] = whole;
    std::printf(
        "%d runs: queries %.2f s, run after run %.2f s (%.1f times); opening %.2f s, all statistics %.2f s\n",
        kRuns, by_queries, loaded, loaded / by_queries, opened, whole);
}
BENCHMARK(statistics_of_ten_thousand)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace

BENCHMARK_MAIN();
