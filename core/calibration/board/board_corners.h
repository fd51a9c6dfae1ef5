#pragma once
// The corners of a lattice measured, and those that the search did not see looked for. Private to
// core/calibration/board.

#include <opencv2/core.hpp>

#include "core/calibration/board/board_lattice.h"

namespace seamwright::detail {

// In the searched picture: every corner measured; those that are not what they seemed go, and those that the
// search did not see are looked for where the others say, a row beyond the lattice too. Answers the blur of
// the edges (px of `small`).
double measure_corners(const cv::Mat& small, SaddleLattice& lattice);

// In the picture as taken, `factor` times larger than what was searched, in whose coordinates the lattice comes;
// it leaves in those of `grey`. Windows as large as the squares let; a lens bends the edges, and how much the
// neighbours say. A corner that something else pulls (a stripe, a glint) goes.
void refine_corners(const cv::Mat& grey, double factor, double blur_px, SaddleLattice& lattice);

}  // namespace seamwright::detail
