#pragma once
// MQTT 3.1.1 by libmosquitto, JSON payloads, QoS 1. Topics after Sparkplug's pattern (namespace, group, kind, node):
//
//   seamwright/GROUP/STATE/NODE  retained: what the station does; {"online":false} is its last will
//   seamwright/GROUP/NDATA/NODE  retained: a part's result, one message a part
//   seamwright/GROUP/NCMD/NODE   to the station: {"id":"7","start":true,"part_type":1,"paint":3,"part_number":815,"part_name":"CAR"}
//
// NCMD. "id" is the sender's and another one each time: the same one again is a repetition of QoS 1 and does nothing.
// Retained commands are not obeyed. "start" true calls for the part (setting start: line), false gives it up; without
// "start" the part is announced for the robot's next call, and for that one alone. What is no such object is told and dropped.
//
// While the broker is away results wait in a queue of `queue` messages, the oldest go first when it is full, which is
// told. A result may come twice after an outage; "run" says so. Of the state only the newest is sent.

#include "devices/line/line_link.h"

namespace seamwright {

inline constexpr int kMqttVersion = 1;  // of the payloads

std::string mqtt_topic(const std::string& group, std::string_view kind, const std::string& node);
// What may stand in a topic's level: '/', '+', '#' and what is not printable become '_'.
std::string topic_level(std::string_view text);
nlohmann::json mqtt_state(const LineState& state);
nlohmann::json mqtt_result(const LineState& state);

struct MqttCommand {
    std::string id;
    std::optional<bool> start;
    LinePart part;
};
Expected<MqttCommand> read_mqtt_command(std::string_view payload);

Expected<std::unique_ptr<LineLink>> open_mqtt(const nlohmann::json& settings, const std::string& name);
const SettingTable& mqtt_settings();

}  // namespace seamwright
