#pragma once
// GigE Vision and USB3 Vision cameras through GenICam (Aravis 0.8): driver "genicam".
//
// Settings; all but one of serial, address and id optional, with defaults:
//   {"serial": "", "address": "" (IPv4), "id": "" (Aravis' device id),  which camera; several: all must fit
//    "search": [],             addresses asked one by one for the serial, instead of a broadcast everywhere
//    "exposure_us", "gain_db", "frame_rate_hz", "region": {"x","y","width","height"}, "pixel_format":
//    "Mono8", "trigger": "software",    or "free", or a source that the camera has: "Line1"
//    "channel": "grey",        of colour formats (RGB8, BGR8, Bayer of 8, 10, 12 bit): grey, red, green, blue
//    or
//                              red-difference (R - (G + B) / 2, in which white light is gone)
//    "hardware_trigger": false, the robot fires the sensor: trigger defaults to "Line1" instead
//    "features": {NAME: VALUE}, any GenICam feature: number, text, true/false; null executes a command; in
//    the
//                              alphabet's order, after all of the above but the trigger
//    "chunks": [],             chunks to switch on; ChunkTimestamp is then the frame's device time
//    "range": {"x_scale_mm": 1, "x_offset_mm": 0, "z_scale_mm": 1, "z_offset_mm": 0, "invalid": 0}
//                              grey images are ranges (8 or 16 bit), coordinates are scaled so and not as the
//                              camera's Scan3d features say; "invalid" null: every value is a return
//    "packet_size": 0,         bytes, 0: found out, on loopback the camera's own
//    "packet_socket": false,   kernel ring instead of an UDP socket: needs CAP_NET_RAW, never on loopback
//    "packet_resend": true, "packet_timeout_ms": 20, "frame_retention_ms": 100,
//    "socket_buffer": 0,       bytes, 0: eight frames, at most 32 MiB (the kernel's rmem_max caps it)
//    "buffers": 8,             frames on the way from the wire, and as many handed out
//    "timeout_ms": 1000,       of a software trigger's frame, and of a reconnection's first answer
//    "reconnect_ms": 100, "reconnect_most_ms": 1000,  back-off, doubling
//    "heartbeat_ms": 500}      how often the camera is asked whether it is there; 0: Aravis' own heartbeat
//    only
//
// What a camera leaves undone is refused in words: no such feature, out of its range, another program in
// control, a pixel format that cannot be read.
//
// Frames. A frame of any buffer status but success is delivered `incomplete` (`corrupt` when its size or
// format is wrong) without image or profile, and counted as damaged. Range cameras: each row is a frame of
// its own, in order, sequence = image * rows + row; a damaged image is one damaged frame. sequence follows
// FrameCounter of frame_order.h and counts on over stops and reconnections; frames missing in it are counted
// as lost; a damaged frame whose number got
// lost too carries that of the frame before it. device_time_ns is the camera's time stamp, host_time_ns the
// arrival of the last packet.
//
// Software triggers carry their spot to their frame as TriggerPairing of frame_order.h says; a frame whose
// trigger cannot be told is delivered `late`. After lost track the next trigger() begins the acquisition anew
// first. Frames of hardware triggers have no spot.
//
// A camera that leaves (control lost, or three unanswered heartbeats) makes wait_next() fail with
// kDisconnected; later calls reconnect, at most once a back-off, restore every setting and the acquisition,
// and ask the identity anew: another serial number at the same address is refused.

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "devices/device_session.h"
#include "devices/profile_source.h"

namespace seamwright {

struct DiscoveredCamera {
    std::string vendor, model, serial, address, protocol;  // protocol: "GigEVision", "USB3Vision"
    std::string id;                                        // Aravis' device id
};
// Broadcasts on every network interface and looks at USB; takes about a second.
std::vector<DiscoveredCamera> discover_cameras();

Expected<std::unique_ptr<ProfileSource>> open_genicam_sensor(const nlohmann::json& settings,
                                                             DeviceSession& session);

}  // namespace seamwright
