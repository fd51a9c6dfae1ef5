#include "devices/exchange/json_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace seamwright {
namespace {

const char* type_name(const nlohmann::json& json) {
    switch (json.type()) {
        case nlohmann::json::value_t::null:
            return "null";
        case nlohmann::json::value_t::object:
            return "an object";
        case nlohmann::json::value_t::array:
            return "an array";
        case nlohmann::json::value_t::string:
            return "a text";
        case nlohmann::json::value_t::boolean:
            return "true/false";
        default:
            return "a number";
    }
}

}  // namespace

Expected<nlohmann::json> parse_json(std::string_view text, const std::string& where) {
    using nlohmann::json;
    constexpr int kDeepest = 64;
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    std::vector<std::set<std::string>> keys;  // of the objects that are open
    std::string twice;
    bool too_deep = false;
    const json::parser_callback_t watch = [&](int depth, json::parse_event_t event, json& parsed) {
        if (depth > kDeepest) too_deep = true;
        if (event == json::parse_event_t::object_start) keys.emplace_back();
        if (event == json::parse_event_t::object_end) keys.pop_back();
        if (event == json::parse_event_t::key) {
            const auto& key = parsed.get_ref<const std::string&>();
            if (!keys.back().insert(key).second && twice.empty()) twice = key;
        }
        return !too_deep;
    };
    try {
        json parsed = json::parse(text.begin(), text.end(), watch);
        if (too_deep) return input_error(fmt::format("the JSON is nested deeper than {}", kDeepest), where);
        if (!twice.empty())
            return input_error("the key \"" + twice + "\" is given twice in one object", where);
        return parsed;
    } catch (const json::exception& e) {
        // "[json.exception.parse_error.101] parse error at line 1, column 4: ..." without the library's own
        // tag.
        std::string message = e.what();
        if (const auto tag = message.find("] "); tag != std::string::npos) message.erase(0, tag + 2);
        if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) message = "the text is empty";
        return input_error("is no JSON (" + message + ")", where);
    }
}

Expected<nlohmann::json> read_json_file(const std::filesystem::path& path, std::size_t limit_bytes) {
    auto text = read_text_file(path, limit_bytes);
    if (!text) return tl::unexpected(text.error());
    return parse_json(*text, path.string());
}

std::string json_path(const std::string& where, const std::string& key) {
    return where.empty() ? key : where + "." + key;
}
std::string json_path(const std::string& where, std::size_t index) {
    return fmt::format("{}[{}]", where, index);
}

Expected<void> only_fields(const nlohmann::json& json, std::initializer_list<std::string_view> known,
                           const std::string& where) {
    if (!json.is_object())
        return input_error(std::string("must be an object, not ") + type_name(json), where);
    if (known.size() == 0) return {};
    for (const auto& [key, value] : json.items()) {
        if (std::find(known.begin(), known.end(), key) != known.end()) continue;
        std::string list;
        for (std::string_view k : known) list += (list.empty() ? "" : ", ") + std::string(k);
        return input_error("is not a known field", json_path(where, key), "known are " + list);
    }
    return {};
}

Expected<double> as_number(const nlohmann::json& value, const std::string& where) {
    if (!value.is_number())
        return input_error(std::string("must be a number, not ") + type_name(value), where);
    const double number = value.get<double>();
    if (!std::isfinite(number)) return input_error("must be finite", where);
    return number;
}

Expected<const nlohmann::json*> json_field(const nlohmann::json& json, const std::string& key,
                                           const std::string& where) {
    if (!json.is_object())
        return input_error(std::string("must be an object, not ") + type_name(json), where);
    const auto it = json.find(key);
    if (it == json.end()) return input_error("is missing", json_path(where, key));
    return &*it;
}

Expected<const nlohmann::json*> json_array(const nlohmann::json& json, const std::string& key,
                                           const std::string& where) {
    const auto field = json_field(json, key, where);
    if (!field || (*field)->is_array()) return field;
    return input_error(std::string("must be an array, not ") + type_name(**field), json_path(where, key));
}

Expected<double> json_number(const nlohmann::json& json, const std::string& key, const std::string& where) {
    const auto field = json_field(json, key, where);
    if (!field) return tl::unexpected(field.error());
    return as_number(**field, json_path(where, key));
}

Expected<std::string> json_string(const nlohmann::json& json, const std::string& key,
                                  const std::string& where) {
    const auto field = json_field(json, key, where);
    if (!field) return tl::unexpected(field.error());
    if (!(*field)->is_string()) {
        return input_error(std::string("must be a text, not ") + type_name(**field), json_path(where, key));
    }
    return (*field)->get<std::string>();
}

Expected<double> json_number_or(const nlohmann::json& json, const std::string& key, double otherwise,
                                const std::string& where) {
    return json.is_object() && !json.contains(key) ? Expected<double>(otherwise)
                                                   : json_number(json, key, where);
}

Expected<bool> json_bool_or(const nlohmann::json& json, const std::string& key, bool otherwise,
                            const std::string& where) {
    if (json.is_object() && !json.contains(key)) return otherwise;
    const auto field = json_field(json, key, where);
    if (!field) return tl::unexpected(field.error());
    if (!(*field)->is_boolean()) {
        return input_error(std::string("must be true or false, not ") + type_name(**field),
                           json_path(where, key));
    }
    return (*field)->get<bool>();
}

Expected<std::string> json_string_or(const nlohmann::json& json, const std::string& key,
                                     const std::string& otherwise, const std::string& where) {
    return json.is_object() && !json.contains(key) ? Expected<std::string>(otherwise)
                                                   : json_string(json, key, where);
}

Expected<std::vector<double>> as_numbers(const nlohmann::json& json, std::size_t size,
                                         const std::string& where) {
    if (!json.is_array())
        return input_error(std::string("must be an array of numbers, not ") + type_name(json), where);
    if (size != 0 && json.size() != size) {
        return input_error(fmt::format("has {} entries instead of {}", json.size(), size), where);
    }
    std::vector<double> numbers;
    numbers.reserve(json.size());
    for (std::size_t i = 0; i < json.size(); ++i) {
        const auto number = as_number(json[i], json_path(where, i));
        if (!number) return tl::unexpected(number.error());
        numbers.push_back(*number);
    }
    return numbers;
}

Expected<Eigen::Vector2d> json_vector2(const nlohmann::json& json, const std::string& key,
                                       const std::string& where) {
    const auto field = json_field(json, key, where);
    if (!field) return tl::unexpected(field.error());
    const auto numbers = as_numbers(**field, 2, json_path(where, key));
    if (!numbers) return tl::unexpected(numbers.error());
    return Eigen::Vector2d((*numbers)[0], (*numbers)[1]);
}

Expected<Eigen::Vector3d> json_vector3(const nlohmann::json& json, const std::string& key,
                                       const std::string& where) {
    const auto field = json_field(json, key, where);
    if (!field) return tl::unexpected(field.error());
    const auto numbers = as_numbers(**field, 3, json_path(where, key));
    if (!numbers) return tl::unexpected(numbers.error());
    return Eigen::Vector3d((*numbers)[0], (*numbers)[1], (*numbers)[2]);
}

}  // namespace seamwright
