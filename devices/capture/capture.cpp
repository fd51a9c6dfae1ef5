#include "devices/capture/capture.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <string_view>

namespace seamwright {

StripeImage StoredImage::view() const {
    StripeImage image;
    image.pixels = pixels.data();
    image.width = width;
    image.height = height;
    image.bit_depth = bit_depth;
    image.row_bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(image.bytes_per_pixel());
    return image;
}

StoredImage keep_image(const StripeImage& image) {
    StoredImage stored{image.width, image.height, image.bit_depth, {}};
    const std::size_t row =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.bytes_per_pixel());
    stored.pixels.reserve(row * static_cast<std::size_t>(image.height));
    for (int y = 0; y < image.height; ++y) {
        const std::byte* from = image.pixels + static_cast<std::size_t>(y) * image.row_bytes;
        stored.pixels.insert(stored.pixels.end(), from, from + row);
    }
    return stored;
}

std::string utc_now() {
    const auto now = std::chrono::system_clock::now();
    const auto ms =
        std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()).count() % 1000;
    return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(now)),
                       ms);
}

std::optional<std::int64_t> utc_seconds(const std::string& utc) {
    const std::string_view text = utc;
    const auto number = [&](std::size_t at, std::size_t digits, int& value) {
        if (at + digits > text.size()) return false;
        const char *first = text.data() + at, *last = first + digits;
        return std::all_of(first, last, [](char c) { return c >= '0' && c <= '9'; }) &&
               std::from_chars(first, last, value).ptr == last;
    };
    const auto sign = [&](std::size_t at, char c) { return at < text.size() && text[at] == c; };
    int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
    if (!number(0, 4, year) || !sign(4, '-') || !number(5, 2, month) || !sign(7, '-') || !number(8, 2, day))
        return std::nullopt;
    const std::chrono::year_month_day date{std::chrono::year(year),
                                           std::chrono::month(static_cast<unsigned>(month)),
                                           std::chrono::day(static_cast<unsigned>(day))};
    if (!date.ok()) return std::nullopt;
    if (text.size() > 10) {
        if (!sign(10, 'T') || !number(11, 2, hour) || !sign(13, ':') || !number(14, 2, minute) ||
            !sign(16, ':') || !number(17, 2, second) || hour > 23 || minute > 59 || second > 60)
            return std::nullopt;
        std::size_t at = 19;
        if (sign(at, '.'))
            for (++at; at < text.size() && text[at] >= '0' && text[at] <= '9';) ++at;
        if (sign(at, 'Z')) ++at;
        if (at != text.size()) return std::nullopt;
    }
    const auto days = std::chrono::sys_days(date).time_since_epoch();
    return std::chrono::duration_cast<std::chrono::seconds>(days).count() + 3600 * hour + 60 * minute +
           second;
}

}  // namespace seamwright
