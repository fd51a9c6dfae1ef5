#pragma once
// KUKA over KUKAVARPROXY: a server on the controller gives its variables by name; Seamwright is the client
// and works the global variables of seamwright.dat (program.h), so no EthernetKRL is needed. Messages:
// kvp_message.h.
//
// Settings: kuka_kvp_settings().
//
// A region's frame is one of the module's (SW_NAME) or any variable of type FRAME by its own name
// ("BASE_DATA[5]"). What the protocol cannot do: it does not tell the controller that the connection is lost;
// SW_RELEASED then stays as it is until the next part begins. The flange is
// computed from $BASE_C, $POS_ACT and $TOOL_C (without _C where the server knows no others); a tool that is
// fixed in the cell ($IPO_MODE #TCP) is refused.

#include <memory>
#include <nlohmann/json.hpp>

#include "devices/device_session.h"
#include "devices/exchange/settings.h"
#include "devices/robot_link.h"

namespace seamwright {

const SettingTable& kuka_kvp_settings();
Expected<std::unique_ptr<RobotLink>> open_kuka_kvp(const nlohmann::json& settings, DeviceSession& session);

}  // namespace seamwright
