#pragma once
// What becomes of colour, of a file's picture as of a camera's. OpenCV's types: only readers of images include this.

#include <opencv2/core/mat.hpp>

#include "devices/exchange/image_file.h"

namespace seamwright {

// BGR or BGRA of 8 or 16 bit to the one channel that is extracted, of the same depth.
cv::Mat one_channel(const cv::Mat& image, ImageChannel channel);

}  // namespace seamwright
