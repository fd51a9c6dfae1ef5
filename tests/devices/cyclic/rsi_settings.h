#pragma once
// What a link to a robot with RSI is opened with, and the frame that was taught.

#include <nlohmann/json.hpp>

#include "core/geometry/pose.h"
#include "devices/exchange/pose_json.h"
#include "devices/net/socket.h"

namespace seamwright {

inline std::uint16_t free_port() {
    return UdpSocket::bind("127.0.0.1", 0)->port();
}

inline const Pose kTaught = make_pose(rotation_exp({0, 0, 0.3}), {900, -200, 600});

inline nlohmann::json link_settings(std::uint16_t port) {
    return {{"port", port},
            {"frames", {{"PATH", {{"base_from_frame", pose_json(kTaught)}}}}},
            {"speed_mm_s", 50},
            {"speed_deg_s", 10},
            {"acceleration_mm_s2", 500},
            {"acceleration_deg_s2", 100},
            {"max_late", 60},
            {"timeout_ms", 400},
            {"confirm_timeout_ms", 4000},
            {"session_gap_ms", 500}};
}

}  // namespace seamwright
