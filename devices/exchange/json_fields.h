#pragma once
// Fields of a JSON document, read strictly: every Error names the path ("spots[3].sigma_mm"), what stands there and what
// should. Absent optional fields answer the fallback; a field of the wrong type is never ignored.

#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.h"

namespace seamwright {

inline std::string json_path(const std::string& parent, const std::string& key) {
    return parent.empty() ? key : parent + "." + key;
}
inline std::string json_path(const std::string& parent, std::size_t index) {
    return fmt::format("{}[{}]", parent, index);
}

// Parses a whole document. The Error tells the byte position.
inline Expected<nlohmann::json> parse_json(const std::string& text, const std::string& where) {
    try {
        return nlohmann::json::parse(text);
    } catch (const nlohmann::json::parse_error& e) {
        return input_error(fmt::format("this is not JSON (stopped at byte {})", e.byte), where,
                           "check for missing commas, quotes or brackets");
    }
}

inline Expected<const nlohmann::json*> json_field(const nlohmann::json& object, const std::string& key,
                                                  const std::string& path) {
    if (!object.is_object())
        return input_error(fmt::format("an object was expected, this is {}", object.type_name()), path);
    auto it = object.find(key);
    if (it == object.end()) return input_error("the field is missing", json_path(path, key));
    return &*it;
}

inline Expected<double> as_number(const nlohmann::json& value, const std::string& path) {
    if (!value.is_number())
        return input_error(fmt::format("a number was expected, this is {}", value.type_name()), path);
    const double number = value.get<double>();
    if (!std::isfinite(number)) return input_error("the number is not finite", path);
    return number;
}

inline Expected<double> json_number(const nlohmann::json& object, const std::string& key, const std::string& path) {
    auto field = json_field(object, key, path);
    if (!field) return tl::unexpected(field.error());
    return as_number(**field, json_path(path, key));
}

inline Expected<double> json_number_or(const nlohmann::json& object, const std::string& key, double fallback,
                                       const std::string& path) {
    if (object.is_object() && !object.contains(key)) return fallback;
    return json_number(object, key, path);
}

inline Expected<std::string> json_string(const nlohmann::json& object, const std::string& key,
                                         const std::string& path) {
    auto field = json_field(object, key, path);
    if (!field) return tl::unexpected(field.error());
    if (!(*field)->is_string())
        return input_error(fmt::format("a text was expected, this is {}", (*field)->type_name()),
                           json_path(path, key));
    return (*field)->get<std::string>();
}

inline Expected<const nlohmann::json*> json_array(const nlohmann::json& object, const std::string& key,
                                                  const std::string& path) {
    auto field = json_field(object, key, path);
    if (!field) return tl::unexpected(field.error());
    if (!(*field)->is_array())
        return input_error(fmt::format("a list was expected, this is {}", (*field)->type_name()),
                           json_path(path, key));
    return *field;
}

// Exactly `count` finite numbers; count 0 = any number of them.
inline Expected<std::vector<double>> as_numbers(const nlohmann::json& value, std::size_t count,
                                                const std::string& path) {
    if (!value.is_array())
        return input_error(fmt::format("a list of numbers was expected, this is {}", value.type_name()), path);
    if (count && value.size() != count)
        return input_error(fmt::format("{} numbers were expected, there are {}", count, value.size()), path);
    std::vector<double> numbers;
    numbers.reserve(value.size());
    for (std::size_t i = 0; i < value.size(); ++i) {
        auto number = as_number(value[i], json_path(path, i));
        if (!number) return tl::unexpected(number.error());
        numbers.push_back(*number);
    }
    return numbers;
}

inline Expected<Eigen::Vector3d> json_vector3(const nlohmann::json& object, const std::string& key,
                                              const std::string& path) {
    auto field = json_field(object, key, path);
    if (!field) return tl::unexpected(field.error());
    auto n = as_numbers(**field, 3, json_path(path, key));
    if (!n) return tl::unexpected(n.error());
    return Eigen::Vector3d((*n)[0], (*n)[1], (*n)[2]);
}

inline Expected<Eigen::Vector2d> json_vector2(const nlohmann::json& object, const std::string& key,
                                              const std::string& path) {
    auto field = json_field(object, key, path);
    if (!field) return tl::unexpected(field.error());
    auto n = as_numbers(**field, 2, json_path(path, key));
    if (!n) return tl::unexpected(n.error());
    return Eigen::Vector2d((*n)[0], (*n)[1]);
}

// Refuses misspelt fields, which would otherwise be silently ignored.
inline Expected<void> only_fields(const nlohmann::json& object, std::initializer_list<const char*> known,
                                  const std::string& path) {
    if (!object.is_object())
        return input_error(fmt::format("an object was expected, this is {}", object.type_name()), path);
    for (const auto& item : object.items()) {
        bool found = false;
        std::string list;
        for (const char* k : known) {
            found = found || item.key() == k;
            list += (list.empty() ? "" : ", ") + std::string(k);
        }
        if (!found) return input_error("unknown field", json_path(path, item.key()), "known are: " + list);
    }
    return {};
}

}  // namespace seamwright
