#pragma once
// The words of KRL, RAPID and URScript, and their expressions as trees.
//
// Unlike the languages of the simulated controllers (devices/controllers), which refuse a program as a controller does,
// this reads on behind whatever it does not know: a statement that cannot be read is one note, not the end of the file.

#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace seamwright::program_path {

enum class Dialect { krl, rapid, urscript };

struct Token {
    enum class Kind { name, number, text, sign, newline, end } kind = Kind::end;
    std::string text;  // of a name in capitals (KRL) or small letters (RAPID), else as written
    double number = 0;
    int line = 0;
};

// Never fails: what no word begins with is a sign. Comments, KRL's & lines and URScript's $ lines are left out.
std::vector<Token> tokens_of(std::string_view text, Dialect dialect);

// A statement that cannot be read. Ends in devices/robot_path, as a note of its line.
struct Misread : std::runtime_error {
    using std::runtime_error::runtime_error;
};

class Cursor {
  public:
    explicit Cursor(std::span<const Token> tokens) : tokens_(tokens) {}
    const Token& peek(std::size_t ahead = 0) const;
    bool done() const { return peek().kind == Token::Kind::end; }
    bool is(std::string_view word, std::size_t ahead = 0) const;  // a name or a sign
    bool accept(std::string_view word);
    void expect(std::string_view word);  // throws Misread
    Token take();                        // throws Misread at the end
    std::string name();                  // throws Misread
    std::size_t at() const { return at_; }
    void go_to(std::size_t at) { at_ = at; }

  private:
    std::span<const Token> tokens_;
    std::size_t at_ = 0;
};

struct Expr;
using ExprPtr = std::shared_ptr<const Expr>;

struct Argument {
    std::string name;  // \WObj:= of RAPID, a= of URScript; empty: by place
    ExprPtr value;     // none: left out, or only present (\Conc)
    bool optional = false;
};

struct Expr {
    // list: [..] of RAPID and URScript; record: {X 1, Y 2} of KRL; pose: p[..] of URScript.
    enum class Kind { number, truth, text, list, record, pose, name, index, component, call, unary, binary };
    Kind kind = Kind::number;
    double number = 0;
    bool whole = false;           // a number without point or exponent
    std::string text;             // literal, name, component, function or operator
    std::vector<Argument> parts;  // items, indices, arguments, operands
    ExprPtr of;                   // what is indexed or whose component it is
};

// Throws Misread: not an expression, or nested too deep.
ExprPtr read_expression(Cursor& cursor, Dialect dialect);
// Up to the closing sign, which is taken; RAPID's optional ones may follow without a comma. `closing` empty: to the end.
std::vector<Argument> read_arguments(Cursor& cursor, Dialect dialect, std::string_view closing);
// As a person would write it, for notes: "BASE_DATA[3]".
std::string shown(const Expr& expression);

}  // namespace seamwright::program_path
