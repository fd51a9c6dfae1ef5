#include "devices/exchange/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "devices/exchange/files.h"

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

}  // namespace

Expected<void> read_image_file(const std::filesystem::path& path, Frame& frame, int bit_depth) {
    frame.image = {};
    if (bit_depth != 0 && bit_depth != 8 && bit_depth != 10 && bit_depth != 12 && bit_depth != 16) {
        return input_error(fmt::format("a bit depth of {} is not supported", bit_depth), path.string(),
                           "give 8, 10, 12 or 16");
    }
    const auto bytes = read_text_file(path, std::size_t{1} << 30);
    if (!bytes) return tl::unexpected(bytes.error());
    if (bytes->empty()) return file_error("the image file is empty", path.string());
    if (!is_known_format(*bytes))
        return file_error("is no readable image", path.string(), "give PNG, BMP, TIFF or PGM");
    // The JPEG decoder fills what is missing with grey, which would be measured; the others refuse by
    // themselves.
    if (bytes->starts_with("\xFF\xD8") && bytes->rfind("\xFF\xD9") == std::string::npos) {
        return file_error("the JPEG image is truncated", path.string());
    }
    cv::Mat image;
    try {
        const cv::Mat raw(1, static_cast<int>(bytes->size()), CV_8U, const_cast<char*>(bytes->data()));
        image = cv::imdecode(raw, cv::IMREAD_UNCHANGED | cv::IMREAD_IGNORE_ORIENTATION);
        if (image.empty())
            return file_error("is no readable image", path.string(), "give PNG, BMP, TIFF or PGM");
        if (image.depth() != CV_8U && image.depth() != CV_16U) {
            return file_error("the image has neither 8 nor 16 bit", path.string());
        }
        if (image.total() > (std::size_t{1} << 28))
            return file_error("the image is too large", path.string());
        if (image.channels() == 3) cv::cvtColor(image, image, cv::COLOR_BGR2GRAY);
        if (image.channels() == 4) cv::cvtColor(image, image, cv::COLOR_BGRA2GRAY);
        if (image.channels() != 1) return file_error("the image is neither grey nor colour", path.string());
        const bool wide = image.depth() == CV_16U;
        const int depth = bit_depth == 0 ? (wide ? 16 : 8) : bit_depth;
        if ((depth > 8) != wide) {
            return file_error(fmt::format("the image does not have {} bit", depth), path.string());
        }
        if (depth == 10 || depth == 12) {
            double largest = 0;
            cv::minMaxLoc(image, nullptr, &largest);
            if (largest >= (1 << depth)) {
                return file_error(fmt::format("the value {} does not fit {} bit", largest, depth),
                                  path.string());
            }
        }
        const std::size_t row = static_cast<std::size_t>(image.cols) * image.elemSize();
        frame.pixels.resize(row * static_cast<std::size_t>(image.rows));
        for (int r = 0; r < image.rows; ++r) {
            std::memcpy(frame.pixels.data() + row * static_cast<std::size_t>(r), image.ptr(r), row);
        }
        frame.image = {frame.pixels.data(), image.cols, image.rows, row, depth};
    } catch (const std::exception& e) {  // cv::Exception, bad_alloc of a header that lies about its size
        return file_error("is no readable image", path.string(), "give PNG, BMP, TIFF or PGM");
    }
    return {};
}

Expected<void> write_image_file(const std::filesystem::path& path, const StripeImage& image) {
    if (image.empty()) return input_error("there is no image to write", path.string());
    try {
        const cv::Mat view(image.height, image.width, image.bit_depth > 8 ? CV_16U : CV_8U,
                           const_cast<std::byte*>(image.pixels), image.row_bytes);
        std::vector<unsigned char> encoded;
        if (!cv::imencode(path.extension().string(), view, encoded, {cv::IMWRITE_PNG_COMPRESSION, 1})) {
            return file_error("the image cannot be encoded", path.string(), "name it .png, .tiff or .pgm");
        }
        return write_text_file(path, {reinterpret_cast<const char*>(encoded.data()), encoded.size()});
    } catch (const std::exception&) {
        return file_error("the image cannot be encoded", path.string(), "name it .png, .tiff or .pgm");
    }
}

}  // namespace seamwright
