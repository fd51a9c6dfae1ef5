#pragma once
// Settings of the driver "genicam".

#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "devices/exchange/image_file.h"
#include "devices/exchange/settings.h"
#include "devices/genicam/pixels/range_image.h"

namespace seamwright {

struct GenicamSettings {
    std::string serial, address, id;
    std::vector<std::string> search;
    std::optional<double> exposure_us, gain_db, frame_rate_hz;
    std::optional<int> x, y, width, height;
    std::string pixel_format;
    ImageChannel channel = ImageChannel::grey;  // of colour formats
    std::string trigger = "software";
    nlohmann::json features = nlohmann::json::object();
    std::vector<std::string> chunks;
    std::optional<RangeMapping> range;
    int packet_size = 0, buffers = 0;
    bool packet_socket = false, packet_resend = false;
    std::size_t socket_buffer = 0;
    std::chrono::milliseconds packet_timeout{}, frame_retention{}, timeout{}, reconnect{}, reconnect_most{},
        heartbeat{};
    std::string camera_name() const;  // "camera 192.168.1.20", for sentences
};
const SettingTable& genicam_settings();
Expected<GenicamSettings> parse_genicam_settings(const nlohmann::json& settings);

}  // namespace seamwright
