// What an ABB controller, or anybody, sends to the EGM port.

#include <cstdint>
#include <cstdlib>
#include <span>

#include "devices/abb/egm_message.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto bytes = std::as_bytes(std::span(data, size));
    if (const auto state = seamwright::parse_egm_robot(bytes)) {
        for (const auto& pose : {state->planned, state->measured})
            if (pose &&
                !(pose->translation().norm() < 2e5 &&
                  (pose->linear() * pose->linear().transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-9))
                std::abort();
    }
    if (const auto correction = seamwright::parse_egm_path_correction(bytes))
        if (!correction->pos_mm.allFinite()) std::abort();
    return 0;
}
