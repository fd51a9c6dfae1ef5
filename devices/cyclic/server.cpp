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
constexpr std::uint64_t kFarBack = 1000;  // cycles: older than that is no late packet but a new session
}  // namespace

Expected<std::unique_ptr<CyclicServer>> CyclicServer::start(const CyclicSettings& settings,
                                                            std::unique_ptr<CyclicProtocol> protocol) {
    auto socket = UdpSocket::bind(settings.listen, settings.port);
    if (!socket) return tl::unexpected(socket.error());
    std::unique_ptr<CyclicServer> server(new CyclicServer(settings, std::move(protocol), std::move(*socket)));
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
      protocol_(std::move(protocol)),
      socket_(std::move(socket)),
      port_(socket_.port()),
      ramp_(settings.ramp, settings.cycle_ms / 1e3) {}

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
        if (size) {
            handle(std::span(buffer).first(*size), from);
        } else if (!is_silence(size.error()) && !stop_) {
            // Oversized, or refused by the system (a peer's closed port): counted, never parsed.
            const std::lock_guard lock(mutex_);
            ++counters_.bad;
        }
        const std::lock_guard lock(mutex_);
        if (state_.age_ns >= 0 && robot_ &&
            Clock::now() - last_ > std::chrono::milliseconds(settings_.session_gap_ms)) {
            if (!ramp_.zero() || !ramp_.target_is_zero())
                raise(
                    "the robot fell silent under a correction; it drops the correction when it starts anew");
            robot_.reset();
            ramp_.reset();
            state_.steady = 0;
        }
    }
}

void CyclicServer::raise(const char* reason) {
    if (!alarm_) alarm_ = reason;
    if (!ramp_.target_is_zero()) ramp_.set_target(Pose::Identity());
    state_.steady = 0;
}

