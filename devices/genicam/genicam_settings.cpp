#include "devices/genicam/genicam_settings.h"

#include <fmt/format.h>

#include <cmath>

#include "devices/exchange/json_fields.h"

namespace seamwright {
namespace {

// Reads fields one after another and keeps the first Error.
class Reader {
  public:
    Reader(const nlohmann::json& json, std::string where) : json_(json), where_(std::move(where)) {}
    void fail(Error error) {
        if (!error_) error_ = std::move(error);
    }
    template <class Value>
    bool keep(const Expected<Value>& value) {
        if (!value) fail(value.error());
        return value && !error_;
    }
    bool has(const char* key) const { return !error_ && json_.contains(key); }
    double number(const char* key, double otherwise, double low, double high, bool whole) {
        if (error_) return otherwise;
        const auto value = json_number_or(json_, key, otherwise, where_);
        if (!keep(value)) return otherwise;
        if (!(*value >= low && *value <= high)) {
            fail(input_error(Text("{} is out of range {} to {}", *value, low, high),
                             json_path(where_, key))
                     .value());
            return otherwise;
        }
        if (whole && *value != std::floor(*value)) {
            fail(input_error("must be a whole number", json_path(where_, key)).value());
            return otherwise;
        }
        return *value;
    }
    void optional(const char* key, std::optional<double>& to, double low, double high) {
        if (has(key)) to = number(key, 0, low, high, false);
    }
    void optional(const char* key, std::optional<int>& to, double low, double high) {
        if (has(key)) to = static_cast<int>(number(key, 0, low, high, true));
    }
    int whole(const char* key, int otherwise, int low, int high) {
        return static_cast<int>(number(key, otherwise, low, high, true));
    }
    void milliseconds(const char* key, std::chrono::milliseconds& to, int low, int high) {
        to = std::chrono::milliseconds(whole(key, static_cast<int>(to.count()), low, high));
    }
    void truth(const char* key, bool& to) {
        if (error_) return;
        if (const auto value = json_bool_or(json_, key, to, where_); keep(value)) to = *value;
    }
    void text(const char* key, std::string& to) {
        if (error_) return;
        if (const auto value = json_string_or(json_, key, to, where_); keep(value)) to = *value;
    }
    void texts(const char* key, std::vector<std::string>& to) {
        if (!has(key)) return;
        const auto array = json_array(json_, key, where_);
        if (!keep(array)) return;
        for (const nlohmann::json& entry : **array) {
            if (!entry.is_string())
                return fail(input_error("must hold texts", json_path(where_, key)).value());
            to.push_back(entry.get<std::string>());
        }
    }
    const nlohmann::json& json() const { return json_; }
    const std::optional<Error>& error() const { return error_; }

