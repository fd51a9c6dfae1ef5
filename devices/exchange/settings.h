#pragma once
// Settings of devices: a JSON object of optional fields.

#include <fmt/format.h>

#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"

namespace seamwright {

// Reads fields one after another into values that hold their defaults, and keeps the first Error. All fields
// are optional; numbers have a range.
class SettingsReader {
  public:
    SettingsReader(const nlohmann::json& json, std::string where) : json_(json), where_(std::move(where)) {}
    void only(std::initializer_list<std::string_view> known) { keep(only_fields(json_, known, where_)); }
    // A default stands as it is: it may say that there is none.
    void number(const char* key, double& value, double low, double high) {
        if (failed() || (json_.is_object() && !json_.contains(key))) return;
        const auto read = json_number(json_, key, where_);
        if (!read) return keep(tl::make_unexpected(read.error()));
        if (!(*read >= low && *read <= high)) {
            return keep(input_error(Text("{} is out of range {} to {}", *read, low, high),
                                    json_path(where_, key)));
        }
        value = *read;
    }
    template <class Integer>
    void whole(const char* key, Integer& value, double low, double high) {
        auto number_value = static_cast<double>(value);
        number(key, number_value, low, high);
        if (!failed() && number_value != std::floor(number_value)) {
            keep(input_error("must be a whole number", json_path(where_, key)));
        }
        if (!failed()) value = static_cast<Integer>(number_value);
    }
    void truth(const char* key, bool& value) {
        if (failed()) return;
        const auto read = json_bool_or(json_, key, value, where_);
        if (!read) return keep(tl::make_unexpected(read.error()));
        value = *read;
    }
    void text(const char* key, std::string& value) {
        if (failed()) return;
        const auto read = json_string_or(json_, key, value, where_);
        if (!read) return keep(tl::make_unexpected(read.error()));
        value = *read;
    }
    void pose(const char* key, Pose& value) {
        if (failed() || !json_.contains(key)) return;
        const auto read = parse_pose(json_.at(key), json_path(where_, key));
        if (!read) return keep(tl::make_unexpected(read.error()));
        value = *read;
    }
    template <class Read>
    void object(const char* key, Read read) {
        if (failed() || !json_.contains(key)) return;
        SettingsReader inner(json_.at(key), json_path(where_, key));
        inner.keep(only_fields(json_.at(key), {}, json_path(where_, key)));
        if (!inner.failed()) read(inner);
        if (inner.failed()) error_ = inner.error_;
    }
    const nlohmann::json& json() const { return json_; }
    std::string path(const std::string& key) const { return json_path(where_, key); }
    void keep(const Expected<void>& result) {
        if (!result && !error_) error_ = result.error();
    }
    bool failed() const { return error_.has_value(); }
    const Error& error() const { return *error_; }

  private:
    const nlohmann::json& json_;
    std::string where_;
    std::optional<Error> error_;
};

}  // namespace seamwright
