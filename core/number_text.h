#pragma once
// A number from its text, the same under every locale: a desktop's decimal comma means nothing here.

#include <charconv>
#include <optional>
#include <string_view>
#include <type_traits>

namespace seamwright {

// The whole of `text` as decimal point and digits, or to `base`; nullopt otherwise and when it does not fit.
template <class Number>
std::optional<Number> number_from(std::string_view text, int base = 10) {
    Number value{};
    const char* end = text.data() + text.size();
    std::from_chars_result read{};
    if constexpr (std::is_floating_point_v<Number>)
        read = std::from_chars(text.data(), end, value);
    else
        read = std::from_chars(text.data(), end, value, base);
    if (text.empty() || read.ec != std::errc() || read.ptr != end) return std::nullopt;
    return value;
}

}  // namespace seamwright
