#include "devices/line/handshake.h"

namespace seamwright {

void Handshake::hear(const LineWords& words, Time now) {
    const bool rises = heard_ && words.start && !words_.start;
    const bool back = !heard_;
    const bool beats = !heard_ || words.heartbeat != words_.heartbeat;
    if (beats) beat_ = now;
    heard_ = true;
    words_ = words;
    if (!options_.line_starts || silent(now)) return;
    if (back && phase_ == Phase::done && !shown_ && !words.start) result_stays_ = true;
    if (!words.start) other_called_ = false;
    if (back && words.start && words.part != called_) {
        other_called_ = phase_ == Phase::busy;
        if (phase_ == Phase::done) not_followed(now);
    }
    const bool waits = phase_ == Phase::idle || (phase_ == Phase::done && result_stays_);
    if (rises && waits) {
        phase_ = Phase::called;
        called_ = words.part;
        called_at_ = now;
    } else if (!words.start && (phase_ == Phase::unseen || phase_ == Phase::called ||
                                (phase_ == Phase::done && !result_stays_))) {
        phase_ = Phase::idle;
    }
}

void Handshake::lost() {
    heard_ = false;
    if (phase_ == Phase::idle || phase_ == Phase::called) phase_ = Phase::unseen;
}

bool Handshake::silent(Time now) const {
    return heard_ && options_.heartbeat_timeout.count() > 0 && now - beat_ > options_.heartbeat_timeout;
}

void Handshake::advance(const LineState& state, Time now) {
    if (silent(now) && (phase_ == Phase::idle || phase_ == Phase::called)) phase_ = Phase::unseen;
    if (phase_ == Phase::called && now - called_at_ > options_.call_timeout) not_followed(now);
    if (phase_ == Phase::busy && state.results != results_) {
        phase_ = Phase::done;
        done_at_ = now;
        result_stays_ = !words_.start;
        shown_ = false;
        if (other_called_) not_followed(now);
    }
}

void Handshake::not_followed(Time now) {
    phase_ = Phase::done;
    done_at_ = now;
    not_followed_ = true;
    result_stays_ = shown_ = other_called_ = false;
}

std::optional<LineCall> Handshake::take(const LineState& state, Time now) {
    advance(state, now);
    if (phase_ != Phase::called) return std::nullopt;
    phase_ = Phase::busy;
    results_ = state.results;
    not_followed_ = other_called_ = false;
    return LineCall{
        called_, std::chrono::duration_cast<std::chrono::nanoseconds>(called_at_.time_since_epoch()).count()};
}

HandshakeBits Handshake::bits(const LineState& state, Time now) {
    HandshakeBits bits;
    bits.alarm = state.alarm;
    bits.result = state.result;
    if (silent(now)) bits.alarm = LineAlarm::line_silent;
    if (!options_.line_starts) {
        bits.ready = state.ready;
        bits.busy = state.busy;
        bits.done = !state.busy && state.results > 0;
        return bits;
    }
    advance(state, now);
    bits.ready = state.ready && (phase_ == Phase::idle || (phase_ == Phase::done && result_stays_));
    bits.busy = phase_ == Phase::busy;
    bits.done = phase_ == Phase::done;
    shown_ = shown_ || (bits.done && heard_);
    if (bits.done && not_followed_) {
        bits.result = LineResult::not_measured;
        bits.alarm = LineAlarm::call_not_followed;
    }
    if (bits.done && !result_stays_ && options_.drop_timeout.count() > 0 &&
        now - done_at_ > options_.drop_timeout)
        bits.alarm = LineAlarm::start_not_dropped;
    return bits;
}

}  // namespace seamwright
