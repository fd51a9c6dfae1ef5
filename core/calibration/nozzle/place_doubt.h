#pragma once
// Whether the touches contradict the given place of the target: it was knocked since it was measured (nozzle.h).

#include <optional>

#include "core/calibration/nozzle/wrong_touches.h"

namespace seamwright::nozzle {

struct OtherPlace {
    Eigen::Vector3d off_mm = Eigen::Vector3d::Zero();  // from the given place, base
    bool radius_as_well = false;                       // another radius explains the same touches as well
};

// The place by the touches alone, where it differs from the given beyond chance, or explains the touches that were left
// out (some or all) as well as leaving them out does; else nothing. `whole`: before any was left out.
std::optional<OtherPlace> other_place(const TouchSet& whole, const WrongTouches& found);

}  // namespace seamwright::nozzle
