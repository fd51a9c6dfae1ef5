#pragma once
// The detectors behind find_board for circle grids and boards with markers, on OpenCV images. Private to core/calibration/board.

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "core/calibration/board/board.h"

namespace seamwright::detail {

// 8-bit copy of any depth.
cv::Mat grey_of(const StripeImage& image);
// 255 where a long thin piece is saturated: the laser stripe.
cv::Mat stripe_mask(const cv::Mat& grey);
// The stripe painted over with its surroundings.
cv::Mat without_stripe(const cv::Mat& grey, const cv::Mat& stripe);
// Contrast stretched between quantiles of the pixels outside `ignore`, then value^gamma.
cv::Mat stretched(const cv::Mat& grey, const cv::Mat& ignore, double gamma);

// The picture as dots and markers are looked for in it: as it is, or where it is large reduced to a side of 1600 px, then
// of 3200. A pixel p of one of them lies at (p + 1/2) s - 1/2 of the picture, s the ratio of their widths.
std::vector<cv::Mat> reduced(const cv::Mat& grey);

std::optional<FoundBoard> find_circles(const cv::Mat& grey, const BoardSpec& spec);
// ChArUco and AprilGrid: OpenCV reads the markers of `grey` (8 bit), which predict where the corners are; these are measured in
// `full`, the picture as taken (8 or 16 bit), as those of a chessboard are (board_saddles.h).
std::optional<FoundBoard> find_marker_board(const cv::Mat& full, const cv::Mat& grey, const BoardSpec& spec);

}  // namespace seamwright::detail
