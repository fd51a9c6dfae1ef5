#pragma once
// What a robot that asks in every interpolation cycle is told, packet by packet. No clock, no socket, no
// thread.
//
// THE INVARIANT. Whatever arrives, in whatever order, late, twice or not at all: from one cycle to the next
// the correction in the robot changes by no more than
//     speed_mm_s * cycle  and  speed_deg_s * cycle,
// the shift that a turning displacement adds along a running path included; and either the robot holds what
// state().held says (to a step of that size after cycle numbers that jumped, to follow_tolerance for sums),
// or there is an alarm.
//
// It follows from two rules. (1) The robot's correction is what it has taken, not what was sent: an answer
// counts once the next packet tells that it came in time (`late` has not risen; for a protocol that does not
// tell, the step is divided by the number of answers that may be lost). Until then the ramp stays where it
// was, and every answer lies within one step of what the robot holds. A late answer leaves what it holds:
// RSI with HOLDON as shipped, EGM. (2) Where the bookkeeping may be broken (cycle numbers that jump, fall or
// wrap, packets lost or late, silence, a peer with another port) the robot is asked: what it shows
// (evidence.h) decides between what it held and zero. Only zero can have come about without us: a new session
// begins with no correction, and a configuration that lets go of a late correction drops it. What is shown
// speaks before the numbers; where it says nothing, numbers that go on mean the session goes on.
//   - A robot that shows zero within an unbroken session is not answered for kSuspicion packets, which leaves
//     it what it has, until it is certain.
//   - A robot that is found with a correction that nobody here has told (this program was ended in the
//     middle) is led back from there. One that shows its servo's lag too, as it moves, is not answered until the lag is
//     known (kLargestLag_s).
//
// An alarm ramps back to zero while the answers go on. The correction is held nowhere: holding it while the
// path runs on is no smaller a deviation, and only looks like calm. Alarms: `max_late` late or missed cycles
// while a correction is in force (one is forgotten per 250 good ones), `max_late` packets in a row with old
// numbers, a programmed position that jumps further than `max_path_speed_mm_s` allows, numbers that no robot
// can mean, an element that is missing, an offset beyond the limit, a correction that the robot does not
// show within follow_tolerance for follow_ms, a new session or silence under a correction. An alarm is kept
// until take_alarm().
//
// While the path runs a steering (steering.h) may add an offset to the confirmed correction, within the same limits;
// what it raises is an alarm like the others.
//
// No path runs on without its permission: one that goes before the path is over stops the robot. It does so
// by `released`, which falls with the next answer while the correction is led back, or, where the protocol
// has none (stops_unanswered), by no answer at all; such a robot keeps its correction until it stands.

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "devices/cyclic/evidence.h"
#include "devices/cyclic/protocol.h"
#include "devices/cyclic/statistics.h"
#include "devices/cyclic/steering.h"

namespace seamwright {

struct CyclicArrival {
    bool gap = false, other_peer = false;
    std::int64_t heard_ns = 0;  // steady clock; for who steers
};

class CyclicCorrector {
  public:
    CyclicCorrector(const CyclicSettings& settings, std::unique_ptr<CyclicProtocol> protocol);

    // Books one datagram. False: it is no packet of the protocol, and nothing has changed. `gap`: nothing
    // came for session_gap_ms before it; `other_peer`: it is of another peer than the packet before.
    bool handle(std::span<const std::byte> datagram, const CyclicArrival& arrival = {});
    // The answer to the newest packet, once; empty where none is owed. It lives until the next call.
    std::span<const std::byte> answer();
    void silence();  // nothing came for session_gap_ms

    void set_target(const Pose& displacement);  // in the reference frame
    void withdraw();                            // the permission too
    void await_path();                          // the correction is confirmed: the path may run
    // nullptr: nobody steers any more.
    void steer(std::shared_ptr<PathSteering> steering) { steering_ = std::move(steering); }
    void forget_path() { phase_ = PathPhase::none; }  // another correction is about to be confirmed

