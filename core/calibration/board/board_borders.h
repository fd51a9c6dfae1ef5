#pragma once
// Where a checkerboard ends around a lattice of its corners, by the colours of the squares beyond. Private to
// core/calibration/board.

#include <array>
#include <opencv2/core.hpp>

#include "core/calibration/board/board_lattice.h"

namespace seamwright::detail {

// What lies beyond one side of a lattice.
struct Border {
    int more = 0;        // rows of corners that the squares promise beyond the lattice's own
    bool ended = false;  // behind those the board is seen to end
    bool cut = false;    // the picture ends before the next row of corners would come
};

// The sides +i, -i, +j, -j. `soft`: the searched picture (softened_root()), in whose coordinates the lattice
// is.
std::array<Border, 4> borders_of(const cv::Mat& soft, const SaddleLattice& lattice);

// Takes off what the board's frame or a texture has put beyond it: a corner or two where a whole row would be
// seen. Whether there was any.
bool trim(const cv::Mat& soft, SaddleLattice& lattice);

// Whether the squares inside have the colours of a checkerboard.
bool coloured(const cv::Mat& soft, const SaddleLattice& lattice);

}  // namespace seamwright::detail
