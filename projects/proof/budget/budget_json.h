#pragma once
// The budget as JSON. "u" and its like are mm or degree as the measurand's "unit" says; infinite degrees of freedom
// are null; "input_unit" is "mm" or "1" (scale, shear, speed); "limits" are the 95 % limits of Monte Carlo; "mend" is what
// would help most across the bead, [{"source","what","share_percent","u_without"}], the largest first.

#include <nlohmann/json.hpp>

#include "projects/proof/budget.h"

namespace seamwright {

nlohmann::json budget_json(const RegionBudget& budget);

}  // namespace seamwright
