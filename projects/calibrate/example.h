#pragma once
// Data of every method as somebody writes them who starts: small, complete, noisy as real ones, solved with a
// good or usable verdict. Always the same.

#include <nlohmann/json.hpp>
#include <string_view>

#include "core/error.h"

namespace seamwright {

// What `seamwright calibrate METHOD` takes. Error (usage): no such method.
Expected<nlohmann::json> calibration_example(std::string_view method);

// The layout in a few lines, for --help; empty for an unknown method.
std::string_view calibration_layout(std::string_view method);

}  // namespace seamwright
