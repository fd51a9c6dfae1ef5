#pragma once
// Which correction a robot holds, by what it shows.
//
// The difference m of its actual to its programmed pose is the correction in force, less its servo lag: the
// actual pose is where the programmed one was up to kLargestLag_s ago, on the path p as on the ramp c. So a
// course of corrections explains m as far as
//     min over 0 <= tau <= kLargestLag_s of |m - c(t - tau) - (p(t - tau) - p(t))|
// is small, and the same for the rotation. A shift along the travel by less than the way of kLargestLag_s
// cannot be told from lag; along a seam that goes on it is no error.

#include <array>
#include <cstddef>
#include <optional>

#include "devices/cyclic/protocol.h"

namespace seamwright {

inline constexpr double kLargestLag_s = 0.1;

struct Misfit {
    double mm = 0, rad = 0;
    bool within(double limit_mm, double limit_rad) const { return mm <= limit_mm && rad <= limit_rad; }
};

// The corrections and programmed poses of the last kLargestLag_s, the newest packet's among them.
class HeldHistory {
  public:
    explicit HeldHistory(double cycle_s);
    void clear() { count_ = 0; }
    bool full() const { return count_ == capacity_; }  // as long as any lag
    void add(const CyclicTold& held, const Pose& programmed);
    // The newest one again away.
    void take_back() {
        next_ = (next_ + capacity_ - 1) % capacity_;
        if (count_ > 0) --count_;
    }
    // Of what the newest packet shows: to what was held, or to `instead` had it been held all the time.
    Misfit misfit(const CyclicTold& shown, const CyclicPacket& newest, CyclicProtocol& protocol,
                  const CyclicTold* instead = nullptr) const;
    // What of `shown` no lag explains, for a robot that may hold anything.
    CyclicTold without_lag(const CyclicTold& shown, const CyclicPacket& newest,
                           CyclicProtocol& protocol) const;

  private:
    struct Cycle {
        CyclicTold held;
        Pose programmed = Pose::Identity();
    };
    // Of the i-th cycle back from the newest.
    CyclicTold rest(std::size_t i, const CyclicTold& shown, const CyclicPacket& newest,
                    CyclicProtocol& protocol, const CyclicTold* instead) const;

    std::array<Cycle, 128> cycles_;
    std::size_t capacity_, count_ = 0, next_ = 0;
};

}  // namespace seamwright