    struct State {
        std::int64_t age_ns = -1;  // since the newest good packet; -1 before the first (server.h fills it in)
        CyclicPacket packet;
        CyclicTold held;           // as the robot has it
        CyclicTold told;           // as sent last
        bool arrived = false;      // the ramp is at its end
        bool zero = true;          // the robot holds nothing, by its own account, and is told nothing
        bool silent = true;        // no packet for session_gap_ms
        bool follows = false;      // it shows what it holds
        Misfit misfit;             // of what it shows to what it holds
        std::uint64_t steady = 0;  // packets in a row since arrival that were in time and showed it
        std::uint64_t session = 0;
        PathPhase path = PathPhase::none;
    };
    State state() const;
    const CyclicCounters& counters() const { return counters_; }
    CyclicCounters& counters() { return counters_; }
    const std::optional<Text>& alarm() const { return alarm_; }
    std::optional<Text> take_alarm();
    bool at_zero() const;  // nothing is in force and nothing wanted
    const char* why_not_told() const { return protocol_->why_not_told(); }

  private:
    enum class Relation { first, next, gap, jump, old };
    Relation relate(const CyclicPacket& packet, const CyclicArrival& arrival);
    enum class Holds { on, zero, unknown };
    Holds judge(const CyclicPacket& packet, const std::optional<CyclicTold>& shown, Relation relation);
    bool adopt(const CyclicPacket& packet, const std::optional<CyclicTold>& shown, double moved_mm);
    void commit(bool taken);
    void drop(const char* reason, bool new_session);
    void watch_late(const CyclicPacket& packet, std::uint64_t missed);
    void watch_follow(const std::optional<CyclicTold>& shown);
    void watch_path(const CyclicPacket& packet, double speed_mm_s);
    void ask_steering();
    void restart_from(const CyclicTold& found);
    void raise(Text reason);
    void lead_back();
    void revoke();
    void path_is_over();

    const CyclicSettings settings_;
    const double cycle_s_, step_mm_, step_rad_, tolerance_rad_;
    std::unique_ptr<CyclicProtocol> protocol_;
    CorrectionRamp ramp_, sent_ramp_;  // as taken by the robot; as sent
    CyclicTold held_, told_;
    HeldHistory history_;
    CyclicPacket last_;
    bool known_ = false, silent_ = true;
    bool owed_ = false;         // the newest packet has no answer yet
    bool pause_ = false;        // the next answer tells what the robot has, no more
    bool clean_ = false;        // and was in order
    bool not_running_ = false;  // by the packet before
    bool followed_ = false;     // it has shown a correction of ours since zero
    bool ever_told_ = false;    // anything but zero
    bool showed_zero_ = false;  // it has shown in this session that it holds nothing
    bool follows_ = false, settled_ = true;
    Misfit misfit_;
    bool looked_ = false;  // whether the robot holds what nobody here has told
    int found_ = 0;        // packets in a row that show the same, standing
    CyclicTold found_shown_;
    int suspicion_ = 0;  // packets in a row that show zero instead of what was taken
    int open_ = 0;       // packets since numbers that jumped, of which it is not known what the robot holds
    int deviating_ = 0;  // packets in a row
    int repeated_ = 0;   // packets in a row with old numbers
    int running_back_ = 0;  // of them, each the follower of the one before
    std::uint64_t old_number_ = 0, steady_ = 0, cycles_ = 1, good_ = 0;
    std::uint64_t trouble_ = 0;
    PathPhase phase_ = PathPhase::none;
    bool permitted_ = false;   // since await_path(), and the path is not over
    bool unanswered_ = false;  // until the robot has stopped
    bool run_before_ = false;  // what is under way is no path of this permission
    Eigen::Vector3d path_begin_ = Eigen::Vector3d::Zero();
    int standing_ = 0;  // packets in a row
    std::shared_ptr<PathSteering> steering_;
    std::optional<Text> alarm_;
    CyclicCounters counters_;
};

}  // namespace seamwright
