#include <fmt/format.h>

#include <algorithm>

#include "devices/line/modbus_station.h"
#include "devices/line/mqtt.h"

namespace seamwright {

const std::vector<LineProtocol>& line_protocols() {
    static const std::vector<LineProtocol> protocols = {
        {"modbus-server", "Modbus TCP, the PLC connects", &open_modbus_server, &modbus_server_settings},
        {"modbus-client", "Modbus TCP, the PLC is polled", &open_modbus_client, &modbus_client_settings},
        {"mqtt", "MQTT 3.1.1, JSON over a broker", &open_mqtt, &mqtt_settings},
    };
    return protocols;
}

const LineProtocol* line_protocol(std::string_view name) {
    const auto& all = line_protocols();
    const auto found = std::find_if(all.begin(), all.end(), [&](const auto& p) { return p.name == name; });
    return found == all.end() ? nullptr : &*found;
}

Expected<std::unique_ptr<LineLink>> open_line(const std::string& protocol, const nlohmann::json& settings,
                                              const std::string& name) {
    if (const LineProtocol* p = line_protocol(protocol)) return p->open(settings, name);
    std::string known;
    for (const LineProtocol& p : line_protocols()) known += (known.empty() ? "" : ", ") + std::string(p.name);
    return input_error(Text("there is no protocol \"{}\" of a line", protocol), {},
                       Text("known are {}", known));
}

const std::vector<LineCode>& line_results() {
    static const std::vector<LineCode> codes = {
        {0, "none", "there was no part yet"},
        {1, "corrected", "pushed; the application runs in the corrected frames"},
        {2, "measured",
         "a dry run, or the drift watch's reference; every region is within its limits, nothing was written"},
        {3, "refused", "the gate refused a region, or it could not be solved; the frames are as they were"},
        {4, "not_taken", "pushed, but the application did not begin; the old frames stand again"},
        {5, "alarm", "a push went wrong; look at the station before the robot moves"},
        {6, "device", "a sensor or robot failed; nothing was pushed"},
        {7, "cancelled", "ended by a person; nothing was pushed"},
        {8, "not_measured", "the call was not followed; the alarm says why"},
    };
    return codes;
}

const std::vector<LineCode>& line_alarms() {
    static const std::vector<LineCode> codes = {
        {0, "none", "all is well"},
        {1, "station_starts", "the devices have not all answered yet"},
        {10, "device_lost", "a sensor or robot is lost; told until all answer again"},
        {11, "device_silent", "the same: nothing came from it in time"},
        {12, "device_disconnected", "the same: it closed the connection"},
        {13, "device_in_use", "the same: another program holds it"},
        {20, "refused", "the last part was refused by the gate"},
        {21, "not_taken", "the application did not begin on the last part"},
        {22, "push_failed", "the last push went wrong"},
        {23, "device_failed", "a device failed while the last part was measured"},
        {24, "cancelled", "the last part was cancelled"},
        {30, "call_not_followed", "the station could not follow a start in call_timeout_ms"},
        {31, "call_too_old", "a call may be older than --start-expiry, or a newer one came; call again"},
        {32, "part_type_unknown",
         "the part's type is none of those that the station is set up for; where it is set up for none, "
         "part_type is passed over"},
        {33, "start_not_dropped", "start is still 1, drop_timeout_ms after done"},
        {34, "line_silent", "line_heartbeat stands still"},
    };
    return codes;
}

namespace {
std::string_view name_of_code(const std::vector<LineCode>& codes, int number) {
    for (const LineCode& code : codes)
        if (code.number == number) return code.name;
    return codes.front().name;
}
}  // namespace

std::string_view to_string(LineResult result) {
    return name_of_code(line_results(), static_cast<int>(result));
}

std::string LinePart::id() const {
    if (!name.empty()) return name;
    return number ? std::to_string(number) : std::string();
}

std::string line_name(std::string_view bytes) {
    std::string name;
    for (const char c : bytes.substr(0, kLongestLineName)) name += c < 0x20 || c > 0x7e ? '_' : c;
    while (!name.empty() && name.back() == ' ') name.pop_back();
    return name;
}

}  // namespace seamwright
