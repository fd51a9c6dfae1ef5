#pragma once
// A URScript program in the form that the interpreter runs: every function a list of operations on a stack.
//
// The sources are the body of the program's own function, as PolyScope puts Script nodes of type File one
// behind the other. Everything that the language refuses at loading is refused here: unknown or later defined
// names, names defined twice or that belong to the language, wrong counts and names of arguments, comparison
// chains, blocks without end, threads with parameters, jumps outside a loop, and whatever the interpreter
// does not have.

#include <string>
#include <vector>

#include "core/error.h"
#include "devices/controllers/ur/script/value.h"

namespace seamwright::urscript {

enum class Code {
    constant,       // a: of Program::constants
    load_global,    // a: slot
    load_local,     // a: slot
    store_global,   // a: slot; takes the value
    store_local,    // a: slot
    store_element,  // a: slot, b: 1 where global; takes index and value
    index,          // list, index -> element
    add,
    subtract,
    multiply,
    divide,
    remainder,
    negate,
    equal,
    unequal,
    less,
    greater,
    less_equal,
    greater_equal,
    logical_and,
    logical_or,
    logical_xor,
    logical_not,
    make_list,  // a: elements
    make_pose,
    jump,          // a: place
    jump_if_not,   // a: place; takes the condition
    call,          // a: function, b: arguments
    call_builtin,  // a: of builtins()
    run_thread,    // a: function; leaves the handle
    give_back,     // ends the function with the value on top
    drop,
    join_thread,
    kill_thread,
    halt_program,
    enter_critical,
    exit_critical
};

struct Operation {
    Code code{};
    int a = 0, b = 0, line = 0;
};

struct Function {
    std::string name;
    bool thread = false;
    std::size_t parameters = 0;
    std::vector<std::string> locals;  // parameters first
    std::vector<Operation> code;
};

struct Source {
    std::string name, text;
};

struct Program {
    std::vector<Function> functions;  // the first is the program itself
    std::vector<Value> constants;
    std::vector<std::string> globals;
    std::vector<std::pair<std::string, int>> sources;  // name and first line
    std::string where(int line) const;                 // "seamwright.script line 12"
};

// Error (input) with file and line.
Expected<Program> compile(const std::vector<Source>& sources);

}  // namespace seamwright::urscript
