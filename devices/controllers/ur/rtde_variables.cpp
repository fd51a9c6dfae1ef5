#include "devices/controllers/ur/rtde_variables.h"

#include <fmt/format.h>

namespace seamwright::urscript {
namespace {

using State = ControllerState;
using Six = std::array<double, 6>;

std::uint32_t word_of(const std::array<bool, 128>& bits, std::size_t first) {
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < 32; ++i) word |= static_cast<std::uint32_t>(bits[first + i]) << i;
    return word;
}
void set_word(std::array<bool, 128>& bits, std::size_t first, std::uint32_t word) {
    for (std::size_t i = 0; i < 32; ++i) bits[first + i] = (word >> i & 1U) != 0;
}

using Outputs = std::map<std::string, OutputVariable, std::less<>>;

void add_registers(Outputs& all, const std::string& way, const Registers State::*bank) {
    for (std::size_t i = 0; i < 48; ++i) {
        all[fmt::format("{}_int_register_{}", way, i)] = {
            rtde::Kind::int32, [=](const State& s) { return rtde::Value{(s.*bank).ints[i]}; }};
        all[fmt::format("{}_double_register_{}", way, i)] = {
            rtde::Kind::real, [=](const State& s) { return rtde::Value{(s.*bank).reals[i]}; }};
    }
    for (std::size_t i = 64; i < 128; ++i)
        all[fmt::format("{}_bit_register_{}", way, i)] = {
            rtde::Kind::boolean,
            [=](const State& s) { return rtde::Value{static_cast<bool>((s.*bank).bits[i])}; }};
    for (const std::size_t first : {std::size_t{0}, std::size_t{32}})
        all[fmt::format("{}_bit_registers{}_to_{}", way, first, first + 31)] = {
            rtde::Kind::uint32, [=](const State& s) { return rtde::Value{word_of((s.*bank).bits, first)}; }};
}

Outputs make_outputs() {
    Outputs all;
    const auto add = [&](const char* name, rtde::Kind kind, std::function<rtde::Value(const State&)> value) {
        all[name] = {kind, std::move(value)};
    };
    const auto real = [&](const char* name, double v) {
        add(name, rtde::Kind::real, [v](const State&) { return rtde::Value{v}; });
    };
    const auto six = [&](const char* name, double v) {
        add(name, rtde::Kind::vector6, [v](const State&) { return rtde::Value{Six{v, v, v, v, v, v}}; });
    };
    add("timestamp", rtde::Kind::real, [](const State& s) { return rtde::Value{s.timestamp_s}; });
    for (const char* name : {"target_q", "actual_q"})
        add(name, rtde::Kind::vector6, [](const State& s) { return rtde::Value{s.joints}; });
    // The simulated robot has no masses and follows what it is told.
    for (const char* name :
         {"target_qd", "target_qdd", "target_current", "target_moment", "actual_qd", "actual_current",
          "actual_current_as_torque", "joint_control_output", "actual_TCP_force", "ft_raw_wrench"})
        six(name, 0);
    six("actual_current_window", 10);
    six("joint_temperatures", 30);
    six("actual_joint_voltage", 48);
    add("actual_TCP_pose", rtde::Kind::vector6, [](const State& s) { return rtde::Value{s.tcp_pose}; });
    add("target_TCP_pose", rtde::Kind::vector6, [](const State& s) { return rtde::Value{s.target_pose}; });
    for (const char* name : {"actual_TCP_speed", "target_TCP_speed"})
        add(name, rtde::Kind::vector6, [](const State& s) { return rtde::Value{s.tcp_speed}; });
    add("tcp_offset", rtde::Kind::vector6, [](const State& s) { return rtde::Value{s.tcp_offset}; });
    add("actual_digital_input_bits", rtde::Kind::uint64,
        [](const State& s) { return rtde::Value{s.digital_in}; });
    add("actual_digital_output_bits", rtde::Kind::uint64,
        [](const State& s) { return rtde::Value{std::uint64_t{s.digital_out | s.configurable_out << 8}}; });
    real("actual_execution_time", 0.1);
    add("robot_mode", rtde::Kind::int32, [](const State& s) { return rtde::Value{s.robot_mode}; });
    add("joint_mode", rtde::Kind::vector6_int32, [](const State&) {
        return rtde::Value{std::array<std::int32_t, 6>{253, 253, 253, 253, 253, 253}};  // running
    });
    for (const char* name : {"safety_mode", "safety_status"})
        add(name, rtde::Kind::int32, [](const State& s) { return rtde::Value{s.safety_mode}; });
    for (const char* name : {"actual_tool_accelerometer", "elbow_position", "elbow_velocity"})
        add(name, rtde::Kind::vector3, [](const State&) { return rtde::Value{std::array<double, 3>{}}; });
    add("speed_scaling", rtde::Kind::real, [](const State& s) { return rtde::Value{s.speed_scaling}; });
    add("target_speed_fraction", rtde::Kind::real,
        [](const State& s) { return rtde::Value{s.speed_slider}; });
    real("actual_momentum", 0);
    real("actual_main_voltage", 48);
    real("actual_robot_voltage", 48);
    real("actual_robot_current", 0.5);
    add("runtime_state", rtde::Kind::uint32, [](const State& s) { return rtde::Value{s.runtime}; });
    add("robot_status_bits", rtde::Kind::uint32, [](const State& s) {
        return rtde::Value{std::uint32_t{1U | (s.runtime == 2 ? 2U : 0U)}};  // powered, running
    });
    add("safety_status_bits", rtde::Kind::uint32, [](const State& s) {
        switch (s.safety_mode) {
            case 1:
                return rtde::Value{std::uint32_t{1}};  // normal
            case 3:
                return rtde::Value{std::uint32_t{1U << 2}};  // protective stopped
            default:
                return rtde::Value{std::uint32_t{(1U << 9) | (1U << 10)}};  // fault, stopped due to safety
        }
    });
    add("analog_io_types", rtde::Kind::uint32, [](const State& s) { return rtde::Value{s.analog_types}; });
    real("standard_analog_input0", 0);
    real("standard_analog_input1", 0);
    add("standard_analog_output0", rtde::Kind::real,
        [](const State& s) { return rtde::Value{s.analog_out[0]}; });
    add("standard_analog_output1", rtde::Kind::real,
        [](const State& s) { return rtde::Value{s.analog_out[1]}; });
    real("io_current", 0);
    real("tool_analog_input0", 0);
    real("tool_analog_input1", 0);
    add("tool_output_voltage", rtde::Kind::int32, [](const State&) { return rtde::Value{std::int32_t{0}}; });
    real("tool_output_current", 0);
    real("tool_temperature", 30);
    add("payload_cog", rtde::Kind::vector3,
        [](const State&) { return rtde::Value{std::array<double, 3>{}}; });
    add("payload_inertia", rtde::Kind::vector6, [](const State&) { return rtde::Value{Six{}}; });
    real("payload", 0);
    real("tcp_force_scalar", 0);
    add_registers(all, "output", &State::outputs);
    add_registers(all, "input", &State::inputs);
    return all;
}

template <class T>
std::function<void(ControllerInputs&, const rtde::Value&)> into(T ControllerInputs::*member) {
    return [member](ControllerInputs& in, const rtde::Value& v) { in.*member = std::get<T>(v); };
}

std::map<std::string, InputVariable, std::less<>> make_inputs() {
    using Inputs = ControllerInputs;
    std::map<std::string, InputVariable, std::less<>> all;
    all["speed_slider_mask"] = {rtde::Kind::uint32, into(&Inputs::slider_mask)};
    all["speed_slider_fraction"] = {rtde::Kind::real, into(&Inputs::slider)};
    all["standard_digital_output_mask"] = {rtde::Kind::uint8, into(&Inputs::digital_mask)};
    all["standard_digital_output"] = {rtde::Kind::uint8, into(&Inputs::digital)};
    all["configurable_digital_output_mask"] = {rtde::Kind::uint8, into(&Inputs::configurable_mask)};
    all["configurable_digital_output"] = {rtde::Kind::uint8, into(&Inputs::configurable)};
    all["standard_analog_output_mask"] = {rtde::Kind::uint8, into(&Inputs::analog_mask)};
    all["standard_analog_output_type"] = {rtde::Kind::uint8, into(&Inputs::analog_type)};
    all["external_force_torque"] = {rtde::Kind::vector6, into(&Inputs::force)};
    for (std::size_t i = 0; i < 2; ++i)
        all[fmt::format("standard_analog_output_{}", i)] = {
            rtde::Kind::real, [i](Inputs& in, const rtde::Value& v) { in.analog[i] = std::get<double>(v); }};
    for (std::size_t i = 0; i < 48; ++i) {
        all[fmt::format("input_int_register_{}", i)] = {
            rtde::Kind::int32,
            [i](Inputs& in, const rtde::Value& v) { in.registers.ints[i] = std::get<std::int32_t>(v); }};
        all[fmt::format("input_double_register_{}", i)] = {
            rtde::Kind::real,
            [i](Inputs& in, const rtde::Value& v) { in.registers.reals[i] = std::get<double>(v); }};
    }
    for (std::size_t i = 64; i < 128; ++i)
        all[fmt::format("input_bit_register_{}", i)] = {
            rtde::Kind::boolean,
            [i](Inputs& in, const rtde::Value& v) { in.registers.bits[i] = std::get<bool>(v); }};
    for (const std::size_t first : {std::size_t{0}, std::size_t{32}})
        all[fmt::format("input_bit_registers{}_to_{}", first, first + 31)] = {
            rtde::Kind::uint32, [first](Inputs& in, const rtde::Value& v) {
                set_word(in.registers.bits, first, std::get<std::uint32_t>(v));
            }};
    return all;
}

}  // namespace

const std::map<std::string, OutputVariable, std::less<>>& output_variables() {
    static const auto all = make_outputs();
    return all;
}

const std::map<std::string, InputVariable, std::less<>>& input_variables() {
    static const auto all = make_inputs();
    return all;
}

}  // namespace seamwright::urscript
