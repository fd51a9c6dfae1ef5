#pragma once
// KUKA over EthernetKRL: the controller runs the KRL modules of program.h (`seamwright robot-program --brand
// kuka`) and connects to Seamwright, which listens. Telegrams: eki_telegram.h.
//
// Settings, defaults: {"listen": "127.0.0.1" (this computer's address in the robot's network), "port": 54600,
// "robot_address": "" (the controller's: must be named unless "listen" is loopback; others are refused and
// told), "timeout_ms": 1000 (connection, and every answer)}, and those of the generated program (program.h).
//
// A new connection replaces the one before (a controller that was switched off leaves a dead one behind); who
// it is says its hello. Commands are numbered and answers carry the number, so a late answer is dropped. The
// triggers of a program are numbered too; one that is missing makes wait_trigger fail.

#include <memory>
#include <nlohmann/json.hpp>

#include "devices/device_session.h"
#include "devices/robot_link.h"
#include "devices/robot_program.h"

namespace seamwright {

Expected<std::unique_ptr<RobotLink>> open_kuka_eki(const nlohmann::json& settings, DeviceSession& session);

}  // namespace seamwright
