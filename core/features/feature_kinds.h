#pragma once
// The kinds of feature, one file each. feature_registry.cpp lists them; nothing else names them.

#include "core/features/feature.h"

namespace seamwright {

FeatureKind contour_end_kind();

}  // namespace seamwright
