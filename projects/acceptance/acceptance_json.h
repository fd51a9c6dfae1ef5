#pragma once
// The acceptance as JSON (the contract's fields) and as text. Lengths are millimetres; a pair [low, high] under
// "limits" is the 95 % confidence of the index of that name, "mean_chart" and "s_chart" of stability are control
// limits.

#include <nlohmann/json.hpp>
#include <string>

#include "projects/acceptance/studies.h"

namespace seamwright {

nlohmann::json acceptance_json(const Acceptance& acceptance);

}  // namespace seamwright
