// What a Gocator sends: control replies, data messages, lines of its ASCII output.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "devices/gocator/ascii_result.h"
#include "devices/gocator/gdp_message.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace seamwright;
    const std::string bytes(reinterpret_cast<const char*>(data), size);
    std::string stream = bytes;
    for (auto reply = gdp::take_reply(stream); reply && *reply; reply = gdp::take_reply(stream))
        for (const auto command : {gdp::Command::system_info, gdp::Command::system_info_v1})
            (void)gdp::parse_system_info(command, (*reply)->answer);
    stream = bytes;
    for (auto message = gdp::take_message(stream); message && *message; message = gdp::take_message(stream)) {
        (void)gdp::parse_stamps((*message)->content);
        (void)gdp::parse_intensities((*message)->content);
        for (const auto type : {gdp::Type::points, gdp::Type::uniform})
            if (const auto read = gdp::parse_profiles(type, (*message)->content))
                for (const Profile& p : read->profiles)
                    if (p.x_mm.size() != p.z_mm.size()) std::abort();
    }
    // The first byte of text chooses the format, what stands before a zero is the pattern.
    const auto zero = bytes.find('\0');
    gocator::AsciiFormat custom;
    custom.pattern = zero == std::string::npos ? "%frame, %value[0], %decision[0]" : bytes.substr(0, zero);
    stream = zero == std::string::npos ? bytes : bytes.substr(zero + 1);
    const bool known = gocator::check_format(custom).has_value();
    for (auto line = gocator::take_line(stream, {}); line && *line; line = gocator::take_line(stream, {})) {
        for (const auto& format : {gocator::AsciiFormat{}, custom}) {
            if (!known && !format.pattern.empty()) continue;
            if (const auto result = gocator::parse_result(**line, format))
                for (const auto& [id, mm] : result->value_mm)
                    if (id < 0 || !std::isfinite(mm)) std::abort();
        }
    }
    return 0;
}
