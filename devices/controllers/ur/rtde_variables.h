#pragma once
// What a controller tells and takes by RTDE, by the names of Universal Robots' RTDE guide.

#include <functional>
#include <map>
#include <string>

#include "devices/controllers/ur/script/kinematics.h"
#include "devices/controllers/ur/script/robot.h"
#include "devices/ur/rtde_message.h"

namespace seamwright::urscript {

// Of one controller cycle.
struct ControllerState {
    std::uint64_t cycle = 0;
    double timestamp_s = 0;  // since the controller's start
    double cycle_s = 0.002;
    Registers inputs, outputs;
    PoseValue tcp_pose{}, target_pose{}, tcp_offset{};
    std::array<double, 6> tcp_speed{};
    Joints joints{};
    std::int32_t robot_mode = 7, safety_mode = 1;
    std::uint32_t runtime = 1;
    std::uint64_t digital_in = 0, digital_out = 0, configurable_out = 0;
    std::array<double, 2> analog_out{};
    std::uint32_t analog_types = 0;
    double speed_slider = 1, speed_scaling = 1;
    bool tells_tcp_offset = true;
};

struct OutputVariable {
    rtde::Kind kind;
    std::function<rtde::Value(const ControllerState&)> value;
};
const std::map<std::string, OutputVariable, std::less<>>& output_variables();

// What a client writes, kept until the next cycle takes it as a whole.
struct ControllerInputs {
    Registers registers;
    std::uint8_t digital_mask = 0, digital = 0, configurable_mask = 0, configurable = 0, analog_mask = 0,
                 analog_type = 0;
    std::array<double, 2> analog{};
    std::uint32_t slider_mask = 0;
    double slider = 1;
    std::array<double, 6> force{};
};
struct InputVariable {
    rtde::Kind kind;
    std::function<void(ControllerInputs&, const rtde::Value&)> take;
};
const std::map<std::string, InputVariable, std::less<>>& input_variables();

}  // namespace seamwright::urscript
