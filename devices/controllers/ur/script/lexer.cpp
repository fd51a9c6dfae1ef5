#include "devices/controllers/ur/script/lexer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

namespace seamwright::urscript {
namespace {

constexpr std::array<std::string_view, 27> kKeywords = {
    "and",           "break", "continue", "def",    "elif", "else", "end",    "enter_critical",
    "exit_critical", "False", "global",   "halt",   "if",   "join", "kill",   "local",
    "not",           "or",    "pass",     "return", "run",  "sec",  "thread", "True",
    "while",         "xor",   "struct"};

// The script manual's modules motion, internals, urmath and interfaces.
constexpr std::array kFunctions = std::to_array<std::string_view>({"conveyor_pulse_decode",
                                                                   "encoder_enable_pulse_decode",
                                                                   "end_force_mode",
                                                                   "end_freedrive_mode",
                                                                   "end_teach_mode",
                                                                   "force_mode",
                                                                   "force_mode_set_damping",
                                                                   "freedrive_mode",
                                                                   "get_conveyor_tick_count",
                                                                   "get_target_tcp_pose_along_path",
                                                                   "get_target_tcp_speed_along_path",
                                                                   "movec",
                                                                   "movej",
                                                                   "movel",
                                                                   "movep",
                                                                   "path_offset_disable",
                                                                   "path_offset_enable",
                                                                   "path_offset_set",
                                                                   "pause_on_error_code",
                                                                   "position_deviation_warning",
                                                                   "reset_revolution_counter",
                                                                   "screw_driving",
                                                                   "servoc",
                                                                   "servoj",
                                                                   "set_conveyor_tick_count",
                                                                   "set_pos",
                                                                   "set_safety_mode_transition_hardness",
                                                                   "speedj",
                                                                   "speedl",
                                                                   "stop_conveyor_tracking",
                                                                   "stopj",
                                                                   "stopl",
                                                                   "teach_mode",
                                                                   "track_conveyor_circular",
                                                                   "track_conveyor_linear",
                                                                   "force",
                                                                   "get_actual_joint_positions",
                                                                   "get_actual_joint_speeds",
                                                                   "get_actual_tcp_pose",
                                                                   "get_actual_tcp_speed",
                                                                   "get_actual_tool_flange_pose",
                                                                   "get_controller_temp",
                                                                   "get_forward_kin",
                                                                   "get_inverse_kin",
                                                                   "get_inverse_kin_has_solution",
                                                                   "get_joint_temp",
                                                                   "get_joint_torques",
                                                                   "get_steptime",
                                                                   "get_target_joint_positions",
                                                                   "get_target_joint_speeds",
                                                                   "get_target_payload",
                                                                   "get_target_tcp_pose",
                                                                   "get_target_tcp_speed",
                                                                   "get_target_waypoint",
                                                                   "get_tcp_force",
                                                                   "get_tcp_offset",
                                                                   "get_tool_accelerometer_reading",
                                                                   "get_tool_current",
                                                                   "is_steady",
                                                                   "is_within_safety_limits",
                                                                   "popup",
                                                                   "powerdown",
                                                                   "set_gravity",
                                                                   "set_payload",
                                                                   "set_payload_cog",
                                                                   "set_payload_mass",
                                                                   "set_target_payload",
                                                                   "set_tcp",
                                                                   "sleep",
                                                                   "str_at",
                                                                   "str_cat",
                                                                   "str_empty",
                                                                   "str_find",
                                                                   "str_len",
                                                                   "str_sub",
                                                                   "sync",
                                                                   "textmsg",
                                                                   "to_num",
                                                                   "to_str",
                                                                   "tool_contact",
                                                                   "acos",
                                                                   "asin",
                                                                   "atan",
                                                                   "atan2",
                                                                   "binary_list_to_integer",
                                                                   "ceil",
                                                                   "cos",
                                                                   "d2r",
                                                                   "floor",
                                                                   "get_list_length",
                                                                   "integer_to_binary_list",
                                                                   "interpolate_pose",
                                                                   "inv",
                                                                   "length",
                                                                   "log",
                                                                   "norm",
                                                                   "normalize",
                                                                   "point_dist",
                                                                   "pose_add",
                                                                   "pose_dist",
                                                                   "pose_inv",
                                                                   "pose_sub",
                                                                   "pose_trans",
                                                                   "pow",
                                                                   "r2d",
                                                                   "random",
                                                                   "rotvec2rpy",
                                                                   "rpy2rotvec",
                                                                   "sin",
                                                                   "sqrt",
                                                                   "tan",
                                                                   "wrench_trans",
                                                                   "get_analog_in",
                                                                   "get_analog_out",
                                                                   "get_configurable_digital_in",
                                                                   "get_configurable_digital_out",
                                                                   "get_digital_in",
                                                                   "get_digital_out",
                                                                   "get_euromap_input",
                                                                   "get_euromap_output",
                                                                   "get_flag",
                                                                   "get_standard_analog_in",
                                                                   "get_standard_analog_out",
                                                                   "get_standard_digital_in",
                                                                   "get_standard_digital_out",
                                                                   "get_tool_analog_in",
                                                                   "get_tool_digital_in",
                                                                   "get_tool_digital_out",
                                                                   "modbus_add_signal",
                                                                   "modbus_delete_signal",
                                                                   "modbus_get_signal_status",
                                                                   "modbus_send_custom_command",
                                                                   "modbus_set_output_register",
                                                                   "modbus_set_output_signal",
                                                                   "modbus_set_signal_update_frequency",
                                                                   "read_input_boolean_register",
                                                                   "read_input_float_register",
                                                                   "read_input_integer_register",
                                                                   "read_output_boolean_register",
                                                                   "read_output_float_register",
                                                                   "read_output_integer_register",
                                                                   "read_port_bit",
                                                                   "read_port_register",
                                                                   "rpc_factory",
                                                                   "rtde_set_watchdog",
                                                                   "set_analog_out",
                                                                   "set_configurable_digital_out",
                                                                   "set_digital_out",
                                                                   "set_flag",
                                                                   "set_runstate_outputs",
                                                                   "set_standard_analog_out",
                                                                   "set_standard_digital_out",
                                                                   "set_tool_digital_out",
                                                                   "set_tool_voltage",
                                                                   "socket_close",
                                                                   "socket_get_var",
                                                                   "socket_open",
                                                                   "socket_read_ascii_float",
                                                                   "socket_read_binary_integer",
                                                                   "socket_read_byte_list",
                                                                   "socket_read_line",
                                                                   "socket_read_string",
                                                                   "socket_send_byte",
                                                                   "socket_send_int",
                                                                   "socket_send_line",
                                                                   "socket_send_string",
                                                                   "socket_set_var",
                                                                   "write_output_boolean_register",
                                                                   "write_output_float_register",
                                                                   "write_output_integer_register",
                                                                   "write_port_bit",
                                                                   "write_port_register",
                                                                   "zero_ftsensor"});

constexpr std::array<std::string_view, 16> kSigns = {"==", "!=", "<=", ">=", "(", ")", "[", "]",
                                                     ",",  ":",  "=",  "<",  ">", "+", "-", "*"};

bool starts_name(char c) {
    return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
}
bool digit(char c) {
    return c >= '0' && c <= '9';
}

}  // namespace

bool is_keyword(std::string_view name) {
    return std::find(kKeywords.begin(), kKeywords.end(), name) != kKeywords.end();
}

std::span<const std::string_view> functions_of_the_language() {
    return kFunctions;
}

bool is_function_of_the_language(std::string_view name) {
    return std::find(kFunctions.begin(), kFunctions.end(), name) != kFunctions.end();
}

Expected<std::vector<Token>> tokens_of(std::string_view text) {
    std::vector<Token> tokens;
    int line = 1;
    const auto fail = [&](const std::string& what) { return input_error(what, Text("line {}", line)); };
    const auto add = [&](Token::Kind kind, std::string word, Value value = {}) {
        tokens.push_back({kind, std::move(word), std::move(value), line});
    };
    std::size_t at = 0;
    while (at < text.size()) {
        const char c = text[at];
        if (c == '\n') {
            add(Token::Kind::newline, "\n");
            ++line, ++at;
        } else if (c == ' ' || c == '\t' || c == '\r') {
            ++at;
        } else if (c == '#') {
            at = std::min(text.find('\n', at), text.size());
        } else if (starts_name(c)) {
            std::size_t end = at;
            while (end < text.size() && (starts_name(text[end]) || digit(text[end]))) ++end;
            const std::string word(text.substr(at, end - at));
            if (word == "True" || word == "False")
                add(Token::Kind::number, word, {word == "True"});
            else
                add(is_keyword(word) ? Token::Kind::keyword : Token::Kind::name, word);
            at = end;
        } else if (digit(c) || (c == '.' && at + 1 < text.size() && digit(text[at + 1]))) {
            const char *begin = text.data() + at, *stop = text.data() + text.size();
            double real = 0;
            const auto r = std::from_chars(begin, stop, real);
            if (r.ec != std::errc{}) return fail("a number is out of range");
            const std::string word(begin, r.ptr);
            if (r.ptr != stop && starts_name(*r.ptr)) return fail("\"" + word + *r.ptr + "\" is no number");
            if (word.find_first_of(".eE") != std::string::npos) {
                add(Token::Kind::number, word, {real});
            } else {
                if (real > 2147483648.0) return fail(word + " is beyond 32 bits");
                // -2147483648 is the sign before 2147483648, which alone is beyond the range: the parser
                // looks.
                add(Token::Kind::number, word,
                    real > 2147483647.0 ? Value{real} : Value{static_cast<std::int32_t>(real)});
            }
            at += word.size();
        } else if (c == '"') {
            const std::size_t end = text.find('"', at + 1);
            if (end == std::string_view::npos ||
                text.substr(at, end - at).find('\n') != std::string_view::npos)
                return fail("a string has no end");
            if (end - at - 1 > 1023) return fail("a string is longer than 1023 signs");
            add(Token::Kind::text, "", {std::string(text.substr(at + 1, end - at - 1))});
            at = end + 1;
        } else if (c == '/' || c == '%') {
            add(Token::Kind::sign, std::string(1, c));
            ++at;
        } else if (const auto sign = std::find_if(kSigns.begin(), kSigns.end(),
                                                  [&](auto s) { return text.substr(at, s.size()) == s; });
                   sign != kSigns.end()) {
            add(Token::Kind::sign, std::string(*sign));
            at += sign->size();
        } else {
            return fail(fmt::format("\"{}\" is no sign of URScript", c));
        }
    }
    add(Token::Kind::newline, "\n");
    add(Token::Kind::end, "");
    return tokens;
}

}  // namespace seamwright::urscript
