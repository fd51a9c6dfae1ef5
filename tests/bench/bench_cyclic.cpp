// How fast a cyclic correction is answered: a simulated robot asks every 4 ms over loopback for 10 s, the
// ramp in motion half of the time. Latency is that of our thread, from the datagram received to the answer
// handed over; the robot counts what came too late.

#include <benchmark/benchmark.h>

#include <thread>

#include "devices/abb/egm.h"
#include "devices/controllers/abb/egm_controller.h"
#include "devices/controllers/kuka/rsi_controller.h"
#include "devices/exchange/pose_json.h"
#include "devices/kuka/rsi.h"
#include "devices/net/socket.h"

namespace seamwright {
namespace {

template <class Open, class Start>
void answer(benchmark::State& state, Open open, Start start) {
    const std::uint16_t port = UdpSocket::bind("127.0.0.1", 0)->port();
    const Pose taught = make_pose(Eigen::Matrix3d::Identity(), {900, -200, 600});
    Pose moved = taught;
    moved.translation() += Eigen::Vector3d(1, -2, 1);
    DeviceSession session;
    auto link = open({{"port", port},
                      {"max_late", 1000},
                      {"frames", {{"PATH", {{"base_from_frame", pose_json(taught)}}}}}},
                     session, nullptr);
    auto robot = start(nullptr, {{"port", port}, {"late_limit", 1000}, {"application", false}}, nullptr);
    if (!link || !robot || !(*link)->write_frame("PATH", moved)) {
        state.SkipWithError("cannot open");
        return;
    }
    for (auto _ : state) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
        bool up = false;
        while (std::chrono::steady_clock::now() < end) {
            up = !up;
            if (!(*link)->write_frame("PATH", up ? moved : taught) ||
                !(*link)->confirm(PartVerdict::corrected, "")) {
                state.SkipWithError("a correction was refused");
                return;
            }
        }
    }
    const CyclicCounters c = static_cast<CyclicLink&>(**link).server().counters();
    state.counters["answers"] = static_cast<double>(c.answers);
    state.counters["missed"] = static_cast<double>(c.missed_cycles);
    state.counters["late"] = static_cast<double>(c.late);
    state.counters["p50_us"] = c.latency_p50_us;
    state.counters["p99_us"] = c.latency_p99_us;
    state.counters["max_us"] = c.latency_max_us;
}

void rsi_answer(benchmark::State& state) {
    answer(state, open_kuka_rsi, start_kuka_rsi);
}
void egm_answer(benchmark::State& state) {
    answer(state, open_abb_egm, start_abb_egm);
}
BENCHMARK(rsi_answer)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();
BENCHMARK(egm_answer)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

}  // namespace
}  // namespace seamwright

BENCHMARK_MAIN();
