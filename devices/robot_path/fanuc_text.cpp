// FANUC's TP programs as ASCII (.ls): /MN with the motions, /POS with the positions. Statements, blocks and jumps as a
// tree, and the positions.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "devices/robot_path/fanuc_machine.h"

namespace seamwright::program_path {

namespace {

std::optional<double> number_behind(std::string_view body, std::string_view key) {
    for (std::size_t at = 0; (at = body.find(key, at)) != std::string_view::npos; at += key.size()) {
        if (at > 0 && (std::isalnum(static_cast<unsigned char>(body[at - 1])) != 0 || body[at - 1] == '_'))
            continue;
        std::size_t from = body.find_first_not_of(" \t\r\n", at + key.size());
        if (from == std::string_view::npos || (body[from] != '=' && body[from] != ':')) continue;
        from = body.find_first_not_of(" \t\r\n+", from + 1);
        if (from == std::string_view::npos) return {};
        double value = 0;
        const auto [end, problem] = std::from_chars(body.data() + from, body.data() + body.size(), value);
        if (problem != std::errc() || !std::isfinite(value) || std::abs(value) > 1e9) return {};
        return value;
    }
    return {};
}

}  // namespace

void Fanuc::load(int file, std::string_view text) {
    std::string section, name = "program", statement;
    int line = 0, begin = 0, position_line = 0;
    std::string position;
    std::vector<Statement> flat;
    while (!text.empty()) {
        ++line;
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view now = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::size_t first = now.find_first_not_of(" \t\r");
        if (first == std::string_view::npos) continue;
        now = now.substr(first, now.find_last_not_of(" \t\r") - first + 1);
        if (now.front() == '/' && !now.starts_with("//")) {
            section = std::string(now.substr(0, now.find_first_of(" \t")));
            if (section == "/PROG") {
                const auto at = now.find_first_not_of(" \t", 5);
                if (at != std::string_view::npos)
                    name = std::string(now.substr(at, now.find_first_of(" \t", at) - at));
            }
            note(file, line, LineKind::understood);
            continue;
        }
        if (section == "/MN") {
            const std::size_t colon = now.find(':');
            const bool numbered =
                colon != std::string_view::npos && now.find_first_not_of("0123456789 ") == colon;
            if (numbered) now.remove_prefix(colon + 1);
            if (statement.empty()) begin = line;
            statement += std::string(now) + " ";
            if (!now.ends_with(";")) continue;
            Statement s;
            s.file = file;
            s.line = begin;
            const std::size_t from = statement.find_first_not_of(" \t");
            const std::string_view said =
                std::string_view(statement).substr(std::min(from, statement.size()));
            if (!said.starts_with("//") && !said.starts_with("--") && !said.starts_with("!"))
                for (Token& t : tokens_of(said, Dialect::rapid))
                    if (t.kind != Token::Kind::newline && t.text != ";") {
                        t.line = begin;
                        s.tokens.push_back(std::move(t));
                    }
            statement.clear();
            if (s.tokens.empty()) continue;  // a comment
            note(file, begin, LineKind::not_reached);
            flat.push_back(std::move(s));
        } else if (section == "/POS") {
            if (position.empty()) position_line = line;
            position += std::string(now) + "\n";
            if (position.find('}') == std::string::npos && position.size() < 10000) continue;
            read_position(file, position_line, position);
            position.clear();
        }
    }
    Routine routine;
    routine.file = file;
    routine.name = name;
    std::size_t at = 0;
    while (at < flat.size()) {
        for (Statement& s : block(flat, at, 0)) routine.body.push_back(std::move(s));
        if (at < flat.size()) routine.body.push_back(flat[at++]);  // a closing word of nothing
    }
    routine_order_.push_back(name);
    add_routine(std::move(routine));
}

std::vector<Token> Fanuc::collapsed(const std::vector<Token>& tokens, bool with_registers) {
    std::vector<Token> out;
    for (std::size_t i = 0; i < tokens.size(); ++i) {
        const bool opens =
            tokens[i].kind == Token::Kind::name && i + 1 < tokens.size() && tokens[i + 1].text == "[";
        if (!opens) {
            out.push_back(tokens[i]);
            continue;
        }
        Token t = tokens[i];
        std::size_t at = i + 2;
        t.text += "[";
        for (int item = 0; item < 3 && at < tokens.size(); ++item) {
            if (item > 0) t.text += ",";
            if (tokens[at].kind == Token::Kind::number) {
                t.text += fmt::format("{:.0f}", tokens[at].number);
                ++at;
            } else if (tokens[at].text == "r" && at + 2 < tokens.size() && tokens[at + 1].text == "[" &&
                       tokens[at + 2].kind == Token::Kind::number) {
                const Value* r =
                    with_registers ? variable(fmt::format("r[{:.0f}]", tokens[at + 2].number)) : nullptr;
                const auto n = r ? r->as_number() : std::nullopt;
                t.text += n ? fmt::format("{:.0f}", *n) : "?";
                while (at < tokens.size() && tokens[at].text != "]") ++at;
                ++at;
            } else {
                t.text += "?";
            }
            if (at >= tokens.size() || tokens[at].text != ",") break;
            ++at;
        }
        while (at < tokens.size() && tokens[at].text != "]") ++at;
        t.text += "]";
        out.push_back(std::move(t));
        i = at;
    }
    return out;
}

ExprPtr Fanuc::condition(const std::vector<Token>& tokens, std::size_t from, std::size_t to) {
    const std::vector<Token> some(tokens.begin() + static_cast<std::ptrdiff_t>(from),
                                  tokens.begin() + static_cast<std::ptrdiff_t>(to));
    const std::vector<Token> words = collapsed(some, false);
    try {
        Cursor c(words);
        auto e = read_expression(c, Dialect::rapid);
        if (c.done()) return e;
    } catch (const Misread&) {
    }
    auto e = std::make_shared<Expr>();
    e->kind = Expr::Kind::name;
    e->text = "?";
    return e;
}

std::size_t Fanuc::index_of(const std::vector<Token>& tokens, std::string_view word) {
    const auto at =
        std::find_if(tokens.begin(), tokens.end(), [&](const Token& t) { return t.text == word; });
    return static_cast<std::size_t>(at - tokens.begin());
}

// Behind a condition, not between the numbers of PR[1,2].
std::size_t Fanuc::comma_of(const std::vector<Token>& tokens) {
    int open = 0;
    for (std::size_t i = 0; i < tokens.size(); ++i) {
        if (tokens[i].text == "[") ++open;
        if (tokens[i].text == "]") --open;
        if (open == 0 && tokens[i].text == ",") return i;
    }
    return tokens.size();
}

std::string Fanuc::label_of(const std::vector<Token>& tokens, std::size_t from) {
    for (std::size_t i = from; i + 2 < tokens.size(); ++i)
        if (tokens[i].text == "lbl" && tokens[i + 1].text == "[" && tokens[i + 2].kind == Token::Kind::number)
            return fmt::format("{:.0f}", tokens[i + 2].number);
    return {};
}

bool Fanuc::closes(const Statement& s) {
    const std::string& word = s.tokens.front().text;
    return word == "else" || word == "endif" || word == "endfor";
}

Block Fanuc::block(const std::vector<Statement>& flat, std::size_t& at, int depth) {
    Block all;
    while (at < flat.size() && !closes(flat[at])) {
        const Statement& now = flat[at];
        const std::string& word = now.tokens.front().text;
        const std::size_t then = index_of(now.tokens, "then"), jmp = index_of(now.tokens, "jmp");
        Statement s;
        s.file = now.file;
        s.line = now.line;
        if (depth < kDeepestNesting && word == "if" && then < now.tokens.size()) {
            s.kind = Statement::Kind::branch;
            auto asked = condition(now.tokens, 1, then);
            ++at;
            s.branches.emplace_back(asked, block(flat, at, depth + 1));
            if (at < flat.size() && flat[at].tokens.front().text == "else") {
                ++at;
                s.branches.emplace_back(nullptr, block(flat, at, depth + 1));
            }
            if (at < flat.size() && flat[at].tokens.front().text == "endif") ++at;
        } else if (depth < kDeepestNesting && word == "for") {
            const std::vector<Token>& t = now.tokens;
            const std::size_t equals = index_of(t, "="), to = index_of(t, "to"), down = index_of(t, "downto");
            s.kind = Statement::Kind::count;
            const std::vector<Token> variable = collapsed(
                {t.begin() + 1, t.begin() + static_cast<std::ptrdiff_t>(std::min(equals, t.size()))}, false);
            s.variable = variable.empty() ? "?" : variable.front().text;
            const std::size_t split = std::min(to, down);
            s.from = condition(t, std::min(equals + 1, t.size()),
                               std::max(std::min(equals + 1, t.size()), std::min(split, t.size())));
            s.to = condition(t, std::min(split + 1, t.size()), t.size());
            auto step = std::make_shared<Expr>();
            step->number = down < to ? -1 : 1;
            s.step = step;
            ++at;
            s.branches.emplace_back(nullptr, block(flat, at, depth + 1));
            if (at < flat.size() && flat[at].tokens.front().text == "endfor") ++at;
        } else if (depth < kDeepestNesting && jmp < now.tokens.size() && (word == "jmp" || word == "if")) {
            const std::string label = label_of(now.tokens, jmp);
            std::size_t end = at + 1;
            int nested = 0;
            bool found = false, labelled = false;
            for (; end < flat.size(); ++end) {
                const std::string& w = flat[end].tokens.front().text;
                if (nested == 0 && w == "lbl") {
                    found = label_of(flat[end].tokens, 0) == label;
                    if (found) break;
                    labelled = true;
                }
                if ((w == "if" && index_of(flat[end].tokens, "then") < flat[end].tokens.size()) || w == "for")
                    ++nested;
                if ((w == "endif" || w == "endfor") && nested-- == 0) break;
            }
            std::size_t comma = index_of(now.tokens, ",");
            if (!found || label.empty()) {
                s.tokens = now.tokens;
                ++at;
            } else {
                const std::vector<Statement> over(flat.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                                                  flat.begin() + static_cast<std::ptrdiff_t>(end));
                at = end;
                auto staying = std::make_shared<Expr>();
                if (word == "jmp" && !labelled) {
                    staying->kind = Expr::Kind::truth;
                } else if (word == "jmp" || labelled) {
                    staying->kind = Expr::Kind::name;
                    staying->text = "a jump";
                } else {
                    staying->kind = Expr::Kind::unary;
                    staying->text = "not";
                    staying->parts = {{{}, condition(now.tokens, 1, std::min(comma, jmp))}};
                }
                s.kind = Statement::Kind::branch;
                std::size_t inner = 0;
                Block body;
                while (inner < over.size()) {
                    for (Statement& i : block(over, inner, depth + 1)) body.push_back(std::move(i));
                    if (inner < over.size()) body.push_back(over[inner++]);
                }
                s.branches.emplace_back(staying, std::move(body));
            }
        } else if (const std::size_t comma = comma_of(now.tokens);
                   word == "if" && comma < now.tokens.size()) {  // IF R[1]=1,CALL SUB
            s.kind = Statement::Kind::branch;
            Statement deed = s;
            deed.kind = Statement::Kind::simple;
            deed.tokens.assign(now.tokens.begin() + static_cast<std::ptrdiff_t>(comma) + 1, now.tokens.end());
            s.branches.emplace_back(condition(now.tokens, 1, comma), Block{std::move(deed)});
            ++at;
        } else {
            s.tokens = now.tokens;
            ++at;
        }
        all.push_back(std::move(s));
    }
    return all;
}

void Fanuc::read_position(int file, int line, std::string_view text) {
    const std::size_t open = text.find('['), close = text.find(']'), brace = text.find('{');
    note(file, line, LineKind::understood);
    if (open == text.npos || close == text.npos || brace == text.npos || close < open || close > brace) {
        note(file, line, LineKind::not_understood, "this is not known here");
        return;
    }
    const std::string_view name = text.substr(open + 1, close - open - 1);
    int number = 0;
    std::from_chars(name.data(), name.data() + name.size(), number);
    std::string_view body = text.substr(brace + 1);
    for (const char* other : {"GP2", "GP3", "GP4", "GP5"})  // of another group: a positioner's
        if (const auto at = body.find(other); at != body.npos) body = body.substr(0, at);
    Position p;
    if (const auto colon = name.find(':'); colon != name.npos) p.label = std::string(name.substr(colon + 1));
    p.joints = number_behind(body, "J1").has_value();
    const auto uf = number_behind(body, "UF"), ut = number_behind(body, "UT");
    p.frame = uf ? fmt::format("{:.0f}", *uf) : "F";
    p.tool = ut ? fmt::format("{:.0f}", *ut) : "F";
    std::array<double, 6> n{};
    const char* keys[] = {"X", "Y", "Z", "W", "P", "R"};
    bool whole = true;
    for (std::size_t i = 0; i < 6; ++i) {
        const auto value = number_behind(body, keys[i]);
        whole = whole && value;
        n[i] = value.value_or(0);
    }
    if (whole) p.pose = pose_from(n);
    positions_[{file, number}] = std::move(p);
}

}  // namespace seamwright::program_path
