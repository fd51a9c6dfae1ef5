#pragma once
// What a spot's recipe finds in its own reference profile: what forecasts, budgets and corrections know of the reference's
// noise before anything is measured.

#include <optional>

#include "core/features/feature.h"
#include "projects/model/project.h"

namespace seamwright {

// nullopt where the spot has no reference profile, or its recipe finds nothing sure in it. The same recipe in the same
// profile has the same answer, bit for bit: the last ones are remembered, because every edit at the desk and every part
// of a production asks for those of all spots. Any thread may ask.
std::optional<Feature> feature_at_reference(const Spot& spot);

// The points of the reference profile that the feature rests on (Feature::points_used); 0 where it finds none.
int points_at_reference(const Spot& spot);

// How far the reference lies beside the point that the spot's feature has in the profile kept with it, along the axes that
// count; 0 within what robot and feature scatter, and where the profile does not show the feature.
double reference_beside_mm(const Project& project, const Spot& spot);

}  // namespace seamwright
