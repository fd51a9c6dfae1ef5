#include "devices/genicam/colour.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

namespace seamwright {
namespace {

// Red, green, blue of a pixel to the channel; ITU-R BT.601 for grey, as image files are read.
int one_value(const std::array<int, 3>& rgb, ImageChannel channel) {
    switch (channel) {
        case ImageChannel::red:
            return rgb[0];
        case ImageChannel::green:
            return rgb[1];
        case ImageChannel::blue:
            return rgb[2];
        case ImageChannel::red_difference:
            return std::max(0, rgb[0] - (rgb[1] + rgb[2]) / 2);
        case ImageChannel::grey:
            break;
    }
    return (299 * rgb[0] + 587 * rgb[1] + 114 * rgb[2] + 500) / 1000;
}

// Which colour a Bayer pixel has: "RG" names the first two of the first row, the second row is the other two.
int bayer_colour(std::string_view pattern, int x, int y) {
    const char first = pattern[static_cast<std::size_t>(x & 1)];
    if ((y & 1) == 0) return first == 'R' ? 0 : first == 'G' ? 1 : 2;
    const char above = pattern[static_cast<std::size_t>(x & 1)],
               beside = pattern[static_cast<std::size_t>(1 - (x & 1))];
    if (above != 'G') return 1;
    return beside == 'R' ? 2 : 0;  // below green stands what the first row lacks
}

}  // namespace

StripeImage unpack_colour(const PixelFormat& format, std::span<const std::byte> payload, int width,
                          int height, std::size_t row_padding, ImageChannel channel,
                          std::vector<std::byte>& pixels) {
    assert(!format.colour.empty() && (format.packing == Packing::bytes || format.packing == Packing::words));
    const std::size_t unit = format.bit_depth > 8 ? 2 : 1;
    const bool mosaic = format.colour.size() == 2;
    const std::size_t row_in = static_cast<std::size_t>(width) * unit * (mosaic ? 1 : 3) + row_padding;
    const std::size_t row_out = static_cast<std::size_t>(width) * unit;
    assert(payload.size() + row_padding >= row_in * static_cast<std::size_t>(height));
    if (pixels.size() < row_out * static_cast<std::size_t>(height))
        pixels.resize(row_out * static_cast<std::size_t>(height));
    const auto at = [&](int y, std::size_t component) {
        int value = 0;
        std::memcpy(&value, payload.data() + static_cast<std::size_t>(y) * row_in + component * unit, unit);
        return value;  // little-endian on both sides
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            std::array<int, 3> rgb{};
            if (mosaic) {
                std::array<int, 3> sum{}, count{};
                const int own = bayer_colour(format.colour, x, y);
                for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v)
                    for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
                        const auto c = static_cast<std::size_t>(bayer_colour(format.colour, u, v));
                        sum[c] += at(v, static_cast<std::size_t>(u));
                        ++count[c];
                    }
                for (std::size_t c = 0; c < 3; ++c) rgb[c] = count[c] ? sum[c] / count[c] : 0;
                rgb[static_cast<std::size_t>(own)] = at(y, static_cast<std::size_t>(x));
            } else {
                const auto first = 3 * static_cast<std::size_t>(x);
                rgb = {at(y, first), at(y, first + 1), at(y, first + 2)};
                if (format.colour == "BGR") std::swap(rgb[0], rgb[2]);
            }
            const int value = one_value(rgb, channel);
            std::memcpy(
                pixels.data() + static_cast<std::size_t>(y) * row_out + static_cast<std::size_t>(x) * unit,
                &value, unit);
        }
    return StripeImage{pixels.data(), width, height, row_out, format.bit_depth};
}

}  // namespace seamwright
