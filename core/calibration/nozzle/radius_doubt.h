#pragma once
// Whether the touches contradict the given distance of tip and centre, the sphere's radius and that of the tip's ball
// (nozzle.h).

#include <optional>

#include "core/calibration/nozzle/touch_fit.h"

namespace seamwright::nozzle {

// The distance by the touches alone, mm, where it differs from the given beyond chance, and beyond the spread that is
// assumed where none is stated; else nothing. `fit`: of the set as given.
std::optional<double> other_radius(const TouchSet& set, const TouchFit& fit);

}  // namespace seamwright::nozzle
