#pragma once
// The middle value of a list: half of them may be anything without moving it far.

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>

namespace seamwright {

// The upper one of the two middle values of an even list; NaN of an empty one. Puts the values in another
// order and allocates nothing.
inline double median(std::span<double> values) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace seamwright
