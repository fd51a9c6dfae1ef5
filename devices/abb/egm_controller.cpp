// The robot's end of EGM path correction, before a simulated cell.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <limits>
#include <mutex>
#include <thread>

#include "devices/abb/egm.h"
#include "devices/abb/egm_message.h"
#include "devices/cyclic/path.h"
#include "devices/exchange/json_fields.h"
#include "devices/net/socket.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
constexpr std::size_t kHistory = 20000;
constexpr int kStandsAtEnd_ms = 100;

struct Options {
    std::string address = "127.0.0.1";
    int port = 6510, cycle_ms = 4, late_limit = 100, restart_ms = 700, slow_ms = 300, ramp_out_ms = 200;
    double max_translation_mm = 20, path_s = 2;
    bool application = true;
    SimulatedPath path;
};

class Egm final : public SimulatedEgm {
  public:
    Egm(Options options, UdpSocket socket, std::unique_ptr<SimulatedController> measuring)
        : options_(std::move(options)),
          socket_(std::move(socket)),
          measuring_(std::move(measuring)),
          thread_([this] { run(); }) {}
    ~Egm() override {
        stop_ = true;
        socket_.close();
        thread_.join();
    }
    std::uint16_t port() const override { return static_cast<std::uint16_t>(options_.port); }
    Sample newest() const override {
        const std::lock_guard lock(mutex_);
        return history_.empty() ? Sample{} : history_.back();
    }
    std::vector<Sample> history() const override {
        const std::lock_guard lock(mutex_);
        return {history_.begin(), history_.end()};
    }
    std::uint64_t stops() const override { return stops_; }
    SimulatedController* measuring() override { return measuring_.get(); }

  private:
    void run() {
        auto next = Clock::now();
        std::uint64_t cycle = 0;
        std::uint32_t seqno = 0;
        bool half_sent = false;
        int off_ms = 0;       // EGM is stopped for so long yet
        int standing_ms = 0;  // at the end of the path
        double left_ms = -1;  // of the path, once a correction is in force
        EgmMci stopped = EgmMci::error;
        while (!stop_) {
            next += milliseconds(options_.cycle_ms);
            const bool at_end = options_.application && left_ms == 0;
            if (!at_end && off_ms <= 0) ++cycle;  // without EGM it stands: its program has ended or raised
            ++clock_;
            const ControllerFault kind = fault();
            if (kind == ControllerFault::slow) {
                for (int waited = 0; waited < options_.slow_ms && !stop_; waited += 10)
                    std::this_thread::sleep_for(milliseconds(10));
                const auto missed = static_cast<std::uint32_t>(options_.slow_ms / options_.cycle_ms);
                seqno += missed;
                cycle += missed;
                clock_ += missed;
            }
            next = std::max(next, Clock::now() + milliseconds(1));
            const double time = static_cast<double>(cycle) * options_.cycle_ms / 1e3;
            const Pose programmed = options_.path.at(time);
            const Eigen::Vector3d travel = options_.path.tangent(time);
            EgmState s;
            s.seqno = ++seqno;
            s.tm_ms = static_cast<std::uint32_t>(clock_) * static_cast<std::uint32_t>(options_.cycle_ms);
            s.planned = programmed;
            s.measured = corrected(programmed, travel);
            s.motors_on = s.rapid_running = true;
            s.mci = off_ms > 0 ? stopped : EgmMci::running;
            if (kind == ControllerFault::out_of_range) {
                s.planned->translation().x() = 1e9;
                s.measured->translation().z() = std::numeric_limits<double>::infinity();
            }
            if (kind != ControllerFault::half_message && kind != ControllerFault::disconnect)
                half_sent = false;
            send(kind, s, half_sent);
            const bool answered = await_answer(next, s.tm_ms);
            without_answer_ = answered ? 0 : without_answer_ + 1;
            if (off_ms > 0) {
                // What is told is not taken; what was in force is led out in ramp_out_ms.
                const Eigen::Vector3d step =
                    out_ * (static_cast<double>(options_.cycle_ms) / options_.ramp_out_ms);
                in_force_ = in_force_.norm() <= step.norm() ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                                            : Eigen::Vector3d(in_force_ - step);
                told_.setZero();
                off_ms -= options_.cycle_ms;
                without_answer_ = 0;
                if (off_ms <= 0) in_force_.setZero();
            } else {
                in_force_ = told_;
            }
            if (measured_.begins(measuring_.get())) part_begins();
            const bool correcting = !told_.isZero(0);
            if (correcting && left_ms < 0) left_ms = options_.path_s * 1000;
            if (left_ms > 0) left_ms = std::max(0.0, left_ms - options_.cycle_ms);
            standing_ms = at_end ? standing_ms + options_.cycle_ms : 0;
            const bool over = standing_ms > kStandsAtEnd_ms;
            if (over || without_answer_ > options_.late_limit || told_.norm() > options_.max_translation_mm ||
                (kind == ControllerFault::reject_write && correcting)) {
                if (over)
                    take();
                else
                    ++stops_;
                stopped = over ? EgmMci::stopped : EgmMci::error;
                out_ = in_force_;
                told_.setZero();
                without_answer_ = 0;
                left_ms = -1;
                standing_ms = 0;
                off_ms = options_.restart_ms;
                withdraw();
            } else if (correcting && !released()) {
                take_verdict(PartVerdict::corrected);
            } else if (!correcting && released()) {
                withdraw();
            }
            const std::lock_guard lock(mutex_);
            history_.push_back({programmed, corrected(programmed, travel), in_force_, travel});
            if (history_.size() > kHistory) history_.pop_front();
        }
    }

