#pragma once
// Saddle points strung to a lattice: from four that close a square, step by step along the edges between
// them, each next place predicted by the homography of the corners around it, so that neither tilt nor the
// bend of a lens is assumed. Private to core/calibration.

#include <Eigen/Core>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "core/calibration/board/board_saddles.h"

namespace seamwright::detail {

using LatticeCell = std::pair<int, int>;

// A corner at lattice place (i, j). i runs along +x, j along +y of a right-handed frame as seen in the image;
// the square whose lowest corner is (i, j) is bright where i + j is even.
struct LatticeCorner {
    Eigen::Vector2d at;
    int saddle = -1;  // which of the saddles; -1: measured by a fit alone
};
using SaddleLattice = std::map<LatticeCell, LatticeCorner>;

// Place and steps at a cell, by the homography (with few corners: the affinity) of those within two cells,
// itself left out.
struct LatticePlace {
    Eigen::Vector2d at, along_i, along_j;
    double least_step() const { return std::min(along_i.norm(), along_j.norm()); }
};
// nullopt: fewer than four corners around, or all on one line.
std::optional<LatticePlace> predict(const SaddleLattice& lattice, double i, double j, int reach = 2);

// Cells of the lattice's bounding box.
struct LatticeBox {
    int low_i = 0, high_i = -1, low_j = 0, high_j = -1;
    int columns() const { return high_i - low_i + 1; }
    int rows() const { return high_j - low_j + 1; }
};
LatticeBox box_of(const SaddleLattice& lattice);

// All lattices of at least `least` corners, the largest first. A saddle belongs to one of them at most.
std::vector<SaddleLattice> grow_lattices(const cv::Mat& soft, const std::vector<Saddle>& saddles,
                                         std::size_t least);

// Corners that those around them do not predict to `share` of the step are taken out.
void drop_misfits(SaddleLattice& lattice, double share);

}  // namespace seamwright::detail
