#pragma once
// For tests that talk to threads and programs.

#include <sys/wait.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>

#include "devices/line/line_link.h"

namespace seamwright {

template <class Condition>
bool soon(const Condition& condition, std::chrono::milliseconds patience = std::chrono::seconds(10)) {
    const auto until = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < until) {
        if (condition()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return condition();
}

struct Said {
    int exit_code = -1;
    std::string text;
};
// A command of the shell; both streams.
inline Said shell(const std::string& command) {
    Said said;
    FILE* pipe = popen((command + " 2>&1 </dev/null").c_str(), "r");
    if (!pipe) return said;
    std::array<char, 4096> part{};
    while (const std::size_t n = std::fread(part.data(), 1, part.size(), pipe))
        said.text.append(part.data(), n);
    const int status = pclose(pipe);
    said.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return said;
}

// A finished part as the station tells it.
inline LineState told_part(std::uint32_t number, LineState state = {}) {
    state.ready = true;
    state.busy = false;
    state.results = number;
    state.result = LineResult::corrected;
    state.alarm = LineAlarm::none;
    state.run = number;
    state.parts = number;
    state.part_id = "CAR-" + std::to_string(number);
    state.seconds = 12.345;
    LineRegion region;
    region.id = "edge";
    region.passed = region.solved = true;
    region.xyz_mm = {1.2345, -2.5, 0.0004};
    region.abc_deg = {-0.25, 0.1234, 179.9999};
    region.sigma_xyz_mm = {0.0101, 0.02, 0.03};
    region.sigma_abc_deg = {0.001, 0.0021, 0.0005};
    state.regions = {region};
    return state;
}

}  // namespace seamwright
