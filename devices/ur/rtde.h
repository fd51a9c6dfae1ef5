#pragma once
// Universal Robots (CB3 from PolyScope 3.4, e-Series) by RTDE.
//
// The controller is the server: poses, modes and registers stream from port 30004, and frames are handed to
// the URScript module through registers (module.h; `robot-program --brand ur` writes the module and the
// measuring program). Protocol version 2, or 1 where the controller knows no other. Who the controller is,
// and whether it stands under remote control, tells its dashboard server (port 29999); model and serial number from
// PolyScope 3.12 and 5.6 on, before that they are empty: not known. PolyScope X without a dashboard server is not served.
//
// A frame is a pose of the module, known by its name; the application's path runs in
// pose_trans(sw_activate(sw_name), p). The flange is actual_TCP_pose without tcp_offset; controllers that do not
// tell the offset are taken as having none, as the module has while it measures.
//
// Modes: fault (emergency stop, violation, safety fault), stopped (protective or safeguard stop, brakes, no
// program running), external (remote control), automatic and manual_reduced (dashboard's operational mode;
// automatic where no password makes a difference).
//
// Settings: ur_rtde_settings(). move_to() answers when the robot stands.
//
// Failure: what comes too late, out of turn, of wrong length or beyond 100 m drops the connection, so that
// nothing is taken for the answer of a later request. RTDE does not tell the module that a client went away:
// a thread of the link lets the module hear it five times a second and more, and a second without takes back
// what the robot program has not taken (module.h). The text of confirm() has no register and is not sent.

#include <memory>
#include <nlohmann/json.hpp>

#include "devices/device_session.h"
#include "devices/exchange/settings.h"
#include "devices/robot_link.h"

namespace seamwright {

const SettingTable& ur_rtde_settings();
Expected<std::unique_ptr<RobotLink>> open_ur_rtde(const nlohmann::json& settings, DeviceSession& session);

}  // namespace seamwright
