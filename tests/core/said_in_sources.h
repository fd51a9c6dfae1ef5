#pragma once
// What the sources say: their string literals, and which of them reach a person as a Text.

#include <map>
#include <set>
#include <string>
#include <vector>

namespace seamwright {

struct SourceLiteral {
    std::string text;  // neighbours joined, signs unescaped
    std::string call;  // the innermost function, type or object whose arguments it stands among; "" = none
    int argument = 0;  // its number there
    int line = 0;
};
// Comments, raw strings and #include left out.
std::vector<SourceLiteral> literals_of(const std::string& source);

// A literal that becomes a Text, by where it stands.
bool is_said(const SourceLiteral& literal);
// One of them: what a table of settings says of a setting (devices/exchange/settings.h). Its name, what an absent
// one means and its choices are not said.
bool is_setting_help(const SourceLiteral& literal);

}  // namespace seamwright
