#pragma once
// RSI as a cyclic protocol: telegrams to packets, corrections to RKorr. See rsi.h.

#include <memory>
#include <string>

#include "devices/cyclic/protocol.h"

namespace seamwright {

struct RsiOptions {
    bool relative = false, tool = false;
    std::string sen_type = "ImFree";
    int decimals = 7;
};
std::unique_ptr<CyclicProtocol> make_rsi_protocol(const RsiOptions& options, int cycle_ms);

}  // namespace seamwright
