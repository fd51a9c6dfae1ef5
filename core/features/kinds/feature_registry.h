#pragma once
// The registry: adding a kind is one file and one line in feature_registry.cpp.

#include "core/features/feature.h"
#include "core/features/registration/registration.h"

namespace seamwright {

const std::vector<FeatureKind>& feature_kinds();
const FeatureKind* feature_kind(std::string_view name);  // nullptr when unknown

// Validates the recipe against its kind, then prepares it.
Expected<std::unique_ptr<FeatureFinder>> make_feature_finder(const FeatureRecipe& recipe);

// How far from its taught place the contour may stand: the template's own window; of other kinds, which have none, 20 mm
// and 15 degrees.
SearchWindow search_window(const FeatureRecipe& recipe);

}  // namespace seamwright
