#include "devices/genicam/pixels/colour.h"

#include <cassert>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "devices/exchange/image_channel.h"

namespace seamwright {
namespace {

// Mosaics by their first two pixels, as OpenCV names them.
int conversion_of(std::string_view pattern) {
    if (pattern == "RG") return cv::COLOR_BayerRGGB2BGR;
    if (pattern == "GR") return cv::COLOR_BayerGRBG2BGR;
    if (pattern == "GB") return cv::COLOR_BayerGBRG2BGR;
    return cv::COLOR_BayerBGGR2BGR;
}

}  // namespace

Expected<StripeImage> unpack_colour(const PixelFormat& format, std::span<const std::byte> payload, int width,
                                    int height, std::size_t row_padding, ImageChannel channel,
                                    std::vector<std::byte>& pixels) {
    assert(!format.colour.empty());
    assert(payload.size() + row_padding >= image_bytes(format, width, height, row_padding));
    const bool mosaic = format.colour.size() == 2;
    if (mosaic && (width < 3 || height < 3))
        return device_error(Text("an image of {} x {} pixels shows no colours", width, height),
                            std::string(format.name));
    const int depth = format.bit_depth > 8 ? CV_16U : CV_8U;
    cv::Mat values(height, width, CV_MAKETYPE(depth, mosaic ? 1 : 3));
    const auto of_row = static_cast<std::size_t>(width) * (mosaic ? 1 : 3);  // values
    const auto bits = static_cast<std::size_t>(format.bits_per_pixel());
    if (row_padding == 0) {
        unpack_pixels(format, payload, of_row * static_cast<std::size_t>(height),
                      reinterpret_cast<std::byte*>(values.data));
    } else {
        const std::size_t row = (static_cast<std::size_t>(width) * bits + 7) / 8;
        for (int y = 0; y < height; ++y)
            unpack_pixels(format, payload.subspan(static_cast<std::size_t>(y) * (row + row_padding), row),
                          of_row, reinterpret_cast<std::byte*>(values.ptr(y)));
    }
    cv::Mat bgr;
    if (mosaic)
        cv::demosaicing(values, bgr, conversion_of(format.colour));
    else if (format.colour == "RGB")
        cv::cvtColor(values, bgr, cv::COLOR_RGB2BGR);
    else
        bgr = values;
    const cv::Mat one = one_channel(bgr, channel);
    const std::size_t row_out = static_cast<std::size_t>(width) * one.elemSize();
    if (pixels.size() < row_out * static_cast<std::size_t>(height))
        pixels.resize(row_out * static_cast<std::size_t>(height));
    assert(one.isContinuous());
    std::memcpy(pixels.data(), one.data, row_out * static_cast<std::size_t>(height));
    return StripeImage{pixels.data(), width, height, row_out, format.bit_depth};
}

}  // namespace seamwright
