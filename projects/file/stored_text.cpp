#include "projects/file/stored_text.h"

#include <cmath>
#include <optional>
#include <utility>

#include "devices/exchange/json_fields.h"
#include "projects/file/project_json.h"

namespace seamwright {
namespace {

constexpr std::string_view kBegin = R"({"text":)";
constexpr int kDeepest = 8;
constexpr const char* kTexts = "texts";

nlohmann::json write(const Text& text, int depth);

nlohmann::json argument_json(const Text::Argument& argument, int depth) {
    if (const auto* text = std::get_if<Text>(&argument)) return {{"text", write(*text, depth + 1)}};
    if (const auto* number = std::get_if<double>(&argument)) {
        if (std::isfinite(*number)) return *number;
        return {{"number", std::isnan(*number) ? "nan" : *number > 0 ? "inf" : "-inf"}};
    }
    if (const auto* number = std::get_if<std::int64_t>(&argument)) return *number;
    return std::get<std::string>(argument);
}

std::optional<Text> read(const nlohmann::json& json, int depth);

std::optional<Text::Argument> argument_from(const nlohmann::json& json, int depth) {
    if (json.is_string()) return json.get<std::string>();
    if (json.is_number_integer()) {
        if (json.is_number_unsigned() && !std::in_range<std::int64_t>(json.get<std::uint64_t>())) return {};
        return json.get<std::int64_t>();
    }
    if (json.is_number_float()) return json.get<double>();
    if (!json.is_object() || json.size() != 1) return {};
    if (const auto text = json.find("text"); text != json.end()) return read(*text, depth + 1);
    const auto number = json.find("number");
    if (number == json.end()) return {};
    if (*number == "nan") return std::nan("");
    if (*number == "inf") return HUGE_VAL;
    if (*number == "-inf") return -HUGE_VAL;
    return {};
}

std::optional<Text> read(const nlohmann::json& json, int depth) {
    if (json.is_string()) return Text(json.get<std::string>());
    if (depth > kDeepest || !json.is_object()) return {};
    const auto key = json.find("text"), with = json.find("with");
    if (key == json.end() || !key->is_string() || json.size() != (with == json.end() ? 1U : 2U)) return {};
    std::vector<Text::Argument> arguments;
    if (with != json.end()) {
        if (!with->is_array()) return {};
        for (const auto& item : *with) {
            auto argument = argument_from(item, depth);
            if (!argument) return {};
            arguments.push_back(std::move(*argument));
        }
    }
    return Text::from(key->get<std::string>(), std::move(arguments));
}

// Whatever the program says can be read again: what read() would refuse is stored as its English.
nlohmann::json write(const Text& text, int depth) {
    if (text.empty()) return "";
    if (text.foreign() || depth > kDeepest || !Text::from(text.key(), text.arguments()))
        return text.english();
    nlohmann::json json = {{"text", text.key()}};
    for (const Text::Argument& argument : text.arguments())
        json["with"].push_back(argument_json(argument, depth));
    return json;
}

const nlohmann::json* stored_in(const nlohmann::json& object, const char* name) {
    const auto texts = object.find(kTexts);
    if (texts == object.end() || !texts->is_object()) return nullptr;
    const auto it = texts->find(name);
    return it == texts->end() ? nullptr : &*it;
}

}  // namespace

nlohmann::json text_json(const Text& text) {
    return write(text, 0);
}

Expected<Text> text_from_json(const nlohmann::json& json) {
    if (auto text = read(json, 0)) return *std::move(text);
    return input_error("this is no stored text");
}

std::string stored_text(const Text& text) {
    const nlohmann::json json = text_json(text);
    if (json.is_string() && !json.get_ref<const std::string&>().starts_with(kBegin))
        return utf8_text(json.get_ref<const std::string&>());
    return dump_messages(
        json.is_string() ? nlohmann::json{{"text", "{}"}, {"with", nlohmann::json::array({json})}} : json);
}

Text text_from_stored(std::string stored) {
    if (stored.starts_with(kBegin))
        if (const auto json = parse_json(stored, {}))
            if (auto text = read(*json, 0)) return *std::move(text);
    return Text(std::move(stored));
}

void put_text(nlohmann::json& object, const char* name, const Text& text) {
    object[name] = text.english();
    if (!text.empty() && !text.foreign()) object[kTexts][name] = text_json(text);
}

void put_texts(nlohmann::json& object, const char* name, const std::vector<Text>& texts) {
    nlohmann::json english = nlohmann::json::array(), stored = nlohmann::json::array();
    for (const Text& text : texts) {
        english.push_back(text.english());
        stored.push_back(text_json(text));
    }
    object[name] = std::move(english);
    if (!texts.empty()) object[kTexts][name] = std::move(stored);
}

Text text_in(const nlohmann::json& object, const char* name) {
    if (const nlohmann::json* stored = stored_in(object, name))
        if (auto text = read(*stored, 0)) return *std::move(text);
    const auto english = object.find(name);
    return english != object.end() && english->is_string() ? Text(english->get<std::string>()) : Text();
}

std::vector<Text> texts_in(const nlohmann::json& object, const char* name) {
    std::vector<Text> texts;
    const auto english = object.find(name);
    if (english == object.end() || !english->is_array()) return texts;
    const nlohmann::json* stored = stored_in(object, name);
    for (std::size_t i = 0; i < english->size(); ++i) {
        std::optional<Text> text;
        if (stored && stored->is_array() && i < stored->size()) text = read((*stored)[i], 0);
        if (!text && (*english)[i].is_string()) text = Text((*english)[i].get<std::string>());
        if (text) texts.push_back(*std::move(text));
    }
    return texts;
}

}  // namespace seamwright
