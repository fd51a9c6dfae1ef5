#pragma once
// The language's own functions that the interpreter has.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "devices/controllers/ur/script/value.h"

namespace seamwright::urscript {

class ScriptRobot;

// What a thread waits for before its next operation. Everything but `nothing` uses the robot's time.
struct Wait {
    enum class For { nothing, cycle, time, motion, popup, thread } what = For::nothing;
    double until_s = 0;       // time
    std::size_t pending = 0;  // motion: at most that many moves left
    int thread = 0;
};

struct BuiltinCall {
    ScriptRobot& robot;
    int thread;                    // who calls
    std::vector<Value> arguments;  // one for each parameter; no value where it was left out
    Value result{};
    Wait wait{};
};

struct Builtin {
    std::string_view name;
    std::vector<std::string_view> parameters;
    std::size_t required;
    Expected<void> (*act)(BuiltinCall& call);  // Error (input): what the controller stops the program for
};
const std::vector<Builtin>& builtins();
std::optional<int> find_builtin(std::string_view name);

}  // namespace seamwright::urscript
