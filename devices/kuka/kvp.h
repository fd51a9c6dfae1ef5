#pragma once
// KUKA over KUKAVARPROXY: a server on the controller gives its variables by name; Seamwright is the client
// and works the global variables of seamwright.dat (program.h), so no EthernetKRL is needed. Messages:
// kvp_message.h.
//
// Settings, defaults: {"address": the controller's, "port": 7000, "timeout_ms": 1000 (connection, and every
// answer), "poll_ms": 10 (start signal and triggers), "retry_ms": 100, "retry_most_ms": 500 (back-off,
// doubling)}.
//
// A region's frame is one of the module's (SW_NAME) or any variable of type FRAME by its own name
// ("BASE_DATA[5]"). What the protocol cannot do: it does not tell the controller that the connection is lost;
// SW_RELEASED then stays as it is until the next part begins. The flange is $POS_ACT: the module runs with
// $TOOL and $BASE at zero while measuring.

#include <memory>
#include <nlohmann/json.hpp>

#include "devices/device_session.h"
#include "devices/robot_link.h"
#include "devices/simulated/cell.h"
#include "devices/simulated/controller.h"

namespace seamwright {

Expected<std::unique_ptr<RobotLink>> open_kuka_kvp(const nlohmann::json& settings, DeviceSession& session);

// The server before a simulated cell, with the module's variables. Settings: {"address": "127.0.0.1", "port":
// 7000 (0 = any free one), "slow_ms": 300, "trigger_interval_ms": 40, "approach_ms": 100}.
Expected<std::unique_ptr<SimulatedController>> start_kuka_kvp_controller(std::shared_ptr<SimulatedCell> cell,
                                                                         const nlohmann::json& settings);

}  // namespace seamwright
