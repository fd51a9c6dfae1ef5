#pragma once
// ABB controllers (IRC5, OmniCore) by a RAPID server task of ours.
//
// The controller is the server: a semi-static task binds, listens and accepts one client (TCP, port 1025
// unless the project says another), as ABB's Application manual "Controller software", chapter Socket
// Messaging, has it. The protocol is ours, shaped by RAPID's limits; its messages
// are in rapid_message.h, which is what the RAPID task has to be written to.
//
// Frames are work objects: the name is that of a wobjdata on the controller, at most 32 characters.
// write_frame() stages base_from_frame (uframe being identity); the controller puts the staged shift into
// `oframe` of that work object when the verdict is `corrected`, and no path may run in it before.
// read_frame() answers the staged frame while one is staged, else the work object itself.
//
// The permission is a token that the application (SW_Take, SW_Activate) or the server takes by one
// TestAndSet: what permission() tells is who has it. While it is given and not taken the link must be heard
// every 5 s (any request does; a link that waits asks every 0.5 s by itself), or the controller takes the
// connection for lost. A module of the first version cannot tell; then permission() is refused.
//
// "tool" and "load" of the settings concern the written program (program.h).
//
// RAPID's num is single precision: a frame comes back off by at most half a unit in the last place, 0.00025
// mm a coordinate up to 8 m, 0.0005 mm up to 16 m, and about 1e-5 degree. Both are below what the safety gate
// allows. Poses travel with 4 decimals of a millimetre and 8 of a quaternion.
//
// Settings: abb_rapid_settings().
//
// Failure: a controller that is silent or answers half a message is known by is_silence(), and the connection
// is dropped, so that a late answer is never taken for that of the next question. An answer with another
// number or word than the question's, a missing trigger number, a number that is not finite or beyond 1e5 mm,
// a quaternion whose norm is off 1 by more than 1e-3 and an unknown mode are refused in words. Text of
// confirm() is cut to 79 ASCII characters.

#include <memory>
#include <nlohmann/json.hpp>

#include "devices/device_session.h"
#include "devices/exchange/settings.h"
#include "devices/robot_link.h"

namespace seamwright {

const SettingTable& abb_rapid_settings();
Expected<std::unique_ptr<RobotLink>> open_abb_rapid(const nlohmann::json& settings, DeviceSession& session);

}  // namespace seamwright
