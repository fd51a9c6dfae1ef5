// What a KUKA controller sends over EthernetKRL: the stream, cut in two anywhere, and every document in it.

#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "devices/kuka/eki_telegram.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace seamwright;
    if (size == 0) return 0;
    const std::string_view bytes(reinterpret_cast<const char*>(data + 1), size - 1);
    const std::size_t cut = bytes.size() * data[0] / 256;
    EkiSplitter splitter("Robot");
    if (!splitter.add(bytes.substr(0, cut)) || !splitter.add(bytes.substr(cut))) return 0;
    for (std::string document; splitter.next(document);) {
        if (document.size() > kEkiLongestTelegram) std::abort();
        const auto telegram = parse_eki_telegram(document);
        if (!telegram) continue;
        if (!telegram->pose.matrix().allFinite() || telegram->id < 0) std::abort();
        (void)mode_from_eki(telegram->mode);
    }
    return 0;
}
