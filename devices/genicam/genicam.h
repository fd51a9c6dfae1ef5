#pragma once
// GigE Vision and USB3 Vision cameras through GenICam (Aravis 0.8): driver "genicam".
//
// Settings: genicam_settings() of genicam_settings.h. Features are set in the alphabet's order, after all else
// but the trigger. With "range" grey images (8 or 16 bit) are ranges, whose coordinates are scaled so and not as
// the camera's Scan3d features say.
//
// What a camera leaves undone is refused in words: no such feature, out of its range, another program in
// control, a pixel format that cannot be read.
//
// Frames. A frame of any buffer status but success is delivered `incomplete` (`corrupt` when its size or
// format, or the part of the sensor that it shows, is not the one it was started with) without image or profile, and counted as damaged. Range cameras: each row is a frame of
// its own, in order, sequence = image * rows + row; a damaged image is one damaged frame. sequence follows
// FrameCounter of frame_order.h and counts on over stops and reconnections; frames missing in it are counted
// as lost; a damaged frame whose number got
// lost too carries that of the frame before it. Of a camera on a trigger line the frames lost before an acquisition's
// first are delivered too, `incomplete` and without times. device_time_ns is the camera's time stamp, host_time_ns the
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
