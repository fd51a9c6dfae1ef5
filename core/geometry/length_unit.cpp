#include "core/geometry/length_unit.h"

namespace seamwright {

std::optional<double> mm_of_unit(std::string_view unit) {
    if (unit == "mm") return 1;
    if (unit == "m") return 1000;
    if (unit == "um") return 1e-3;
    if (unit == "in") return 25.4;
    if (unit == "cm") return 10;
    if (unit == "nm") return 1e-6;
    if (unit == "mil") return 0.0254;
    return std::nullopt;
}

}  // namespace seamwright
