#include "devices/controllers/kuka/rsi_controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <deque>
#include <mutex>
#include <thread>

#include "core/geometry/notation.h"
#include "devices/controllers/cyclic/read_within.h"
#include "devices/controllers/kuka/rsi_application.h"
#include "devices/exchange/json_fields.h"
#include "devices/kuka/rsi_program.h"
#include "devices/kuka/rsi_telegram.h"
#include "devices/net/socket.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
constexpr std::size_t kHistory = 20000;
constexpr std::uint64_t kFirstIpoc = 4208163634;

struct Options {
    std::string address = "127.0.0.1", sen_type = "ImFree";
    int port = 49152, cycle_ms = 4, late_limit = 100, restart_ms = 100, slow_ms = 300, following_ms = 8;
    bool relative = false, tool = false, hold_on = true, sums_late = false, application = true;
    double max_translation_mm = 20, path_s = 2;
    SimulatedPath path;
};

class Rsi final : public SimulatedRsi {
  public:
    Rsi(Options options, UdpSocket socket, std::unique_ptr<SimulatedController> measuring)
        : options_(std::move(options)), socket_(std::move(socket)), measuring_(std::move(measuring)) {}
    // Error (KrlError) for a program that the controller does not load.
    void start(std::shared_ptr<SimulatedCell> cell, const std::vector<ProgramFile>& program) {
        cell_ = std::move(cell);
        if (options_.application) {
            krl::RsiApplicationSettings settings{options_.path, options_.path_s, options_.restart_ms};
            settings.path_over = [this] { take(); };
            if (cell_)
                settings.stop_message = [cell = cell_] {
                    return cell->mode() == RobotMode::stopped || cell->mode() == RobotMode::fault;
                };
            application_ = std::make_unique<krl::RsiApplication>(std::move(settings), program);
        }
        thread_ = std::thread([this] { run(); });
    }
    ~Rsi() override {
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
    std::uint64_t late() const override { return late_total_; }
    SimulatedController* measuring() override { return measuring_.get(); }
    std::vector<std::string> messages() const override {
        return application_ ? application_->messages() : std::vector<std::string>{};
    }

  private:
    static std::string frame(const char* name, const Pose& pose, double scale = 1) {
        const KukaAbc abc = kuka_from_rotation(pose.linear());
        const Eigen::Vector3d p = pose.translation() * scale;
        return fmt::format(
            "<{} X=\"{:.9f}\" Y=\"{:.9f}\" Z=\"{:.9f}\" A=\"{:.9f}\" B=\"{:.9f}\" C=\"{:.9f}\" />", name,
            p.x(), p.y(), p.z(), abc.a_deg, abc.b_deg, abc.c_deg);
    }

    Pose corrected(const Pose& programmed) const {
        const Eigen::Vector3d offset(sum_[0], sum_[1], sum_[2]);
        const Eigen::Matrix3d turn = rotation_from_kuka({sum_[3], sum_[4], sum_[5]});
        if (options_.tool)
            return make_pose(programmed.linear() * turn,
                             programmed.translation() + programmed.linear() * offset);
        return make_pose(turn * programmed.linear(), programmed.translation() + offset);
    }

    // RSI_ON: the correction is zero.
    void begin_session() {
        sum_ = last_ = {};
        late_ = 0;
        late_in_row_ = 0;
        release_ = false;
        shown_.clear();
        withdraw();
    }

    // What the program does in this cycle; without one RSI is on and the path goes on for ever.
    krl::RsiApplication::Now next_cycle() {
        if (application_) return application_->cycle(options_.cycle_ms);
        krl::RsiApplication::Now now;
        if (off_ms_ > 0 && (off_ms_ -= options_.cycle_ms) <= 0) ++session_;
        endless_ms_ += options_.cycle_ms;
        now.on = off_ms_ <= 0;
        now.relative = options_.relative;
        now.session = session_;
        now.under_way = now.on;
        now.programmed = options_.path.at(endless_ms_ / 1e3);
        return now;
    }

    void run() {
        auto next = Clock::now();
        std::uint64_t ipoc = kFirstIpoc, session = 0;
        bool half_sent = false;
        const auto cycle = static_cast<std::uint64_t>(options_.cycle_ms);
        while (!stop_) {
            next += milliseconds(options_.cycle_ms);
            ipoc += cycle;
            const krl::RsiApplication::Now now = next_cycle();
            relative_ = now.relative;
            if (now.session != session || !now.on) {
                session = now.session;
                begin_session();
            }
            if (!now.on) {
                if (measured_.begins(measuring_.get())) part_begins();
                book(now.programmed, ipoc);
                std::this_thread::sleep_until(next = std::max(next, Clock::now()));
                continue;
            }
            const ControllerFault kind = fault();
            if (kind == ControllerFault::slow) {
                for (int waited = 0; waited < options_.slow_ms && !stop_; waited += 10)
                    std::this_thread::sleep_for(milliseconds(10));
            }
            // After a pause of the machine the clock goes on from now; a controller would not pause.
            const auto behind = Clock::now() - next;
            if (behind > milliseconds(0)) {
                const auto cycles = behind / milliseconds(options_.cycle_ms) + 1;
                next += cycles * milliseconds(options_.cycle_ms);
                if (kind == ControllerFault::slow) {
                    ipoc += static_cast<std::uint64_t>(cycles) * cycle;
                    for (int i = 0; i < cycles; ++i) missed();
                }
            }
            // The controller's time is its cycle stamp: a pause of this machine stops both.
            const Pose actual = lagging(corrected(now.programmed));
            if (kind != ControllerFault::half_message && kind != ControllerFault::disconnect)
                half_sent = false;
            if (now.under_way) options_.path.carry(cell_.get(), actual);
            const bool wild = kind == ControllerFault::out_of_range;
            const std::string text = fmt::format(
                "<Rob Type=\"KUKA\">{}{}<Delay D=\"{}\" /><DiL>0</DiL><Path>{}</Path><IPOC>{}</IPOC></Rob>",
                frame("RIst", actual, wild ? 1e9 : 1), frame("RSol", now.programmed, wild ? 1e9 : 1), late_,
                now.under_way ? 1 : 0, kind == ControllerFault::wrong_answer ? kFirstIpoc : ipoc);
            const Endpoint to{options_.address, static_cast<std::uint16_t>(options_.port)};
            switch (kind) {
                case ControllerFault::silent:
                    break;
                case ControllerFault::half_message:
                case ControllerFault::disconnect:
                    if (!half_sent) (void)socket_.send_to(bytes_of(text.substr(0, text.size() / 2)), to);
                    half_sent = true;
                    break;
                default:
                    (void)socket_.send_to(bytes_of(text), to);
            }
            if (await_answer(next, std::to_string(ipoc))) {
                late_in_row_ = 0;
                if (!options_.sums_late) late_ = 0;
            } else {
                missed();
            }
            // One robot: its path does not begin before its measuring program has come to its end.
            const bool measured = !measuring_ || measuring_->verdict() == PartVerdict::corrected;
            if (application_) application_->set_release(release_ && measured);
            if (measured_.begins(measuring_.get())) part_begins();
            const bool correcting = std::any_of(sum_.begin(), sum_.end(), [](double x) { return x != 0; });
            const double size = Eigen::Vector3d(sum_[0], sum_[1], sum_[2]).norm();
            if (late_in_row_ > options_.late_limit || size > options_.max_translation_mm ||
                (kind == ControllerFault::reject_write && correcting)) {
                ++stops_;
                begin_session();
                if (application_)
                    application_->rsi_fails();
                else
                    off_ms_ = options_.restart_ms;
                continue;
            }
            const bool may_run = application_ ? release_ : correcting;
            if (may_run && !released())
                take_verdict(PartVerdict::corrected);
            else if (!may_run && released())
                withdraw();
            book(now.programmed, ipoc);
        }
    }

    void book(const Pose& programmed, std::uint64_t ipoc) {
        const std::lock_guard lock(mutex_);
        history_.push_back({programmed, corrected(programmed), sum_, ipoc});
        if (history_.size() > kHistory) history_.pop_front();
    }

    // A cycle without an answer in time: HOLDON takes the last RKorr once more, else it is zero.
    void missed() {
        ++late_;
        ++late_total_;
        ++late_in_row_;
        if (!options_.hold_on) last_ = {};
        take_correction();
    }

    void take_correction() {
        for (std::size_t k = 0; k < 6; ++k) sum_[k] = relative_ ? sum_[k] + last_[k] : last_[k];
        // Sums of decimals: what rounding of the addition leaves is no correction.
        if (relative_)
            for (double& x : sum_)
                if (std::abs(x) < 1e-10) x = 0;
    }

    // The servos follow.
    Pose lagging(const Pose& commanded) {
        shown_.push_front(commanded);
        const auto lag = static_cast<std::size_t>(options_.following_ms / options_.cycle_ms);
        while (shown_.size() > lag + 1) shown_.pop_back();
        return shown_.back();
    }

    // Takes answers until the next cycle is due; true if the one to this cycle was among them.
    bool await_answer(Clock::time_point until, const std::string& ipoc) {
        std::array<std::byte, kLargestRsiTelegram> buffer;
        bool answered = false;
        while (!stop_) {
            const auto rest = std::chrono::duration_cast<milliseconds>(until - Clock::now());
            if (answered || Clock::now() >= until) break;
            Endpoint from;
            const auto size = socket_.receive(buffer, from, std::max(rest, milliseconds(1)));
            if (!size) {
                if (!is_silence(size.error())) std::this_thread::sleep_for(milliseconds(1));
                continue;
            }
            const auto sen = parse_rsi_sen(std::span(buffer).first(*size));
            if (!sen || sen->ipoc != ipoc || sen->type != options_.sen_type || !sen->rkorr ||
                !sen->rkorr->usable)
                continue;
            answered = true;
            last_ = sen->rkorr->xyzabc;
            release_ = sen->release.value_or(false);
            take_correction();
        }
        std::this_thread::sleep_until(until);
        return answered;
    }

    const Options options_;
    UdpSocket socket_;
    std::unique_ptr<SimulatedController> measuring_;
    std::shared_ptr<SimulatedCell> cell_;
    NextPart measured_;
    std::array<double, 6> sum_{}, last_{};
    std::uint64_t late_ = 0;  // as Delay D tells
    int late_in_row_ = 0;
    bool release_ = false, relative_ = false;
    std::unique_ptr<krl::RsiApplication> application_;
    // Without one.
    int off_ms_ = 0;
    double endless_ms_ = 0;
    std::uint64_t session_ = 1;
    std::deque<Pose> shown_;
    std::atomic<std::uint64_t> stops_ = 0, late_total_ = 0;
    mutable std::mutex mutex_;
    std::deque<Sample> history_;
    std::atomic<bool> stop_ = false;
    std::thread thread_;
};

}  // namespace

