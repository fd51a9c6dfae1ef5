#pragma once
// The clock by which frames, poses and triggers of one computer are compared (Frame::host_time_ns).

#include <chrono>
#include <cstdint>

namespace seamwright {

// Of the steady clock: no time of day, and never set back.
inline std::int64_t host_now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace seamwright
