// A run over loopback: GigE Vision camera, robot controller, 12 spots. How long after the last profile has
// arrived is the corrected frame released on the controller, and how much of it is our code (the rest:
// protocol and disk).

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "tests/projects/served_cell.h"

namespace {

using namespace seamwright;

std::int64_t now_ns() {
    return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

double percentile(std::vector<double> values, double p) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0 : values[static_cast<std::size_t>(p * static_cast<double>(values.size() - 1))];
}

void trigger_to_released(benchmark::State& state, const char* driver) {
    const auto folder =
        std::filesystem::temp_directory_path() / fmt::format("seamwright_bench_run_{}", ::getpid());
    std::filesystem::create_directories(folder);
    auto served = serve_cell({.driver = driver, .width = 1280, .height = 1024}, folder / "run.seam");
    if (!served) return state.SkipWithError(served.error().sentence().c_str());
    served->cell->set_part({make_pose(rotation_exp({0.002, -0.001, 0.003}), {2, -1, 1}), {}});
    std::vector<double> released_ms, all_ms;
    RunOptions options;
    options.push = true;
    for (auto _ : state) {
        std::atomic<std::int64_t> released_at = 0;
        std::jthread observer([&](const std::stop_token& stop) {
            bool was = true;
            while (!stop.stop_requested()) {
                const bool is = served->controller().released();
                if (is && !was) released_at = now_ns();
                was = is;
                std::this_thread::sleep_for(std::chrono::microseconds(50));
            }
        });
        auto run = served->station->run(options);
        const std::int64_t end = now_ns();
        observer = {};
        if (!run || run->status != RunStatus::ok)
            return state.SkipWithError(run ? run->message.c_str() : run.error().sentence().c_str());
        const std::int64_t last = run->captures.back().host_time_ns;
        released_ms.push_back(static_cast<double>(released_at - last) / 1e6);
        all_ms.push_back(static_cast<double>(end - last) / 1e6);
    }
    state.counters["released_p50_ms"] = percentile(released_ms, 0.5);
    state.counters["released_p99_ms"] = percentile(released_ms, 0.99);
    state.counters["recorded_p99_ms"] = percentile(all_ms, 0.99);
    fmt::print(
        "last profile to frame released, {}, {} runs of 12 spots: p50 {:.2f} ms, p99 {:.2f} ms; recorded p99 "
        "{:.2f} ms\n",
        driver, released_ms.size(), percentile(released_ms, 0.5), percentile(released_ms, 0.99),
        percentile(all_ms, 0.99));
    std::filesystem::remove_all(folder);
}
BENCHMARK_CAPTURE(trigger_to_released, kuka_eki, "kuka-eki")->Iterations(100)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(trigger_to_released, kuka_kvp, "kuka-kvp")->Iterations(100)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
