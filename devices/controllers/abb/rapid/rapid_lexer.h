#pragma once
// The words of RAPID. Private to rapid_parser.cpp.

#include <string>
#include <vector>

namespace seamwright::rapid {

struct Token {
    enum class Kind { word, number, text, sign, end };
    Kind kind = Kind::end;
    std::string text;  // a word folded, a sign as it is
    std::string shown;
    double number = 0;
    int line = 1;
};

// Ends with one of kind `end`. Throws LoadError.
std::vector<Token> tokens_of(const std::string& text, const std::string& file);

}  // namespace seamwright::rapid
