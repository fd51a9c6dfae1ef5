#pragma once
// `calibrate ... --report FILE.html`: residuals, coverage of the field of view, pose geometry, on one page.

#include <nlohmann/json.hpp>
#include <string>

namespace seamwright {

// `result` as in commands.h; `data` is what was solved. Pictures that the data cannot give are left out.
std::string calibration_report(const std::string& method, const nlohmann::json& data,
                               const nlohmann::json& result);

}  // namespace seamwright
