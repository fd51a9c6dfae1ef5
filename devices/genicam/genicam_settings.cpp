#include "devices/genicam/genicam_settings.h"

#include <fmt/format.h>

#include <cmath>

#include "devices/exchange/settings.h"

namespace seamwright {
namespace {

RangeMapping read_range(SettingsReader& r) {
    RangeMapping m;
    m.invalid = 0;
    r.number("x_scale_mm", m.x.scale_mm);
    r.number("x_offset_mm", m.x.offset_mm);
    r.number("z_scale_mm", m.z.scale_mm);
    r.number("z_offset_mm", m.z.offset_mm);
    if (r.has("invalid") && r.json().at("invalid").is_null())
        m.invalid.reset();
    else
        r.number("invalid", m.invalid);
    if (m.z.scale_mm == 0) r.keep(input_error("must not be 0", r.path("z_scale_mm")));
    return m;
}

}  // namespace

std::string GenicamSettings::camera_name() const {
    if (!address.empty()) return "camera " + address;
    if (!serial.empty()) return "camera with serial number " + serial;
    return "camera " + id;
}

const SettingTable& genicam_settings() {
    using namespace entry;
    static const SettingTable table = joined(
        {text("serial", "", "which camera; of serial, address and id one is needed, all given must fit"),
         text("address", "", "which camera, IPv4"),
         text("id", "", "which camera, as Aravis names it"),
         yes_no("hardware_trigger", false, "the robot fires the sensor: trigger is Line1 unless named"),
         list("search", nlohmann::json::array(),
              "addresses asked one by one for the serial, instead of a broadcast everywhere"),
         number("exposure_us", nullptr, 0, 1e9, "at the start; else the camera's own"),
         number("gain_db", nullptr, -1e3, 1e6, "at the start; else the camera's own"),
         number("frame_rate_hz", nullptr, 0, 1e6, "of a free camera; else its own"),
         object("region",
                {whole("x", nullptr, 0, 65535, "first column"), whole("y", nullptr, 0, 65535, "first row"),
                 whole("width", nullptr, 1, 65535, "columns"), whole("height", nullptr, 1, 65535, "rows")},
                "part of the image that is sent; else all of it, and a camera whose image begins elsewhere "
                "is refused"),
         text("pixel_format", nullptr, "by its GenICam name; else Mono8"),
         choice("channel", {"grey", "red", "green", "blue", "red-difference"},
                "of colour formats: what is made into the image"),
         text("trigger", "software", "software, free, or an input of the camera: Line1"),
         object("features", {},
                "any GenICam feature, set in the alphabet's order: number, text, true or false; null "
                "executes a command"),
         list("chunks", nlohmann::json::array(),
              "chunks to switch on; ChunkTimestamp is then the frame's device time"),
         object("range",
                {number("x_scale_mm", 1, -1e5, 1e5, "times the column"),
                 number("x_offset_mm", 0, -1e5, 1e5, "added to it"),
                 number("z_scale_mm", 1, -1e5, 1e5, "times the value"),
                 number("z_offset_mm", 0, -1e5, 1e5, "added to it"),
                 number("invalid", 0, -1e9, 1e9, "value of a column without return; null: there is none")},
                "millimetres of cameras that send profiles, unless they say them"),
         whole("packet_size", 0, 0, 65535, "bytes; 0: found out"),
         yes_no("packet_socket", false, "kernel ring instead of an UDP socket: needs CAP_NET_RAW"),
         yes_no("packet_resend", true, "lost packets are asked for again"),
         whole("packet_timeout_ms", 20, 1, 10000, "until a packet counts as lost"),
         whole("frame_retention_ms", 100, 1, 10000, "until a frame counts as damaged"),
         whole("socket_buffer", 0, 0, 1 << 30, "bytes; 0: eight frames, at most 32 MiB"),
         whole("buffers", 8, 2, 1024, "frames on the way from the wire, and as many handed out"),
         whole("timeout_ms", 1000, 1, 600000,
               "for a software trigger's frame, and for a reconnection's first answer"),
         whole("heartbeat_ms", 500, 0, 60000,
               "how often the camera is asked whether it is there; 0: Aravis' own heartbeat only")},
        reconnect(1, 100, 1000));
    return table;
}

Expected<GenicamSettings> parse_genicam_settings(const nlohmann::json& json) {
    const std::string where = "settings";
    GenicamSettings s;
    SettingsReader r(json, where, genicam_settings());
    r.text("serial", s.serial);
    r.text("address", s.address);
    r.text("id", s.id);
    r.texts("search", s.search);
    r.number("exposure_us", s.exposure_us);
    r.number("gain_db", s.gain_db);
    r.number("frame_rate_hz", s.frame_rate_hz);
    r.object("region", [&](SettingsReader& region) {
        region.whole("x", s.x);
        region.whole("y", s.y);
        region.whole("width", s.width);
        region.whole("height", s.height);
    });
    r.text("pixel_format", s.pixel_format);
    std::string channel = "grey";
    r.text("channel", channel);
    if (const auto known = image_channel(channel)) s.channel = *known;
    bool hardware = false;
    r.truth("hardware_trigger", hardware);
    r.text("trigger", s.trigger);
    if (hardware && !r.has("trigger")) s.trigger = "Line1";
    if (hardware && (s.trigger == "software" || s.trigger == "free"))
        r.keep(input_error(Text("\"{}\" contradicts hardware_trigger", s.trigger), "settings.trigger",
                           "name the camera's input, e.g. \"Line1\""));
    r.object("features", [&](SettingsReader& features) {
        s.features = features.json();
        for (const auto& [name, value] : s.features.items())
            if (value.is_structured())
                features.keep(
                    input_error("must be a number, a text, true, false or null", features.path(name)));
    });
    r.texts("chunks", s.chunks);
    r.object("range", [&](SettingsReader& range) { s.range = read_range(range); });
    r.whole("packet_size", s.packet_size);
    if (s.packet_size > 0 && s.packet_size < 200)
        r.keep(input_error("must be 0 or at least 200 bytes", "settings.packet_size"));
    r.truth("packet_socket", s.packet_socket);
    r.truth("packet_resend", s.packet_resend);
    r.duration("packet_timeout_ms", s.packet_timeout);
    r.duration("frame_retention_ms", s.frame_retention);
    r.whole("socket_buffer", s.socket_buffer);
    r.whole("buffers", s.buffers);
    r.duration("timeout_ms", s.timeout);
    r.duration("reconnect_ms", s.reconnect);
    r.duration("reconnect_most_ms", s.reconnect_most);
    r.duration("heartbeat_ms", s.heartbeat);
    if (!r.failed() && s.serial.empty() && s.address.empty() && s.id.empty())
        return input_error("no camera is named", where, "give \"serial\", \"address\" or \"id\"");
    if (r.failed()) return tl::unexpected(r.error());
    return s;
}

}  // namespace seamwright
