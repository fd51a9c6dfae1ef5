#pragma once
// A plain checkerboard in a picture: lattices at several scales, their corners measured in the picture as
// taken, and which corner of the board each of them is. Private to core/calibration.
//
// A lattice is the board asked for where its corners, with those that the squares beyond promise, span exactly
// columns x rows, and the board is seen to end on every side (board_borders.h). Where it is not, another size
// would fit as well and the indices would be a guess.

#include <opencv2/core.hpp>

#include "core/calibration/board/board.h"

namespace seamwright::detail {

// `grey` 8 or 16 bit, single channel, `full_scale` the value of a saturated pixel.
BoardSearch find_checker(const cv::Mat& grey, double full_scale, const BoardSpec& spec);

}  // namespace seamwright::detail
