#pragma once
// `calibrate ... --report FILE.html`: residuals, coverage of the field of view, pose geometry, on one page.

#include <string>

#include "projects/calibrate/methods/method.h"

namespace seamwright {

// `data` is what was solved. Pictures that the data cannot give are left out.
std::string calibration_report(const CalibrationMethod& method, const nlohmann::json& data,
                               const CalibrationSolution& solution);

}  // namespace seamwright
