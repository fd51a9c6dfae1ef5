#pragma once
// Sentences in English and German without Qt: for the checklist and the hand-over report, which the command
// line writes too. The English is the key; the German stands in resources/translations/hand_over_de.json.

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

namespace seamwright {

enum class Language { english, german };
std::optional<Language> language_from(std::string_view code);  // "en", "de"
std::string_view code_of(Language language);

// The pattern with its arguments' marks {} (or {0}, {1} where the German turns them around). An argument that
// is a Phrase is translated too, anything else is printed as it is.
class Phrase {
  public:
    Phrase() = default;
    template <class... A>
    explicit Phrase(const char* english, const A&... arguments) : english_(english) {
        (add(arguments), ...);
    }
    std::string in(Language language) const;
    bool empty() const { return english_.empty(); }

  private:
    template <class T>
    void add(const T& argument) {
        if constexpr (std::is_same_v<T, Phrase>)
            arguments_.emplace_back(argument);
        else
            arguments_.emplace_back(fmt::format("{}", argument));
    }
    std::string english_;
    std::vector<std::variant<std::string, Phrase>> arguments_;
};

// The German of an English pattern; nullopt when there is none.
std::optional<std::string_view> german_of(std::string_view english);

}  // namespace seamwright
