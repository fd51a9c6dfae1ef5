#pragma once
// LMI Gocator profile sensors: driver "gocator".
//
// Settings: gocator_settings().
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
#include "devices/exchange/settings.h"
#include "devices/profile_source.h"

namespace seamwright {

const SettingTable& gocator_settings();
Expected<std::unique_ptr<ProfileSource>> open_gocator_sensor(const nlohmann::json& settings,
                                                             DeviceSession& session);

}  // namespace seamwright
