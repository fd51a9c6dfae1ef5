#include "devices/controllers/kuka/krl/krl_lexer.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/number_text.h"
#include "devices/controllers/kuka/krl/krl_value.h"

namespace seamwright::krl {
namespace {

char upper(char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
}
bool is_letter(char c) {
    c = upper(c);
    return (c >= 'A' && c <= 'Z') || c == '_' || c == '$';
}
bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

std::vector<Token> tokens_of(std::string_view line) {
    std::vector<Token> tokens;
    std::size_t at = 0;
    const auto name = [&] {
        std::string text;
        while (at < line.size() && (is_letter(line[at]) || is_digit(line[at]))) text += upper(line[at++]);
        if (text.size() > kLongestName)
            throw KrlError(fmt::format("the name {} has more than {} characters", text, kLongestName));
        return text;
    };
    while (at < line.size()) {
        const char c = line[at];
        if (c == ' ' || c == '\t' || c == '\r') {
            ++at;
        } else if (c == ';') {
            break;
        } else if (is_letter(c)) {
            tokens.push_back({TokenKind::name, name()});
        } else if (c == '#') {
            ++at;
            if (at >= line.size() || !is_letter(line[at])) throw KrlError("# without a name");
            tokens.push_back({TokenKind::enumeration, name()});
        } else if (is_digit(c)) {
            const std::size_t from = at;
            bool real = false;
            while (at < line.size() && (is_digit(line[at]) || line[at] == '.' || upper(line[at]) == 'E')) {
                const bool exponent = upper(line[at]) == 'E';
                real = real || exponent || line[at] == '.';
                ++at;
                if (exponent && at < line.size() && (line[at] == '-' || line[at] == '+')) ++at;
            }
            const auto number = number_from<double>(line.substr(from, at - from));
            if (!number) throw KrlError(fmt::format("{} is no number", line.substr(from, at - from)));
            tokens.push_back({real ? TokenKind::real : TokenKind::integer,
                              std::string(line.substr(from, at - from)), *number});
        } else if (c == '"') {
            const auto end = line.find('"', at + 1);
            if (end == std::string_view::npos) throw KrlError("a string without its end");
            tokens.push_back({TokenKind::string, std::string(line.substr(at + 1, end - at - 1))});
            at = end + 1;
        } else {
            std::string sign(1, c);
            if (at + 1 < line.size()) {
                const std::string two = sign + line[at + 1];
                if (two == "==" || two == "<>" || two == "<=" || two == ">=") sign = two;
            }
            if (sign.size() == 1 && std::string_view("=<>+-*/()[]{},.:").find(c) == std::string_view::npos)
                throw KrlError(fmt::format("KRL does not know the sign {}", c < ' ' || c > '~' ? '?' : c));
            tokens.push_back({TokenKind::sign, sign});
            at += sign.size();
        }
    }
    return tokens;
}

}  // namespace

std::vector<Line> lines_of(std::string_view text) {
    std::vector<Line> lines;
    int number = 0;
    while (!text.empty()) {
        ++number;
        const auto end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        if (line.starts_with('&')) continue;  // header of the editor
        try {
            if (line.size() > kLongestLine) throw KrlError("the line is too long");
            auto tokens = tokens_of(line);
            if (!tokens.empty()) lines.push_back({number, std::move(tokens)});
        } catch (const KrlError& e) {
            throw KrlError(fmt::format("line {}: {}", number, e.what()));
        }
    }
    return lines;
}

bool is_reserved(std::string_view name) {
    static const std::set<std::string_view> words = {
        "AND",      "ANIN",       "ANOUT",     "AXIS",     "BAS",    "BOOL",     "BRAKE",    "B_AND",
        "B_EXOR",   "B_NOT",      "B_OR",      "CASE",     "CCLOSE", "CHANNEL",  "CHAR",     "CIRC",
        "CIRC_REL", "CONFIRM",    "CONST",     "CONTINUE", "COPEN",  "CREAD",    "CWRITE",   "C_DIS",
        "C_ORI",    "C_PTP",      "C_SPL",     "C_VEL",    "DECL",   "DEF",      "DEFAULT",  "DEFDAT",
        "DEFFCT",   "DELAY",      "DIGIN",     "DISTANCE", "DO",     "E3AXIS",   "E3POS",    "E6AXIS",
        "E6POS",    "EKI_STATUS", "ELSE",      "END",      "ENDDAT", "ENDFCT",   "ENDFOR",   "ENDIF",
        "ENDLOOP",  "ENDSPLINE",  "ENDSWITCH", "ENDWHILE", "ENUM",   "EXIT",     "EXOR",     "EXT",
        "EXTFCT",   "FALSE",      "FOR",       "FRAME",    "GLOBAL", "GOTO",     "HALT",     "IF",
        "IMPORT",   "INT",        "INTERRUPT", "IS",       "LIN",    "LIN_REL",  "LOAD",     "LOOP",
        "MAXIMUM",  "MINIMUM",    "NOT",       "OFF",      "ON",     "ONSTART",  "OR",       "PATH",
        "POS",      "PRIO",       "PTP",       "PTP_REL",  "PUBLIC", "PULSE",    "REAL",     "REPEAT",
        "RESUME",   "RETURN",     "SCIRC",     "SEC",      "SIGNAL", "SLIN",     "SLIN_REL", "SPL",
        "SPLINE",   "SPTP",       "SREAD",     "STEP",     "STRUC",  "SWITCH",   "SWRITE",   "SYNC",
        "THEN",     "TO",         "TRIGGER",   "TRUE",     "UNTIL",  "WAIT",     "WHEN",     "WHILE",
        "WITH",     "ABS",        "SQRT",      "SIN",      "COS",    "TAN",      "ACOS",     "ATAN2",
        "INV_POS",  "STRCOMP",    "STRCOPY",   "STRLEN",   "STRADD", "STRCLEAR", "STRFIND",  "VARSTATE",
        "MSGQUIT",  "MSGNOTIFY",  "INVERSE",   "FORWARD",  "ERROR_T"};
    return words.count(name) > 0;
}

}  // namespace seamwright::krl
