// Evaluation: one run = 12 profiles cut from the door, noise, filter, template match, region solved and
// judged. Runs per second on one core, and what the second one adds.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <memory>
#include <thread>
#include <vector>

#include "projects/evaluate/cell.h"

namespace {

using namespace seamwright;
using namespace seamwright::evaluation;

constexpr std::size_t kRuns = 64;

struct Taught {
    std::atomic<std::size_t> profiles{0};
    Method method;
    Cell cell;
    TaughtCell taught;

    Taught() : cell(door_cell({}, profiles)) {
        cell.settings.jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
        if (auto cells = teach_all(cell, method)) taught = std::move(*cells);
    }
    // Runs without a correction.
    int run(int jobs) const {
        std::atomic<int> refused{0};
        spread_out(jobs, kRuns, [&] {
            return [&, measurers = std::make_shared<Measurers>(make_measurers(taught)),
                    frame = std::make_shared<Frame>()](std::size_t i) {
                Random random(5, i);
                const Eigen::Vector3d move = 5 * random.normal3();
                const Pose truth = make_pose(Eigen::Matrix3d::Identity(), move);
                std::vector<SpotMeasurement> measurements;
                for (std::size_t n = 0; n < taught.spots.size(); ++n)
                    measurements.push_back(measure_spot(cell, method, taught.spots[n], n, (*measurers)[n],
                                                        truth, random, *frame));
                if (!correct(taught.project, measurements)) ++refused;
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
    if (t.taught.spots.empty()) {
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

// Turn about, so that a busy machine hits both alike; the median of the pairs. The cores that the process got
// (its processor time by the wall's) tell whether the machine was free.
void print_scaling() {
    using Clock = std::chrono::steady_clock;
    struct Took {
        double seconds, cores;
    };
    const auto took = [](int jobs) {
        const auto start = Clock::now();
        const std::clock_t cpu = std::clock();
        taught().run(jobs);
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        return Took{seconds, static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC / seconds};
    };
    const auto median = [](std::vector<double> values) {
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::nth_element(values.begin(), middle, values.end());
        return *middle;
    };
    std::vector<double> ratio, rate[2], cores[2];
    for (int k = 0; k < 5; ++k) {
        const Took one = took(1), two = took(2);
        ratio.push_back(one.seconds / two.seconds);
        rate[0].push_back(static_cast<double>(kRuns) / one.seconds);
        rate[1].push_back(static_cast<double>(kRuns) / two.seconds);
        cores[0].push_back(one.cores);
        cores[1].push_back(two.cores);
    }
    std::printf(
        "ratio evaluation 2 cores / 1 core: %.2f (%.1f and %.1f runs per second of 12 profiles each; the "
        "process got %.2f and %.2f cores of %u)\n",
        median(ratio), median(rate[0]), median(rate[1]), median(cores[0]), median(cores[1]),
        std::thread::hardware_concurrency());
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    print_scaling();
    return 0;
}
