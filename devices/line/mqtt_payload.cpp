#include <fmt/format.h>

#include <cmath>

#include "devices/exchange/json_fields.h"
#include "devices/line/mqtt.h"

namespace seamwright {
namespace {

using nlohmann::json;

json triple(const Eigen::Vector3d& v) {
    json list = json::array();
    for (int k = 0; k < 3; ++k) list.push_back(std::isfinite(v[k]) ? json(v[k]) : json());
    return list;
}

// A whole number within its type.
template <class Whole>
Expected<void> read_whole(const json& object, const char* key, Whole& value) {
    SEAM_TRY(const double number, json_number_or(object, key, 0, ""));
    if (number < 0 || number > static_cast<double>(std::numeric_limits<Whole>::max()) ||
        number != std::floor(number))
        return input_error(Text("must be a whole number from 0 to {}", std::numeric_limits<Whole>::max()),
                           key);
    value = static_cast<Whole>(number);
    return {};
}

}  // namespace

std::string topic_level(std::string_view text) {
    std::string level;
    for (const char c : text) {
        const bool bad = c == '/' || c == '+' || c == '#' || c == '$' ||
                         static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e;
        level += bad ? '_' : c;
    }
    return level.empty() ? "_" : level.substr(0, 64);
}

std::string mqtt_topic(const std::string& group, std::string_view kind, const std::string& node) {
    return fmt::format("seamwright/{}/{}/{}", topic_level(group), kind, topic_level(node));
}

json mqtt_state(const LineState& s) {
    return {{"version", kMqttVersion},
            {"online", true},
            {"utc", s.utc},
            {"state", s.busy    ? "busy"
                      : s.ready ? "ready"
                                : "not_ready"},
            {"part", s.part_id},
            {"parts", s.parts},
            {"alarm", static_cast<int>(s.alarm)},
            {"text", s.text}};
}

json mqtt_result(const LineState& s) {
    json regions = json::array();
    for (const LineRegion& r : s.regions) {
        json one = {{"id", r.id}, {"passed", r.passed}, {"refusal", r.refusal}};
        one["shift_mm"] = r.solved ? triple(r.xyz_mm) : json();
        one["shift_abc_deg"] = r.solved ? triple(r.abc_deg) : json();
        one["sigma_mm"] = r.solved ? triple(r.sigma_xyz_mm) : json();
        one["sigma_abc_deg"] = r.solved ? triple(r.sigma_abc_deg) : json();
        regions.push_back(std::move(one));
    }
    return {{"version", kMqttVersion},
            {"utc", s.utc},
            {"part", s.part_id},
            {"part_type", s.part.type},
            {"paint", s.part.paint},
            {"part_number", s.part.number},
            {"part_name", s.part.name},
            {"run", s.run},
            {"result", to_string(s.result)},
            {"alarm", static_cast<int>(s.alarm)},
            {"seconds", s.seconds},
            {"text", s.text},
            {"regions", std::move(regions)}};
}

Expected<MqttCommand> read_mqtt_command(std::string_view payload) {
    if (payload.size() > 4096) return input_error("a command of over 4096 bytes");
    SEAM_TRY(const json object, parse_json(payload, ""));
    SEAM_OK(only_fields(object, {"id", "start", "part_type", "paint", "part_number", "part_name"}, ""));
    MqttCommand command;
    SEAM_TRY(command.id, json_string(object, "id", ""));
    if (command.id.empty() || command.id.size() > 64) return input_error("must have 1 to 64 signs", "id");
    if (object.contains("start")) {
        SEAM_TRY(const bool start, json_bool_or(object, "start", false, ""));
        command.start = start;
    }
    SEAM_OK(read_whole(object, "part_type", command.part.type));
    SEAM_OK(read_whole(object, "paint", command.part.paint));
    SEAM_OK(read_whole(object, "part_number", command.part.number));
    SEAM_TRY(const std::string name, json_string_or(object, "part_name", "", ""));
    command.part.name = line_name(name);
    return command;
}

}  // namespace seamwright
