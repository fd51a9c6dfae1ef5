#pragma once
// `seamwright calibrate METHOD FILE.seam --live`.

#include <string>
#include <vector>

#include "app/cli/command.h"
#include "projects/calibrate/methods/method.h"

namespace seamwright::cli {

struct LiveCalibrationArguments {
    bool live = false, anew = false, use = false;
    std::string robot;
    std::vector<std::string> settings;  // NAME=VALUE
    int captures = 0, verification = 1;
    double patience_s = 300;
};

void add_live_options(CLI::App& command, const CalibrationMethod& method,
                      LiveCalibrationArguments& arguments);
Expected<Answer> calibrate_on_devices(const CalibrationMethod& method, const std::string& file,
                                      const std::string& sensor, const LiveCalibrationArguments& arguments);

}  // namespace seamwright::cli
