#pragma once
// What a Gocator's own measuring tools found, as lines of text over TCP port 8190. The job on the sensor says
// which and how; the same is said to the driver.
//
//     standard   M00,00,V151290,D0,M01,01,V18520,D0   M type (hexadecimal), id, V value, D decision; any
//     number custom     a pattern with %time (us) %encoder %frame %value[ID] %decision[ID], everything else
//     as it is:
//                the sensor's default is "%time, %value[0], %decision[0]"
//
// Values are whole um; an invalid one is the text "INVALID". Bits 1-7 of a decision are not 0 when the value
// is none. Source: the vendor's user manual, chapter "ASCII Protocol". Its "standard with stamp" is not
// described there and is not read.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/error.h"

namespace seamwright::gocator {

inline constexpr std::uint16_t kAsciiPort = 8190;
inline constexpr std::size_t kLongestLine = 65536;

struct AsciiFormat {
    std::string pattern;  // empty = standard
    std::string delimiter = ",", terminator = "\r\n", invalid = "INVALID";
};

struct AsciiResult {
    std::map<int, double> value_mm;  // by the id of the measurement; those that are invalid are missing
    std::optional<std::int64_t> time_us, frame;
};

// Refuses an empty delimiter or terminator and a pattern with an unknown placeholder, or with two that
// nothing tells apart.
Expected<void> check_format(const AsciiFormat& format);
// Takes the first whole line off the front of `stream`; nullopt while there is none. Error (device): a line
// beyond kLongestLine.
Expected<std::optional<std::string>> take_line(std::string& stream, const AsciiFormat& format);
// Error (device): the line is no result of this format. Precondition: the format was checked.
Expected<AsciiResult> parse_result(std::string_view line, const AsciiFormat& format);

}  // namespace seamwright::gocator
