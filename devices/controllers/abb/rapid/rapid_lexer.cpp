#include "devices/controllers/abb/rapid/rapid_lexer.h"

#include <fmt/format.h>

#include <charconv>
#include <set>

#include "devices/controllers/abb/rapid/rapid_language.h"

namespace seamwright::rapid {
namespace {

bool letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
bool digit(char c) {
    return c >= '0' && c <= '9';
}

class Lexer {
  public:
    Lexer(const std::string& text, std::string file) : text_(text), file_(std::move(file)) {}
    std::vector<Token> all() {
        std::vector<Token> tokens;
        do tokens.push_back(next());
        while (tokens.back().kind != Token::Kind::end);
        return tokens;
    }

  private:
    [[noreturn]] void refuse(const std::string& why) const { throw LoadError({file_, line_}, why); }
    char peek(std::size_t ahead = 0) const { return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0'; }

    Token next() {
        for (;;) {
            const char c = peek();
            if (c == '\n') ++line_;
            if (c == '!')
                while (at_ < text_.size() && peek() != '\n') ++at_;
            else if (c == ' ' || c == '\t' || c == '\r' || c == '\n')
                ++at_;
            else
                break;
        }
        Token token;
        token.line = line_;
        if (at_ >= text_.size()) return token;
        const char c = peek();
        if (letter(c)) return word(std::move(token));
        if (digit(c) || (c == '.' && digit(peek(1)))) return number(std::move(token));
        if (c == '"') return quoted(std::move(token));
        token.kind = Token::Kind::sign;
        for (const char* two : {":=", "<>", "<=", ">="})
            if (c == two[0] && peek(1) == two[1]) token.text = two;
        if (token.text.empty()) {
            if (std::string_view("=<>+-*/()[]{},;\\.|:").find(c) == std::string_view::npos)
                refuse(fmt::format("the sign '{}' is not known", c));
            token.text = c;
        }
        at_ += token.text.size();
        return token;
    }
    Token word(Token token) {
        const std::size_t from = at_;
        while (letter(peek()) || digit(peek()) || peek() == '_') ++at_;
        token.kind = Token::Kind::word;
        token.shown = text_.substr(from, at_ - from);
        if (token.shown.size() > kLongestIdentifier)
            refuse(fmt::format("the name {} has more than {} characters", token.shown, kLongestIdentifier));
        token.text = folded(token.shown);
        return token;
    }
    Token number(Token token) {
        token.kind = Token::Kind::number;
        const char* end = text_.data() + text_.size();
        const auto read = std::from_chars(text_.data() + at_, end, token.number);
        if (read.ec != std::errc()) refuse("this is no number");
        token.text.assign(text_.data() + at_, read.ptr);
        at_ = static_cast<std::size_t>(read.ptr - text_.data());
        if (letter(peek())) refuse("a name cannot begin with a digit");
        return token;
    }
    Token quoted(Token token) {
        token.kind = Token::Kind::text;
        for (++at_;; ++at_) {
            const char c = peek();
            if (c == '\0' || c == '\n') refuse("the string is not closed in its line");
            if (c == '"' && peek(1) != '"') break;
            if (c == '"') ++at_;
            if (c != '\\') {
                token.text += c;
                continue;
            }
            if (peek(1) == '\\') {
                ++at_;
                token.text += '\\';
                continue;
            }
            int code = 0;
            const char* from = text_.data() + at_ + 1;
            if (at_ + 3 > text_.size() || std::from_chars(from, from + 2, code, 16).ptr != from + 2)
                refuse("a \\ in a string wants two hexadecimal digits or another \\");
            token.text += static_cast<char>(code);
            at_ += 2;
        }
        ++at_;
        if (token.text.size() > kLongestString)
            refuse(
                fmt::format("a string holds {} characters, this has {}", kLongestString, token.text.size()));
        return token;
    }

    const std::string& text_;
    const std::string file_;
    std::size_t at_ = 0;
    int line_ = 1;
};

}  // namespace

std::vector<Token> tokens_of(const std::string& text, const std::string& file) {
    return Lexer(text, file).all();
}

std::string folded(std::string name) {
    for (char& c : name)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return name;
}

bool is_reserved_word(const std::string& name) {
    static const std::set<std::string> words = {
        "alias",     "and",     "backward", "case",     "connect",   "const", "default",   "div",
        "do",        "else",    "elseif",   "endfor",   "endfunc",   "endif", "endmodule", "endproc",
        "endrecord", "endtest", "endtrap",  "endwhile", "error",     "exit",  "false",     "for",
        "from",      "func",    "goto",     "if",       "inout",     "local", "mod",       "module",
        "nostepin",  "not",     "noview",   "or",       "pers",      "proc",  "raise",     "readonly",
        "record",    "retry",   "return",   "step",     "sysmodule", "task",  "test",      "then",
        "to",        "trap",    "true",     "trynext",  "undo",      "var",   "viewonly",  "while",
        "with",      "xor"};
    return words.count(name) > 0;
}

}  // namespace seamwright::rapid
