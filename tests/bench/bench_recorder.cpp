// One profile sensor of 1000 profiles/s, 2048 points each, recorded to disk: how much of one core it takes,
// whether anything is dropped, and how fast the recorder could go.

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <thread>

#include "devices/capture/recorder.h"

namespace {

using namespace seamwright;
using Clock = std::chrono::steady_clock;

constexpr int kPoints = 2048;
constexpr double kSeconds = 5, kRate_hz = 1000;

double cpu_seconds() {
    rusage use{};
    getrusage(RUSAGE_SELF, &use);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(use.ru_utime) + seconds(use.ru_stime);
}

// A contour with sensor noise, so that packing has real work.
void fill(Frame& frame, std::uint64_t n) {
    frame.sequence = n;
    frame.host_time_ns = Clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
    frame.profile.clear();
    std::uint64_t random = n * 0x9e3779b97f4a7c15u + 1;
    for (int i = 0; i < kPoints; ++i) {
        random ^= random << 13, random ^= random >> 7, random ^= random << 17;
        frame.profile.x_mm.push_back(0.05 * i);
        frame.profile.z_mm.push_back(300 + 5 * std::sin(0.003 * i) + 1e-21 * static_cast<double>(random));
        frame.profile.intensity.push_back(static_cast<float>(random & 255));
    }
}

void record(benchmark::State& state, bool paced) {
    const auto path =
        std::filesystem::temp_directory_path() / fmt::format("seamwright_bench_recorder_{}", ::getpid());
    for (auto _ : state) {
        std::filesystem::remove(path);
        auto recorder = Recorder::create(path, {});
        if (!recorder) return state.SkipWithError(recorder.error().sentence().c_str());
        const auto source = (*recorder)->add_sensor("A", {});
        if (!source) return state.SkipWithError(source.error().sentence().c_str());
        // What the sensor delivers is there before: its making is not the recorder's work.
        std::vector<Frame> frames(64);
        for (std::size_t i = 0; i < frames.size(); ++i) fill(frames[i], i);
        const double cpu_before = cpu_seconds();
        const auto begin = Clock::now();
        const auto count = static_cast<std::uint64_t>(kRate_hz * kSeconds);
        for (std::uint64_t n = 0; n < count; ++n) {
            if (paced)
                std::this_thread::sleep_until(
                    begin + std::chrono::duration<double>(static_cast<double>(n) / kRate_hz));
            Frame& frame = frames[n % frames.size()];
            frame.sequence = n;
            (*recorder)->frame(*source, frame);
        }
        auto status = (*recorder)->finish();
        const double wall = std::chrono::duration<double>(Clock::now() - begin).count();
        const double cpu = cpu_seconds() - cpu_before;
        if (!status) return state.SkipWithError(status.error().sentence().c_str());
        const CaptureCounters& c = status->sources.at("A");
        fmt::print(
            "recorder, {}: {:.0f} profiles/s of {} points to disk, {} of {} kept, {} dropped, {:.0f} MB/s, "
            "{:.1f} % of one core\n",
            paced ? "paced at 1000/s" : "as fast as it goes", static_cast<double>(c.frames) / wall, kPoints,
            c.frames, count, c.dropped, static_cast<double>(status->bytes) / 1e6 / wall, 100 * cpu / wall);
        fmt::print("ratio recorder_{}/1000_per_second {:.2f}\n", paced ? "paced" : "free",
                   static_cast<double>(c.frames) / wall / kRate_hz);
        state.counters["dropped"] = static_cast<double>(c.dropped);
        state.counters["core_percent"] = 100 * cpu / wall;
    }
    std::filesystem::remove(path);
}
BENCHMARK_CAPTURE(record, paced_1000_per_second, true)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(record, unpaced, false)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
