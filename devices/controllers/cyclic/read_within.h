#pragma once
// Numbers of a simulated cyclic controller's settings, all within the same limits.

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <utility>

#include "devices/exchange/json_fields.h"

namespace seamwright {

// Into the targets, which keep what they hold where the settings say nothing. Error (input): the key that is no number or
// beyond the limits.
template <class Number>
Expected<void> read_within(const nlohmann::json& settings, double least, double most,
                           std::initializer_list<std::pair<const char*, Number*>> fields) {
    for (const auto& [key, value] : fields) {
        SEAM_TRY(const auto number, json_number_or(settings, key, *value, ""));
        if (!(number >= least && number <= most))
            return input_error(Text("not within {} and {}", least, most), key);
        *value = static_cast<Number>(number);
    }
    return {};
}

}  // namespace seamwright
