#pragma once
// RAPID as the interpreter holds it: types, values, and the tree of a module, whose names the linker
// resolves.
//
// What it takes is the part of the language that our programs and small application programs use (Technical
// reference manual "RAPID kernel"): whatever else stands in a module is an error where it stands, never
// skipped.

#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace seamwright::rapid {

inline constexpr std::size_t kLongestIdentifier = 32, kLongestString = 80;

struct Place {
    std::string file;
    int line = 0;
};

// A module that a controller does not load. `what` is the sentence with file and line.
struct LoadError : std::runtime_error {
    LoadError(const Place& at, const std::string& why)
        : std::runtime_error(at.file + ", line " + std::to_string(at.line) + ": " + why) {}
};

// Names are compared in lower case: RAPID does not tell capital letters apart.
std::string folded(std::string name);
bool is_reserved_word(const std::string& folded_name);

struct Type {
    enum class Kind { number, long_number, truth, text, record, opaque, any, presence };
    std::string name;
    Kind kind = Kind::number;
    const Type* alias_of = nullptr;
    struct Field {
        std::string name;
        const Type* type;
    };
    std::vector<Field> fields;
    const Type* root() const { return alias_of ? alias_of->root() : this; }
};

// Numbers are single precision (num) or double (dnum); truth is 0 or 1.
struct Value {
    const Type* type = nullptr;
    std::vector<int> dims;  // of an array; `parts` are then its elements, the last index running fastest
    double number = 0;
    std::string text;
    std::vector<Value> parts;
    std::shared_ptr<void> object;  // what stands behind socketdev, triggdata, ...
};
Value make_value(const Type* type, const std::vector<int>& dims = {});
double as_num(double value);  // in single precision

enum class Storage { variable, constant, persistent };

struct Data;
struct Routine;
struct Expr;
using ExprPtr = std::unique_ptr<Expr>;

struct Argument {
    std::string name;  // of an optional one, folded; else empty
    ExprPtr value;     // none for a switch
    Place at;
    std::size_t parameter = 0;  // of the linker
};

struct Expr {
    enum class Kind { number, text, truth, name, aggregate, index, component, call, unary, binary };
    Kind kind = Kind::number;
    Place at;
    double number = 0;
    std::string text;  // literal, operator, or name (folded)
    std::vector<ExprPtr> parts;
    std::vector<Argument> arguments;
    // Of the linker:
    const Type* type = nullptr;
    std::vector<int> dims;
    Data* data = nullptr;  // global
    int slot = -1;         // of the routine
    const Routine* routine = nullptr;
    std::size_t field = 0;
};

struct Statement;
using Block = std::vector<std::unique_ptr<Statement>>;

struct Statement {
    enum class Kind {
        assign,
        call,
        branch,
        loop_while,
        loop_for,
        test,
        give_back,
        raise,
        retry,
        trynext,
        exit,
        connect
    };
    Kind kind = Kind::call;
    Place at;
    ExprPtr target, value, step;  // assign: target := value; for: from value to step's sibling `until`
    ExprPtr until;
    std::vector<std::pair<ExprPtr, Block>> branches;            // IF, ELSEIF; WHILE has one
    std::vector<std::pair<std::vector<ExprPtr>, Block>> cases;  // TEST
    Block otherwise;
    bool has_otherwise = false;
    std::string name;  // of the routine called, of the loop's variable, of the trap; folded
    std::vector<Argument> arguments;
    int slot = -1;
    const Routine* routine = nullptr;
};

struct Parameter {
    enum class Mode { in, inout, variable, persistent };
    std::string name;  // folded
    std::string type_name;
    Mode mode = Mode::in;
    bool optional = false, any_dims = false;
    int dims = 0;
    int choice = 0;  // optional ones of the same number exclude each other
    const Type* type = nullptr;
};

struct Data {
    enum class Scope { global, local, task };
    std::string name, shown;  // folded, as written
    Storage storage = Storage::variable;
    Scope scope = Scope::global;
    std::string type_name;
    std::vector<ExprPtr> dims;
    ExprPtr initial;
    Place at;
    const Type* type = nullptr;
    std::vector<int> sizes;
    int slot = -1;                 // of a routine's
    std::shared_ptr<Value> value;  // of a module's; a shared PERS has one for all tasks
};

struct Routine {
    enum class Kind { procedure, function, trap };
    Kind kind = Kind::procedure;
    std::string name, shown, module;
    bool local = false, has_handler = false;
    int native = -1;  // of the system's: its number in the instruction set
    std::string type_name;
    const Type* type = nullptr;
    std::vector<Parameter> parameters;
    std::vector<std::unique_ptr<Data>> data;
    Block body, handler;
    int slots = 0;
    Place at;
};

struct Module {
    std::string name, shown;
    Place at;
    std::vector<std::unique_ptr<Type>> types;
    std::vector<std::vector<std::pair<std::string, std::string>>> type_fields;  // beside types: type, name
    std::vector<std::string> type_alias;                                        // beside types
    std::vector<std::unique_ptr<Data>> data;
    std::vector<std::unique_ptr<Routine>> routines;
};

// Throws LoadError. `system` reads the instruction set: routines are heads without bodies.
std::unique_ptr<Module> parse_module(const std::string& text, const std::string& file, bool system = false);

}  // namespace seamwright::rapid
