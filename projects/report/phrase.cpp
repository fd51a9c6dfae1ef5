#include "projects/report/phrase.h"

#include <fmt/args.h>

#include <map>
#include <nlohmann/json.hpp>

#include "hand_over_texts.h"

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
    static const auto texts = nlohmann::json::parse(resources::hand_over_de_json)
                                  .get<std::map<std::string, std::string, std::less<>>>();
    const auto it = texts.find(english);
    if (it == texts.end()) return std::nullopt;
    return it->second;
}

std::string Phrase::in(Language language) const {
    std::string_view pattern = english_;
    if (language == Language::german)
        if (const auto german = german_of(english_)) pattern = *german;
    fmt::dynamic_format_arg_store<fmt::format_context> values;
    for (const auto& argument : arguments_) {
        const auto* phrase = std::get_if<Phrase>(&argument);
        values.push_back(phrase ? phrase->in(language) : std::get<std::string>(argument));
    }
    return fmt::vformat(pattern, values);
}

}  // namespace seamwright
