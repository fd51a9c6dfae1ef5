// Evaluation: one run = 12 profiles cut from the door, noise, filter, template match, region solved and
// judged. Runs per second on one core, and what the second one adds.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <memory>
#include <thread>

#include "app/cli/evaluate/cell.h"

namespace {

using namespace seamwright;
using namespace seamwright::cli;

constexpr std::size_t kRuns = 64;

struct Taught {
    std::atomic<std::size_t> profiles{0};
    Method method;
    Cell cell;
    std::vector<TaughtSpot> spots;

    Taught() : cell(door_cell({}, profiles)) {
        cell.settings.jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
        auto taught = teach_all(cell, method);
        if (taught) spots = std::move(*taught);
    }
    // Runs without a correction.
    int run(int jobs) const {
        std::atomic<int> refused{0};
        spread_out(jobs, kRuns, [&] {
            return [&, finders = std::make_shared<Finders>(make_finders(spots)),
                    profile = std::make_shared<Profile>()](std::size_t i) {
                Random random(5, i);
                const Eigen::Vector3d move = 5 * random.normal3();
                const Pose truth = make_pose(Eigen::Matrix3d::Identity(), move);
                std::vector<SpotObservation> observed;
                for (std::size_t n = 0; n < spots.size(); ++n)
                    if (auto o =
                            measure_spot(cell, method, spots[n], n, *(*finders)[n], truth, random, *profile))
                        observed.push_back(std::move(*o));
                if (!correct(cell, method, std::move(observed))) ++refused;
            };
        });
        return refused;
    }
};

const Taught& taught() {
    static const Taught t;
    return t;
}

void runs_per_second(benchmark::State& state) {
    const Taught& t = taught();
    if (t.spots.empty()) {
        state.SkipWithError("the spots cannot be taught");
        return;
    }
    int refused = 0;
    for (auto _ : state) refused += t.run(static_cast<int>(state.range(0)));
    state.counters["runs/s"] = benchmark::Counter(
        static_cast<double>(kRuns) * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
    state.counters["refused"] = refused;
}
BENCHMARK(runs_per_second)
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

// Turn about, so that a busy machine hits both alike; the median of the pairs.
void print_scaling() {
    using Clock = std::chrono::steady_clock;
    const auto seconds = [](int jobs) {
        const auto start = Clock::now();
        taught().run(jobs);
        return std::chrono::duration<double>(Clock::now() - start).count();
    };
    std::vector<double> ratio, one;
    for (int k = 0; k < 7; ++k) {
        one.push_back(seconds(1));
        ratio.push_back(one.back() / seconds(2));
    }
    std::nth_element(ratio.begin(), ratio.begin() + 3, ratio.end());
    std::nth_element(one.begin(), one.begin() + 3, one.end());
    const auto per_second = [](double took) { return static_cast<double>(kRuns) / took; };
    std::printf(
        "ratio evaluation 2 cores / 1 core: %.2f (%.1f and %.1f runs per second, 12 profiles a run; %u cores "
        "here)\n",
        ratio[3], per_second(one[3]), ratio[3] * per_second(one[3]), std::thread::hardware_concurrency());
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    print_scaling();
    return 0;
}
