#pragma once
// URScript's text as tokens.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "devices/controllers/ur/script/value.h"

namespace seamwright::urscript {

struct Token {
    enum class Kind { name, keyword, number, text, sign, newline, end };
    Kind kind = Kind::end;
    std::string text;  // name, keyword or sign
    Value value;       // number or text
    int line = 0;
};

// Error (input): a sign that the language does not have, a string without end, a number out of range; with
// the line.
Expected<std::vector<Token>> tokens_of(std::string_view text);

bool is_keyword(std::string_view name);
// Names of the language's own functions, more of them than the interpreter has: no program may define them.
bool is_function_of_the_language(std::string_view name);
std::span<const std::string_view> functions_of_the_language();

}  // namespace seamwright::urscript
