#pragma once
// Answers a robot that asks in every interpolation cycle (UDP; RSI and EGM): one thread, as high a priority
// as the system grants, one datagram in, one out, nothing allocated in between. What is told, and that no
// cycle's step is beyond the limit: corrector.h.
//
// One peer, address and port, is the robot: the first that sends a packet of the protocol, or the one at
// `robot_address`, until it is silent for `session_gap_ms`. Everybody else is a stranger: not answered,
// counted, told. Another peer after such a silence takes over, which is told too, and begins a new session.
// Where packets have piled up (this machine paused), only the newest is answered: the others are late, and a
// robot that takes the newest answer would take all their steps at once.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "devices/cyclic/corrector.h"
#include "devices/net/socket.h"

namespace seamwright {

class CyclicServer {
  public:
    static Expected<std::unique_ptr<CyclicServer>> start(const CyclicSettings& settings,
                                                         std::unique_ptr<CyclicProtocol> protocol);
    ~CyclicServer();
    CyclicServer(const CyclicServer&) = delete;
    CyclicServer& operator=(const CyclicServer&) = delete;

    std::uint16_t port() const;
    // Thread-safe, all of them. They are the corrector's.
    using State = CyclicCorrector::State;
    State state() const;
    void set_target(const Pose& displacement);
    void withdraw();
    void await_path();
    void forget_path();
    void steer(std::shared_ptr<PathSteering> steering);
    std::optional<Text> alarm() const;
    std::optional<Text> take_alarm();
    CyclicCounters counters() const;
    const char* why_not_told() const;
    std::string robot() const;           // "192.168.1.5:59152"; empty before the first packet
    std::string last_stranger() const;   // empty when there was none
    std::vector<Text> take_takeovers();  // a sentence each

  private:
    CyclicServer(const CyclicSettings& settings, std::unique_ptr<CyclicProtocol> protocol, UdpSocket socket);
    void run();
    bool book_unreadable(const Error& error);
    bool book(std::span<const std::byte> datagram, const Endpoint& from);

    const CyclicSettings settings_;
    UdpSocket socket_;
    std::uint16_t port_ = 0;
    LatencyHistogram latency_;
    mutable std::mutex mutex_;
    CyclicCorrector corrector_;
    std::uint64_t strangers_ = 0, answers_ = 0, unreadable_ = 0;
    std::optional<Endpoint> stranger_, robot_;
    bool silent_ = true;  // whoever comes next is the robot
    std::vector<Text> takeovers_;
    std::chrono::steady_clock::time_point last_;
    std::atomic<bool> stop_ = false;
    std::thread thread_;
};

}  // namespace seamwright
