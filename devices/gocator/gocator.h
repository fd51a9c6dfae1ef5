#pragma once
// LMI Gocator profile sensors: driver "gocator".
//
// Settings; all but address optional, with defaults:
// clang-format off
//   {"address": "192.168.1.10",
//    "control_port": 3190,
//    "output": "profiles",        whole profiles (gdp_message.h): tick them on the sensor's Output page; or
//              "ascii",           what the sensor's own tools measured (ascii_result.h), as a profile of a few points
//    "data_port": 3196,           of the profiles; 8190 with output "ascii"
//    "source": 0,                 of profiles: 0 top, 1 bottom, 2 top left, 3 top right
//    "points": [[0, 1]],          output "ascii": ids of the measurements X and Z of each point; feature kind
//                                 "sensor-point" takes one of them
//    "format": "", "delimiter": ",", "terminator": "\r\n", "invalid": "INVALID",   output "ascii", as set there
//    "serial": "",                refused when another sensor answers
//    "hardware_trigger": false,   the robot fires the sensor's digital input; else a software trigger
//    "timeout_ms": 1000,          of an answer
//    "start_timeout_ms": 15000,   of the answers to start and stop: a sensor takes up to 15 s for them
//    "reconnect_ms": 100, "reconnect_most_ms": 5000,   back-off, doubling
//    "buffers": 8}
// clang-format on
//
// Exposure, trigger source and active area belong to the job on the sensor and are set on its own page: there
// are no parameters. start() stops and starts the sensor's job, each for as long as start_timeout_ms
// (give_up() ends it within 50 ms); stop() does not wait for the job's end beyond timeout_ms. wait_next()
// while it is not started is an Error.
//
// Frames. sequence counts on over stops and reconnections; a gap in the sensor's own frame numbers is counted
// as lost and goes on in `sequence`. Lines of text without %frame have no number: a lost one is not seen.
// Software triggers carry their spot to the next frame, those of lost frames are passed over. A message whose
// sizes contradict each other is a frame `corrupt`; a result whose point is invalid is a profile without
// return. A sensor that closes the connection or does not answer a ping makes wait_next() fail with
// kDisconnected; later calls reconnect, at most once a back-off, and refuse another serial number.

#include <memory>
#include <nlohmann/json.hpp>

#include "devices/device_session.h"
#include "devices/profile_source.h"

namespace seamwright {

Expected<std::unique_ptr<ProfileSource>> open_gocator_sensor(const nlohmann::json& settings,
                                                             DeviceSession& session);

}  // namespace seamwright
