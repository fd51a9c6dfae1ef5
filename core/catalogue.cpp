#include "core/text.h"

#include <map>
#include <nlohmann/json.hpp>

#include "german_texts.h"

namespace seamwright {

std::optional<Language> language_from(std::string_view code) {
    if (code == "en") return Language::english;
    if (code == "de") return Language::german;
    return std::nullopt;
}

std::string_view code_of(Language language) {
    return language == Language::german ? "de" : "en";
}

std::optional<std::string_view> german_of(std::string_view english) {
    static const auto texts = nlohmann::json::parse(resources::texts_de_json)
                                  .get<std::map<std::string, std::string, std::less<>>>();
    const auto it = texts.find(english);
    if (it == texts.end()) return std::nullopt;
    return it->second;
}

}  // namespace seamwright
