#pragma once
// Settings of a feature kind as typed on the command line: numbers, or choices by name.

#include <string>
#include <utility>

#include "core/features/feature.h"

namespace seamwright::cli {

// A parameter's value from text: a number or one of its choices. Error (usage): neither.
Expected<double> setting_value(const ParameterInfo& info, const std::string& text);

// The parameter's value from text ("12.5", "right"). Error (usage): not a setting of this kind, not a number
// or choice.
Expected<double> feature_setting(const FeatureKind& kind, const std::string& name, const std::string& text);

// "side=right" -> {"side", 1}.
Expected<std::pair<std::string, double>> feature_setting(const FeatureKind& kind,
                                                         const std::string& assignment);

// nullptr never: an unknown kind is an Error that lists the known ones.
Expected<const FeatureKind*> find_feature_kind(const std::string& name);

}  // namespace seamwright::cli
