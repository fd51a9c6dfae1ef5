#include "core/correction/ahead/pose_history.h"

#include <algorithm>

namespace seamwright {

PoseHistory::PoseHistory(std::size_t capacity) : ring_(std::max<std::size_t>(capacity, 1)) {}

void PoseHistory::add(std::int64_t time_ns, const Pose& pose) {
    if (count_ > 0 && time_ns <= nth(count_ - 1).time_ns) return;
    if (count_ == ring_.size()) {
        first_ = (first_ + 1) % ring_.size();
        --count_;
    }
    ring_[(first_ + count_) % ring_.size()] = {time_ns, pose};
    ++count_;
}

std::optional<Pose> PoseHistory::at(std::int64_t time_ns, double most_between_s) const {
    std::size_t low = 0, high = count_;  // the first that is not before
    while (low < high) {
        const std::size_t middle = (low + high) / 2;
        if (nth(middle).time_ns < time_ns)
            low = middle + 1;
        else
            high = middle;
    }
    if (low == count_) return std::nullopt;
    const Timed& after = nth(low);
    if (after.time_ns == time_ns) return after.pose;
    if (low == 0) return std::nullopt;
    const Timed& before = nth(low - 1);
    const double between_s = 1e-9 * static_cast<double>(after.time_ns - before.time_ns);
    if (between_s > most_between_s) return std::nullopt;
    return interpolate(before.pose, after.pose,
                       1e-9 * static_cast<double>(time_ns - before.time_ns) / between_s);
}

}  // namespace seamwright
