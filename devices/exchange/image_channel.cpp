#include "devices/exchange/image_channel.h"

#include <opencv2/imgproc.hpp>
#include <vector>

namespace seamwright {

cv::Mat one_channel(const cv::Mat& image, ImageChannel channel) {
    cv::Mat result;
    if (channel == ImageChannel::grey) {
        cv::cvtColor(image, result, image.channels() == 3 ? cv::COLOR_BGR2GRAY : cv::COLOR_BGRA2GRAY);
        return result;
    }
    if (channel != ImageChannel::red_difference) {
        cv::extractChannel(image, result,
                           channel == ImageChannel::blue    ? 0
                           : channel == ImageChannel::green ? 1
                                                            : 2);
        return result;
    }
    std::vector<cv::Mat> bgr;
    cv::split(image, bgr);
    cv::addWeighted(bgr[0], 0.5, bgr[1], 0.5, 0, result);
    cv::subtract(bgr[2], result, result);
    return result;
}

}  // namespace seamwright
