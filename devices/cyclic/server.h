#pragma once
// Answers a robot that asks in every interpolation cycle (UDP; RSI and EGM): one thread, as high a priority
// as the system grants, one datagram in, one out, nothing allocated in between.
//
// What happens when cycles go wrong. A robot that gets no answer in time goes on with the correction that it
// has (RSI: HOLDON, then an error after so many late packets; EGM: the last correction, then a time-out), and
// drops it when it starts a new session. Therefore
//   - the ramp counts packets, not time: after a pause it goes on from the correction sent last, and never
//     jumps to where a clock would have it;
//   - a new session (cycle numbers far back, or the first packet after `session_gap_ms` of silence) begins
//     with no correction;
//   - an alarm ramps back to zero while the answers go on. The correction is held nowhere: holding it while
//     the path runs on is no smaller a deviation, and only looks like calm;
//   - with relative corrections an answer that may be lost makes the sum in the robot unknown: from then on
//     all increments are zero until a new session.
// Alarms: `max_late` late or missed cycles while a correction is in force, `max_late` packets in a row with
// old numbers, a programmed position that jumps further than `max_path_speed_mm_s` allows, numbers that no
// robot can mean, an offset beyond the limit, a new session or silence under a correction. An alarm is kept
// until take_alarm().

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>

#include "devices/cyclic/ramp.h"
#include "devices/cyclic/statistics.h"
#include "devices/net/socket.h"
#include "devices/robot_link.h"

namespace seamwright {

struct CyclicPacket {
    std::uint64_t number = 0;                // IPOC, seqno
    std::uint64_t numbers_per_cycle = 1;     // IPOC counts milliseconds
    std::uint64_t late = 0;                  // answers that the robot counted as late, since its start
    std::optional<Pose> programmed, actual;  // reference_from_tcp, mm
    const char* problem = nullptr;  // numbers that cannot be meant: it is answered, but measures nothing
    bool running = true;            // the controller takes corrections (EGM: states)
    RobotMode mode = RobotMode::unknown;
};

// One protocol. Called from the server's thread only; the answer lives until the next call.
class CyclicProtocol {
  public:
    virtual ~CyclicProtocol() = default;
    virtual Expected<CyclicPacket> parse(std::span<const std::byte> datagram) = 0;
    virtual std::span<const std::byte> answer(const CyclicPacket& packet,
                                              const CyclicCorrection& correction) = 0;
    virtual void new_session() {}
    virtual bool settled() const { return true; }       // tells the whole of the correction it was given last
    virtual bool incremental() const { return false; }  // a lost answer makes the sum unknown
};

struct CyclicSettings {
    std::string listen = "127.0.0.1";
    std::uint16_t port = 0;
    std::string robot_address;  // empty: who comes first, until it is silent; not unless `listen` is loopback
    int cycle_ms = 4;
    RampLimits ramp;
    double max_translation_mm = 10, max_rotation_deg = 2;
    int max_late = 10;
    int session_gap_ms = 500;
    double max_path_speed_mm_s = 3000;
};

class CyclicServer {
  public:
    static Expected<std::unique_ptr<CyclicServer>> start(const CyclicSettings& settings,
                                                         std::unique_ptr<CyclicProtocol> protocol);
    ~CyclicServer();
    CyclicServer(const CyclicServer&) = delete;
    CyclicServer& operator=(const CyclicServer&) = delete;

    std::uint16_t port() const;
    // Thread-safe, all of them.
    void set_target(const Pose& displacement);  // in the reference frame
    void withdraw() { set_target(Pose::Identity()); }
    struct State {
        std::int64_t age_ns = -1;  // since the newest good packet; -1 before the first
        CyclicPacket packet;
        CyclicCorrection correction;  // as sent last
        bool arrived = false, zero = true;
        std::uint64_t steady =
            0;  // good packets in a row since arrival, none of them telling of a late answer
    };
    State state() const;
    CyclicCounters counters() const;
    std::string last_stranger() const;  // "192.168.1.7:4711"; empty when there was none
    std::optional<std::string> alarm() const;
    std::optional<std::string> take_alarm();

  private:
    CyclicServer(const CyclicSettings& settings, std::unique_ptr<CyclicProtocol> protocol, UdpSocket socket);
    void run();
    void handle(std::span<const std::byte> datagram, const Endpoint& from);
    void raise(const char* reason);  // precondition: locked

    const CyclicSettings settings_;
    std::unique_ptr<CyclicProtocol> protocol_;
    UdpSocket socket_;
    std::uint16_t port_ = 0;
    LatencyHistogram latency_;
    mutable std::mutex mutex_;
    CorrectionRamp ramp_;
    State state_;
    CyclicCounters counters_;
    std::optional<Endpoint> stranger_;
    std::optional<Endpoint> robot_;
    std::chrono::steady_clock::time_point last_;
    std::uint64_t last_late_ = 0, trouble_ = 0;
    int old_in_row_ = 0;
    bool frozen_ = false;  // incremental, sum unknown
    const char* alarm_ = nullptr;
    std::atomic<bool> stop_ = false;
    std::thread thread_;
};

}  // namespace seamwright
