#pragma once
// A Universal Robots controller before the simulated cell: it executes the delivered seamwright.script and a
// robot program that calls it, in the controller's cycles, and has the controller's own interfaces, RTDE and
// dashboard. Nothing of Seamwright's handshake is known here but what the script does.
//
// The robot program (resources/robot/simulated/application.script) measures when press_start() calls or when
// Seamwright starts it, waits `application_wait_ms`, takes the permission and lays a short bead in the first
// frame. In mode manual_reduced it is sw_teach() instead. A cell's `stopped` is a protective stop, in which
// the program is paused; `fault` stops it, and it begins anew when the fault is gone. A program that halts or
// that the controller stops for a fault of its own stands until the dashboard's "play".
//
// clang-format off
// Settings, defaults: {
//   "address": "127.0.0.1", "port": 30004, "dashboard_port": 29999   0 = any free one
//   "scripts": ""                folder with seamwright.script, and application.script where that is another, in place of the generated ones
//   "first_register": 24, "trigger_output": 0   of the generated module
//   "application_wait_ms": 200   between the verdict and the path
//   "time_scale": 1              motion that much faster than real
//   "cb3": false                 PolyScope 3 with 8 ms cycles instead of PolyScope 5 with 2 ms
//   "protocol_version": 2        the newest of RTDE that it accepts: 1 or 2
//   "tells_tcp_offset": true     old ones do not
//   "tool": POSE identity        the TCP set on the controller
//   "least_slice": 100, "most_slice": 2000, "seed": 1   operations that a thread may run in a cycle
//   "slow_ms": 300               of ControllerFault::slow
//   "trigger_interval_ms", "approach_ms"   of older files, not looked at: the robot drives at its speed}
// clang-format on

#include <memory>
#include <nlohmann/json.hpp>

#include "devices/simulated/cell.h"
#include "devices/simulated/controller.h"

namespace seamwright {

// Error: an address in use, a script that cannot be read or that the controller refuses, with its line.
Expected<std::unique_ptr<SimulatedController>> start_ur_rtde_controller(std::shared_ptr<SimulatedCell> cell,
                                                                        const nlohmann::json& settings);

}  // namespace seamwright
