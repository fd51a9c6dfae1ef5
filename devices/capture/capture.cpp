#include "devices/capture/capture.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>

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

}  // namespace seamwright