Expected<std::unique_ptr<SimulatedController>> start_kuka_rsi(std::shared_ptr<SimulatedCell> cell,
                                                              const nlohmann::json& settings,
                                                              StartController start_controller) {
    if (auto ok =
            only_fields(settings,
                        {"address", "port", "cycle_ms", "mode", "reference", "sen_type", "late_limit",
                         "max_translation_mm", "restart_ms", "speed_mm_s", "slow_ms", "following_ms",
                         "hold_on", "delay", "application", "path_s", "path", "flange_from_tcp", "measuring"},
                        "");
        !ok)
        return tl::unexpected(ok.error());
    Options o;
    std::string mode = "absolute", reference = "base", delay = "run_length";
    for (const auto& [key, value] : {std::pair<const char*, std::string*>{"address", &o.address},
                                     {"sen_type", &o.sen_type},
                                     {"mode", &mode},
                                     {"reference", &reference},
                                     {"delay", &delay}}) {
        SEAM_TRY(auto text, json_string_or(settings, key, *value, ""));
        *value = text;
    }
    if (mode != "absolute" && mode != "relative") return input_error("not absolute or relative", "mode");
    if (reference != "base" && reference != "tool") return input_error("not base or tool", "reference");
    if (delay != "run_length" && delay != "sum") return input_error("not run_length or sum", "delay");
    o.relative = mode == "relative";
    o.sums_late = delay == "sum";
    for (const auto& [key, value] : {std::pair<const char*, bool*>{"hold_on", &(o.hold_on = !o.relative)},
                                     {"application", &o.application}}) {
        SEAM_TRY(auto read, json_bool_or(settings, key, *value, ""));
        *value = read;
    }
    o.tool = reference == "tool";
    SEAM_OK(read_within<int>(settings, 1, 65535,
                             {{"port", &o.port},
                              {"cycle_ms", &o.cycle_ms},
                              {"late_limit", &o.late_limit},
                              {"restart_ms", &o.restart_ms},
                              {"following_ms", &o.following_ms},
                              {"slow_ms", &o.slow_ms}}));
    SEAM_OK(read_within<double>(settings, 0, 1e4,
                                {{"max_translation_mm", &o.max_translation_mm},
                                 {"path_s", &o.path_s},
                                 {"speed_mm_s", &o.path.speed_mm_s}}));
    SEAM_OK(read_simulated_path(settings, o.path));
    auto measuring = start_measuring_controller(settings, cell, start_controller);
    if (!measuring) return measuring;
    SEAM_TRY(auto socket, UdpSocket::bind(o.address == "127.0.0.1" ? "127.0.0.1" : "0.0.0.0", 0));
    ProgramRequest request;
    request.settings = {{"port", o.port}, {"mode", mode}, {"reference", reference}, {"sen_type", o.sen_type}};
    SEAM_TRY(auto program, write_rsi_program(request));
    auto controller = std::make_unique<Rsi>(std::move(o), std::move(socket), std::move(*measuring));
    try {
        controller->start(std::move(cell), program);
    } catch (const krl::KrlError& e) {
        return device_error(Text("the controller does not take the program: {}", e.what()), "simulated KUKA");
    }
    return controller;
}

}  // namespace seamwright
