#include "devices/controllers/abb/egm_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <limits>
#include <mutex>
#include <thread>

#include "abb_application.h"
#include "devices/abb/egm_message.h"
#include "devices/abb/program.h"
#include "devices/controllers/abb/egm_application.h"
#include "devices/controllers/cyclic/read_within.h"
#include "devices/controllers/cyclic/simulated_path.h"
#include "devices/exchange/json_fields.h"
#include "devices/net/socket.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
constexpr std::size_t kHistory = 20000;

struct EgmRobotOptions {
    std::string address = "127.0.0.1";
    int port = 6510, cycle_ms = 4, late_limit = 100, restart_ms = 700, slow_ms = 300, ramp_out_ms = 200;
    double max_translation_mm = 20, path_s = 2;
    bool application = true;
    SimulatedPath path;
};

class Egm final : public SimulatedEgm {
  public:
    Egm(EgmRobotOptions options, UdpSocket socket, std::unique_ptr<SimulatedController> measuring)
        : options_(std::move(options)), socket_(std::move(socket)), measuring_(std::move(measuring)) {}
    ~Egm() override {
        stop_ = true;
        socket_.close();
        if (thread_.joinable()) thread_.join();
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

    std::vector<std::string> messages() const override { return application_->messages(); }
    // Throws rapid::LoadError.
    void start(std::shared_ptr<SimulatedCell> cell, const std::vector<rapid::SourceText>& modules) {
        cell_ = std::move(cell);
        rapid::EgmApplicationSettings settings;
        settings.path = options_.path;
        settings.path_s = options_.path_s;
        settings.ends = options_.application;
        settings.cycle_ms = options_.cycle_ms;
        settings.restart_ms = options_.restart_ms;
        application_ = std::make_unique<rapid::EgmApplication>(settings, modules);
        thread_ = std::thread([this] { run(); });
    }

  private:
    void run() {
        auto next = Clock::now();
        std::uint32_t seqno = 0;
        bool half_sent = false, answered = false;
        rapid::EgmApplication::Now before;
        while (!stop_) {
            next += milliseconds(options_.cycle_ms);
            int passed_ms = options_.cycle_ms;
            const ControllerFault kind = fault();
            if (kind == ControllerFault::slow) {
                for (int waited = 0; waited < options_.slow_ms && !stop_; waited += 10)
                    std::this_thread::sleep_for(milliseconds(10));
                passed_ms += options_.slow_ms;
                seqno += static_cast<std::uint32_t>(options_.slow_ms / options_.cycle_ms);
            }
            next = std::max(next, Clock::now() + milliseconds(1));
            clock_ms_ += passed_ms;
            const auto now = application_->cycle(passed_ms, answered, permitted());
            const bool running = now.mci == EgmMci::running;
            if (now.paths > before.paths) take();
            if (now.stops > before.stops) withdraw();
            stops_ = now.stops;
            if (before.mci == EgmMci::running && !running) {
                out_ = in_force_;
                told_.setZero();
            }
            before = now;
            const Pose actual = corrected(now.programmed, now.travel);
            if (running && permitted()) options_.path.carry(cell_.get(), actual);
            EgmState s;
            s.seqno = ++seqno;
            s.tm_ms = static_cast<std::uint32_t>(clock_ms_);
            s.planned = now.programmed;
            s.measured = actual;
            s.motors_on = s.rapid_running = true;
            s.mci = now.mci;
            if (kind == ControllerFault::out_of_range) {
                s.planned->translation().x() = 1e9;
                s.measured->translation().z() = std::numeric_limits<double>::infinity();
            }
            if (kind != ControllerFault::half_message && kind != ControllerFault::disconnect)
                half_sent = false;
            if (now.talks) send(kind, s, half_sent);
            answered = await_answer(next, s.tm_ms);
            if (running) {
                in_force_ = told_;
            } else {
                told_.setZero();
                lead_out();
            }
            if (measured_.begins(measuring_.get())) part_begins();
            const bool correcting = !told_.isZero(0);
            if (told_.norm() > options_.max_translation_mm ||
                (kind == ControllerFault::reject_write && correcting))
                application_->egm_fails();
            else if (correcting && !released())
                take_verdict(PartVerdict::corrected);
            else if (!correcting && released())
                withdraw();
            const std::lock_guard lock(mutex_);
            history_.push_back(
                {now.programmed, corrected(now.programmed, now.travel), in_force_, now.travel});
            if (history_.size() > kHistory) history_.pop_front();
        }
    }

    // Without a measuring controller: a correction is in force.
    bool permitted() const {
        if (!measuring_) return !told_.isZero(0);
        return measuring_->verdict() == PartVerdict::corrected;
    }

    // What is told to a stopped EGM is not taken; what was in force goes within ramp_out_ms.
    void lead_out() {
        const Eigen::Vector3d step = out_ * (static_cast<double>(options_.cycle_ms) / options_.ramp_out_ms);
        in_force_ = in_force_.norm() <= step.norm() ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                                    : Eigen::Vector3d(in_force_ - step);
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

    const EgmRobotOptions options_;
    UdpSocket socket_;
    std::unique_ptr<SimulatedController> measuring_;
    std::shared_ptr<SimulatedCell> cell_;
    NextPart measured_;
    Eigen::Vector3d told_ = Eigen::Vector3d::Zero(), in_force_ = told_, out_ = told_;
    std::int64_t clock_ms_ = 0;
    std::unique_ptr<rapid::EgmApplication> application_;
    std::atomic<std::uint64_t> stops_ = 0;
    mutable std::mutex mutex_;
    std::deque<Sample> history_;
    std::atomic<bool> stop_ = false;
    std::thread thread_;
};

void replace(std::string& text, const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
}

// The delivered module with the sample rate of the settings and the time-out that the commissioning engineer chose.
Expected<std::vector<rapid::SourceText>> modules_of(const EgmRobotOptions& o) {
    ProgramRequest request;
    request.project = "the simulated cell";
    request.driver = "abb-egm";
    request.settings = {{"cycle_ms", o.cycle_ms}};
    SEAM_TRY(auto files, write_abb_program(request));
    std::string application(resources::SimEgmApplication_mod);
    replace(application, "@REST@", fmt::format("{:.3f}", o.restart_ms / 1e3));
    std::vector<rapid::SourceText> modules = {{"SimEgmApplication.mod", application}};
    for (ProgramFile& file : files) {
        if (file.name != "SeamwrightEgm.mod") continue;
        replace(file.text, "CommTimeout:=1",
                fmt::format("CommTimeout:={:.3f}", o.late_limit * o.cycle_ms / 1e3));
        modules.push_back({file.name, file.text});
    }
    return modules;
}

}  // namespace

Expected<std::unique_ptr<SimulatedController>> start_abb_egm(std::shared_ptr<SimulatedCell> cell,
                                                             const nlohmann::json& settings,
                                                             StartController start_controller) {
    if (auto ok = only_fields(settings,
                              {"address", "port", "cycle_ms", "late_limit", "max_translation_mm",
                               "restart_ms", "speed_mm_s", "straight", "slow_ms", "ramp_out_ms",
                               "application", "path_s", "path", "flange_from_tcp", "measuring"},
                              "");
        !ok)
        return tl::unexpected(ok.error());
    EgmRobotOptions o;
    SEAM_TRY(auto address, json_string_or(settings, "address", o.address, ""));
    o.address = address;
    SEAM_OK(read_within<int>(settings, 1, 65535,
                             {{"port", &o.port},
                              {"cycle_ms", &o.cycle_ms},
                              {"late_limit", &o.late_limit},
                              {"restart_ms", &o.restart_ms},
                              {"ramp_out_ms", &o.ramp_out_ms},
                              {"slow_ms", &o.slow_ms}}));
    SEAM_OK(read_within<double>(settings, 0, 1e4,
                                {{"max_translation_mm", &o.max_translation_mm},
                                 {"path_s", &o.path_s},
                                 {"speed_mm_s", &o.path.speed_mm_s}}));
    SEAM_TRY(auto straight, json_bool_or(settings, "straight", false, ""));
    o.path.straight = straight;
    SEAM_TRY(auto application, json_bool_or(settings, "application", o.application, ""));
    o.application = application;
    SEAM_OK(read_simulated_path(settings, o.path));
    auto measuring = start_measuring_controller(settings, cell, start_controller);
    if (!measuring) return measuring;
    SEAM_TRY(auto socket, UdpSocket::bind(o.address == "127.0.0.1" ? "127.0.0.1" : "0.0.0.0", 0));
    SEAM_TRY(auto modules, modules_of(o));
    auto controller = std::make_unique<Egm>(o, std::move(socket), std::move(*measuring));
    try {
        controller->start(std::move(cell), modules);
    } catch (const rapid::LoadError& e) {
        return input_error(e.what(), "programs of the ABB controller");
    }
    return controller;
}

}  // namespace seamwright