  private:
    const nlohmann::json& json_;
    std::string where_;
    std::optional<Error> error_;
};

void read_range(Reader& outer, const nlohmann::json& json, GenicamSettings& s) {
    const std::string where = "settings.range";
    if (!outer.keep(
            only_fields(json, {"x_scale_mm", "x_offset_mm", "z_scale_mm", "z_offset_mm", "invalid"}, where)))
        return;
    RangeMapping m;
    m.invalid = 0;
    Reader r(json, where);
    m.x.scale_mm = r.number("x_scale_mm", 1, -1e5, 1e5, false);
    m.x.offset_mm = r.number("x_offset_mm", 0, -1e5, 1e5, false);
    m.z.scale_mm = r.number("z_scale_mm", 1, -1e5, 1e5, false);
    m.z.offset_mm = r.number("z_offset_mm", 0, -1e5, 1e5, false);
    if (json.contains("invalid")) {
        if (json.at("invalid").is_null())
            m.invalid.reset();
        else
            m.invalid = r.number("invalid", 0, -1e9, 1e9, false);
    }
    if (m.z.scale_mm == 0) r.fail(input_error("must not be 0", where + ".z_scale_mm").value());
    if (r.error()) return outer.fail(*r.error());
    s.range = m;
}

}  // namespace

std::string GenicamSettings::camera_name() const {
    if (!address.empty()) return "camera " + address;
    if (!serial.empty()) return "camera with serial number " + serial;
    return "camera " + id;
}

Expected<GenicamSettings> parse_genicam_settings(const nlohmann::json& json) {
    const std::string where = "settings";
    GenicamSettings s;
    Reader r(json, where);
    r.keep(only_fields(json,
                       {"serial",
                        "address",
                        "id",
                        "search",
                        "exposure_us",
                        "gain_db",
                        "frame_rate_hz",
                        "region",
                        "pixel_format",
                        "channel",
                        "trigger",
                        "hardware_trigger",
                        "features",
                        "chunks",
                        "range",
                        "packet_size",
                        "packet_socket",
                        "packet_resend",
                        "packet_timeout_ms",
                        "frame_retention_ms",
                        "socket_buffer",
                        "buffers",
                        "timeout_ms",
                        "reconnect_ms",
                        "reconnect_most_ms",
                        "heartbeat_ms"},
                       where));
    r.text("serial", s.serial);
    r.text("address", s.address);
    r.text("id", s.id);
    r.texts("search", s.search);
    r.optional("exposure_us", s.exposure_us, 0, 1e9);
    r.optional("gain_db", s.gain_db, -1e3, 1e6);
    r.optional("frame_rate_hz", s.frame_rate_hz, 0, 1e6);
    if (r.has("region") &&
        r.keep(only_fields(json.at("region"), {"x", "y", "width", "height"}, "settings.region"))) {
        Reader region(json.at("region"), "settings.region");
        region.optional("x", s.x, 0, 65535);
        region.optional("y", s.y, 0, 65535);
        region.optional("width", s.width, 1, 65535);
        region.optional("height", s.height, 1, 65535);
        if (region.error()) r.fail(*region.error());
    }
    r.text("pixel_format", s.pixel_format);
    std::string channel = "grey";
    r.text("channel", channel);
    if (const auto known = image_channel(channel))
        s.channel = *known;
    else
        r.fail(input_error(Text("\"{}\" is no channel", channel), "settings.channel",
                           "give grey, red, green, blue or red-difference")
                   .value());
    bool hardware = false;
    r.truth("hardware_trigger", hardware);
    if (hardware) s.trigger = "Line1";
    r.text("trigger", s.trigger);
    if (hardware && (s.trigger == "software" || s.trigger == "free"))
        r.fail(input_error(Text("\"{}\" contradicts hardware_trigger", s.trigger), "settings.trigger",
                           "name the camera's input, e.g. \"Line1\"")
                   .value());
    if (r.has("features")) {
        if (r.keep(only_fields(json.at("features"), {}, "settings.features")))
            s.features = json.at("features");
        for (const auto& [name, value] : s.features.items()) {
            if (value.is_structured())
                r.fail(
                    input_error("must be a number, a text, true, false or null", "settings.features." + name)
                        .value());
        }
    }
    r.texts("chunks", s.chunks);
    if (r.has("range")) read_range(r, json.at("range"), s);
    s.packet_size = r.whole("packet_size", 0, 0, 65535);
    if (s.packet_size > 0 && s.packet_size < 200)
        r.fail(input_error("must be 0 or at least 200 bytes", "settings.packet_size").value());
    r.truth("packet_socket", s.packet_socket);
    r.truth("packet_resend", s.packet_resend);
    r.milliseconds("packet_timeout_ms", s.packet_timeout, 1, 10000);
    r.milliseconds("frame_retention_ms", s.frame_retention, 1, 10000);
    s.socket_buffer = static_cast<std::size_t>(r.whole("socket_buffer", 0, 0, 1 << 30));
    s.buffers = r.whole("buffers", 8, 2, 1024);
    r.milliseconds("timeout_ms", s.timeout, 1, 600000);
    r.milliseconds("reconnect_ms", s.reconnect, 1, 600000);
    r.milliseconds("reconnect_most_ms", s.reconnect_most, 1, 600000);
    r.milliseconds("heartbeat_ms", s.heartbeat, 0, 60000);
    if (!r.error() && s.serial.empty() && s.address.empty() && s.id.empty())
        return input_error("no camera is named", where, "give \"serial\", \"address\" or \"id\"");
    if (r.error()) return tl::unexpected(*r.error());
    return s;
}

}  // namespace seamwright
