#pragma once
// The words of one line of KRL in their order, and the expressions among them: the inside of krl_parser.cpp.

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "devices/controllers/kuka/krl/krl_lexer.h"
#include "devices/controllers/kuka/krl/krl_tree.h"

namespace seamwright::krl {

// The tokens of one line.
class Reader {
  public:
    explicit Reader(const Line& line) : line_(line) {}
    const Token& peek(std::size_t ahead = 0) const {
        static const Token end;
        return at_ + ahead < line_.tokens.size() ? line_.tokens[at_ + ahead] : end;
    }
    bool done() const { return at_ >= line_.tokens.size(); }
    Token take() {
        if (done()) throw KrlError("the line ends too early");
        return line_.tokens[at_++];
    }
    bool is(std::string_view word) const {
        const Token& t = peek();
        return (t.kind == TokenKind::name || t.kind == TokenKind::sign) && t.text == word;
    }
    bool accept(std::string_view word) {
        if (!is(word)) return false;
        ++at_;
        return true;
    }
    void expect(std::string_view word) {
        if (!accept(word))
            throw KrlError(fmt::format("{} is expected{}", word, done() ? "" : " before " + peek().text));
    }
    std::string new_name() {
        const Token t = take();
        if (t.kind != TokenKind::name) throw KrlError(fmt::format("{} is no name", t.text));
        if (is_reserved(t.text))
            throw KrlError(fmt::format("{} is a word of KRL and names nothing else", t.text));
        if (t.text.starts_with('$')) throw KrlError(fmt::format("{}: names with $ are the system's", t.text));
        return t.text;
    }
    void end() const {
        if (!done()) throw KrlError(fmt::format("{} is too much in this line", peek().text));
    }
    int number() const { return line_.number; }

  private:
    const Line& line_;
    std::size_t at_ = 0;
};

ExpressionPtr expression(Reader& r);

// NAME, NAME[i], NAME[i,], NAME[], NAME.X or NAME(arguments).
ExpressionPtr place_or_call(Reader& r);

}  // namespace seamwright::krl
