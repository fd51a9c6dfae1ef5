// A run over loopback: GigE Vision camera, robot controller, 12 spots. How long after the last profile has
// arrived is the corrected frame written and read back, how long until it is released on the controller, and
// where that time goes. The stages are cut at
// the calls that the station makes to the robot, by a link that notes when each began and ended:
//   measure   last frame -> last spot measured (extract, filter, feature; each has a benchmark of its own)
//   judge     -> all regions corrected and through the gate, without the gate's questions to the robot
//   asking    the gate's questions to the robot: identity and mode
//   storing   the judged run, its last profiles and the attempt made durable; after the writing its outcome
//   frame     old frame read, new one written and read back
//   verdict   told -> released on the controller
// "our code" is measure + judge: a lower bound, since storing holds the packing of the run beside the disk's
// syncs. The ratio is one of percentiles, not a percentile of ratios.

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <thread>
#include <type_traits>
#include <vector>

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

enum class Ask { gate, read, write, confirm };
struct Call {
    Ask ask;
    std::int64_t begin_ns, end_ns;
};

// Passes every call on and notes those between the last profile and the release.
class TimedLink : public RobotLink {
  public:
    TimedLink(std::unique_ptr<RobotLink> link, std::vector<Call>& calls)
        : link_(std::move(link)), calls_(calls) {}
    Expected<RobotIdentity> identity() override {
        return timed(Ask::gate, [&] { return link_->identity(); });
    }
    Expected<RobotMode> mode() override {
        return timed(Ask::gate, [&] { return link_->mode(); });
    }
    bool tells_mode() const override { return link_->tells_mode(); }
    bool permission_outlives_link() const override { return link_->permission_outlives_link(); }
    Expected<Pose> base_from_flange() override { return link_->base_from_flange(); }
    Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) override {
        return link_->start_measuring(moves);
    }
    Expected<TriggerEvent> wait_trigger(std::chrono::milliseconds timeout) override {
        return link_->wait_trigger(timeout);
    }
    Expected<Pose> read_frame(const std::string& name) override {
        return timed(Ask::read, [&] { return link_->read_frame(name); });
    }
    Expected<void> write_frame(const std::string& name, const Pose& base_from_frame) override {
        return timed(Ask::write, [&] { return link_->write_frame(name, base_from_frame); });
    }
    Expected<void> confirm(PartVerdict verdict, const std::string& text) override {
        return timed(Ask::confirm, [&] { return link_->confirm(verdict, text); });
    }
    Expected<Permission> permission() override { return link_->permission(); }

  private:
    template <class F>
    std::invoke_result_t<F> timed(Ask ask, F call) {
        const std::int64_t begin = now_ns();
        auto result = call();
        calls_.push_back({ask, begin, now_ns()});
        return result;
    }
    std::unique_ptr<RobotLink> link_;
    std::vector<Call>& calls_;
};

using Stages = std::map<std::string, std::vector<double>>;  // ms

// Adds one run's stages; false when the calls are not those of one region pushed.
bool add_stages(Stages& stages, std::int64_t last_frame, std::int64_t measured,
                const std::vector<Call>& calls, std::int64_t released) {
    std::int64_t asking = 0, gate_end = measured;
    bool frame_judged = false;
    std::vector<Call> push;
    for (const Call& call : calls) {
        if (call.begin_ns < measured) continue;
        // The first frame that is read is the gate's question too.
        const bool of_gate = call.ask == Ask::gate || (call.ask == Ask::read && !frame_judged);
        frame_judged = frame_judged || call.ask == Ask::read;
        if (!of_gate) {
            push.push_back(call);
        } else {
            asking += call.end_ns - call.begin_ns;
            gate_end = call.end_ns;
        }
    }
    if (push.size() != 4 || push[0].ask != Ask::read || push[1].ask != Ask::write ||
        push[2].ask != Ask::read || push[3].ask != Ask::confirm || gate_end > push[0].begin_ns)
        return false;
    const auto add = [&](const char* name, std::int64_t ns) {
        stages[name].push_back(static_cast<double>(ns) / 1e6);
    };
    const std::int64_t judge = gate_end - measured - asking;
    add("1 measure", measured - last_frame);
    add("2 judge", judge);
    add("3 asking", asking);
    add("4 storing the run", push[1].begin_ns - push[0].end_ns + push[0].begin_ns - gate_end);
    add("5 frame", push[0].end_ns - push[0].begin_ns + push[2].end_ns - push[1].begin_ns);
    add("written", push[2].end_ns - last_frame);
    add("6 storing the outcome", push[3].begin_ns - push[2].end_ns);
    add("7 verdict", released - push[3].begin_ns);
    add("our code", measured - last_frame + judge);
    return true;
}

