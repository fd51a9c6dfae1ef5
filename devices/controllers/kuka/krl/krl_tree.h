#pragma once
// A parsed KRL module: what parse_module() makes of a file and machine.h executes.

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/controllers/kuka/krl/krl_value.h"

namespace seamwright::krl {

struct Expression;
using ExpressionPtr = std::shared_ptr<const Expression>;

struct Expression {
    enum class Kind { literal, aggregate, place, call, unary, binary } kind = Kind::literal;
    Value value;                       // literal
    std::string name;                  // place, call, or the operator
    std::vector<ExpressionPtr> parts;  // indices, arguments (nullptr = left out), operands
    bool row = false;                  // place: NAME[], NAME[1,]
    std::string component;             // place: .X
    std::vector<std::pair<std::string, ExpressionPtr>> fields;  // aggregate
};

struct Statement;
using Block = std::vector<Statement>;

struct Statement {
    enum class Kind {
        assign,
        call,
        if_,
        for_,
        while_,
        repeat,
        loop,
        exit,
        switch_,
        return_,
        halt,
        wait_for,
        wait_sec,
        lin,
        lin_rel,
        ptp,
        trigger,
        pulse,
        interrupt_decl,  // value: its priority; second: the event; third: the call
        interrupt_on,    // value: its priority
        interrupt_off,
        brake,
        resume
    } kind = Kind::halt;
    int line = 0;
    ExpressionPtr target, value, second, third;  // as the kind needs them
    std::vector<Block> blocks;                   // bodies: THEN, ELSE; the loop's; one a CASE, then DEFAULT
    std::vector<std::vector<ExpressionPtr>> cases;
    bool approximates = false;  // C_DIS
    bool global = false;        // GLOBAL INTERRUPT DECL
};

struct Declaration {
    std::string name;
    Type type = Type::integer;
    std::vector<long> dimensions;  // 0 = NAME[] of a parameter
    bool global = false;
    ExpressionPtr initial;
    int line = 0;
};

struct Parameter {
    std::string name;
    bool out = false, array = false;
};

struct Routine {
    std::string name, module;
    bool global = false;
    std::optional<Type> returns;
    std::vector<Parameter> parameters;
    std::vector<Declaration> declarations;
    Block body;
};

struct Module {
    std::string name;  // of the file, in capitals, without its ending
    bool is_data = false, is_public = false;
    std::vector<std::shared_ptr<const Routine>> routines;  // .src and .sub; the first has the file's name
    std::vector<Declaration> declarations;                 // .dat
    Block assignments;                                     // .dat: NAME[]="text"
};

// Of a .src, .sub or .dat. Error (KrlError) with the line.
Module parse_module(const std::string& file_name, const std::string& text);

// A variable's name with index and component, or a value, as KUKAVARPROXY takes them.
ExpressionPtr parse_expression(const std::string& text);

}  // namespace seamwright::krl
