#include "devices/exchange/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/profile/stripe/peaks.h"
#include "devices/exchange/files.h"
#include "devices/exchange/image_channel.h"
#include "devices/exchange/image_codecs.h"

#if defined(__SANITIZE_THREAD__)
// GDAL, which OpenCV registers among its codecs, takes its own locks in both orders while it starts.
extern "C" const char* __tsan_default_suppressions() {
    return "deadlock:libgdal.so";
}
#endif

namespace seamwright {
namespace {

// By content. What is none of these would be handed by OpenCV to GDAL, which opens far more than images.
bool is_known_format(const std::string& bytes) {
    for (const char* start :
         {"\x89PNG\r\n", "BM", "P1", "P2", "P3", "P4", "P5", "P6", "\xFF\xD8\xFF", "MM"}) {
        if (bytes.starts_with(start)) return true;
    }
    return bytes.starts_with("II*");  // TIFF, little-endian
}

constexpr double kMosaicShare = 0.12;

constexpr std::pair<ImageChannel, std::string_view> kChannels[] = {
    {ImageChannel::grey, "grey"},
    {ImageChannel::red, "red"},
    {ImageChannel::green, "green"},
    {ImageChannel::blue, "blue"},
    {ImageChannel::red_difference, "red-difference"}};

struct LineShown {
    double share = 0;   // of the lines whose strongest peak goes on from the line before
    double height = 0;  // the middle peak over the picture's bright rest
};
LineShown line_shown(const StripeImage& image) {
    LineShown shown;
    PeakOptions options;
    options.per_line = 1;
    const auto scan = guess_scan_lines(image);
    if (!scan) return shown;
    options.scan = *scan;
    StripePeaks peaks;
    if (!find_peaks(image, options, peaks)) return shown;
    std::vector<float> heights;
    for (int line = 1; line < peaks.lines; ++line) {
        if (!peaks.count[static_cast<std::size_t>(line)] || !peaks.count[static_cast<std::size_t>(line - 1)])
            continue;
        const auto at = static_cast<std::size_t>(line);
        if (std::abs(peaks.position_px[at] - peaks.position_px[at - 1]) > 3) continue;
        heights.push_back(peaks.intensity[at]);
    }
    if (heights.empty()) return shown;
    shown.share = static_cast<double>(heights.size()) / std::max(1, peaks.lines - 1);
    const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
    std::nth_element(heights.begin(), middle, heights.end());
    std::vector<int> greys;
    for (int r = 0; r < image.height; r += 4)
        for (int c = 0; c < image.width; c += 4) {
            const std::byte* at = image.pixels + static_cast<std::size_t>(r) * image.row_bytes +
                                  static_cast<std::size_t>(c * image.bytes_per_pixel());
            int value = std::to_integer<int>(at[0]);
            if (image.bytes_per_pixel() == 2) value |= std::to_integer<int>(at[1]) << 8;
            greys.push_back(value);
        }
    const auto bright = greys.begin() + static_cast<std::ptrdiff_t>(greys.size() * 9 / 10);
    std::nth_element(greys.begin(), bright, greys.end());
    shown.height = *middle / (*bright + 0.02 * image.full_scale());
    return shown;
}

}  // namespace

std::string_view to_string(ImageChannel channel) {
    for (const auto& [known, word] : kChannels)
        if (known == channel) return word;
    return "grey";
}
std::optional<ImageChannel> image_channel(std::string_view word) {
    for (const auto& [channel, known] : kChannels)
        if (known == word) return channel;
    return std::nullopt;
}

bool is_colour_mosaic(const StripeImage& image) {
    const int type = image.bytes_per_pixel() == 2 ? CV_16U : CV_8U;
    const cv::Size even(image.width / 2 * 2, image.height / 2 * 2);
    if (image.empty() || even.area() == 0) return false;
    const cv::Mat pixels(even, type, const_cast<std::byte*>(image.pixels), image.row_bytes);
    cv::Mat grey;
    pixels.convertTo(grey, CV_32F);
    double together = 0, range = 0;
    std::vector<float> above(static_cast<std::size_t>(even.width / 2), 0.0F);
    for (int r = 0; r < even.height; r += 2) {
        const float* upper = grey.ptr<float>(r);
        const float* lower = grey.ptr<float>(r + 1);
        float left = 0;
        for (int c = 0; c < even.width; c += 2) {
            const auto [least, most] = std::minmax({upper[c], upper[c + 1], lower[c], lower[c + 1]});
            const float m = upper[c] - upper[c + 1] - lower[c] + lower[c + 1];
            float& over = above[static_cast<std::size_t>(c / 2)];
            together += 0.5 * m * (left + over);
            range += static_cast<double>(most - least) * (most - least);
            left = over = m;
        }
    }
    return together > kMosaicShare * range;
}

Text mosaic_warning() {
    return "raw picture of a colour camera: neighbouring pixels see other colours, and the stripe jumps "
           "between them; give "
           "pictures in colour";
}

Expected<ChannelChoice> choose_channel(const std::filesystem::path& path, int bit_depth) {
    ChannelChoice choice;
    Frame grey, frame;
    SEAM_OK(read_image_file(path, grey, bit_depth));
    SEAM_TRY(const auto bytes, read_text_file(path, std::size_t{1} << 30));
    int channels = 1;
    try {
        SEAM_TRY(const cv::Mat stored, decode_image(bytes));
        channels = stored.channels();
    } catch (const std::exception&) {
        return file_error("is no readable image", path.string(), "give PNG, BMP, TIFF or PGM");
    }
    choice.mosaic = channels == 1 && is_colour_mosaic(grey.image);
    for (const ImageChannel channel : {ImageChannel::red, ImageChannel::green, ImageChannel::blue}) {
        if (channels == 1) break;
        SEAM_OK(read_image_file(path, frame, bit_depth, channel));
        choice.colour = choice.colour || frame.pixels != grey.pixels;
    }
    double best = -1;
    for (const auto& [channel, word] : kChannels) {
        const bool is_grey = channel == ImageChannel::grey;
        if (!is_grey && !choice.colour) break;
        if (!is_grey) SEAM_OK(read_image_file(path, frame, bit_depth, channel));
        const LineShown shown = line_shown(is_grey ? grey.image : frame.image);
        // A line that stands four times above the rest stands out; more is no better.
        const double score = shown.share * std::min(shown.height, 4.0);
        if (is_grey) choice.share_grey = shown.share;
        if (score <= best * 1.02) continue;  // as good: the earlier one
        best = score;
        choice.channel = channel;
        choice.share = shown.share;
    }
    return choice;
}

Expected<void> subtract_image(Frame& on, const Frame& off) {
    const StripeImage& a = on.image;
    const StripeImage& b = off.image;
    if (a.width != b.width || a.height != b.height || a.bit_depth != b.bit_depth || a.empty())
        return input_error(Text("{} x {} of {} bit and {} x {} of {} bit are no pair", a.width, a.height,
                                a.bit_depth, b.width, b.height, b.bit_depth));
    const int type = a.bit_depth > 8 ? CV_16U : CV_8U;
    cv::Mat lit(a.height, a.width, type, on.pixels.data(), a.row_bytes);
    const cv::Mat dark(b.height, b.width, type, const_cast<std::byte*>(b.pixels), b.row_bytes);
    cv::subtract(lit, dark, lit);
    return {};
}

Expected<void> read_image_file(const std::filesystem::path& path, Frame& frame, int bit_depth,
                               ImageChannel channel) {
    frame.image = {};
    if (bit_depth != 0 && bit_depth != 8 && bit_depth != 10 && bit_depth != 12 && bit_depth != 16) {
        return input_error(Text("a bit depth of {} is not supported", bit_depth), path.string(),
                           "give 8, 10, 12 or 16");
    }
    SEAM_TRY(const auto bytes, read_text_file(path, std::size_t{1} << 30));
    if (bytes.empty()) return file_error("the image file is empty", path.string());
    if (!is_known_format(bytes))
        return file_error("is no readable image", path.string(), "give PNG, BMP, TIFF or PGM");
    // The JPEG decoder fills what is missing with grey, which would be measured; the others refuse by
    // themselves.
    if (bytes.starts_with("\xFF\xD8") && bytes.rfind("\xFF\xD9") == std::string::npos) {
        return file_error("the JPEG image is truncated", path.string());
    }
    cv::Mat image;
    try {
        SEAM_TRY(image, decode_image(bytes));
        if (image.empty())
            return file_error("is no readable image", path.string(), "give PNG, BMP, TIFF or PGM");
        if (image.depth() != CV_8U && image.depth() != CV_16U) {
            return file_error("the image has neither 8 nor 16 bit", path.string());
        }
        if (image.channels() == 3 || image.channels() == 4) image = one_channel(image, channel);
        if (image.channels() != 1) return file_error("the image is neither grey nor colour", path.string());
        const bool wide = image.depth() == CV_16U;
        const int depth = bit_depth == 0 ? (wide ? 16 : 8) : bit_depth;
        if ((depth > 8) != wide) {
            return file_error(Text("the image does not have {} bit", depth), path.string());
        }
        if (depth == 10 || depth == 12) {
            double largest = 0;
            cv::minMaxLoc(image, nullptr, &largest);
            if (largest >= (1 << depth)) {
                return file_error(Text("the value {} does not fit {} bit", largest, depth), path.string());
            }
        }
        const std::size_t row = static_cast<std::size_t>(image.cols) * image.elemSize();
        frame.pixels.resize(row * static_cast<std::size_t>(image.rows));
        for (int r = 0; r < image.rows; ++r) {
            std::memcpy(frame.pixels.data() + row * static_cast<std::size_t>(r), image.ptr(r), row);
        }
        frame.image = {frame.pixels.data(), image.cols, image.rows, row, depth};
    } catch (const std::exception& e) {  // cv::Exception, bad_alloc of a header that lies about its size
        return file_error(
            Text("is no readable image, or one of more than {} million pixels", kMostImagePixels >> 20),
            path.string(), "give PNG, BMP, TIFF or PGM");
    }
    return {};
}

Expected<void> write_image_file(const std::filesystem::path& path, const StripeImage& image) {
    if (image.empty()) return input_error("there is no image to write", path.string());
    try {
        const cv::Mat view(image.height, image.width, image.bit_depth > 8 ? CV_16U : CV_8U,
                           const_cast<std::byte*>(image.pixels), image.row_bytes);
        SEAM_TRY(const auto encoded, encode_image(path.extension(), view));
        if (encoded.empty()) {
            return file_error("the image cannot be encoded", path.string(), "name it .png, .tiff or .pgm");
        }
        return write_text_file(path, {reinterpret_cast<const char*>(encoded.data()), encoded.size()});
    } catch (const std::exception&) {
        return file_error("the image cannot be encoded", path.string(), "name it .png, .tiff or .pgm");
    }
}

}  // namespace seamwright
