#include "devices/exchange/words/tokens.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>

namespace seamwright::program_path {
namespace {

bool is_letter(char c, Dialect dialect) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
           (c == '$' && dialect == Dialect::krl) || static_cast<unsigned char>(c) >= 0x80;
}
bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

class Scanner {
  public:
    Scanner(std::string_view text, Dialect dialect) : text_(text), dialect_(dialect) {}

    std::vector<Token> all() {
        while (at_ < text_.size()) one();
        put(Token::Kind::newline, "\n");
        return std::move(tokens_);
    }

  private:
    char look(std::size_t ahead = 0) const { return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0'; }
    void put(Token::Kind kind, std::string text, double number = 0) {
        tokens_.push_back({kind, std::move(text), number, line_});
    }
    void to_end_of_line() { at_ = std::min(text_.find('\n', at_), text_.size()); }

    bool comment() const {
        const bool first = tokens_.empty() || tokens_.back().kind == Token::Kind::newline;
        switch (dialect_) {
            case Dialect::krl:
                return look() == ';' || (first && look() == '&');
            case Dialect::rapid:
                return look() == '!';
            default:
                return look() == '#' || (first && look() == '$');
        }
    }

    void one() {
        const char c = look();
        if (c == '\n') {
            put(Token::Kind::newline, "\n");
            ++line_, ++at_;
        } else if (c == ' ' || c == '\t' || c == '\r' || c == '\0') {
            ++at_;
        } else if (comment()) {
            to_end_of_line();
        } else if (c == '"' || (c == '\'' && dialect_ != Dialect::rapid)) {
            quoted(c);
        } else if (is_digit(c) || (c == '.' && is_digit(look(1)))) {
            number();
        } else if (is_letter(c, dialect_)) {
            name();
        } else {
            sign();
        }
    }

    void quoted(char quote) {
        std::string value;
        for (++at_; at_ < text_.size() && look() != '\n'; ++at_) {
            if (look() != quote) {
                value += look();
            } else if (look(1) == quote && dialect_ == Dialect::rapid) {
                value += quote;
                ++at_;
            } else {
                break;
            }
        }
        if (look() == quote) ++at_;
        const bool counted = dialect_ == Dialect::krl && quote == '\'' && value.size() > 1;
        if (!counted) return put(Token::Kind::text, value);
        const int base = value[0] == 'H' || value[0] == 'h' ? 16 : value[0] == 'B' || value[0] == 'b' ? 2 : 0;
        unsigned long long n = 0;
        const char* end = value.data() + value.size();
        if (base == 0 || std::from_chars(value.data() + 1, end, n, base).ptr != end)
            return put(Token::Kind::text, value);
        put(Token::Kind::number, value, static_cast<double>(n));
    }

    void number() {
        double value = 0;
        const char* begin = text_.data() + at_;
        const auto [end, problem] = std::from_chars(begin, text_.data() + text_.size(), value);
        if (problem == std::errc::result_out_of_range) value = std::numeric_limits<double>::infinity();
        const auto length = static_cast<std::size_t>(std::max(end, begin + 1) - begin);
        put(Token::Kind::number, std::string(begin, length), value);
        at_ += length;
    }

    void name() {
        const std::size_t from = at_;
        while (at_ < text_.size() && (is_letter(look(), dialect_) || is_digit(look()))) ++at_;
        std::string value(text_.substr(from, at_ - from));
        for (char& c : value) {
            if (dialect_ == Dialect::krl && c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
            if (dialect_ == Dialect::rapid && c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
        }
        put(Token::Kind::name, std::move(value));
    }

    void sign() {
        static constexpr std::array<std::string_view, 6> two = {":=", "<>", "==", "<=", ">=", "!="};
        const std::string_view pair = text_.substr(at_, 2);
        const std::size_t length = std::find(two.begin(), two.end(), pair) != two.end() ? 2 : 1;
        put(Token::Kind::sign, std::string(text_.substr(at_, length)));
        at_ += length;
    }

    std::string_view text_;
    Dialect dialect_;
    std::size_t at_ = 0;
    int line_ = 1;
    std::vector<Token> tokens_;
};

constexpr int kDeepest = 60;  // brackets within brackets

class ExpressionReader {
  public:
    ExpressionReader(Cursor& cursor, Dialect dialect) : c_(cursor), dialect_(dialect) {}

    ExprPtr expression() {
        if (++depth_ > kDeepest) throw Misread("nested too deep");
        auto e = level(0);
        --depth_;
        return e;
    }

    std::vector<Argument> arguments(std::string_view closing) {
        std::vector<Argument> all;
        const auto closed = [&] { return closing.empty() ? c_.done() : c_.accept(closing); };
        while (!closed()) {
            if (c_.accept(",")) {
                if (c_.is(",") || all.empty()) all.push_back({});  // left out
                continue;
            }
            Argument a;
            if (dialect_ == Dialect::rapid && c_.accept("\\")) {
                a.optional = true;
                a.name = c_.name();
                if (c_.accept(":=")) a.value = expression();
            } else {
                if (dialect_ == Dialect::urscript && c_.peek().kind == Token::Kind::name && c_.is("=", 1)) {
                    a.name = c_.name();
                    c_.take();
                }
                a.value = expression();
            }
            all.push_back(std::move(a));
        }
        return all;
    }

  private:
    static std::shared_ptr<Expr> made(Expr::Kind kind, std::string text = {}) {
        auto e = std::make_shared<Expr>();
        e->kind = kind;
        e->text = std::move(text);
        return e;
    }

    // Comparisons bind least in all three but for AND and OR, which stand below them in RAPID and URScript; KRL's are
    // the other way round, which only conditions without brackets tell apart.
    ExprPtr level(std::size_t depth) {
        static const std::vector<std::vector<std::string_view>> operators = {
            {"or", "OR", "xor", "EXOR"},
            {"and", "AND"},
            {"==", "<>", "<=", ">=", "<", ">", "!=", "="},
            {"+", "-"},
            {"*", "/", "div", "mod", "%"},
            {":"}};
        if (depth == operators.size()) return unary();
        auto left = level(depth + 1);
        for (int terms = 1;; ++terms) {
            if (terms > kDeepest)
                throw Misread("nested too deep");  // a tree leans as deep as its chain is long
            const auto& now = operators[depth];
            const auto op = std::find_if(now.begin(), now.end(), [&](std::string_view o) {
                return c_.is(o) && (o != ":" || dialect_ == Dialect::krl) &&
                       (o != "=" || dialect_ == Dialect::rapid);
            });
            if (op == now.end()) return left;
            c_.take();
            auto e = made(Expr::Kind::binary, std::string(*op));
            e->parts = {{{}, left}, {{}, level(depth + 1)}};
            left = std::move(e);
        }
    }

    ExprPtr unary() {
        if (++depth_ > kDeepest) throw Misread("nested too deep");
        ExprPtr e;
        if (c_.is("-") || c_.is("not") || c_.is("NOT")) {
            auto u = made(Expr::Kind::unary, c_.take().text);
            u->parts = {{{}, unary()}};
            e = std::move(u);
        } else if (c_.accept("+")) {
            e = unary();
        } else {
            e = postfix(primary());
        }
        --depth_;
        return e;
    }

    ExprPtr primary() {
        const Token t = c_.take();
        switch (t.kind) {
            case Token::Kind::number: {
                auto e = made(Expr::Kind::number);
                e->number = t.number;
                e->whole = std::isalpha(static_cast<unsigned char>(t.text.front())) != 0 ||  // 'H1F'
                           t.text.find_first_not_of("0123456789") == std::string::npos;
                return e;
            }
            case Token::Kind::text:
                return made(Expr::Kind::text, t.text);
            case Token::Kind::name:
                return named(t);
            default:
                break;
        }
        if (t.text == "(") {
            auto e = expression();
            c_.expect(")");
            return e;
        }
        if (t.text == "#" && dialect_ == Dialect::krl) return made(Expr::Kind::text, "#" + c_.name());
        if (t.text == "{" && dialect_ == Dialect::krl) return record();
        if (t.text == "[" && dialect_ != Dialect::krl) {
            auto e = made(Expr::Kind::list);
            e->parts = arguments("]");
            return e;
        }
        throw Misread(t.text);
    }

    ExprPtr named(const Token& t) {
        std::string folded = t.text;
        std::transform(folded.begin(), folded.end(), folded.begin(),
                       [](unsigned char c) { return std::tolower(c); });
        if (folded == "true" || folded == "false") {
            auto e = made(Expr::Kind::truth);
            e->number = folded == "true";
            return e;
        }
        if (dialect_ == Dialect::urscript && t.text == "p" && c_.accept("[")) {
            auto e = made(Expr::Kind::pose);
            e->parts = arguments("]");
            return e;
        }
        if (c_.accept("(")) {
            auto e = made(Expr::Kind::call, t.text);
            e->parts = arguments(")");
            return e;
        }
        return made(Expr::Kind::name, t.text);
    }

    ExprPtr record() {  // {E6POS: X 1.0, Y 2.0, POINT2[] " "}
        auto e = made(Expr::Kind::record);
        if (c_.is(":", 1)) {
            e->text = c_.name();
            c_.take();
        }
        do {
            Argument a;
            a.name = c_.name();
            if (c_.accept("[")) {
                while (!c_.accept("]")) c_.take();
            }
            a.value = expression();
            e->parts.push_back(std::move(a));
        } while (c_.accept(","));
        c_.expect("}");
        return e;
    }

    ExprPtr postfix(ExprPtr e) {
        const std::string_view open = dialect_ == Dialect::rapid ? "{" : "[";
        const std::string_view close = dialect_ == Dialect::rapid ? "}" : "]";
        for (int links = 0; links < kDeepest; ++links) {
            if (c_.accept(open)) {
                auto i = made(Expr::Kind::index);
                i->of = std::move(e);
                i->parts = arguments(close);
                e = std::move(i);
            } else if (c_.is(".") && c_.peek(1).kind == Token::Kind::name) {
                c_.take();
                auto k = made(Expr::Kind::component, c_.name());
                k->of = std::move(e);
                e = std::move(k);
            } else {
                return e;
            }
        }
        throw Misread("nested too deep");
    }

    Cursor& c_;
    Dialect dialect_;
    int depth_ = 0;
};

}  // namespace

std::vector<Token> tokens_of(std::string_view text, Dialect dialect) {
    return Scanner(text, dialect).all();
}

const Token& Cursor::peek(std::size_t ahead) const {
    static const Token end;
    return at_ + ahead < tokens_.size() ? tokens_[at_ + ahead] : end;
}
bool Cursor::is(std::string_view word, std::size_t ahead) const {
    const Token& t = peek(ahead);
    return (t.kind == Token::Kind::name || t.kind == Token::Kind::sign) && t.text == word;
}
bool Cursor::accept(std::string_view word) {
    if (!is(word)) return false;
    ++at_;
    return true;
}
void Cursor::expect(std::string_view word) {
    if (!accept(word)) throw Misread(fmt::format("{} is expected", word));
}
Token Cursor::take() {
    if (done()) throw Misread("it ends too early");
    return tokens_[at_++];
}
std::string Cursor::name() {
    Token t = take();
    if (t.kind != Token::Kind::name) throw Misread(t.text);
    return std::move(t.text);
}

ExprPtr read_expression(Cursor& cursor, Dialect dialect) {
    return ExpressionReader(cursor, dialect).expression();
}
std::vector<Argument> read_arguments(Cursor& cursor, Dialect dialect, std::string_view closing) {
    return ExpressionReader(cursor, dialect).arguments(closing);
}

std::string shown(const Expr& e) {
    const auto inner = [&](const char* open, const char* close) {
        std::string s = open;
        for (std::size_t i = 0; i < e.parts.size() && s.size() < 60; ++i)
            s += (i > 0 ? "," : "") + (e.parts[i].value ? shown(*e.parts[i].value) : e.parts[i].name);
        return s + close;
    };
    switch (e.kind) {
        case Expr::Kind::number:
            return fmt::format("{}", e.number);
        case Expr::Kind::truth:
            return e.number != 0 ? "TRUE" : "FALSE";
        case Expr::Kind::index:
            return shown(*e.of) + inner("[", "]");
        case Expr::Kind::component:
            return shown(*e.of) + "." + e.text;
        case Expr::Kind::call:
            return e.text + inner("(", ")");
        case Expr::Kind::binary:
            return shown(*e.parts[0].value) + e.text + shown(*e.parts[1].value);
        case Expr::Kind::unary:
            return e.text + shown(*e.parts[0].value);
        case Expr::Kind::list:
        case Expr::Kind::record:
        case Expr::Kind::pose:
            return "[..]";
        default:
            return e.text;
    }
}

}  // namespace seamwright::program_path
