#pragma once
// The step in which a sensor tells its heights.

#include <span>

namespace seamwright {

// What the z of a contour are multiples of beside a constant, mm; 0: of nothing that can be told. `x`, `z` finite, in contour
// order.
//
// The least step between neighbours of which nearly all others are multiples, not wider than the pitch, where the contour
// bends by it again and again: a drawn one whose corners lie on a grid does so at its corners only. Rounding to a quantum q
// adds q^2 / 12 to the variance of a point, which differences of neighbours do not show as long as they are rounded alike.
double z_quantum_mm(std::span<const double> x, std::span<const double> z);

}  // namespace seamwright
