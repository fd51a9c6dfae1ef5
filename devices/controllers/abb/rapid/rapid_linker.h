#pragma once
// Modules of a task put together as a controller's loader does it: every name resolved, every type, argument
// and reserved name checked, initial values computed. Persistents that are global are one for all tasks of
// the same Persistents; they must have the same type everywhere and no two different initial values.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "devices/controllers/abb/rapid/rapid_language.h"

namespace seamwright::rapid {

// The instruction set: predefined types, data, instructions and functions, from rapid_system.cpp.
struct InstructionSet {
    std::unique_ptr<Module> module;
    std::map<std::string, const Type*> types;
    std::vector<std::unique_ptr<Type>> basic;
    std::map<std::string, Data*> data;
    std::map<std::string, Routine*> routines;
};
// `signals` are those of the I/O configuration: name -> "signaldo" or "signaldi".
InstructionSet make_instruction_set(const std::string& text,
                                    const std::map<std::string, std::string>& signals);

struct SharedPersistent {
    std::shared_ptr<Value> value;
    bool has_initial = false;
    Place at;
};
using Persistents = std::map<std::string, SharedPersistent>;

struct TaskProgram {
    std::string name;
    std::vector<std::unique_ptr<Module>> modules;
    std::map<std::string, Data*> data;         // global ones of its modules, folded names
    std::map<std::string, Routine*> routines;  // global ones
    // "module.name" for local ones; nullptr when there is none.
    const Data* find(const std::string& name) const;
};

struct SourceText {
    std::string file, text;
};

// Throws LoadError.
TaskProgram link_task(const std::string& name, const std::vector<SourceText>& sources,
                      const InstructionSet& system, Persistents& shared);

}  // namespace seamwright::rapid