    // Across the path only.
    Pose corrected(const Pose& programmed, const Eigen::Vector3d& travel) const {
        Pose pose = programmed;
        if (const auto path = reference_from_path(travel, programmed.linear().col(2)))
            pose.translation() += in_force_.y() * path->col(1) + in_force_.z() * path->col(2);
        return pose;
    }

    void send(ControllerFault kind, const EgmState& s, bool& half_sent) {
        std::array<std::byte, 1024> buffer;
        const Endpoint to{options_.address, static_cast<std::uint16_t>(options_.port)};
        auto bytes = write_egm_robot(buffer, s);
        switch (kind) {
            case ControllerFault::silent:
                return;
            case ControllerFault::half_message:
            case ControllerFault::disconnect:
                if (!half_sent) (void)socket_.send_to(bytes.first(bytes.size() / 2), to);
                half_sent = true;
                return;
            case ControllerFault::wrong_answer:
                bytes = write_egm_path_correction(buffer, {s.seqno, s.tm_ms, 0, Eigen::Vector3d::Zero()});
                break;
            default:
                break;
        }
        (void)socket_.send_to(bytes, to);
    }

    // Takes every correction of the cycle, the newest counts. One that tells this cycle's time is not
    // followed by another: only what was late lies before it.
    bool await_answer(Clock::time_point until, std::uint32_t tm_ms) {
        std::array<std::byte, kLargestEgmMessage> buffer;
        bool answered = false, newest = false;
        while (!stop_ && !newest && Clock::now() < until) {
            Endpoint from;
            const auto rest = std::chrono::duration_cast<milliseconds>(until - Clock::now());
            const auto size = socket_.receive(buffer, from, std::max(rest, milliseconds(1)));
            if (!size) {
                if (!is_silence(size.error())) std::this_thread::sleep_for(milliseconds(1));
                continue;
            }
            const auto correction = parse_egm_path_correction(std::span(buffer).first(*size));
            if (!correction) continue;
            told_ = correction->pos_mm;
            answered = true;
            newest = correction->tm_ms == tm_ms;
        }
        std::this_thread::sleep_until(until);
        return answered;
    }

    const Options options_;
    UdpSocket socket_;
    std::unique_ptr<SimulatedController> measuring_;
    NextPart measured_;
    Eigen::Vector3d told_ = Eigen::Vector3d::Zero(), in_force_ = told_, out_ = told_;
    std::uint64_t clock_ = 0;  // cycles
    int without_answer_ = 0;
    std::atomic<std::uint64_t> stops_ = 0;
    mutable std::mutex mutex_;
    std::deque<Sample> history_;
    std::atomic<bool> stop_ = false;
    std::thread thread_;
};

}  // namespace

Expected<std::unique_ptr<SimulatedController>> start_abb_egm(std::shared_ptr<SimulatedCell> cell,
                                                             const nlohmann::json& settings,
                                                             StartController start_controller) {
    if (auto ok = only_fields(
            settings,
            {"address", "port", "cycle_ms", "late_limit", "max_translation_mm", "restart_ms", "speed_mm_s",
             "straight", "slow_ms", "ramp_out_ms", "application", "path_s", "measuring"},
            "");
        !ok)
        return tl::unexpected(ok.error());
    Options o;
    auto address = json_string_or(settings, "address", o.address, "");
    if (!address) return tl::unexpected(address.error());
    o.address = *address;
    for (const auto& [key, value] : {std::pair<const char*, int*>{"port", &o.port},
                                     {"cycle_ms", &o.cycle_ms},
                                     {"late_limit", &o.late_limit},
                                     {"restart_ms", &o.restart_ms},
                                     {"ramp_out_ms", &o.ramp_out_ms},
                                     {"slow_ms", &o.slow_ms}}) {
        auto number = json_number_or(settings, key, *value, "");
        if (!number) return tl::unexpected(number.error());
        if (!(*number >= 1 && *number <= 65535)) return input_error("not within 1 and 65535", key);
        *value = static_cast<int>(*number);
    }
    for (const auto& [key, value] :
         {std::pair<const char*, double*>{"max_translation_mm", &o.max_translation_mm},
          {"path_s", &o.path_s},
          {"speed_mm_s", &o.path.speed_mm_s}}) {
        auto number = json_number_or(settings, key, *value, "");
        if (!number) return tl::unexpected(number.error());
        if (!(*number >= 0 && *number <= 1e4)) return input_error("not within 0 and 10000", key);
        *value = *number;
    }
    auto straight = json_bool_or(settings, "straight", false, "");
    if (!straight) return tl::unexpected(straight.error());
    o.path.straight = *straight;
    auto application = json_bool_or(settings, "application", o.application, "");
    if (!application) return tl::unexpected(application.error());
    o.application = *application;
    auto measuring = start_measuring_controller(settings, std::move(cell), start_controller);
    if (!measuring) return measuring;
    auto socket = UdpSocket::bind(o.address == "127.0.0.1" ? "127.0.0.1" : "0.0.0.0", 0);
    if (!socket) return tl::unexpected(socket.error());
    return std::make_unique<Egm>(std::move(o), std::move(*socket), std::move(*measuring));
}

}  // namespace seamwright
