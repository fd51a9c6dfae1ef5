// The camera on the wire: frames a second and latency over loopback, profiles a second of a range camera to
// disk, and unpacking beside a plain loop.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <random>
#include <thread>

#include "devices/genicam/genicam.h"
#include "devices/genicam/pixels/pixel_format.h"
#include "devices/registry.h"
#include "devices/served/served_camera.h"

using namespace seamwright;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

namespace {

double seconds(Clock::duration d) {
    return std::chrono::duration<double>(d).count();
}
std::int64_t now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
}
double cpu_seconds() {
    rusage u{};
    getrusage(RUSAGE_SELF, &u);
    return static_cast<double>(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
           1e-6 * static_cast<double>(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

std::unique_ptr<ProfileSource> opened(const nlohmann::json& settings) {
    DeviceSession session;
    auto sensor = open_sensor("genicam", settings, session);
    if (!sensor) {
        fmt::print(stderr, "{}\n", sensor.error().sentence());
        std::exit(3);
    }
    if (auto started = (*sensor)->start(); !started) {
        fmt::print(stderr, "{}\n", started.error().sentence());
        std::exit(3);
    }
    return std::move(*sensor);
}

std::string spread(std::vector<double>& ms) {
    std::sort(ms.begin(), ms.end());
    if (ms.empty()) return "none";
    const auto at = [&](double q) {
        return ms[static_cast<std::size_t>(q * static_cast<double>(ms.size() - 1))];
    };
    return fmt::format("p50 {:.2f} ms, p99 {:.2f} ms, max {:.2f} ms", at(0.5), at(0.99), ms.back());
}

// Pushes ready images at `rate` a second: the wire and the driver alone.
void wire(int width, int height, double rate, int frames) {
    WireCameraSettings s;
    s.width = width;
    s.height = height;
    s.queue = 64;
    auto camera = WireCamera::open(s);
    if (!camera) return (void)fmt::print("{}\n", camera.error().sentence());
    (*camera)->set_ready(true);
    auto sensor =
        opened({{"address", "127.0.0.1"}, {"trigger", "free"}, {"packet_resend", false}, {"buffers", 32}});
    std::thread feeding([&] {
        auto due = Clock::now();
        for (int i = 0; i < frames; ++i) {
            std::this_thread::sleep_until(due);
            due += std::chrono::nanoseconds(static_cast<long>(1e9 / rate));
            std::vector<std::byte> image(static_cast<std::size_t>(width * height), static_cast<std::byte>(i));
            (*camera)->push(std::move(image), now_ns());
        }
    });
    std::vector<double> latency;
    const auto begin = Clock::now();
    const double cpu = cpu_seconds();
    int ok = 0;
    while (const auto frame = sensor->wait_next(milliseconds(500))) {
        if ((*frame)->status == FrameStatus::ok)
            latency.push_back(1e-6 * static_cast<double>(now_ns() - (*frame)->device_time_ns));
        ok += (*frame)->status == FrameStatus::ok ? 1 : 0;
    }
    const double took = seconds(Clock::now() - begin) - 0.5, load = cpu_seconds() - cpu;
    feeding.join();
    const auto c = sensor->counters();
    fmt::print(
        "wire {}x{} at {:.0f}/s: {} of {} whole, damaged {}, lost {}, underrun {}; {:.0f}/s; push to "
        "wait_next {}; {:.0f} % of a core for camera and driver\n",
        width, height, rate, ok, frames, c.damaged, c.lost, c.underrun, ok / took, spread(latency),
        100 * load / (took + 0.5));
}

// The robot's triggers to the frame in hand, rendering included.
void cell(int width, int height) {
    auto made = SimulatedCell::open(
        nlohmann::json{{"buffers", 64}, {"optics", {{"width", width}, {"height", height}}}});
    if (!made) return;
    auto camera = ServedCamera::open(*made, nlohmann::json::object());
    if (!camera) return (void)fmt::print("{}\n", camera.error().sentence());
    auto sensor = opened(
        {{"address", "127.0.0.1"}, {"hardware_trigger", true}, {"packet_resend", false}, {"buffers", 32}});
    Frame scratch;
    const Pose pose = (*made)->flange_for(Pose::Identity());
    const auto begin = Clock::now();
    for (int i = 0; i < 20; ++i) (*made)->render(pose, static_cast<std::uint64_t>(i), scratch);
    const double render_ms = 1e3 * seconds(Clock::now() - begin) / 20;
    constexpr int kTriggers = 300;
    std::vector<MeasuringMove> moves(kTriggers);
    for (auto& m : moves) {
        m.spot_id.assign(1, 's');
        m.trigger = m.entry = m.exit = pose;
    }
    (*made)->start_moves(moves);
    std::thread robot([&] {
        auto due = Clock::now();
        for (int i = 0; i < kTriggers; ++i) {
            std::this_thread::sleep_until(due += milliseconds(10));
            (*made)->next_trigger();
        }
    });
    std::vector<double> latency;
    int ok = 0;
    while (const auto frame = sensor->wait_next(milliseconds(500))) {
        if ((*frame)->status == FrameStatus::ok)
            latency.push_back(1e-6 * static_cast<double>(now_ns() - (*frame)->device_time_ns));
        ok += (*frame)->status == FrameStatus::ok ? 1 : 0;
    }
    robot.join();
    const auto c = sensor->counters();
    fmt::print(
        "cell {}x{}, 100 robot triggers/s: {} of {} whole, damaged {}, lost {}; trigger to wait_next {} "
        "(rendering alone {:.2f} ms)\n",
        width, height, ok, kTriggers, c.damaged, c.lost, spread(latency), render_ms);
}

// A range camera of 1024 points a profile, `rows` profiles an image, profiles written to a file.
void range(int rows, double profiles_a_second) {
    WireCameraSettings s;
    s.width = 1024;
    s.height = rows;
    s.pixel_formats = {"Coord3D_C16"};
    s.c_scale_mm = 0.01;
    s.queue = 64;
    auto camera = WireCamera::open(s);
    if (!camera) return (void)fmt::print("{}\n", camera.error().sentence());
    (*camera)->set_ready(true);
    auto sensor =
        opened({{"address", "127.0.0.1"}, {"trigger", "free"}, {"packet_resend", false}, {"buffers", 64}});
    const int images = static_cast<int>(3 * profiles_a_second / rows);
    std::thread feeding([&] {
        auto due = Clock::now();
        for (int i = 0; i < images; ++i) {
            std::this_thread::sleep_until(due);
            due += std::chrono::nanoseconds(static_cast<long>(1e9 * rows / profiles_a_second));
            (*camera)->push(std::vector<std::byte>(static_cast<std::size_t>(2 * 1024 * rows), std::byte{7}),
                            now_ns());
        }
    });
    std::FILE* file = std::tmpfile();
    const auto begin = Clock::now();
    const double cpu = cpu_seconds();
    int got = 0;
    while (const auto frame = sensor->wait_next(milliseconds(500))) {
        const Profile& p = (*frame)->profile;
        std::fwrite(p.x_mm.data(), sizeof(double), p.size(), file);
        std::fwrite(p.z_mm.data(), sizeof(double), p.size(), file);
        ++got;
    }
    const double took = seconds(Clock::now() - begin) - 0.5, load = cpu_seconds() - cpu;
    std::fclose(file);
    feeding.join();
    const auto c = sensor->counters();
    fmt::print(
        "range camera, {} rows an image, {:.0f} profiles/s asked: {:.0f}/s to disk, {} of {} profiles, "
        "damaged "
        "{}, lost {} images, underrun {}; {:.0f} % of a core for camera and driver\n",
        rows, profiles_a_second, got / took, got, images * rows, c.damaged, c.lost, c.underrun,
        100 * load / (took + 0.5));
}

// One pixel after another by its bits, as the standards draw it.
void plain_loop(const PixelFormat& f, const std::byte* packed, std::size_t count, std::uint16_t* out) {
    const auto* in = reinterpret_cast<const std::uint8_t*>(packed);
    if (f.packing == Packing::lsb) {
        std::uint32_t bits = 0;
        int have = 0;
        for (std::size_t i = 0; i < count; ++i) {
            while (have < f.bit_depth) {
                bits |= static_cast<std::uint32_t>(*in++) << have;
                have += 8;
            }
            out[i] = static_cast<std::uint16_t>(bits & ((1U << f.bit_depth) - 1));
            bits >>= f.bit_depth;
            have -= f.bit_depth;
        }
        return;
    }
    const int low = f.bit_depth - 8;
    for (std::size_t i = 0; i + 1 < count; i += 2, in += 3) {
        out[i] = static_cast<std::uint16_t>(in[0] << low | (in[1] & ((1 << low) - 1)));
        out[i + 1] = static_cast<std::uint16_t>(in[2] << low | (in[1] >> 4 & ((1 << low) - 1)));
    }
}

void unpacking(const char* name) {
    const PixelFormat& f = *pixel_format_by_name(name);
    constexpr std::size_t kPixels = 1024 * 512;
    std::vector<std::byte> packed(kPixels * static_cast<std::size_t>(f.bits_per_pixel()) / 8),
        out(2 * kPixels);
    std::vector<std::uint16_t> plain(kPixels);
    std::mt19937 random(1);
    for (auto& b : packed) b = static_cast<std::byte>(random());
    const auto best = [](auto work) {
        double least = 1e9;
        for (int i = 0; i < 200; ++i) {
            const auto begin = Clock::now();
            work();
            least = std::min(least, seconds(Clock::now() - begin));
        }
        return least;
    };
    const double ours = best([&] {
        unpack_pixels(f, packed, kPixels, out.data());
        benchmark::DoNotOptimize(out.data());
    });
    const double theirs = best([&] {
        plain_loop(f, packed.data(), kPixels, plain.data());
        benchmark::DoNotOptimize(plain.data());
    });
    const bool same = std::memcmp(out.data(), plain.data(), out.size()) == 0;
    const double bytes = static_cast<double>(out.size());
    fmt::print("{} to 16 bit: {:.2f} GB/s written, plain loop {:.2f} GB/s, {}\n", name, 1e-9 * bytes / ours,
               1e-9 * bytes / theirs, same ? "same values" : "VALUES DIFFER");
    fmt::print("ratio unpack {} beside a plain loop: {:.2f}\n", name, theirs / ours);
}

}  // namespace

int main() {
    for (const char* name : {"Mono10p", "Mono12p", "Mono10Packed", "Mono12Packed"}) unpacking(name);
    wire(1024, 512, 100, 300);
    wire(1024, 512, 400, 800);
    wire(1280, 1024, 100, 300);
    cell(1024, 512);
    range(1, 1000);
    range(50, 1000);
    range(50, 4000);
    return 0;
}
