#pragma once
// The loader at work. Private to the linker: its way through modules is rapid_linker.cpp, routines and their statements
// rapid_statements.cpp, expressions rapid_expressions.cpp.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "devices/controllers/abb/rapid/rapid_linker.h"

namespace seamwright::rapid {

inline bool same(const Type* a, const Type* b) {
    return a && b && a->root() == b->root();
}
std::string shown(const Type* type, const std::vector<int>& dims);
// A literal, or an aggregate of literals.
bool is_literal(const Expr& e);
Value constant_value(const Expr& e);

class Linker {
  public:
    Linker(TaskProgram& task, const InstructionSet& system, Persistents& shared)
        : task_(task),
          system_(system),
          shared_(shared),
          number_(system.types.at("num")),
          truth_(system.types.at("bool")),
          text_(system.types.at("string")) {}

    void link();
    void declare(Data& d);
    void head(Routine& r);

  private:
    struct Local {
        int slot;
        const Type* type;
        std::vector<int> dims;
        enum class Mode { variable, constant, inout, persistent, optional_in } mode;
        bool optional = false;
    };

    bool is_predefined(const std::string& name) const {
        return system_.types.count(name) + system_.data.count(name) + system_.routines.count(name) > 0;
    }
    const Type* type_of(const std::string& name, const Place& at) const;
    void claim_names();
    void share(Data& d);
    void enter(Module& m);

    void body(Routine& r);
    void block(Block& b);
    void statement(Statement& s);
    void assign(Statement& s);
    void count_loop(Statement& s);
    void test(Statement& s);
    void connect(Statement& s);
    const Routine* find_routine(const std::string& name, const Place& at) const;
    void arguments(const Routine& r, std::vector<Argument>& list, const Place& at);
    void argument(const Routine& r, const Parameter& p, Argument& a);

    std::optional<Local::Mode> reference(const Expr& e) const;
    void expect(const Expr& e, const Type* type, const std::vector<int>& dims) const;
    void check(Expr& e, const Type* wanted, const std::vector<int>& dims = {});
    void check_as(Expr& e, const Type* type) {
        check(e, type);
        expect(e, type, {});
    }
    void aggregate(Expr& e, const Type* wanted, const std::vector<int>& dims);
    void name(Expr& e);
    void index(Expr& e);
    void component(Expr& e);
    void binary(Expr& e);

    TaskProgram& task_;
    const InstructionSet& system_;
    Persistents& shared_;
    std::map<std::string, Data*> own_data_;
    std::map<std::string, Routine*> own_routines_;
    std::map<std::string, Local> locals_;
    Routine* routine_ = nullptr;
    const Type *number_, *truth_, *text_;
};

}  // namespace seamwright::rapid