void trigger_to_released(benchmark::State& state, const char* driver) {
    const auto folder =
        std::filesystem::temp_directory_path() / fmt::format("seamwright_bench_run_{}", ::getpid());
    std::filesystem::create_directories(folder);
    auto served = serve_cell({.driver = driver, .width = 1280, .height = 1024}, folder / "run.seam");
    if (!served) return state.SkipWithError(served.error().sentence().c_str());
    served->cell->set_part({make_pose(rotation_exp({0.002, -0.001, 0.003}), {2, -1, 1}), {}});
    std::vector<Call> calls;
    Station& station = *served->station;
    station.disconnect();
    DeviceSession session;
    std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
    std::map<std::string, std::unique_ptr<RobotLink>> robots;
    for (const SensorSetup& setup : station.project().sensors) {
        auto sensor = open_sensor(setup.driver, setup.settings, session);
        if (!sensor) return state.SkipWithError(sensor.error().sentence().c_str());
        sensors[setup.id] = std::move(*sensor);
    }
    for (const RobotSetup& setup : station.project().robots) {
        auto robot = open_robot(setup.driver, setup.settings, session);
        if (!robot) return state.SkipWithError(robot.error().sentence().c_str());
        robots[setup.id] = std::make_unique<TimedLink>(std::move(*robot), calls);
    }
    station.connect(std::move(sensors), std::move(robots));
    std::vector<double> released_ms, all_ms;
    Stages stages;
    std::int64_t measured_at = 0;
    RunOptions options;
    options.push = true;
    options.progress = [&](const RunProgress& progress) {
        if (progress.done == progress.total && measured_at == 0) measured_at = now_ns();
    };
    for (auto _ : state) {
        calls.clear();
        measured_at = 0;
        std::atomic<std::int64_t> released_at = 0;
        std::jthread observer([&](const std::stop_token& stop) {
            bool was = true;
            for (bool last = false; !last;) {  // looks once more after the end
                last = stop.stop_requested();
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
            return state.SkipWithError((run ? run->message.english() : run.error().sentence()).c_str());
        const std::int64_t last = run->captures.back().host_time_ns;
        released_ms.push_back(static_cast<double>(released_at - last) / 1e6);
        all_ms.push_back(static_cast<double>(end - last) / 1e6);
        if (released_at == 0 || !add_stages(stages, last, measured_at, calls, released_at))
            return state.SkipWithError("the run did not push one region");
    }
    state.counters["released_p50_ms"] = percentile(released_ms, 0.5);
    state.counters["released_p99_ms"] = percentile(released_ms, 0.99);
    state.counters["recorded_p99_ms"] = percentile(all_ms, 0.99);
    const std::vector<double>& written_ms = stages["written"];
    state.counters["written_p50_ms"] = percentile(written_ms, 0.5);
    state.counters["written_p99_ms"] = percentile(written_ms, 0.99);
    fmt::print(
        "last profile to frame written and read back, {}, {} runs of 12 spots: p50 {:.2f} ms, p99 {:.2f} ms; "
        "released p50 {:.2f} ms, p99 {:.2f} ms; recorded p99 {:.2f} ms\n",
        driver, released_ms.size(), percentile(written_ms, 0.5), percentile(written_ms, 0.99),
        percentile(released_ms, 0.5), percentile(released_ms, 0.99), percentile(all_ms, 0.99));
    for (const auto& [stage, ms] : stages)
        fmt::print("  {:<22} p50 {:7.3f} ms, p99 {:7.3f} ms\n", stage, percentile(ms, 0.5),
                   percentile(ms, 0.99));
    fmt::print(
        "ratio our code (without packing for the file) of last profile to written, {}: p50 {:.3f}, p99 "
        "{:.3f}\n",
        driver, percentile(stages["our code"], 0.5) / percentile(written_ms, 0.5),
        percentile(stages["our code"], 0.99) / percentile(written_ms, 0.99));
    fmt::print("ratio last profile to written of the goal of 5 ms, {}: p50 {:.2f}, p99 {:.2f}\n", driver,
               percentile(written_ms, 0.5) / 5, percentile(written_ms, 0.99) / 5);
    std::filesystem::remove_all(folder);
}
BENCHMARK_CAPTURE(trigger_to_released, kuka_eki, "kuka-eki")->Iterations(100)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(trigger_to_released, kuka_kvp, "kuka-kvp")->Iterations(100)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
