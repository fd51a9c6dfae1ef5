#pragma once
// Files as text and JSON: size-limited reading, atomic writing, JSON fields with a path in every Error.

#include <array>
#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace seamwright {

inline constexpr std::size_t kTextFileLimit = std::size_t{256} << 20;  // bytes

// Whole file. Error (file): missing, a folder, unreadable, longer than `limit_bytes`. Devices and pipes are
// read up to the limit. Text is handed over as it is, bytes beyond ASCII included.
Expected<std::string> read_text_file(const std::filesystem::path& path,
                                     std::size_t limit_bytes = kTextFileLimit);

// All or nothing: written beside `path`, flushed to disk and renamed over it, so that a crash leaves either
// the old file or the new one. A link is replaced by a file. Error (file) when the folder is missing or not
// writable.
Expected<void> write_text_file(const std::filesystem::path& path, std::string_view text);

// Strict JSON. Error (input) with line and column: syntax, comments, a key given twice in one object, numbers
// beyond double, nesting deeper than 64, bytes that are no UTF-8. A UTF-8 byte order mark is skipped. `where`
// names the file.
Expected<nlohmann::json> parse_json(std::string_view text, const std::string& where);
Expected<nlohmann::json> read_json_file(const std::filesystem::path& path,
                                        std::size_t limit_bytes = kTextFileLimit);

// Fields of a JSON object. `where` is the path of `json` itself ("spots[3]"); errors append the field
// ("spots[3].id"). All numbers must be finite.
//
// Refuses what is no object and, when `known` is not empty, any key outside `known` (a misspelt key would
// silently mean its default otherwise).
Expected<void> json_object(const nlohmann::json& json, std::initializer_list<std::string_view> known,
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
// An array of exactly `size` numbers (0 = any length) at `json` itself.
Expected<std::vector<double>> json_numbers(const nlohmann::json& json, std::size_t size,
                                           const std::string& where);
// "spots[3]" + "id" -> "spots[3].id"; "" + "id" -> "id".
std::string json_path(const std::string& where, const std::string& key);
std::string json_path(const std::string& where, std::size_t index);

}  // namespace seamwright
