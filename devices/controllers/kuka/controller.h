#pragma once
// A KUKA controller before a simulated cell: it executes the KRL that `seamwright robot-program --brand kuka`
// delivers (machine.h) and a small application of the cell, on an arm that moves in real time. kuka-eki: the
// submit program talks over EthernetKRL as Seamwright.xml configures it. kuka-kvp: a KUKAVARPROXY server
// gives the same variables by name, and no submit program runs.
//
// Settings, all optional: {"address": "127.0.0.1", "port": 54600 (where Seamwright listens; of the KVP server
// 7000, 0 = any free one), "slow_ms": 300, "time_scale": 1 (2 = the robot does everything twice as fast),
// "application_wait_ms": 0 (from the verdict until the application takes the permission),
// "programs": "" (a folder of program files, seamwright.src and the others, in place of the generated ones;
// its Seamwright.xml then names address and port)}.
//
// The operator: in T1 the program SEAMWRIGHT is selected and the start key held; otherwise the application
// runs, which waits in SEAMWRIGHT_SPOTS() for a part that the line calls for (press_start) or that is
// measured by command. A stop ends the program; it is selected anew when the stop is over, and after a HALT.
// The controller holds the program of the cell's moves; when they change the file is loaded anew and the
// application restarted.

#include <memory>
#include <nlohmann/json.hpp>

#include "devices/simulated/cell.h"
#include "devices/simulated/controller.h"

namespace seamwright {

Expected<std::unique_ptr<SimulatedController>> start_kuka_eki_controller(std::shared_ptr<SimulatedCell> cell,
                                                                         const nlohmann::json& settings);
Expected<std::unique_ptr<SimulatedController>> start_kuka_kvp_controller(std::shared_ptr<SimulatedCell> cell,
                                                                         const nlohmann::json& settings);

}  // namespace seamwright
