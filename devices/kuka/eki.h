#pragma once
// KUKA over EthernetKRL: the controller runs the KRL modules of program.h (`seamwright robot-program --brand
// kuka`) and connects to Seamwright, which listens. Telegrams: eki_telegram.h.
//
// Settings: kuka_eki_settings(). Whoever connects from another address than robot_address is refused and told.
//
// A new connection replaces the one before (a controller that was switched off leaves a dead one behind); who
// it is says its hello. Commands are numbered and answers carry the number, so a late answer is dropped. The
// triggers of a program are numbered too; one that is missing makes wait_trigger fail.

#include <memory>
#include <nlohmann/json.hpp>

#include "devices/device_session.h"
#include "devices/exchange/settings.h"
#include "devices/robot_link.h"
#include "devices/robot_program.h"

namespace seamwright {

const SettingTable& kuka_eki_settings();
Expected<std::unique_ptr<RobotLink>> open_kuka_eki(const nlohmann::json& settings, DeviceSession& session);

}  // namespace seamwright
