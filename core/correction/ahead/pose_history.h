#pragma once
// Where a robot stood at an instant: its last poses with their times, screw motion between two of them.
//
// Times are of one clock, ns, and ascend; a pose that is not later than the newest is not kept. The poses of a robot
// that tells them in every cycle carry the time at which they were heard: a delay of the hearing shifts the answer
// along the travel by speed times delay.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry/pose.h"

namespace seamwright {

// A ring of `capacity` poses, allocated once. One thread at a time.
class PoseHistory {
  public:
    explicit PoseHistory(std::size_t capacity);
    void add(std::int64_t time_ns, const Pose& pose);
    void clear() { count_ = 0; }
    std::size_t size() const { return count_; }
    // Nothing: before the oldest, after the newest, or between two that are more than `most_between_s` apart.
    std::optional<Pose> at(std::int64_t time_ns, double most_between_s) const;
    bool covers(std::int64_t time_ns) const { return count_ > 0 && nth(count_ - 1).time_ns >= time_ns; }

  private:
    struct Timed {
        std::int64_t time_ns = 0;
        Pose pose = Pose::Identity();
    };
    const Timed& nth(std::size_t i) const { return ring_[(first_ + i) % ring_.size()]; }
    std::vector<Timed> ring_;
    std::size_t first_ = 0, count_ = 0;
};

}  // namespace seamwright
