#include "devices/exchange/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace seamwright {
namespace {

std::string shown_default(const SettingInfo& s) {
    if (s.otherwise.is_null()) return s.kind == SettingKind::pose ? "identity" : "-";
    return s.otherwise.dump();
}

std::string shown_range(const SettingInfo& s) {
    switch (s.kind) {
        case SettingKind::number:
        case SettingKind::whole:
            return fmt::format("{:.10g} to {:.10g}", s.low, s.high);
        case SettingKind::choice:
            return fmt::format("{}", fmt::join(s.choices, " | "));
        default:
            return std::string(to_string(s.kind));
    }
}

void append(std::string& text, const SettingTable& table, const std::string& indent, std::size_t wide) {
    for (const SettingInfo& s : table) {
        text += fmt::format("{:<{}}  {:<12}  {:<24}  {}{}\n", indent + s.name, wide, shown_default(s),
                            shown_range(s), s.help,
                            s.former.empty() ? "" : fmt::format(" (formerly {})", s.former));
        append(text, s.fields, indent + "  ", wide);
    }
}

std::size_t widest(const SettingTable& table, std::size_t indent) {
    std::size_t most = 0;
    for (const SettingInfo& s : table)
        most = std::max({most, s.name.size() + indent, widest(s.fields, indent + 2)});
    return most;
}

}  // namespace

std::string_view to_string(SettingKind kind) {
    constexpr std::array<std::string_view, 8> names{"number",       "whole number", "text", "choice",
                                                    "true | false", "pose",         "list", "object"};
    return names[static_cast<std::size_t>(kind)];
}

namespace entry {

SettingInfo number(std::string name, nlohmann::json otherwise, double low, double high, std::string help) {
    return {std::move(name), SettingKind::number, std::move(otherwise), low, high, std::move(help)};
}
SettingInfo whole(std::string name, nlohmann::json otherwise, double low, double high, std::string help) {
    return {std::move(name), SettingKind::whole, std::move(otherwise), low, high, std::move(help)};
}
SettingInfo text(std::string name, nlohmann::json otherwise, std::string help) {
    return {std::move(name), SettingKind::text, std::move(otherwise), 0, 0, std::move(help)};
}
SettingInfo choice(std::string name, std::vector<std::string> choices, std::string help) {
    nlohmann::json first = choices.front();
    return {std::move(name), SettingKind::choice, std::move(first), 0, 0,
            std::move(help), std::move(choices)};
}
SettingInfo yes_no(std::string name, bool otherwise, std::string help) {
    return {std::move(name), SettingKind::yes_no, otherwise, 0, 0, std::move(help)};
}
SettingInfo pose(std::string name, std::string help) {
    return {std::move(name), SettingKind::pose, nullptr, 0, 0, std::move(help)};
}
SettingInfo list(std::string name, nlohmann::json otherwise, std::string help) {
    return {std::move(name), SettingKind::list, std::move(otherwise), 0, 0, std::move(help)};
}
SettingInfo object(std::string name, std::vector<SettingInfo> fields, std::string help) {
    return {std::move(name), SettingKind::object, nullptr, 0, 0, std::move(help), {}, std::move(fields)};
}
SettingInfo formerly(std::string former, SettingInfo info) {
    info.former = std::move(former);
    return info;
}
SettingTable joined(SettingTable first, const SettingTable& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
}
SettingTable reconnect(int least_ms, int first_ms, int most_ms, const std::string& former,
                       const std::string& former_most) {
    return {formerly(former, whole("reconnect_ms", first_ms, least_ms, 600000,
                                   "after a lost connection, until the first attempt to connect; doubled by "
                                   "every further one")),
            formerly(former_most, whole("reconnect_most_ms", most_ms, least_ms, 600000,
                                        "most between two attempts to connect"))};
}

}  // namespace entry

std::string settings_text(const SettingTable& table) {
    std::string text;
    append(text, table, "", widest(table, 0));
    return text;
}

SettingsReader::SettingsReader(const nlohmann::json& json, std::string where, const SettingTable& table,
                               UnknownSettings unknown)
    : json_(json), where_(std::move(where)), table_(&table) {
    keep(only_fields(json_, {}, where_));
    if (failed()) return;
    std::vector<std::string_view> known;
    for (const SettingInfo& s : table) {
        known.push_back(s.name);
        if (s.former.empty() || !json_.contains(s.former)) continue;
        if (json_.contains(s.name)) {
            keep(input_error(Text("{} is given under its former name too", s.name), path(s.former),
                             "give one of them"));
            return;
        }
        json_[s.name] = json_[s.former];
        json_.erase(s.former);
    }
    if (unknown == UnknownSettings::refused) keep(only_fields(json_, known, where_));
}

