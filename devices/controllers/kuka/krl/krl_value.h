#pragma once
// Values and variables of KRL as a controller holds them: REAL has 32 bits, arrays count from 1, what was
// never assigned is not initialised and must not be read.

#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/pose.h"

namespace seamwright::krl {

// What stops a program: a sentence and the place. Thrown within the interpreter only; machine.h ends it.
struct KrlError : std::runtime_error {
    explicit KrlError(const std::string& what) : std::runtime_error(what) {}
};

std::string capitals(std::string text);  // names have no case

enum class Type { boolean, integer, real, character, enumeration, frame, pos, e6pos, e6axis, eki_status };
std::string_view to_string(Type type);  // "BOOL", "FRAME", ...
std::optional<Type> type_from(std::string_view upper_name);
bool is_geometric(Type type);  // FRAME, POS, E6POS
bool is_number(Type type);     // INT, REAL, CHAR
// Components in the order in which they are written: X, Y, Z, A, B, C, (S, T, (E1..E6)).
const std::vector<std::string>& components(Type type);

// One value; `text` is an enumeration's name without '#', or, with `string`, a whole row of CHAR.
struct Value {
    Type type = Type::integer;
    bool set = false;
    bool string = false;
    double number = 0;  // BOOL 0/1, INT, REAL, CHAR
    std::string text;
    std::map<std::string, std::optional<double>> parts;  // of a structure, by component

    static Value boolean(bool v);
    static Value integer(double v);  // Error beyond 32 bits
    static Value real(double v);
    static Value name(std::string v);
    static Value string_of(std::string v);
    static Value of(const Pose& pose, Type type);
    static Value unset(Type type);
    bool truth() const;  // Error unless it is a BOOL
    double as_number() const;
    Pose pose() const;  // Error unless X..C are all initialised
};

// As the controller's variable display shows it: {FRAME: X 1.0, Y ...}, #T1, "text", TRUE.
std::string shown(const Value& value);

// `value` as it is stored in a variable of `type`. Error where KRL does not convert.
Value converted(const Value& value, Type type);

struct Variable {
    std::string name;
    Type type = Type::integer;
    std::vector<std::size_t> dimensions;  // none = one value
    std::vector<Value> cells;
    Variable(std::string n, Type t, std::vector<std::size_t> d);
    // Place of the element; the last index is left out for a row of a CHAR array. Error outside the array.
    std::size_t cell(const std::vector<long>& indices, bool row) const;
    std::size_t row_length() const { return dimensions.empty() ? 0 : dimensions.back(); }
    // The characters of a row up to the first that is not initialised or 0.
    std::string row_text(std::size_t from) const;
    void set_row(std::size_t from, const std::string& text);
    bool row_initialised(std::size_t from) const;  // every character
};
using VariablePtr = std::shared_ptr<Variable>;

}  // namespace seamwright::krl
