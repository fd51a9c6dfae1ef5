#pragma once
// Settings of devices: a JSON object of optional fields, described once. The same table refuses what is wrong,
// fills in what is left out, and is what `seamwright devices --help DRIVER` and devices/SETTINGS.md show.

#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"

namespace seamwright {

enum class SettingKind {
    number,
    whole,  // a number without fraction
    text,
    choice,  // one of `choices`
    yes_no,
    pose,  // pose_json.h
    list,
    object  // of `fields`; without them, of names that are the user's
};
std::string_view to_string(SettingKind kind);

// The unit is the end of the name: "timeout_ms".
struct SettingInfo {
    std::string name;
    SettingKind kind = SettingKind::text;
    nlohmann::json otherwise;  // what an absent one means; null: nothing, or what `help` says
    double low = 0, high = 0;  // of number and whole, both included
    std::string help;          // one sentence or less, in English
    std::vector<std::string> choices = {};
    std::vector<SettingInfo> fields = {};
    std::string former = {};  // older name, still read
};
using SettingTable = std::vector<SettingInfo>;

// For the tables.
namespace entry {
SettingInfo number(std::string name, nlohmann::json otherwise, double low, double high, std::string help);
SettingInfo whole(std::string name, nlohmann::json otherwise, double low, double high, std::string help);
SettingInfo text(std::string name, nlohmann::json otherwise, std::string help);
// The first is what an absent one means.
SettingInfo choice(std::string name, std::vector<std::string> choices, std::string help);
SettingInfo yes_no(std::string name, bool otherwise, std::string help);
SettingInfo pose(std::string name, std::string help);
SettingInfo list(std::string name, nlohmann::json otherwise, std::string help);
SettingInfo object(std::string name, std::vector<SettingInfo> fields, std::string help);
SettingInfo formerly(std::string former, SettingInfo info);
SettingTable joined(SettingTable first, const SettingTable& second);
// Back-off of a client that connects, doubling: reconnect_ms, reconnect_most_ms, from `least_ms` on.
SettingTable reconnect(int least_ms, int first_ms, int most_ms, const std::string& former = {},
                       const std::string& former_most = {});
}  // namespace entry

// The table for people: "name  default  range or choices  help", a line each, fields of objects indented.
std::string settings_text(const SettingTable& table);

// Everything at once that a reader of the table would refuse, field by field; what only the driver can know is not
// asked.
Expected<void> check_settings(const nlohmann::json& json, const std::string& where,
                              const SettingTable& table);

// What a reader does with names that its table does not hold.
enum class UnknownSettings { refused, passed_over };

// Reads fields one after another and keeps the first Error. With a table: refuses names that it does not hold,
// wrong kinds and numbers out of range; what is absent is set to the table's default, where that is null the
// value keeps its own (asserted: the table has the name). Without: only() and the ranges stand in the calls.
class SettingsReader {
  public:
    SettingsReader(const nlohmann::json& json, std::string where) : json_(json), where_(std::move(where)) {}
    SettingsReader(const nlohmann::json& json, std::string where, const SettingTable& table,
                   UnknownSettings unknown = UnknownSettings::refused);

    void number(const char* key, double& value);
    void number(const char* key, std::optional<double>& value);
    template <class Integer>
    void whole(const char* key, Integer& value) {
        auto number_value = static_cast<double>(value);
        number(key, number_value);
        if (!failed()) value = static_cast<Integer>(number_value);
    }
    void whole(const char* key, std::optional<int>& value);
    template <class Duration>
    void duration(const char* key, Duration& value) {
        auto count = value.count();
        whole(key, count);
        value = Duration(count);
    }
    void truth(const char* key, bool& value);
    void text(const char* key, std::string& value);  // text and choice
    void texts(const char* key, std::vector<std::string>& value);
    void pose(const char* key, Pose& value);
    // Poses by names of the user's.
    template <class Map>
    void poses(const char* key, Map& value) {
        object(key, [&](SettingsReader& inner) {
            for (const auto& [name, unused] : inner.json().items()) inner.pose(name.c_str(), value[name]);
        });
    }
    template <class Read>
    void object(const char* key, const Read& read) {
        if (!has(key)) return;
        const SettingInfo* s = info(key);
        SettingsReader inner = s && !s->fields.empty() ? SettingsReader(json_.at(key), path(key), s->fields)
                                                       : SettingsReader(json_.at(key), path(key));
        inner.keep(only_fields(json_.at(key), {}, path(key)));
        if (!inner.failed()) read(inner);
        if (inner.failed() && !failed()) error_ = inner.error_;
    }

    void only(std::initializer_list<std::string_view> known) { keep(only_fields(json_, known, where_)); }
    void number(const char* key, double& value, double low, double high);
    template <class Integer>
    void whole(const char* key, Integer& value, double low, double high) {
        auto number_value = static_cast<double>(value);
        number(key, number_value, low, high);
        if (!failed() && number_value != std::floor(number_value))
            keep(input_error("must be a whole number", path(key)));
        if (!failed()) value = static_cast<Integer>(number_value);
    }

    bool has(const char* key) const { return !failed() && json_.is_object() && json_.contains(key); }
    const nlohmann::json& json() const { return json_; }  // former names renamed
    std::string path(const std::string& key) const { return json_path(where_, key); }
    void keep(const Expected<void>& result) {
        if (!result && !error_) error_ = result.error();
    }
    bool failed() const { return error_.has_value(); }
    const Error& error() const { return *error_; }

  private:
    const SettingInfo* info(std::string_view key) const;  // nullptr: without a table

    nlohmann::json json_;
    std::string where_;
    const SettingTable* table_ = nullptr;
    std::optional<Error> error_;
};

}  // namespace seamwright
