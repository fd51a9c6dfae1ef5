#include "devices/cyclic/server.h"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>

#include <array>
#include <utility>

namespace seamwright {
namespace {
using Clock = std::chrono::steady_clock;
constexpr std::size_t kLargestDatagram = 8192;
constexpr int kMostAtOnce = 64;             // datagrams that are booked before the newest packet is answered
constexpr std::size_t kMostTakeovers = 16;  // kept until somebody asks

std::string text(const Endpoint& e) {
    return fmt::format("{}:{}", e.address, e.port);
}
}  // namespace

Expected<std::unique_ptr<CyclicServer>> CyclicServer::start(const CyclicSettings& settings,
                                                            std::unique_ptr<CyclicProtocol> protocol) {
    SEAM_TRY(auto socket, UdpSocket::bind(settings.listen, settings.port));
    std::unique_ptr<CyclicServer> server(new CyclicServer(settings, std::move(protocol), std::move(socket)));
    server->thread_ = std::thread([s = server.get()] { s->run(); });
    // Needs a right that a plant's PC grants and a test machine does not; without it the counters tell.
    sched_param priority{};
    priority.sched_priority = sched_get_priority_max(SCHED_FIFO) - 10;
    (void)pthread_setschedparam(server->thread_.native_handle(), SCHED_FIFO, &priority);
    return server;
}

CyclicServer::CyclicServer(const CyclicSettings& settings, std::unique_ptr<CyclicProtocol> protocol,
                           UdpSocket socket)
    : settings_(settings),
      socket_(std::move(socket)),
      port_(socket_.port()),
      corrector_(settings, std::move(protocol)) {}

CyclicServer::~CyclicServer() {
    stop_ = true;
    socket_.close();
    if (thread_.joinable()) thread_.join();
}

std::uint16_t CyclicServer::port() const {
    return port_;
}

void CyclicServer::run() {
    std::array<std::byte, kLargestDatagram> buffer;
    Endpoint from;
    while (!stop_) {
        const auto size = socket_.receive(buffer, from, Timeout(50));
        const auto received = Clock::now();
        if (size) {
            const std::lock_guard lock(mutex_);
            bool of_robot = book(std::span(buffer).first(*size), from);
            for (int i = 1; i < kMostAtOnce && socket_.has_datagram(); ++i) {
                if (const auto more = socket_.receive(buffer, from, Timeout(1)))
                    of_robot = book(std::span(buffer).first(*more), from) || of_robot;
                else if (!book_unreadable(more.error()))
                    break;
            }
            const auto answer = corrector_.answer();
            if (!answer.empty() && robot_ && socket_.send_to(answer, *robot_)) ++answers_;
            if (of_robot) latency_.record((Clock::now() - received).count());
        } else {
            const std::lock_guard lock(mutex_);
            (void)book_unreadable(size.error());
        }
        const std::lock_guard lock(mutex_);
        if (!silent_ && Clock::now() - last_ > std::chrono::milliseconds(settings_.session_gap_ms)) {
            silent_ = true;
            corrector_.silence();
        }
    }
}

// Whether there was a datagram: oversized, or refused by the system (a peer's closed port). Counted, never
// parsed. Precondition: locked.
bool CyclicServer::book_unreadable(const Error& error) {
    if (is_silence(error) || stop_) return false;
    ++unreadable_;
    return true;
}

// Whether it is of the robot. Precondition: locked.
bool CyclicServer::book(std::span<const std::byte> datagram, const Endpoint& from) {
    const auto now = Clock::now();
    const bool known = robot_.has_value();
    const bool gap = known && now - last_ > std::chrono::milliseconds(settings_.session_gap_ms);
    const bool other = known && *robot_ != from;
    if ((other && !gap) || (!settings_.robot_address.empty() && from.address != settings_.robot_address)) {
        ++strangers_;
        stranger_ = from;
        return false;
    }
    if (gap && !silent_) {
        silent_ = true;
        corrector_.silence();
    }
    if (!corrector_.handle(datagram, {gap, other, std::chrono::nanoseconds(now.time_since_epoch()).count()}))
        return false;
    if (other && takeovers_.size() < kMostTakeovers)
        takeovers_.push_back(
            Text("the robot at {} fell silent, and {} took its place", text(*robot_), text(from)));
    robot_ = from;
    silent_ = false;
    last_ = now;
    return true;
}

void CyclicServer::set_target(const Pose& displacement) {
    const std::lock_guard lock(mutex_);
    corrector_.set_target(displacement);
}

void CyclicServer::withdraw() {
    const std::lock_guard lock(mutex_);
    corrector_.withdraw();
}

void CyclicServer::await_path() {
    const std::lock_guard lock(mutex_);
    corrector_.await_path();
}

void CyclicServer::forget_path() {
    const std::lock_guard lock(mutex_);
    corrector_.forget_path();
}

void CyclicServer::steer(std::shared_ptr<PathSteering> steering) {
    const std::lock_guard lock(mutex_);
    corrector_.steer(std::move(steering));
}

CyclicServer::State CyclicServer::state() const {
    const std::lock_guard lock(mutex_);
    State state = corrector_.state();
    if (robot_) state.age_ns = (Clock::now() - last_).count();
    state.silent = silent_;
    return state;
}

std::string CyclicServer::robot() const {
    const std::lock_guard lock(mutex_);
    return robot_ ? text(*robot_) : std::string();
}

std::string CyclicServer::last_stranger() const {
    const std::lock_guard lock(mutex_);
    return stranger_ ? text(*stranger_) : std::string();
}

std::vector<Text> CyclicServer::take_takeovers() {
    const std::lock_guard lock(mutex_);
    return std::exchange(takeovers_, {});
}

const char* CyclicServer::why_not_told() const {
    const std::lock_guard lock(mutex_);
    return corrector_.why_not_told();
}

CyclicCounters CyclicServer::counters() const {
    CyclicCounters counters;
    {
        const std::lock_guard lock(mutex_);
        counters = corrector_.counters();
        counters.strangers = strangers_;
        counters.answers = answers_;
        counters.bad += unreadable_;
    }
    counters.latency_p50_us = latency_.percentile_us(0.5);
    counters.latency_p99_us = latency_.percentile_us(0.99);
    counters.latency_max_us = latency_.max_us();
    return counters;
}

std::optional<Text> CyclicServer::alarm() const {
    const std::lock_guard lock(mutex_);
    return corrector_.alarm();
}

std::optional<Text> CyclicServer::take_alarm() {
    const std::lock_guard lock(mutex_);
    return corrector_.take_alarm();
}

}  // namespace seamwright
