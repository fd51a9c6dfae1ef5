// What a KUKA controller, or anybody, sends to the RSI port.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "devices/kuka/rsi_telegram.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    if (const auto rob = seamwright::parse_rsi_rob(bytes)) {
        if (rob->ipoc_text[0] == 0 || rob->ipoc_text.back() != 0) std::abort();
        if (rob->rist && rob->rist->usable)
            for (const double x : rob->rist->xyzabc)
                if (!(std::abs(x) <= 1e5)) std::abort();
    }
    (void)seamwright::parse_rsi_sen(bytes);
    return 0;
}
