#include "devices/genicam/camera_features.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "devices/genicam/gvcp.h"
#include "devices/genicam/pixels/pixel_format.h"
#include "devices/silence.h"

namespace seamwright {
namespace {

tl::unexpected<Error> failure(ArvCamera* camera, const Text& what, const GFailure& g, const Text& mend = {}) {
    GFailure ignored;
    const char* serial = arv_camera_get_device_serial_number(camera, ignored.out());
    return device_error(g ? Text("{} ({})", what, g.text()) : what, Text("camera {}", serial ? serial : "?"),
                        mend);
}

bool has(ArvCamera* camera, const char* feature) {
    GFailure g;
    return arv_camera_is_feature_available(camera, feature, g.out()) && !g;
}

std::vector<std::string> take_names(const char** names, guint count) {
    std::vector<std::string> list(names, names + (names ? count : 0));
    g_free(names);
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    return list;
}

std::vector<std::string> offered_formats(ArvCamera* camera) {
    GFailure g;
    guint count = 0;
    const char** names = arv_camera_dup_available_pixel_formats_as_strings(camera, &count, g.out());
    return take_names(names, count);
}

std::vector<std::string> readable(const std::vector<std::string>& offered) {
    std::vector<std::string> list;
    for (const std::string& name : offered)
        if (pixel_format_by_name(name)) list.push_back(name);
    return list;
}

std::vector<std::string> triggers(ArvCamera* camera) {
    GFailure g;
    guint count = 0;
    std::vector<std::string> list{"free"};
    if (!has(camera, "TriggerSource")) return list;
    const char** names = arv_camera_dup_available_trigger_sources(camera, &count, g.out());
    for (std::string& name : take_names(names, count)) list.push_back(name == "Software" ? "software" : name);
    return list;
}

std::string present_trigger(ArvCamera* camera) {
    GFailure g;
    if (!has(camera, "TriggerMode")) return "free";
    const char* mode = arv_camera_get_string(camera, "TriggerMode", g.out());
    if (g || !mode || std::string(mode) != "On") return "free";
    const char* source = arv_camera_get_trigger_source(camera, g.out());
    return g || !source ? "free" : std::string(source) == "Software" ? "software" : source;
}

Expected<void> set_trigger(ArvCamera* camera, const std::string& trigger) {
    const auto known = triggers(camera);
    if (std::find(known.begin(), known.end(), trigger) == known.end())
        return failure(camera, Text("it has no trigger \"{}\"", trigger), {},
                       Text("it offers {}", join_names(known)));
    GFailure g;
    if (trigger == "free") {
        if (!has(camera, "TriggerMode")) return {};
        arv_camera_clear_triggers(camera, g.out());
        if (g) return failure(camera, "its triggers cannot be switched off", g);
        return {};
    }
    arv_camera_set_trigger(camera, trigger == "software" ? "Software" : trigger.c_str(), g.out());
    if (g) return failure(camera, Text("the trigger \"{}\" cannot be set", trigger), g);
    return {};
}

// The address by which this host reaches `address`.
std::string local_address_for(const std::string& address) {
    const int s = ::socket(AF_INET, SOCK_DGRAM, 0);
    if (s < 0) return {};
    sockaddr_in to{}, mine{};
    to.sin_family = AF_INET;
    to.sin_port = htons(kGvcpPort);
    socklen_t size = sizeof mine;
    char text[INET_ADDRSTRLEN] = "";
    if (::inet_pton(AF_INET, address.c_str(), &to.sin_addr) == 1 &&
        ::connect(s, reinterpret_cast<sockaddr*>(&to), sizeof to) == 0 &&
        ::getsockname(s, reinterpret_cast<sockaddr*>(&mine), &size) == 0)
        ::inet_ntop(AF_INET, &mine.sin_addr, text, sizeof text);
    ::close(s);
    return text;
}

Expected<GPtr<ArvDevice>> open_address(const std::string& address, const GenicamSettings& s) {
    GPtr<GInetAddress> there(g_inet_address_new_from_string(address.c_str()));
    if (!there || g_inet_address_get_family(there.get()) != G_SOCKET_FAMILY_IPV4)
        return input_error(Text("\"{}\" is no IPv4 address", address), "settings.address");
    SEAM_TRY(const auto camera, ask_camera(address, std::min(s.timeout, std::chrono::milliseconds(1000))));
    if (!s.serial.empty() && camera.serial != s.serial) {
        return device_error(Text("the camera there has serial number {}, not {}", camera.serial, s.serial),
                            Text("camera {}", address), "correct the serial number or the address");
    }
    GPtr<GInetAddress> here(g_inet_address_new_from_string(local_address_for(address).c_str()));
    if (!here) return device_error("no network interface leads to it", Text("camera {}", address));
    GFailure g;
    GPtr<ArvDevice> device(arv_gv_device_new(here.get(), there.get(), g.out()));
    if (g || !device)
        return device_error(Text("it cannot be opened ({})", g.text()), Text("camera {}", address));
    return device;
}

Expected<GPtr<ArvDevice>> open_device(const GenicamSettings& s) {
    if (!s.address.empty()) return open_address(s.address, s);
    std::string id = s.id, list;
    if (!s.search.empty()) {
        for (const std::string& address : s.search) {
            const auto camera = ask_camera(address, std::chrono::milliseconds(300));
            if (!camera) continue;
            if (camera->serial == s.serial) return open_address(address, s);
            list += (list.empty() ? "" : ", ") + camera->serial;
        }
    } else {
        for (const DiscoveredCamera& camera : discover_cameras()) {
            if (s.serial.empty() ? camera.id == s.id : camera.serial == s.serial) {
                if (camera.protocol == "GigEVision" && !camera.address.empty())
                    return open_address(camera.address, s);
                id = camera.id;
            }
            list += (list.empty() ? "" : ", ") + camera.serial;
        }
    }
    if (id.empty())
        return device_error(Text("there is no camera with serial number {}", s.serial), "genicam",
                            list.empty() ? Text("no camera answers: check power, cable and network")
                                         : Text("these answer: {}", list));
    GFailure g;
    GPtr<ArvDevice> device(arv_open_device(id.c_str(), g.out()));
    if (!device) return device_error(Text("it cannot be opened ({})", g.text()), Text("camera {}", id));
    return device;
}

Expected<void> set_feature(ArvCamera* camera, const std::string& name, const nlohmann::json& value) {
    if (!has(camera, name.c_str())) return failure(camera, Text("it has no feature {}", name), {});
    GFailure g;
    if (value.is_null())
        arv_camera_execute_command(camera, name.c_str(), g.out());
    else if (value.is_boolean())
        arv_camera_set_boolean(camera, name.c_str(), value.get<bool>(), g.out());
    else if (value.is_string())
        arv_camera_set_string(camera, name.c_str(), value.get<std::string>().c_str(), g.out());
    else {
        ArvGcNode* node = arv_device_get_feature(arv_camera_get_device(camera), name.c_str());
        if (ARV_IS_GC_FLOAT(node) && !ARV_IS_GC_INTEGER(node))
            arv_camera_set_float(camera, name.c_str(), value.get<double>(), g.out());
        else
            arv_camera_set_integer(camera, name.c_str(),
                                   static_cast<gint64>(std::llround(value.get<double>())), g.out());
    }
    if (g) return failure(camera, Text("the feature {} cannot be set to {}", name, value.dump()), g);
    return {};
}

ParameterInfo number(std::string name, std::string unit, double low, double high, double now, int decimals,
                     std::string help) {
    return {std::move(name), std::move(unit), low, high, now, decimals, std::move(help), {}};
}

ParameterInfo choice(std::string name, std::vector<std::string> choices, const std::string& now,
                     std::string help) {
    const auto it = std::find(choices.begin(), choices.end(), now);
    ParameterInfo info{std::move(name),
                       "",
                       0,
                       static_cast<double>(choices.size()) - 1,
                       it == choices.end() ? 0.0 : static_cast<double>(it - choices.begin()),
                       0,
                       std::move(help),
                       {}};
    info.choices = std::move(choices);
    return info;
}

}  // namespace

std::vector<DiscoveredCamera> discover_cameras() {
    std::vector<DiscoveredCamera> cameras;
    const auto text = [](const char* t) { return std::string(t ? t : ""); };
    arv_disable_interface("Fake");  // Aravis' in-process test camera
    arv_update_device_list();
    for (unsigned i = 0, n = arv_get_n_devices(); i < n; ++i) {
        DiscoveredCamera c;
        c.vendor = text(arv_get_device_vendor(i));
        c.model = text(arv_get_device_model(i));
        c.serial = text(arv_get_device_serial_nbr(i));
        c.address = text(arv_get_device_address(i));
        c.protocol = text(arv_get_device_protocol(i));
        c.id = text(arv_get_device_id(i));
        cameras.push_back(std::move(c));
    }
    return cameras;
}

Expected<GPtr<ArvCamera>> open_camera(const GenicamSettings& settings) {
    SEAM_TRY(auto device, open_device(settings));
    GFailure g;
    GPtr<ArvCamera> camera(arv_camera_new_with_device(device.get(), g.out()));
    if (!camera) return device_error(Text("it cannot be opened ({})", g.text()), settings.camera_name());
    if (ARV_IS_GV_DEVICE(device.get()) && !arv_gv_device_is_controller(ARV_GV_DEVICE(device.get()))) {
        return device_error(ErrorCode::in_use, kInUse, settings.camera_name(),
                            "close the other program, or wait until its heartbeat has run out");
    }
    arv_camera_set_range_check_policy(camera.get(), ARV_RANGE_CHECK_POLICY_ENABLE);
    // Other programs and the camera itself change registers: nothing is remembered.
    arv_camera_set_register_cache_policy(camera.get(), ARV_REGISTER_CACHE_POLICY_DISABLE);
    const auto offered = offered_formats(camera.get());
    if (readable(offered).empty())
        return device_error("none of its pixel formats can be read", settings.camera_name(),
                            Text("it offers {}", (offered.empty() ? "none" : join_names(offered))));
    return camera;
}

SensorIdentity identity_of(ArvCamera* camera) {
    GFailure g;
    const auto text = [](const char* t) { return std::string(t ? t : ""); };
    SensorIdentity id{"genicam", "", "", ""};
    id.vendor = text(arv_camera_get_vendor_name(camera, g.out()));
    id.model = text(arv_camera_get_model_name(camera, g.out()));
    id.serial = text(arv_camera_get_device_serial_number(camera, g.out()));
    return id;
}

std::string address_of(ArvCamera* camera) {
    ArvDevice* device = arv_camera_get_device(camera);
    if (!ARV_IS_GV_DEVICE(device)) return {};
    GSocketAddress* address = arv_gv_device_get_device_address(ARV_GV_DEVICE(device));
    if (!G_IS_INET_SOCKET_ADDRESS(address)) return {};
    char* text = g_inet_address_to_string(g_inet_socket_address_get_address(G_INET_SOCKET_ADDRESS(address)));
    std::string result(text ? text : "");
    g_free(text);
    return result;
}

Expected<void> apply_settings(ArvCamera* camera, const GenicamSettings& s) {
    const auto set = [camera](const char* name, double value) { return set_parameter(camera, name, value); };
    GFailure g;
    if (!s.pixel_format.empty()) {
        const auto offered = offered_formats(camera);
        if (std::find(offered.begin(), offered.end(), s.pixel_format) == offered.end() ||
            !pixel_format_by_name(s.pixel_format)) {
            return failure(camera,
                           Text("the pixel format \"{}\" is not offered or cannot be read", s.pixel_format),
                           {}, Text("these can be read: {}", join_names(readable(offered))));
        }
        arv_camera_set_pixel_format_from_string(camera, s.pixel_format.c_str(), g.out());
        if (g) return failure(camera, "the pixel format cannot be set", g);
    }
    const char* present = arv_camera_get_pixel_format_as_string(camera, g.out());
    if (g || !present || !pixel_format_by_name(present))
        return failure(camera, Text("its pixel format \"{}\" cannot be read", present ? present : "?"), g,
                       Text("set pixel_format to one of {}", join_names(readable(offered_formats(camera)))));
    // A region that is to grow needs its offset gone first.
    if (s.x || s.y || s.width || s.height) {
        if (s.x || s.width) {
            if (has(camera, "OffsetX")) arv_camera_set_integer(camera, "OffsetX", 0, g.out());
            if (s.width) SEAM_OK(set("region_width", *s.width));
            SEAM_OK(set("region_x", s.x.value_or(0)));
        }
        if (s.y || s.height) {
            if (has(camera, "OffsetY")) arv_camera_set_integer(camera, "OffsetY", 0, g.out());
            if (s.height) SEAM_OK(set("region_height", *s.height));
            SEAM_OK(set("region_y", s.y.value_or(0)));
        }
    }
    if (s.exposure_us) SEAM_OK(set("exposure_us", *s.exposure_us));
    if (s.gain_db) SEAM_OK(set("gain_db", *s.gain_db));
    if (s.frame_rate_hz) SEAM_OK(set("frame_rate_hz", *s.frame_rate_hz));
    if (!s.chunks.empty()) {
        if (!arv_camera_are_chunks_available(camera, g.out()))
            return failure(camera, "it offers no chunks", g);
        std::string list;
        for (const std::string& chunk : s.chunks) list += (list.empty() ? "" : ",") + chunk;
        arv_camera_set_chunks(camera, list.c_str(), g.out());
        if (g) return failure(camera, Text("the chunks {} cannot be switched on", list), g);
    }
    for (const auto& [name, value] : s.features.items()) SEAM_OK(set_feature(camera, name, value));
    if (arv_camera_is_gv_device(camera) && s.packet_size > 0) {
        arv_camera_gv_set_packet_size(camera, s.packet_size, g.out());
        if (g) return failure(camera, "the packet size cannot be set", g);
    }
    return set_trigger(camera, s.trigger);
}

Expected<void> check_field(ArvCamera* camera, const GenicamSettings& s,
                           const std::map<std::string, double>& changed) {
    GFailure g;
    const char* name = arv_camera_get_pixel_format_as_string(camera, g.out());
    const PixelFormat* format = name ? pixel_format_by_name(name) : nullptr;
    if (s.range || (format && format->is_range())) return {};
    const struct {
        const char* feature;
        gint64 plain;
        bool said;
    } fields[] = {{"OffsetX", 0, s.x || s.width || changed.contains("region_x")},
                  {"OffsetY", 0, s.y || s.height || changed.contains("region_y")},
                  {"BinningHorizontal", 1, false},
                  {"BinningVertical", 1, false},
                  {"DecimationHorizontal", 1, false},
                  {"DecimationVertical", 1, false},
                  {"ReverseX", 0, false},
                  {"ReverseY", 0, false}};
    for (const auto& [feature, plain, said] : fields) {
        if (said || s.features.contains(feature) || !has(camera, feature)) continue;
        const bool mirror = std::string_view(feature).starts_with("Reverse");
        const gint64 now = mirror ? arv_camera_get_boolean(camera, feature, g.out())
                                  : arv_camera_get_integer(camera, feature, g.out());
        if (g || now == plain) continue;
        return failure(
            camera,
            Text("its {} is {}, which the sensor's settings do not say: its image is not the one "
                 "that was calibrated",
                 feature, now),
            {},
            Text("set it to {} on the camera, or name it in the settings under \"{}\" and calibrate "
                 "with it",
                 plain, std::string_view(feature).starts_with("Offset") ? "region" : "features"));
    }
    return {};
}

CameraParameters read_parameters(ArvCamera* camera) {
    CameraParameters read;
    auto& list = read.list;
    GFailure g;
    double low = 0, high = 0;
    if (arv_camera_is_exposure_time_available(camera, g.out())) {
        arv_camera_get_exposure_time_bounds(camera, &low, &high, g.out());
        if (!g)
            list.push_back(number("exposure_us", "us", low, high,
                                  arv_camera_get_exposure_time(camera, g.out()), 1, "Exposure time."));
    }
    if (g.silent()) return {{}, true};
    if (arv_camera_is_gain_available(camera, g.out())) {
        arv_camera_get_gain_bounds(camera, &low, &high, g.out());
        if (!g)
            list.push_back(number("gain_db", "dB", low, high, arv_camera_get_gain(camera, g.out()), 2,
                                  "Gain, as the camera calls it."));
    }
    if (g.silent()) return {{}, true};
    if (arv_camera_is_frame_rate_available(camera, g.out())) {
        arv_camera_get_frame_rate_bounds(camera, &low, &high, g.out());
        if (!g)
            list.push_back(number("frame_rate_hz", "Hz", low, high,
                                  arv_camera_get_frame_rate(camera, g.out()), 2,
                                  "Frames a second when free running."));
    }
    const auto whole = [&](const char* name, const char* feature, const char* help) {
        if (g.silent() || !has(camera, feature)) return;
        gint64 from = 0, to = 0;
        arv_camera_get_integer_bounds(camera, feature, &from, &to, g.out());
        if (g) return;
        const auto now = static_cast<double>(arv_camera_get_integer(camera, feature, g.out()));
        if (!g)
            list.push_back(
                number(name, "px", static_cast<double>(from), static_cast<double>(to), now, 0, help));
    };
    whole("region_x", "OffsetX", "First column of the image.");
    whole("region_y", "OffsetY", "First row of the image.");
    whole("region_width", "Width", "Columns of the image.");
    whole("region_height", "Height", "Rows of the image.");
    if (g.silent()) return {{}, true};
    const char* format = arv_camera_get_pixel_format_as_string(camera, g.out());
    if (g.silent()) return {{}, true};
    list.push_back(choice("pixel_format", readable(offered_formats(camera)), format ? format : "",
                          "How grey values or coordinates are coded."));
    list.push_back(choice("trigger", triggers(camera), present_trigger(camera), "What starts an exposure."));
    return read;
}

bool changes_stream(const std::string& name) {
    return name.starts_with("region_") || name == "pixel_format";
}

namespace {
Expected<ParameterInfo> described(ArvCamera* camera, const std::string& name) {
    const auto [infos, silent] = read_parameters(camera);
    if (silent) return device_error(ErrorCode::silence, kNoAnswer, "camera");
    std::string known;
    for (const ParameterInfo& info : infos) {
        if (info.name == name) return info;
        known += (known.empty() ? "" : ", ") + info.name;
    }
    return input_error(Text("\"{}\" is no parameter of this camera", name), "camera",
                       Text("it has {}", known));
}
}  // namespace

Expected<double> get_parameter(ArvCamera* camera, const std::string& name) {
    SEAM_TRY(const auto info, described(camera, name));
    return info.default_value;
}

Expected<void> set_parameter(ArvCamera* camera, const std::string& name, double value) {
    SEAM_TRY(const auto info, described(camera, name));
    SEAM_OK(validate({{name, value}}, {info}, "camera"));
    GFailure g;
    const auto whole = static_cast<gint64>(std::llround(value));
    if (name == "trigger") return set_trigger(camera, info.choices[static_cast<std::size_t>(whole)]);
    if (name == "exposure_us") {
        arv_camera_set_exposure_time(camera, value, g.out());
    } else if (name == "gain_db") {
        arv_camera_set_gain(camera, value, g.out());
    } else if (name == "frame_rate_hz") {
        // arv_camera_set_frame_rate() would switch the trigger off.
        if (has(camera, "AcquisitionFrameRateEnable"))
            arv_camera_set_boolean(camera, "AcquisitionFrameRateEnable", TRUE, g.out());
        if (!g && has(camera, "AcquisitionFrameRate"))
            arv_camera_set_float(camera, "AcquisitionFrameRate", value, g.out());
        else if (!g && has(camera, "AcquisitionFrameRateAbs"))
            arv_camera_set_float(camera, "AcquisitionFrameRateAbs", value, g.out());
        else if (!g) {
            const std::string trigger = present_trigger(camera);
            arv_camera_set_frame_rate(camera, value, g.out());
            if (!g) return set_trigger(camera, trigger);
        }
    } else if (name == "pixel_format") {
        arv_camera_set_pixel_format_from_string(camera, info.choices[static_cast<std::size_t>(whole)].c_str(),
                                                g.out());
    } else {
        const char* feature = name == "region_x"       ? "OffsetX"
                              : name == "region_y"     ? "OffsetY"
                              : name == "region_width" ? "Width"
                                                       : "Height";
        arv_camera_set_integer(camera, feature, whole, g.out());
    }
    if (g) return failure(camera, Text("{} cannot be set to {}", name, value), g);
    return {};
}

Expected<RangeMapping> range_mapping(ArvCamera* camera) {
    RangeMapping m;
    GFailure g;
    double unit_mm = 1;
    if (has(camera, "Scan3dDistanceUnit")) {
        const char* unit = arv_camera_get_string(camera, "Scan3dDistanceUnit", g.out());
        const std::string name = unit ? unit : "";
        if (name == "Inch")
            unit_mm = 25.4;
        else if (name != "Millimeter")
            return failure(camera, Text("its distance unit \"{}\" is no length", name), g,
                           "give the scale in the settings under \"range\"");
    }
    if (has(camera, "Scan3dCoordinateSelector")) {
        const auto read = [&](const char* axis, CoordinateScale& to) {
            GFailure f;
            arv_camera_set_string(camera, "Scan3dCoordinateSelector", axis, f.out());
            if (f) return;
            if (has(camera, "Scan3dCoordinateScale")) {
                const double v = arv_camera_get_float(camera, "Scan3dCoordinateScale", f.out());
                if (!f && std::isfinite(v) && v != 0) to.scale_mm = v;
            }
            if (has(camera, "Scan3dCoordinateOffset")) {
                const double v = arv_camera_get_float(camera, "Scan3dCoordinateOffset", f.out());
                if (!f && std::isfinite(v)) to.offset_mm = v;
            }
        };
        read("CoordinateA", m.x);
        read("CoordinateC", m.z);
    }
    for (CoordinateScale* axis : {&m.x, &m.z}) {
        axis->scale_mm *= unit_mm;
        axis->offset_mm *= unit_mm;
    }
    if (has(camera, "Scan3dInvalidDataFlag") &&
        arv_camera_get_boolean(camera, "Scan3dInvalidDataFlag", g.out()) && !g &&
        has(camera, "Scan3dInvalidDataValue")) {
        const double v = arv_camera_get_float(camera, "Scan3dInvalidDataValue", g.out());
        if (!g) m.invalid = v;
    }
    return m;
}

}  // namespace seamwright
