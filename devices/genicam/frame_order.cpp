#include "devices/genicam/frame_order.h"

#include <algorithm>

namespace seamwright {
namespace {

constexpr std::int64_t kMs = 1'000'000;
// A time stamp further than this from its trigger belongs to something else.
constexpr std::int64_t kFar = 50 * kMs;
// Another trigger fits better when it is closer by more than this.
constexpr std::int64_t kCloser = 3 * kMs;
// More frames than these are not lost before one comes.
constexpr std::uint64_t kMostAtStart = 8;

}  // namespace

std::uint64_t FrameCounter::sequence(std::uint64_t frame_id) {
    if (!last_id_) {
        last_id_ = frame_id;
        if (frame_id == 1 && before_) counts_anew_ = true;
        const bool counts_on = !counts_anew_ && before_ && frame_id == *before_ + 1;
        if (from_one_ && !counts_on && frame_id > 1 && frame_id - 1 <= kMostAtStart) at_start_ = frame_id - 1;
        if (any_) ++highest_;
        any_ = true;
        return highest_ += at_start_;
    }
    const std::uint64_t last = *last_id_;
    std::uint64_t ahead = 0, back = 0;
    if (frame_id > last) {
        ahead = frame_id - last;
        // Just before the wrap, after it: an old frame. Beyond 16 bits nothing wraps.
        if (frame_id <= 0xFFFF && ahead > 0x7FFF) {
            back = 65535 - ahead;
            ahead = 0;
        }
    } else if (last <= 0xFFFF && last - frame_id > 0x7FFF) {
        ahead = frame_id == 0 ? 65536 - last : frame_id + 65535 - last;
    } else {
        back = last - frame_id;
    }
    if (ahead > 0) {
        last_id_ = frame_id;
        highest_ += ahead;
        return highest_;
    }
    return back > highest_ ? 0 : highest_ - back;
}

void FrameCounter::restart(bool from_one) {
    if (last_id_) before_ = last_id_;
    last_id_.reset();
    from_one_ = from_one;
    at_start_ = 0;
}

void TriggerPairing::restart() {
    waiting_.clear();
    anchor_.reset();
    offset_.reset();
    lost_track_ = false;
}

void TriggerPairing::begin(std::string spot_id, std::int64_t before_ns) {
    waiting_.push_back({std::move(spot_id), before_ns, 0});
}

void TriggerPairing::sent(std::int64_t after_ns) {
    if (!waiting_.empty() && waiting_.back().after_ns == 0) waiting_.back().after_ns = after_ns;
}

void TriggerPairing::cancel() {
    if (!waiting_.empty() && waiting_.back().after_ns == 0) waiting_.pop_back();
}

void TriggerPairing::lose_track() {
    lost_track_ = true;
    unanswered_ += waiting_.size();
    waiting_.clear();
}

TriggerPairing::Answer TriggerPairing::arrived(std::uint64_t sequence, std::int64_t device_ns,
                                               std::int64_t host_ns) {
    if (lost_track_) return {Verdict::late, {}};
    if (anchor_ && sequence <= *anchor_) return {Verdict::late, {}};  // out of order: its turn is over
    std::size_t skipped = anchor_ ? static_cast<std::size_t>(sequence - *anchor_ - 1) : 0;
    anchor_ = sequence;
    if (waiting_.empty()) return {Verdict::unprompted, {}};
    // Frames between were lost on the way: so are their triggers' answers.
    if (skipped >= waiting_.size()) {
        lose_track();
        return {Verdict::late, {}};
    }
    for (; skipped > 0; --skipped) {
        waiting_.pop_front();
        ++unanswered_;
    }
    const auto misfit = [&](const Waiting& w) -> std::int64_t {
        const std::int64_t after = w.after_ns ? w.after_ns : host_ns;
        const std::int64_t at = device_ns - *offset_;
        return at < w.before_ns ? w.before_ns - at : at > after ? at - after : 0;
    };
    if (device_ns != 0 && offset_) {
        const std::int64_t own = misfit(waiting_.front());
        const bool other = std::any_of(waiting_.begin() + 1, waiting_.end(),
                                       [&](const Waiting& w) { return misfit(w) + kCloser < own; });
        if (own > kFar || other) {
            lose_track();
            return {Verdict::late, {}};
        }
    }
    Waiting mine = std::move(waiting_.front());
    waiting_.pop_front();
    // The clocks drift against each other: the offset follows the latest pair.
    if (device_ns != 0)
        offset_ = device_ns - (mine.after_ns ? (mine.before_ns + mine.after_ns) / 2 : mine.before_ns);
    return {Verdict::paired, std::move(mine.spot_id)};
}

std::vector<std::string> TriggerPairing::expire(std::int64_t sent_before_ns) {
    std::vector<std::string> spots;
    if (waiting_.empty() || waiting_.front().before_ns >= sent_before_ns) return spots;
    for (const Waiting& w : waiting_) spots.push_back(w.spot_id);
    lose_track();
    return spots;
}

}  // namespace seamwright
