#pragma once
// Lines and words of a KRL file. A statement is a line; ';' begins a comment; letters have no case.

#include <string>
#include <string_view>
#include <vector>

namespace seamwright::krl {

inline constexpr std::size_t kLongestName = 24;
inline constexpr std::size_t kLongestLine = 471;

enum class TokenKind { name, integer, real, string, enumeration, sign, end };
struct Token {
    TokenKind kind = TokenKind::end;
    std::string text;  // names and enumerations in capitals, strings as they are
    double number = 0;
};
struct Line {
    int number = 0;
    std::vector<Token> tokens;  // never empty; without the closing `end`
};

// Error (KrlError): a sign that KRL does not know, a name of over 24 characters, a string without its end, a
// line that is too long, letters beyond ASCII outside comments.
std::vector<Line> lines_of(std::string_view text);

// Not to be given to a variable or a program: keywords, predefined types, and the names of the system's own.
bool is_reserved(std::string_view upper_name);

}  // namespace seamwright::krl
