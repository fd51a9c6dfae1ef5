#pragma once
// The registry: adding a kind is one file and one line in feature_registry.cpp.

#include "core/features/feature.h"

namespace seamwright {

const std::vector<FeatureKind>& feature_kinds();
const FeatureKind* feature_kind(std::string_view name);  // nullptr when unknown

// Validates the recipe against its kind, then prepares it.
Expected<std::unique_ptr<FeatureFinder>> make_feature_finder(const FeatureRecipe& recipe);

}  // namespace seamwright
