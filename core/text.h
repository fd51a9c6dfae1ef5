#pragma once
// What the program says to a person: a pattern, which is the key of its translation, and what goes into it.
//
//   Text("the driver \"{}\" is not known", name)      the literal is the English and the key
//   Text("region {}: {}", id, error.what)             an argument may be a Text and is said in the same language
//   Text("it is {}", to_string(verdict))              so is a word of ours, a literal or a std::string_view
//   Text(error_of_a_library)                          a std::string is what somebody else says: never translated
//
// Nothing may be decided by a Text; what is acted upon is a code or a status beside it. The other languages are
// in resources/translations/texts_de.json, by the pattern.

#include <fmt/format.h>

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/value_type.h"

namespace seamwright {

enum class Language { english, german };
std::optional<Language> language_from(std::string_view code);  // "en", "de"
std::string_view code_of(Language language);

// The German of an English pattern; nullopt when there is none.
std::optional<std::string_view> german_of(std::string_view english);

class Text {
  public:
    // Numbers stay numbers: their format stands in the pattern, "{:.3f} mm". Whole ones are counts and ids,
    // below 2^63.
    using Argument = std::variant<std::string, double, std::int64_t, Text>;

    SEAM_VALUE_TYPE(Text);
    // A sentence of the program without arguments; braces in it are signs like others.
    template <class T>
    requires(std::is_array_v<T> || std::is_same_v<T, const char*>) Text(const T& english)
        : Text(Literal(), english) {}  // NOLINT(google-explicit-constructor): a literal is a sentence
    // Words of somebody else: a library, a device, a person, an old file.
    Text(std::string said);  // NOLINT(google-explicit-constructor): most sentences name a thing
    template <class First, class... Rest>
    explicit Text(fmt::format_string<First, Rest...> english, First&& first, Rest&&... rest)
        : Text(Literal(), {fmt::string_view(english).data(), fmt::string_view(english).size()}) {
        take(std::forward<First>(first));
        (take(std::forward<Rest>(rest)), ...);
    }
    // The same with a pattern that is chosen while the program runs, from literals.
    template <class... A>
    static Text chosen(std::string_view english, const A&... arguments) {
        Text text;
        text.key_ = english;
        (text.take(arguments), ...);
        return text;
    }
    // As it was stored. nullopt: the pattern does not fit its arguments, or would print without measure.
    static std::optional<Text> from(std::string key, std::vector<Argument> arguments);

    explicit operator std::string() const { return english(); }
    bool empty() const { return key_.empty(); }
    void clear() { *this = {}; }
    const std::string& key() const { return key_; }
    const std::vector<Argument>& arguments() const { return arguments_; }
    // What somebody else said, and has no translation.
    bool foreign() const {
        return key_ == "{}" && arguments_.size() == 1 && std::holds_alternative<std::string>(arguments_[0]);
    }

    // A pattern without translation is said in English, what somebody else said as it is.
    std::string in(Language language) const;
    std::string english() const { return in(Language::english); }

    bool operator==(const Text&) const;
    // Friends, so that no std::string becomes a Text to be compared.
    template <class S>
    requires std::is_convertible_v<const S&, std::string_view>
    friend bool operator==(const Text& text, const S& english) {
        return text.english() == std::string_view(english);
    }
    // In JSON that others read: the English.
    template <class Json>
    requires requires { typename Json::json_pointer; }
    friend void to_json(Json& json, const Text& text) { json = text.english(); }
    friend std::ostream& operator<<(std::ostream& out, const Text& text) { return text.print(out); }

  private:
    struct Literal {};
    Text(Literal, std::string_view english);
    std::string formatted(std::string_view pattern, Language language) const;  // throws fmt::format_error
    std::ostream& print(std::ostream& out) const;
    void add(std::string value);
    void add(Text value);
    void add(double value);
    void add(std::int64_t value);
    void add_word(std::string_view english);
    template <class Value>
    void take(Value&& value) {
        using T = std::remove_cvref_t<Value>;
        if constexpr (std::is_same_v<T, Text> || std::is_same_v<T, std::string>)
            add(std::forward<Value>(value));
        else if constexpr (std::is_convertible_v<T, std::string_view>)
            add_word(value);
        else if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, char>)
            add(fmt::format("{}", value));
        else if constexpr (std::is_floating_point_v<T>)
            add(static_cast<double>(value));
        else if constexpr (std::is_integral_v<T>)
            add(static_cast<std::int64_t>(value));
        else
            add(fmt::format("{}", std::forward<Value>(value)));
    }

    std::string key_;
    std::vector<Argument> arguments_;
};

// "where: what", "this; that": signs alone, the same in every language. An empty one leaves the other.
Text joined(const Text& first, std::string_view between, const Text& second);
// "A, B and C".
Text listed(const std::vector<Text>& texts);

}  // namespace seamwright

template <>
struct fmt::formatter<seamwright::Text> : fmt::formatter<fmt::string_view> {
    template <class Context>
    auto format(const seamwright::Text& text, Context& context) const {
        return fmt::formatter<fmt::string_view>::format(text.english(), context);
    }
};
