// What a camera sends: answers to discovery, images and range images of every format and of any length.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "devices/genicam/gvcp.h"
#include "devices/genicam/pixels/range_image.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace seamwright;
    const auto bytes = std::as_bytes(std::span(data, size));
    if (size >= 8) (void)parse_discovery_ack(bytes, static_cast<std::uint16_t>(data[6] << 8 | data[7]));
    if (size < 6) return 0;
    const auto& formats = pixel_formats();
    const PixelFormat& format = formats[data[0] % formats.size()];
    const int width = data[1] | (data[2] & 3) << 8, height = data[3];
    const std::size_t padding = data[4] % 8;
    const auto payload = bytes.subspan(6);
    std::vector<std::byte> pixels;
    if (const auto image = unpack_image(format, payload, width, height, padding, pixels)) {
        if (pixels.size() < image->row_bytes * static_cast<std::size_t>(image->height)) std::abort();
    }
    RangeMapping mapping;
    mapping.invalid = data[5];
    Profile profile;
    if (range_row(format, payload, width, height, data[5] % (height + 1), padding, mapping, profile)) {
        if (profile.x_mm.size() != static_cast<std::size_t>(width)) std::abort();
        for (const double z : profile.z_mm)
            if (std::isinf(z)) std::abort();
    }
    return 0;
}
