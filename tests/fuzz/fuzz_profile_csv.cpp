// Profile CSV: what is accepted must be written and read again as the same points.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "devices/exchange/tables/profile_csv.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    if (const auto profile = seamwright::parse_profile_csv(text, "fuzz")) {
        const auto again = seamwright::parse_profile_csv(seamwright::profile_csv(*profile), "again");
        if (!again || again->size() != profile->size()) std::abort();
    }
    (void)seamwright::parse_align_csv(text, "fuzz");
    return 0;
}
