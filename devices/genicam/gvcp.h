#pragma once
// GVCP discovery by hand: asks one address whether a GigE Vision camera is there and which.
//
// GigE Vision 2.0, chapter 16.1: DISCOVERY_CMD is 42 01 0002 0000 <req_id>, big-endian, to UDP port 3956;
// DISCOVERY_ACK is status 0000, 0003, length 00F8, <req_id> and the bootstrap registers 0x00..0xF7. Answered
// whoever controls the camera.

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>

#include "core/error.h"
#include "devices/genicam/genicam.h"

namespace seamwright {

inline constexpr std::uint16_t kGvcpPort = 3956;

std::array<std::byte, 8> discovery_command(std::uint16_t request_id);
// Error (device): no DISCOVERY_ACK of this request, too short, an error status. Texts end at their first zero
// byte; bytes that are no printable ASCII become '?'.
Expected<DiscoveredCamera> parse_discovery_ack(std::span<const std::byte> datagram, std::uint16_t request_id);

// Silence is an Error with kNoAnswer.
Expected<DiscoveredCamera> ask_camera(const std::string& address, std::chrono::milliseconds timeout);

}  // namespace seamwright
