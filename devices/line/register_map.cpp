#include "devices/line/register_map.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace seamwright {
namespace {

// In thousandths.
std::int64_t thousandths(double value, bool up = false) {
    const double scaled = up ? std::ceil(1000 * value - 1e-9) : std::round(1000 * value);
    if (!std::isfinite(scaled) || std::abs(scaled) > std::numeric_limits<std::int32_t>::max())
        return kNoLineValue;
    return static_cast<std::int64_t>(scaled);
}

// A length or an angle of a region, on which the registers stand in the order of x y z a b c.
template <int k>
std::int64_t shift(const LineRegion& r) {
    if (!r.solved) return kNoLineValue;
    return thousandths(k < 3 ? r.xyz_mm[k % 3] : r.abc_deg[k % 3]);
}
template <int k>
std::int64_t sigma(const LineRegion& r) {
    if (!r.solved) return kNoLineValue;
    return thousandths(k < 3 ? r.sigma_xyz_mm[k % 3] : r.sigma_abc_deg[k % 3], true);
}

template <class Number>
std::int64_t low_bits(Number number, std::int64_t mask = 0xffffffff) {
    return static_cast<std::int64_t>(number) & mask;
}

const LineRegister& line_register(std::string_view name) {
    const auto& all = line_registers();
    const auto found = std::find_if(all.begin(), all.end(), [&](const auto& r) { return r.name == name; });
    assert(found != all.end());
    return *found;
}

void put(const LineRegister& r, std::int64_t value, std::uint16_t* words) {
    const auto bits = static_cast<std::uint32_t>(value);
    if (r.words == 2) words[0] = static_cast<std::uint16_t>(bits >> 16);
    words[r.words - 1] = static_cast<std::uint16_t>(bits);
}

}  // namespace

std::string_view to_string(RegisterType type) {
    switch (type) {
        case RegisterType::uint16:
            return "uint16";
        case RegisterType::uint32:
            return "uint32";
        case RegisterType::int32:
            return "int32";
        case RegisterType::text:
            return "text";
    }
    return "uint16";
}

const std::vector<LineRegister>& line_registers() {
    using enum RegisterType;
    using Words = const StationWords&;
    static const std::vector<LineRegister> registers = {
        {0, 1, uint16, "line_heartbeat",
         "counts on while the line lives; watched where heartbeat_timeout_ms is set"},
        {1, 1, uint16, "start", "1: measure the part; held until done, then 0. Anything but 0 is 1"},
        {2, 1, uint16, "part_type", "0: not said"},
        {3, 1, uint16, "paint", "the colour's number, as the spots' paints are named; 0: not said"},
        {4, 2, uint32, "part_number", "0: not said"},
        {6, 16, text, "part_name", "the run's name; all 0: the part number is"},
        {100, 1, uint16, "protocol_version", "of this table",
         [](Words) -> std::int64_t { return kLineProtocolVersion; }},
        {101, 1, uint16, "heartbeat", "counts on four times a second while the station watches",
         [](Words w) -> std::int64_t { return w.heartbeat; }},
        {102, 1, uint16, "ready", "1: all devices answer, start may come",
         [](Words w) -> std::int64_t { return w.bits.ready; }},
        {103, 1, uint16, "busy", "1: the part is measured",
         [](Words w) -> std::int64_t { return w.bits.busy; }},
        {104, 1, uint16, "done", "1: result, alarm and regions are of the part that was called for",
         [](Words w) -> std::int64_t { return w.bits.done; }},
        {105, 1, uint16, "result", "see results",
         [](Words w) { return static_cast<std::int64_t>(w.bits.result); }},
        {106, 1, uint16, "alarm", "see alarms; 0: none",
         [](Words w) { return static_cast<std::int64_t>(w.bits.alarm); }},
        {107, 1, uint16, "measured_type", "part_type of the present or last part",
         [](Words w) -> std::int64_t { return w.state.part.type; }},
        {108, 2, uint32, "measured_number", "part_number of it",
         [](Words w) -> std::int64_t { return w.state.part.number; }},
        {110, 2, uint32, "run", "the run's number in the project file",
         [](Words w) { return low_bits(w.state.run); }},
        {112, 2, uint32, "parts", "started since the station was",
         [](Words w) { return low_bits(w.state.parts); }},
        {114, 2, uint32, "duration_ms", "the last part took",
         [](Words w) { return low_bits(std::llround(1000 * std::clamp(w.state.seconds, 0.0, 4e6))); }},
        {116, 1, uint16, "regions", "how many follow, at most 16",
         [](Words w) {
             return static_cast<std::int64_t>(std::min<std::size_t>(w.state.regions.size(), kLineRegions));
         }},
    };
    return registers;
}

