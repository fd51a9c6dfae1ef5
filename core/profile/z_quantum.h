#pragma once
// The step in which a sensor tells its heights.

#include <span>

namespace seamwright {

// What the z of a contour are multiples of beside a constant, mm; 0: of nothing that can be told. `x`, `z` finite, in contour
// order.
//
// The step of which nearly all steps between neighbours are multiples, not wider than four pitches, where the contour
// bends by it again and again: a drawn one whose corners lie on a grid does so at its corners only. Where most neighbours
// stand at exactly one height, which noise would not let them, a single step of up to two pitches says it. Rounding to a
// quantum q adds q^2 / 12 to the variance of a point, which differences of neighbours do not show as long as they are
// rounded alike.
double z_quantum_mm(std::span<const double> x, std::span<const double> z);

// The same for an error that all points of a level sheet share: where they stand at exactly one height and no step says the
// quantum, their digits do. The coarsest of 1, 2 and 5 times a power of ten that the heights are multiples of, up to two
// pitches.
double z_rounding_mm(std::span<const double> x, std::span<const double> z);

}  // namespace seamwright
