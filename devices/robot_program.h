#pragma once
// What a brand's generator makes of a project: the measuring program and the application frames, as files for
// the controller.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "devices/robot_link.h"

namespace seamwright {

struct ApplicationFrame {
    std::string region_id;
    std::string name;  // on the controller, as RobotLink::write_frame wants it
    Pose base_from_frame = Pose::Identity();
};

struct ProgramRequest {
    std::string project;
    std::vector<MeasuringMove> moves;  // in the order of measuring
    std::vector<ApplicationFrame> frames;
    nlohmann::json settings = nlohmann::json::object();  // of the project's robot: addresses, ports, numbers
};

struct ProgramFile {
    std::string name;  // without folder
    std::string text;
};

// Tells one measuring program from another: names, order and poses (to 0.001 mm and 0.0001 degree) of its
// spots, as "SW-" and 16 hexadecimal digits. The controller holds the one of its program and compares it at
// the start of measuring.
std::string program_signature(const std::vector<MeasuringMove>& moves);

}  // namespace seamwright
