#pragma once
// The kinds of feature, one file each. feature_registry.cpp lists them; nothing else names them.

#include "core/features/feature.h"
#include "core/features/registration/registration.h"

namespace seamwright {

FeatureKind circle_kind();
FeatureKind contour_end_kind();
FeatureKind corner_kind();
FeatureKind extremum_kind();
FeatureKind sensor_point_kind();
FeatureKind template_kind();
SearchWindow template_window(const ParameterValues& values);

}  // namespace seamwright
