// What image_codecs.h loads.
#include <opencv2/imgcodecs.hpp>

#include "devices/exchange/image_codecs.h"

namespace seamwright {

void seamwright_decode_image(const std::string& bytes, cv::Mat& image) {
    const cv::Mat raw(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
    image = cv::imdecode(raw, cv::IMREAD_UNCHANGED | cv::IMREAD_IGNORE_ORIENTATION);
}

bool seamwright_encode_image(const std::string& extension, const cv::Mat& image,
                             std::vector<unsigned char>& bytes) {
    // Of PNG: the quickest level, which a stripe on black suits as well as the others.
    return cv::imencode(extension, image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
}

}  // namespace seamwright
