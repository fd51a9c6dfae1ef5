#pragma once
// Units of length that profiles and poses come in.

#include <optional>
#include <string_view>

namespace seamwright {

inline constexpr const char* kLengthUnits[] = {"mm", "m", "um", "in"};
// And those that files come in.
inline constexpr const char* kFileUnits[] = {"mm", "cm", "m", "um", "nm", "in", "mil"};
// Millimetres of one unit of either list. nullopt: none of them.
std::optional<double> mm_of_unit(std::string_view unit);

}  // namespace seamwright
