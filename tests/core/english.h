#pragma once
// Texts as a test compares them: by what they say in English.

#include <string>
#include <vector>

#include "core/text.h"

namespace seamwright {

inline std::vector<std::string> english(const std::vector<Text>& texts) {
    std::vector<std::string> said;
    for (const Text& text : texts) said.push_back(text.english());
    return said;
}

}  // namespace seamwright
