#include "devices/exchange/image_codecs.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>

namespace seamwright {
namespace {

struct Codecs {
    DecodeImage decode = nullptr;
    EncodeImage encode = nullptr;
    std::string missing;  // what the loader said
};

const Codecs& codecs() {
    static const Codecs loaded = [] {
        Codecs c;
        std::error_code none;
        const auto beside = std::filesystem::read_symlink("/proc/self/exe", none).parent_path() / kCodecsFile;
        // Read when OpenCV's codecs are loaded: a header that claims more is refused before memory is taken for it.
        ::setenv("OPENCV_IO_MAX_IMAGE_PIXELS", fmt::format_int(kMostImagePixels).c_str(), 1);
        void* const object = dlopen(beside.c_str(), RTLD_NOW | RTLD_LOCAL);
        if (object) {
            c.decode = reinterpret_cast<DecodeImage>(dlsym(object, kDecodeImage));
            c.encode = reinterpret_cast<EncodeImage>(dlsym(object, kEncodeImage));
        }
        if (!c.decode || !c.encode) {
            const char* said = dlerror();
            c.missing = said ? said : beside.string();
        }
        return c;
    }();
    return loaded;
}

tl::unexpected<Error> no_codecs(const Codecs& c) {
    return file_error("the codecs for images are missing", c.missing,
                      Text("put {} beside the program", kCodecsFile));
}

}  // namespace

Expected<cv::Mat> decode_image(const std::string& bytes) {
    const Codecs& c = codecs();
    if (!c.missing.empty()) return no_codecs(c);
    cv::Mat image;
    c.decode(bytes, image);
    return image;
}

Expected<std::vector<unsigned char>> encode_image(const std::filesystem::path& extension,
                                                  const cv::Mat& image) {
    const Codecs& c = codecs();
    if (!c.missing.empty()) return no_codecs(c);
    std::vector<unsigned char> bytes;
    if (!c.encode(extension.string(), image, bytes)) bytes.clear();
    return bytes;
}

}  // namespace seamwright