const std::vector<LineRegister>& line_region_registers() {
    using enum RegisterType;
    using Region = const LineRegion&;
    static const std::vector<LineRegister> registers = {
        {0, 1, uint16, "status", "1: within its limits; 2: refused; 0: there is no such region", nullptr,
         [](Region r) -> std::int64_t { return r.passed ? 1 : 2; }},
        {1, 1, uint16, "solved", "1: shift and sigma are numbers; else they are -2147483648", nullptr,
         [](Region r) -> std::int64_t { return r.solved; }},
        {2, 2, int32, "shift_x", "0.001 mm, displacement of the part in the work object", nullptr, shift<0>},
        {4, 2, int32, "shift_y", "0.001 mm", nullptr, shift<1>},
        {6, 2, int32, "shift_z", "0.001 mm", nullptr, shift<2>},
        {8, 2, int32, "shift_a", "0.001 degree, about Z (KUKA A, B, C: Rz Ry Rx)", nullptr, shift<3>},
        {10, 2, int32, "shift_b", "0.001 degree, about Y", nullptr, shift<4>},
        {12, 2, int32, "shift_c", "0.001 degree, about X", nullptr, shift<5>},
        {14, 2, int32, "sigma_x", "0.001 mm, one standard deviation", nullptr, sigma<0>},
        {16, 2, int32, "sigma_y", "0.001 mm", nullptr, sigma<1>},
        {18, 2, int32, "sigma_z", "0.001 mm", nullptr, sigma<2>},
        {20, 2, int32, "sigma_a", "0.001 degree", nullptr, sigma<3>},
        {22, 2, int32, "sigma_b", "0.001 degree", nullptr, sigma<4>},
        {24, 2, int32, "sigma_c", "0.001 degree", nullptr, sigma<5>},
    };
    return registers;
}

void write_station_words(const StationWords& values, AllWords& words) {
    std::fill(words.begin() + kStationWords, words.end(), std::uint16_t{0});
    for (const LineRegister& r : line_registers())
        if (r.value) put(r, r.value(values), &words[static_cast<std::size_t>(r.address)]);
    const auto& regions = values.state.regions;
    for (std::size_t i = 0; i < std::min<std::size_t>(regions.size(), kLineRegions); ++i)
        for (const LineRegister& r : line_region_registers())
            put(r, r.region(regions[i]),
                &words[kRegionWords + kRegionStride * i + static_cast<std::size_t>(r.address)]);
}

LineWords read_line_words(std::span<const std::uint16_t> words) {
    assert(words.size() >= static_cast<std::size_t>(kLineWords));
    const auto number = [&](std::string_view name) {
        const LineRegister& r = line_register(name);
        const auto* at = &words[static_cast<std::size_t>(r.address)];
        return r.words == 2 ? std::uint32_t{at[0]} << 16 | at[1] : std::uint32_t{at[0]};
    };
    LineWords line;
    line.heartbeat = static_cast<std::uint16_t>(number("line_heartbeat"));
    line.start = number("start") != 0;
    line.part.type = static_cast<std::uint16_t>(number("part_type"));
    line.part.paint = static_cast<std::uint16_t>(number("paint"));
    line.part.number = number("part_number");
    const LineRegister& name = line_register("part_name");
    std::string text;
    for (int i = 0; i < name.words; ++i) {
        const std::uint16_t word = words[static_cast<std::size_t>(name.address + i)];
        text += static_cast<char>(word >> 8);
        text += static_cast<char>(word & 0xff);
    }
    line.part.name = line_name(text.substr(0, text.find('\0')));
    return line;
}

bool line_may_write(int address, int count) {
    return address >= 0 && count > 0 && address + count <= kLineWords;
}

}  // namespace seamwright
