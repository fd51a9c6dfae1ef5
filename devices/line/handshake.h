#pragma once
// Start, busy, done as a PLC expects it, without sockets and clocks: who calls gives words and time.
//
// The line starts parts:
//   start 0 -> 1   called; part type, number and name are those of this instant
//   taken          busy
//   result         done, result valid, busy gone
//   start 1 -> 0   done gone: idle
// A start that is 1 when the line is first heard, or after it was lost, starts nothing: it has to be seen at 0.
// Dropped before busy: the call is withdrawn. Dropped while busy: the part is given up (LineLink::given_up), its result
// stays `done` until the next start, which may come at once: ready stands beside it. So does that of a part which ended
// while the line was away, where its start has gone meanwhile. A line that comes back with start 1 and another part than
// it called for has given that one up: its call for the other is answered by not_measured, never by the former's result.
// Not taken in call_timeout: done with not_measured. Not dropped in drop_timeout: an alarm, and nothing starts until it is.
// The line is silent when its heartbeat has not changed for heartbeat_timeout (0: not watched): a waiting call is
// withdrawn, nothing starts, an alarm.
//
// The robots start parts (line_starts false): start is not looked at, busy and done follow the station.

#include <chrono>

#include "devices/line/line_link.h"

namespace seamwright {

struct HandshakeOptions {
    bool line_starts = false;
    std::chrono::milliseconds call_timeout{5000}, drop_timeout{10000}, heartbeat_timeout{0};
};

struct LineWords {
    std::uint16_t heartbeat = 0;
    bool start = false;
    LinePart part;
};

struct HandshakeBits {
    bool ready = false, busy = false, done = false;
    LineResult result = LineResult::none;
    LineAlarm alarm = LineAlarm::none;
};

class Handshake {
  public:
    using Time = std::chrono::steady_clock::time_point;
    explicit Handshake(const HandshakeOptions& options) : options_(options) {}

    void hear(const LineWords& words, Time now);  // as the line's words stand now
    void lost();                                  // the line is away
    std::optional<LineCall> take(const LineState& state, Time now);
    HandshakeBits bits(const LineState& state, Time now);
    bool given_up() const { return phase_ == Phase::busy && (!words_.start || other_called_); }
    const LinePart& part() const { return words_.part; }

  private:
    enum class Phase { unseen, idle, called, busy, done };
    void advance(const LineState& state, Time now);
    void not_followed(Time now);
    bool silent(Time now) const;

    HandshakeOptions options_;
    Phase phase_ = Phase::unseen;
    bool heard_ = false;
    LineWords words_;
    LinePart called_;
    Time beat_{}, called_at_{}, done_at_{};
    std::uint32_t results_ = 0;  // when the call was taken
    bool not_followed_ = false;  // the call ended without the station
    bool result_stays_ = false;  // start went before the result came
    bool shown_ = false;         // `done`, to a line that was there
    bool other_called_ = false;  // while the line was away, and the part before is still measured
};

}  // namespace seamwright
