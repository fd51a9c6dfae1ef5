#include "devices/robot_program.h"

#include <fmt/format.h>

#include <cmath>

namespace seamwright {

std::string program_signature(const std::vector<MeasuringMove>& moves) {
    std::uint64_t hash = 1469598103934665603u;  // FNV-1a
    const auto add = [&](std::string_view bytes) {
        for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
        hash = (hash ^ 0xffu) * 1099511628211u;  // ends the field
    };
    for (const MeasuringMove& move : moves) {
        add(move.spot_id);
        for (const Pose* pose : {&move.entry, &move.trigger, &move.exit}) {
            // Entries of the rotation matrix in steps of the angle's: sin(1e-4 deg) = 1.7e-6.
            for (int i = 0; i < 3; ++i) add(fmt::format("{}", std::llround(pose->translation()[i] * 1e3)));
            for (int i = 0; i < 9; ++i)
                add(fmt::format("{}", std::llround(pose->linear().data()[i] / 1.7e-6)));
        }
    }
    return fmt::format("SW-{:016X}", hash);
}

}  // namespace seamwright
