#pragma once
// Universal Robots (CB3 from PolyScope 3.4, e-Series, PolyScope X's PolyScope 5 interface) by RTDE.
//
// The controller is the server: poses, modes and registers stream from port 30004, and frames are handed to
// the URScript module through registers (module.h; `robot-program --brand ur` writes the module and the
// measuring program). Protocol version 2, or 1 where the controller knows no other. Who the controller is,
// and whether it stands under remote control, tells its dashboard server (port 29999).
//
// A frame is a pose of the module, known by its name; the application's path runs in
// pose_trans(sw_activate(n), p). The flange is actual_TCP_pose without tcp_offset; controllers that do not
// tell the offset are taken as having none, as the module has while it measures.
//
// Modes: fault (emergency stop, violation, safety fault), stopped (protective or safeguard stop, brakes, no
// program running), external (remote control), automatic and manual_reduced (dashboard's operational mode;
// automatic where no password makes a difference).
//
// Settings, defaults: {"address": "127.0.0.1", "port": 30004, "dashboard_port": 29999, "timeout_ms": 1000
// (connection and every answer), "move_timeout_ms": 60000 (move_to(), which answers when the robot stands),
// "frequency_hz": 125, "first_register": 24 (0 to 36), "retry_ms": 100, "retry_most_ms": 500 (back-off,
// doubling)}.
//
// Failure: what comes too late, out of turn, of wrong length or beyond 100 m drops the connection, so that
// nothing is taken for the answer of a later request. RTDE does not tell the module that a client went away;
// the permission then stays as it is until the next write or part. The text of confirm() has no register and
// is not sent.

#include <memory>
#include <nlohmann/json.hpp>

#include "devices/device_session.h"
#include "devices/robot_link.h"
#include "devices/simulated/cell.h"
#include "devices/simulated/controller.h"

namespace seamwright {

Expected<std::unique_ptr<RobotLink>> open_ur_rtde(const nlohmann::json& settings, DeviceSession& session);

// Both servers before a simulated cell, with the module running in it. Settings: {"address": "127.0.0.1",
// "port": 30004, "dashboard_port": 29999 (0 = any free one), "slow_ms": 300, "trigger_interval_ms": 40,
// "approach_ms": 100, "first_register": 24, "protocol_version": 2 (the newest it accepts: 1 or 2),
// "tells_tcp_offset": true}.
Expected<std::unique_ptr<SimulatedController>> start_ur_rtde_controller(std::shared_ptr<SimulatedCell> cell,
                                                                        const nlohmann::json& settings);

}  // namespace seamwright
