#pragma once
// The inside of compile(), shared by the sources that make it up: statements (compiler.cpp) and expressions
// (compiler_expressions.cpp).

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "devices/controllers/ur/script/lexer.h"
#include "devices/controllers/ur/script/program.h"

namespace seamwright::urscript {

// One pass over the tokens. A failure ends it: every step after the first error does nothing.
class Compiler {
  public:
    Compiler(std::vector<Token> tokens, Program& program) : tokens_(std::move(tokens)), program_(program) {}

    std::optional<std::pair<std::string, int>> run();

  private:
    using Kind = Token::Kind;
    struct Loop {
        int begin;
        std::vector<std::size_t> breaks;
    };
    struct Scope {  // a function that is being written
        int function;
        std::map<std::string, int> functions;  // defined in it
        std::vector<Loop> loops;
    };

    const Token& now() const { return tokens_[at_]; }
    void next() {
        if (at_ + 1 < tokens_.size()) ++at_;
    }
    void fail(std::string what) { fail_at(std::move(what), now().line); }
    void fail_at(std::string what, int line) {
        if (!failed_) failed_ = std::pair(std::move(what), line);
        at_ = tokens_.size() - 1;
    }
    bool is(std::string_view sign) const {
        return (now().kind == Kind::sign || now().kind == Kind::keyword) && now().text == sign;
    }
    bool take(std::string_view sign) {
        if (!is(sign)) return false;
        next();
        return true;
    }
    void expect(std::string_view sign) {
        if (!take(sign)) fail(fmt::format("\"{}\" is missing before \"{}\"", sign, shown()));
    }
    std::string shown() const {
        return now().kind == Kind::newline ? "the end of the line"
               : now().kind == Kind::end   ? "the end of the program"
                                           : now().text;
    }
    void end_of_line() {
        if (now().kind != Kind::newline) return fail("\"" + shown() + "\" stands behind a whole statement");
        next();
    }
    std::string name(std::string_view what) {
        if (now().kind != Kind::name) {
            fail(fmt::format("\"{}\" is no name of {}", shown(), what));
            return {};
        }
        std::string word = now().text;
        next();
        return word;
    }

    Function& function() { return program_.functions[static_cast<std::size_t>(scopes_.back().function)]; }
    bool first_level() const { return scopes_.size() == 1; }
    std::size_t emit(Code code, int a = 0, int b = 0) {
        function().code.push_back({code, a, b, now().line});
        return function().code.size() - 1;
    }
    int here() { return static_cast<int>(function().code.size()); }
    void land(std::size_t jump) { function().code[jump].a = here(); }
    int constant(Value value) {
        program_.constants.push_back(std::move(value));
        return static_cast<int>(program_.constants.size() - 1);
    }
    void emit_return() {
        emit(Code::constant, constant({}));
        emit(Code::give_back);
    }
    static std::optional<int> find(const std::vector<std::string>& names, const std::string& name) {
        const auto it = std::find(names.begin(), names.end(), name);
        if (it == names.end()) return std::nullopt;
        return static_cast<int>(it - names.begin());
    }
    std::optional<int> find_function(const std::string& name) const {
        for (auto scope = scopes_.rbegin(); scope != scopes_.rend(); ++scope)
            if (const auto it = scope->functions.find(name); it != scope->functions.end()) return it->second;
        return std::nullopt;
    }
    bool may_name(const std::string& word, bool variable);

    // Up to one of `closers`, which stays.
    void block(const std::vector<std::string_view>& closers);

    void statement();
    void assignment_or_call();
    // Free names are the global of that name where there is one; on the first level all are global.
    void store(const std::string& word, bool global, bool local);
    void definition(bool thread);
    void condition();
    void conditional();
    void loop();

    // ---- expressions, weakest first
    void expression();
    void negation();
    void comparison();
    void sum();
    void product();
    void sign();
    void primary();
    int elements();
    void named();
    void call(const std::string& word);

    const std::vector<Token> tokens_;
    Program& program_;
    std::size_t at_ = 0;
    std::vector<Scope> scopes_;
    std::optional<Code> mixed_;  // the connective of the expression being read
    std::optional<std::pair<std::string, int>> failed_;
};

}  // namespace seamwright::urscript