const SettingInfo* SettingsReader::info(std::string_view key) const {
    if (!table_) return nullptr;
    const auto found =
        std::find_if(table_->begin(), table_->end(), [&](const SettingInfo& s) { return s.name == key; });
    assert(found != table_->end());
    return &*found;
}

void SettingsReader::number(const char* key, double& value) {
    if (failed()) return;
    const SettingInfo& s = *info(key);
    if (!has(key)) {
        if (s.otherwise.is_number()) value = s.otherwise.get<double>();
        return;
    }
    double read = 0;
    number(key, read, s.low, s.high);
    if (!failed() && s.kind == SettingKind::whole && read != std::floor(read))
        keep(input_error("must be a whole number", path(key)));
    if (!failed()) value = read;
}

void SettingsReader::number(const char* key, double& value, double low, double high) {
    if (!has(key)) return;
    const auto read = json_number(json_, key, where_);
    if (!read) return keep(tl::make_unexpected(read.error()));
    if (!(*read >= low && *read <= high))
        return keep(input_error(Text("{} is out of range {} to {}", *read, low, high), path(key)));
    value = *read;
}

void SettingsReader::number(const char* key, std::optional<double>& value) {
    double read = 0;
    if (!has(key)) return;
    number(key, read);
    if (!failed()) value = read;
}

void SettingsReader::whole(const char* key, std::optional<int>& value) {
    double read = 0;
    if (!has(key)) return;
    number(key, read);
    if (!failed()) value = static_cast<int>(read);
}

void SettingsReader::truth(const char* key, bool& value) {
    if (failed()) return;
    if (const SettingInfo* s = info(key); s && s->otherwise.is_boolean()) value = s->otherwise.get<bool>();
    const auto read = json_bool_or(json_, key, value, where_);
    if (!read) return keep(tl::make_unexpected(read.error()));
    value = *read;
}

void SettingsReader::text(const char* key, std::string& value) {
    if (failed()) return;
    const SettingInfo* s = info(key);
    if (s && s->otherwise.is_string()) value = s->otherwise.get<std::string>();
    const auto read = json_string_or(json_, key, value, where_);
    if (!read) return keep(tl::make_unexpected(read.error()));
    if (s && s->kind == SettingKind::choice &&
        std::find(s->choices.begin(), s->choices.end(), *read) == s->choices.end())
        return keep(input_error(Text("\"{}\" is not known", *read), path(key),
                                Text("known are {}", fmt::join(s->choices, ", "))));
    value = *read;
}

void SettingsReader::texts(const char* key, std::vector<std::string>& value) {
    if (!has(key)) return;
    const auto array = json_array(json_, key, where_);
    if (!array) return keep(tl::make_unexpected(array.error()));
    for (const nlohmann::json& entry : **array) {
        if (!entry.is_string()) return keep(input_error("must hold texts", path(key)));
        value.push_back(entry.get<std::string>());
    }
}

void SettingsReader::pose(const char* key, Pose& value) {
    if (!has(key)) return;
    const auto read = parse_pose(json_.at(key), path(key));
    if (!read) return keep(tl::make_unexpected(read.error()));
    value = *read;
}

Expected<void> check_settings(const nlohmann::json& json, const std::string& where,
                              const SettingTable& table) {
    SettingsReader f(json, where, table);
    for (const SettingInfo& s : table) {
        const char* key = s.name.c_str();
        double number = 0;
        bool truth = false;
        std::string text;
        Pose pose = Pose::Identity();
        switch (s.kind) {
            case SettingKind::number:
            case SettingKind::whole:
                f.number(key, number);
                break;
            case SettingKind::text:
            case SettingKind::choice:
                f.text(key, text);
                break;
            case SettingKind::yes_no:
                f.truth(key, truth);
                break;
            case SettingKind::pose:
                f.pose(key, pose);
                break;
            case SettingKind::list:
                if (f.has(key)) f.keep(json_array(f.json(), key, where).map([](const nlohmann::json*) {}));
                break;
            case SettingKind::object:
                f.object(key, [&](SettingsReader& inner) {
                    if (!s.fields.empty()) inner.keep(check_settings(inner.json(), f.path(s.name), s.fields));
                });
                break;
        }
    }
    if (f.failed()) return tl::unexpected(f.error());
    return {};
}

}  // namespace seamwright
