#include "devices/exchange/image_codecs.h"

#include <fmt/format.h>

#include <cstdlib>

#include "core/loaded_object.h"

namespace seamwright {
namespace {

template <class Function>
Expected<Function*> codec(const char* name) {
    // Read when OpenCV's codecs are loaded: a header that claims more is refused before memory is taken for it.
    static const int set =
        ::setenv("OPENCV_IO_MAX_IMAGE_PIXELS", fmt::format_int(kMostImagePixels).c_str(), 1);
    (void)set;
    return loaded_function<Function>("seamwright_codecs.so", name);
}

}  // namespace

Expected<cv::Mat> decode_image(const std::string& bytes) {
    static const auto decode = codec<decltype(seamwright_decode_image)>("seamwright_decode_image");
    if (!decode) return tl::unexpected(decode.error());
    cv::Mat image;
    (*decode)(bytes, image);
    return image;
}

Expected<std::vector<unsigned char>> encode_image(const std::filesystem::path& extension,
                                                  const cv::Mat& image) {
    static const auto encode = codec<decltype(seamwright_encode_image)>("seamwright_encode_image");
    if (!encode) return tl::unexpected(encode.error());
    std::vector<unsigned char> bytes;
    if (!(*encode)(extension.string(), image, bytes)) bytes.clear();
    return bytes;
}

}  // namespace seamwright
