#pragma once
// What a bundle that does not fit would fit with. Inner part of bundle.h.

#include "core/calibration/bundle/bundle.h"

namespace seamwright::bundle {

// As locate_object(), but for the words of other_unit().
Expected<BundleResult> locate_as_given(const std::vector<PlacedCamera>& cameras,
                                       const std::vector<BundleSight>& sights, const BundleOptions& options);

// The unit in which object or cameras fit, as a cure; empty: in none.
Text other_unit(const std::vector<PlacedCamera>& cameras, const std::vector<BundleSight>& sights,
                const BundleOptions& options);

}  // namespace seamwright::bundle
