#pragma once
// Which touches slipped: those whose absence explains the misfit beyond chance (nozzle.h).

#include <vector>

#include "core/calibration/nozzle/touch_fit.h"

namespace seamwright::nozzle {

struct WrongTouches {
    TouchSet set;                     // of the rest
    TouchFit fit;                     // of the rest
    std::vector<std::size_t> kept;    // indices of the rest
    std::vector<std::size_t> wrong;   // left out
    std::vector<std::size_t> either;  // one of these slipped, and nothing tells which
};

// `most`: of wrong ones that are looked for, at most a quarter of the touches.
WrongTouches without_wrong_touches(const TouchSet& all, std::size_t most);

}  // namespace seamwright::nozzle
