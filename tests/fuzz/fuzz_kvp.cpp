// What a KUKAVARPROXY server or client sends, and the values in it.

#include <cstdint>
#include <cstdlib>
#include <string>

#include "devices/kuka/kvp_message.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace seamwright;
    const std::string bytes(reinterpret_cast<const char*>(data), size);
    const auto values = [](const std::string& text) {
        if (const auto pose = frame_from_krl(text); pose && !pose->matrix().allFinite()) std::abort();
        (void)bool_from_krl(text);
        (void)int_from_krl(text);
        (void)string_from_krl(text);
    };
    values(bytes);
    std::string stream = bytes;
    for (auto answer = take_kvp_answer(stream); answer && *answer; answer = take_kvp_answer(stream))
        values((*answer)->value);
    stream = bytes;
    for (auto request = take_kvp_request(stream); request && *request; request = take_kvp_request(stream))
        values((*request)->value);
    return 0;
}
