#pragma once
// EGM path correction as a cyclic protocol: messages to packets, corrections to the shift across the path.
// See egm.h.

#include <memory>

#include "devices/cyclic/protocol.h"

namespace seamwright {

struct EgmOptions {
    bool sensor_frame = false;
    Pose tcp_from_sensor = Pose::Identity();
};
std::unique_ptr<CyclicProtocol> make_egm_protocol(const EgmOptions& options);

}  // namespace seamwright
