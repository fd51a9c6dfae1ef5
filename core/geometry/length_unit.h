#pragma once
// Units of length that profiles and poses come in.

#include <optional>
#include <string_view>

namespace seamwright {

inline constexpr const char* kLengthUnits[] = {"mm", "m", "um", "in"};
// Millimetres of one unit. nullopt: none of them.
std::optional<double> mm_of_unit(std::string_view unit);

}  // namespace seamwright
