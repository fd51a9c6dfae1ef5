#include "core/text.h"

#include <fmt/args.h>

#include <functional>
#include <ostream>

namespace seamwright {
namespace {

constexpr std::size_t kLongestKey = 20'000, kMostArguments = 1000;  // of the chain of a large region's spots
constexpr std::size_t kLongestMark = 12;                            // "{0:+12.6f}"

// A stored pattern may ask for a width that fills the memory; ours have two digits at most, and no nested marks.
bool modest(std::string_view key) {
    if (key.size() > kLongestKey) return false;
    for (std::size_t i = 0; i < key.size(); ++i) {
        if (key[i] != '{') continue;
        if (i + 1 < key.size() && key[i + 1] == '{') {
            ++i;
            continue;
        }
        const std::size_t end = key.find('}', i);
        if (end == std::string_view::npos || end - i > kLongestMark) return false;
        int digits = 0;
        for (++i; i < end; ++i) {
            digits = key[i] >= '0' && key[i] <= '9' ? digits + 1 : 0;
            if (digits > 2 || key[i] == '{') return false;
        }
    }
    return true;
}

// "{}; {}; {}"
std::string chain_of(std::size_t count, std::string_view between) {
    std::string key = "{}";
    for (std::size_t i = 1; i < count; ++i) key.append(between).append("{}");
    return key;
}

}  // namespace

SEAM_VALUE_TYPE_MEMBERS(Text)

bool Text::operator==(const Text& other) const {
    return key_ == other.key_ && arguments_ == other.arguments_;
}

Text::Text(Literal, std::string_view english) : key_(english) {}

Text::Text(std::string said) {
    if (said.empty()) return;
    key_ = "{}";
    add(std::move(said));
}

void Text::add(std::string value) {
    arguments_.emplace_back(std::move(value));
}
void Text::add(Text value) {
    arguments_.emplace_back(std::move(value));
}
void Text::add(double value) {
    arguments_.emplace_back(value);
}
void Text::add(std::int64_t value) {
    arguments_.emplace_back(value);
}
void Text::add_word(std::string_view english) {
    Text word;
    word.key_ = english;
    add(std::move(word));
}

std::string Text::formatted(std::string_view pattern, Language language) const {
    fmt::dynamic_format_arg_store<fmt::format_context> values;
    for (const Argument& argument : arguments_)
        std::visit(
            [&](const auto& value) {
                if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Text>)
                    values.push_back(value.in(language));
                else
                    values.push_back(value);
            },
            argument);
    return fmt::vformat(fmt::string_view(pattern.data(), pattern.size()), values);
}

std::string Text::in(Language language) const {
    std::string_view pattern = key_;
    if (language == Language::german)
        if (const auto german = german_of(key_)) pattern = *german;
    if (arguments_.empty()) return std::string(pattern);
    try {
        return formatted(pattern, language);
    } catch (const fmt::format_error&) {  // a catalogue that does not fit: never a reason to say nothing
        return language == Language::english ? key_ : english();
    }
}

std::optional<Text> Text::from(std::string key, std::vector<Argument> arguments) {
    if (arguments.size() > kMostArguments || (!arguments.empty() && !modest(key))) return std::nullopt;
    Text text;
    text.key_ = std::move(key);
    text.arguments_ = std::move(arguments);
    if (text.arguments_.empty()) return text;
    try {
        (void)text.formatted(text.key_, Language::english);
    } catch (const fmt::format_error&) {
        return std::nullopt;
    }
    return text;
}

std::ostream& Text::print(std::ostream& out) const {
    return out << english();
}

// What is joined again and again is one pattern, "{}; {}; {}", however many there are: nothing nests.
Text joined(const Text& first, std::string_view between, const Text& second) {
    if (first.empty()) return second;
    if (second.empty()) return first;
    std::vector<Text::Argument> parts;
    for (const Text& part : {std::cref(first), std::cref(second)}) {
        if (part.arguments().size() > 1 && part.key() == chain_of(part.arguments().size(), between))
            parts.insert(parts.end(), part.arguments().begin(), part.arguments().end());
        else
            parts.emplace_back(part);
    }
    std::string key = chain_of(parts.size(), between);
    if (auto chain = Text::from(std::move(key), std::move(parts))) return *std::move(chain);
    return Text::chosen(chain_of(2, between), first, second);  // longer than may be stored
}

Text listed(const std::vector<Text>& texts) {
    Text list;
    for (std::size_t i = 0; i < texts.size(); ++i)
        list =
            i > 0 && i + 1 == texts.size() ? Text("{} and {}", list, texts[i]) : joined(list, ", ", texts[i]);
    return list;
}

}  // namespace seamwright
