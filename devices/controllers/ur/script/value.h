#pragma once
// What a variable of URScript holds. Lists are values: assigning one copies it.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace seamwright::urscript {

using PoseValue = std::array<double, 6>;  // p[x, y, z, rx, ry, rz], metres and rotation vector
struct ThreadHandle {
    int id = 0;
    bool operator==(const ThreadHandle&) const = default;
};
struct Value {
    // No value, the first, is what a function without `return` leaves.
    std::variant<std::monostate, bool, std::int32_t, double, std::string, PoseValue, std::vector<Value>,
                 ThreadHandle>
        is;
    bool operator==(const Value&) const = default;
};
using ListValue = std::vector<Value>;

std::string_view type_name(const Value& value);
std::string text_of(const Value& value);  // as to_str() writes it

}  // namespace seamwright::urscript
