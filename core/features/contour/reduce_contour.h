#pragma once
// A contour as a polygon of few points (methods.md 2; thesis 3.2).

#include <span>
#include <vector>

namespace seamwright {

// (3.21): indices of the polygon that stays within `tolerance_mm` of every point. First and last are kept.
void reduce_contour(std::span<const double> x_mm, std::span<const double> z_mm, double tolerance_mm,
                    std::vector<int>& kept);

}  // namespace seamwright
