#pragma once
// The registers that a PLC shares with the station: one table, by which words are written and read and the
// documentation is made (devices/line/LINE.md). Addresses count from 0 (the "40001" of older manuals is 0).
//
// Numbers of two words have the high word first. Texts have two signs a word, the first one in the high byte, and end at
// a 0. Lengths are counted in 0.001 mm, angles in 0.001 degree, rounded; standard deviations rounded up. What is not
// finite or too large is kNoLineValue.

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "devices/line/handshake.h"

namespace seamwright {

inline constexpr int kLineProtocolVersion = 1;
// The line's words stand at 0.., the station's at kStationWords.., its regions at kRegionWords.., one every
// kRegionStride.
inline constexpr int kLineWords = 22, kStationWords = 100, kStationWordsEnd = 120, kRegionWords = 120,
                     kRegionStride = 32, kLineRegions = 16,
                     kAllWords = kRegionWords + kRegionStride * kLineRegions;
inline constexpr std::int32_t kNoLineValue = std::numeric_limits<std::int32_t>::min();

enum class RegisterType { uint16, uint32, int32, text };
std::string_view to_string(RegisterType type);

// What the station's words are made of.
struct StationWords {
    const LineState& state;
    HandshakeBits bits;
    std::uint16_t heartbeat = 0;
};

struct LineRegister {
    int address;  // of a region's: from the region's first word
    int words;
    RegisterType type;
    std::string_view name, help;
    // One of them: of the station's, of a region's; none: the line's own, which it writes.
    std::int64_t (*value)(const StationWords&) = nullptr;
    std::int64_t (*region)(const LineRegion&) = nullptr;
    bool writable() const { return !value && !region; }
};
const std::vector<LineRegister>& line_registers();         // ascending
const std::vector<LineRegister>& line_region_registers();  // ascending, from the region's first word

using AllWords = std::array<std::uint16_t, kAllWords>;
// The station's words; the line's stay as they are.
void write_station_words(const StationWords& values, AllWords& words);
// Of kLineWords words.
LineWords read_line_words(std::span<const std::uint16_t> words);
// Whether the line may write all of `count` words from `address` on.
bool line_may_write(int address, int count);

}  // namespace seamwright