void CyclicServer::handle(std::span<const std::byte> datagram, const Endpoint& from) {
    const auto received = Clock::now();
    const std::lock_guard lock(mutex_);
    if ((robot_ && *robot_ != from &&
         received - last_ < std::chrono::milliseconds(settings_.session_gap_ms)) ||
        (!settings_.robot_address.empty() && from.address != settings_.robot_address)) {
        ++counters_.strangers;
        stranger_ = from;
        return;
    }
    const auto parsed = protocol_->parse(datagram);
    if (!parsed) {
        ++counters_.bad;
        return;
    }
    const CyclicPacket& packet = *parsed;
    const bool known = robot_.has_value();
    const std::uint64_t before = state_.packet.number;
    bool fresh = !known;
    std::uint64_t missed = 0;
    if (known) {
        if (packet.number <= before) {
            if (before - packet.number <= kFarBack * packet.numbers_per_cycle) {
                ++counters_.out_of_order;
                if (++old_in_row_ == settings_.max_late && !(ramp_.zero() && ramp_.target_is_zero()))
                    raise("the robot repeats old cycle numbers");
                return;
            }
            fresh = true;
        } else if (packet.late < last_late_) {
            fresh = true;  // the count of late answers began anew
        } else {
            missed = (packet.number - before) / packet.numbers_per_cycle;
            missed = missed > 0 ? missed - 1 : 0;
        }
    }
    old_in_row_ = 0;
    if (fresh) {
        if (known && !(ramp_.zero() && ramp_.target_is_zero()))
            raise("the robot began a new session under a correction");
        ramp_.reset();
        protocol_->new_session();
        ++counters_.sessions;
        last_late_ = packet.late;
        trouble_ = 0;
        frozen_ = false;
        state_.steady = 0;
        robot_ = from;
    }
    last_ = received;
    if (packet.problem) {
        ++counters_.bad;
        if (!(ramp_.zero() && ramp_.target_is_zero())) raise(packet.problem);
    } else {
        ++counters_.packets;
    }
    const std::uint64_t newly_late = packet.late > last_late_ ? packet.late - last_late_ : 0;
    last_late_ = packet.late;
    counters_.late += newly_late;
    counters_.missed_cycles += missed;

    const bool active = !(ramp_.zero() && ramp_.target_is_zero());
    if (active) {
        trouble_ += newly_late + missed;
        if (trouble_ >= static_cast<std::uint64_t>(settings_.max_late))
            raise("too many late or lost packets under a correction");
        if (protocol_->incremental() && newly_late + missed > 0 && !ramp_.arrived() && !frozen_) {
            raise("an increment was lost: the sum of the relative corrections in the robot is unknown");
            frozen_ = true;
        }
        if (!packet.running) raise("the controller left the state in which it takes corrections");
    } else {
        trouble_ = 0;
    }

    // Where the path is; a position that cannot be reached counts as none.
    Eigen::Vector3d position = state_.packet.programmed ? state_.packet.programmed->translation()
                                                        : Eigen::Vector3d(Eigen::Vector3d::Zero());
    std::optional<Pose> programmed = state_.packet.programmed;
    if (!packet.problem) {
        std::optional<Pose> now = packet.programmed;
        if (!now && packet.actual) {  // without what was added to it
            now = packet.actual;
            now->translation() -= state_.correction.offset_mm;
            now->linear() = rotation_exp(-state_.correction.turn_rad) * now->linear();
        }
        if (now) {
            const double reach =
                settings_.max_path_speed_mm_s * settings_.cycle_ms / 1e3 * static_cast<double>(missed + 1);
            if (active && !fresh && programmed && (now->translation() - position).norm() > reach)
                raise("the robot's position jumped further than it can move");
            programmed = now;
            position = now->translation();
        }
    }
    CyclicCorrection correction = state_.correction;
    if (fresh) correction = {};
    if (!frozen_) correction = ramp_.step(position);
    const double size = correction.offset_mm.norm();
    if (size > settings_.max_translation_mm) {
        correction.offset_mm *= settings_.max_translation_mm / size;
        raise("the correction left its limit on the way");
    }
    const auto bytes = protocol_->answer({packet.number, packet.numbers_per_cycle, packet.late, programmed,
                                          packet.actual, packet.problem, packet.running, packet.mode},
                                         correction);
    if (!bytes.empty() && socket_.send_to(bytes, from)) ++counters_.answers;
    latency_.record((Clock::now() - received).count());

    state_.steady = ramp_.arrived() && protocol_->settled() && newly_late + missed == 0 && !packet.problem
                        ? state_.steady + 1
                        : 0;
    state_.packet = packet;
    state_.packet.programmed = programmed;
    state_.correction = correction;
    state_.age_ns = 0;
}

void CyclicServer::set_target(const Pose& displacement) {
    const std::lock_guard lock(mutex_);
    ramp_.set_target(displacement);
    trouble_ = 0;
    state_.steady = 0;
}

CyclicServer::State CyclicServer::state() const {
    const std::lock_guard lock(mutex_);
    State state = state_;
    if (state.age_ns >= 0) state.age_ns = (Clock::now() - last_).count();
    state.arrived = ramp_.arrived();
    state.zero = ramp_.zero();
    return state;
}

std::string CyclicServer::last_stranger() const {
    const std::lock_guard lock(mutex_);
    return stranger_ ? fmt::format("{}:{}", stranger_->address, stranger_->port) : std::string();
}

CyclicCounters CyclicServer::counters() const {
    CyclicCounters counters;
    {
        const std::lock_guard lock(mutex_);
        counters = counters_;
    }
    counters.latency_p50_us = latency_.percentile_us(0.5);
    counters.latency_p99_us = latency_.percentile_us(0.99);
    counters.latency_max_us = latency_.max_us();
    return counters;
}

std::optional<std::string> CyclicServer::alarm() const {
    const std::lock_guard lock(mutex_);
    return alarm_ ? std::optional<std::string>(alarm_) : std::nullopt;
}

std::optional<std::string> CyclicServer::take_alarm() {
    const std::lock_guard lock(mutex_);
    const char* reason = std::exchange(alarm_, nullptr);
    return reason ? std::optional<std::string>(reason) : std::nullopt;
}

}  // namespace seamwright
