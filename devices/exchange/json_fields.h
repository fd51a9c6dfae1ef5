#pragma once
// Strict JSON and its fields; every Error carries the JSON path ("spots[3].workobject_from_sensor").

#include <Eigen/Core>
#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "devices/exchange/files.h"

namespace seamwright {

inline constexpr std::size_t kDeepestJson = 64;

// Strict JSON; whatever reads JSON from outside reads it with this one function. Error (input) with line and
// column: syntax, comments, a key given twice in one object, numbers beyond double, nesting deeper than 64
// (ends the parse: what a document of ours holds can be copied, written and destroyed by recursion), text
// beyond kTextFileLimit, bytes that are no UTF-8. A UTF-8 byte order mark is skipped. `where` names the file.
Expected<nlohmann::json> parse_json(std::string_view text, const std::string& where);
// How many objects and arrays stand in one another, none = 0; counts no further than beyond kDeepestJson.
std::size_t json_depth(const nlohmann::json& json);
Expected<nlohmann::json> read_json_file(const std::filesystem::path& path,
                                        std::size_t limit_bytes = kTextFileLimit);

// Fields of a JSON object. `where` is the path of `json` itself ("spots[3]"); errors append the field
// ("spots[3].id"). All numbers must be finite.
//
// Refuses what is no object and, when `known` is not empty, any key outside `known` (a misspelt key would
// silently mean its default otherwise).
Expected<void> only_fields(const nlohmann::json& json, std::initializer_list<std::string_view> known,
                           const std::string& where);
Expected<void> only_fields(const nlohmann::json& json, const std::vector<std::string_view>& known,
                           const std::string& where);
// The field itself (never null), of any kind, or an array; valid as long as `json` is.
Expected<const nlohmann::json*> json_field(const nlohmann::json& json, const std::string& key,
                                           const std::string& where);
Expected<const nlohmann::json*> json_array(const nlohmann::json& json, const std::string& key,
                                           const std::string& where);
Expected<double> json_number(const nlohmann::json& json, const std::string& key, const std::string& where);
Expected<std::string> json_string(const nlohmann::json& json, const std::string& key,
                                  const std::string& where);
// The optional forms answer `otherwise` when the key is absent; null or a wrong type is an Error.
Expected<double> json_number_or(const nlohmann::json& json, const std::string& key, double otherwise,
                                const std::string& where);
Expected<bool> json_bool_or(const nlohmann::json& json, const std::string& key, bool otherwise,
                            const std::string& where);
Expected<std::string> json_string_or(const nlohmann::json& json, const std::string& key,
                                     const std::string& otherwise, const std::string& where);
// `json` itself as an array of exactly `size` numbers (0 = any length), and as a number.
Expected<std::vector<double>> as_numbers(const nlohmann::json& json, std::size_t size,
                                         const std::string& where);
Expected<double> as_number(const nlohmann::json& json, const std::string& where);
Expected<Eigen::Vector2d> json_vector2(const nlohmann::json& json, const std::string& key,
                                       const std::string& where);
Expected<Eigen::Vector3d> json_vector3(const nlohmann::json& json, const std::string& key,
                                       const std::string& where);
// "spots[3]" + "id" -> "spots[3].id"; "" + "id" -> "id".
std::string json_path(const std::string& where, const std::string& key);
std::string json_path(const std::string& where, std::size_t index);

}  // namespace seamwright
