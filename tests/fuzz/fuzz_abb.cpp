// What an ABB controller's server task sends: messages of three lines, and the poses and counts in them.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "devices/abb/rapid_message.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace seamwright;
    const auto message = abb::parse_message({reinterpret_cast<const char*>(data), size}, "fuzz");
    if (!message) return 0;
    if (size != abb::kMessageBytes || message->number > abb::kHighestNumber) std::abort();
    for (const auto& field : message->fields) (void)abb::parse_count(field);
    const auto pose = abb::parse_pose_lines(*message, "fuzz");
    if (pose && !pose->matrix().allFinite()) std::abort();
    return 0;
}
