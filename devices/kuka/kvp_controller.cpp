// A KUKA controller with KUKAVARPROXY and the variables of seamwright.dat.

#include <fmt/format.h>

#include <array>
#include <map>
#include <optional>
#include <thread>

#include "devices/exchange/settings.h"
#include "devices/kuka/kvp.h"
#include "devices/kuka/kvp_message.h"
#include "devices/net/socket.h"
#include "devices/robot_program.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
constexpr Timeout kKvpTick{2};

class KvpController final : public SimulatedController {
  public:
    KvpController(std::shared_ptr<SimulatedCell> cell, TcpListener listener, Timeout slow,
                  Timeout trigger_interval, Timeout approach)
        : cell_(std::move(cell)),
          listener_(std::move(listener)),
          slow_(slow),
          trigger_interval_(trigger_interval),
          approach_(approach) {
        for (const auto& [name, pose] : cell_->settings().robot.frames) frames_.push_back(name);
        thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
    }
    std::uint16_t port() const override { return listener_.port(); }

  private:
    void serve(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            if (auto client = listener_.accept(kKvpTick)) {
                connection_.emplace(std::move(*client));
                cut_ = false;
                std::string stream;
                while (!stop.stop_requested() && answer_all(stream)) run_program();
                connection_.reset();
            }
            run_program();
        }
    }

    // The robot interpreter: the module's programs, whether anybody is connected or not.
    void run_program() {
        if (const auto part = take_start()) {
            part_begins();
            part_ = *part;
            call_ = true;
        }
        if (go_ && !busy_) {
            go_ = false;
            busy_ = true;
            spots_.clear();
            if (!cell_->start_program()) busy_ = false;
            next_trigger_ = Clock::now() + approach_;
        }
        if (!busy_ || Clock::now() < next_trigger_) return;
        next_trigger_ = Clock::now() + trigger_interval_;
        if (const auto event = cell_->next_trigger())
            spots_.push_back(*event);
        else
            busy_ = false;
    }

    bool answer_all(std::string& stream) {
        std::array<char, 4096> buffer;
        const auto got = connection_->receive_some(std::as_writable_bytes(std::span(buffer)), kKvpTick);
        if (!got) return is_silence(got.error());
        stream.append(buffer.data(), *got);
        for (;;) {
            auto request = take_kvp_request(stream);
            if (!request) return false;
            if (!*request) return true;
            KvpAnswer answer{(*request)->id, (*request)->write, (*request)->value, false};
            if ((*request)->write) {
                answer.done =
                    fault() != ControllerFault::reject_write && set((*request)->name, (*request)->value);
            } else if (auto value = get((*request)->name)) {
                answer.value = *value;
                answer.done = true;
            }
            if (!tell(std::move(answer))) return false;
        }
    }

    // "SW_FRAME[3]" and "SW_SPOT[3,]": the number, from 1; 0 = another name.
    static std::size_t index_of(const std::string& name, const std::string& array) {
        if (!name.starts_with(array + "[")) return 0;
        return static_cast<std::size_t>(std::strtoul(name.c_str() + array.size() + 1, nullptr, 10));
    }
    static std::string truth(bool value) { return value ? "TRUE" : "FALSE"; }

    std::optional<std::string> get(const std::string& name) {
        const RobotMode mode = cell_->mode();
        const bool stopped = mode == RobotMode::stopped || mode == RobotMode::fault;
        const auto pose_text = [&](const Pose& pose) {
            std::string text = krl_from_frame(
                fault() == ControllerFault::out_of_range ? Pose(Eigen::Translation3d(1e9, 0, 0)) : pose);
            return "{FRAME: " + text.substr(1);
        };
        if (name == "$KR_SERIALNO") return cell_->settings().serial;
        if (name == "$TRAFONAME[]") return "\"#KR simulated\"";
        if (name == "$STOPMESS") return truth(stopped);
        if (name == "$MODE_OP")
            return fault() == ControllerFault::out_of_range ? "#T9"
                   : mode == RobotMode::manual_reduced      ? "#T1"
                   : mode == RobotMode::manual_full         ? "#T2"
                   : mode == RobotMode::external            ? "#EX"
                                                            : "#AUT";
        if (name == "$POS_ACT") {
            const auto at = cell_->reported_flange();
            if (!at) return std::nullopt;
            std::string text = pose_text(*at);
            text.replace(1, 6, "E6POS:");
            return text.substr(0, text.size() - 1) + ", S 2, T 10, E1 0.0}";
        }
        if (name == "SW_CALL") return truth(call_);
        if (name == "SW_PART[]") return krl_from_string(part_.empty() ? "-" : part_);
        if (name == "SW_SIGNATURE[]") return krl_from_string(program_signature(cell_->program()));
        if (name == "SW_BUSY") return truth(busy_);
        if (name == "SW_MOVE" || name == "SW_GO") return truth(false);
        if (name == "SW_RELEASED") return truth(released());
        if (name == "SW_FRAMES") return std::to_string(frames_.size());
        if (name == "SW_FIRED")
            return std::to_string(fault() == ControllerFault::out_of_range ? 1000000000 : spots_.size());
        if (const auto i = index_of(name, "SW_NAME"); i > 0 && i <= frames_.size())
            return krl_from_string(frames_[i - 1]);
        if (const auto i = index_of(name, "SW_FRAME"); i > 0 && i <= frames_.size())
            return pose_text(cell_->read_frame(frames_[i - 1]).value());
        if (const auto i = index_of(name, "SW_SPOT"); i > 0 && i <= spots_.size())
            return krl_from_string(spots_[i - 1].spot_id);
        if (const auto i = index_of(name, "SW_SPOT_AT"); i > 0 && i <= spots_.size())
            return pose_text(spots_[i - 1].base_from_flange.value_or(Pose::Identity()));
        if (auto frame = cell_->read_frame(name)) return pose_text(*frame);
        return std::nullopt;
    }

    bool set(const std::string& name, const std::string& value) {
        const auto flag = bool_from_krl(value);
        if (name == "SW_CALL" && flag) {
            call_ = *flag;
        } else if (name == "SW_RELEASED" && flag) {
            take_verdict(*flag ? PartVerdict::corrected : PartVerdict::failed);
        } else if (name == "SW_GO" && flag) {
            go_ = *flag;
            if (go_) part_begins();
        } else if (name == "SW_FIRED" && value == "0") {
            spots_.clear();
        } else if (name == "SW_MOVE" && flag) {
            if (*flag) cell_->move_to(move_to_);
        } else if (const auto frame = frame_from_krl(value)) {
            if (name == "SW_MOVE_TO") {
                move_to_ = *frame;
                return true;
            }
            const auto i = index_of(name, "SW_FRAME");
            return cell_->write_frame(i > 0 && i <= frames_.size() ? frames_[i - 1] : name, *frame)
                .has_value();
        } else {
            return false;
        }
        return true;
    }

    bool tell(KvpAnswer answer) {
        const ControllerFault now = fault();
        if (now == ControllerFault::silent || cut_) return true;
        if (now == ControllerFault::slow) std::this_thread::sleep_for(slow_);
        if (now == ControllerFault::wrong_answer) answer.id = static_cast<std::uint16_t>(answer.id + 7);
        std::string bytes = kvp_bytes(answer);
        cut_ = now == ControllerFault::half_message;  // and nothing more on this connection
        if (cut_ || now == ControllerFault::disconnect) bytes.resize(bytes.size() / 2);
        return connection_->send(bytes_of(bytes), Timeout(500)) && now != ControllerFault::disconnect;
    }

    std::shared_ptr<SimulatedCell> cell_;
    TcpListener listener_;
    const Timeout slow_, trigger_interval_, approach_;
    std::vector<std::string> frames_;
    std::optional<TcpConnection> connection_;
    // Variables of the module; the thread's alone.
    bool call_ = false, go_ = false, busy_ = false, cut_ = false;
    std::string part_;
    std::vector<TriggerEvent> spots_;
    Pose move_to_ = Pose::Identity();
    Clock::time_point next_trigger_{};
    std::jthread thread_;  // last: everything above is there while it runs
};

}  // namespace

Expected<std::unique_ptr<SimulatedController>> start_kuka_kvp_controller(std::shared_ptr<SimulatedCell> cell,
                                                                         const nlohmann::json& settings) {
    std::string address = "127.0.0.1";
    int port = 7000, slow_ms = 300, trigger_interval_ms = 40, approach_ms = 100;
    SettingsReader f(settings, "settings");
    f.only({"address", "port", "slow_ms", "trigger_interval_ms", "approach_ms"});
    f.text("address", address);
    f.whole("port", port, 0, 65535);
    f.whole("slow_ms", slow_ms, 0, 60000);
    f.whole("trigger_interval_ms", trigger_interval_ms, 0, 60000);
    f.whole("approach_ms", approach_ms, 0, 60000);
    if (f.failed()) return tl::unexpected(f.error());
    auto listener = TcpListener::listen(address, static_cast<std::uint16_t>(port));
    if (!listener) return tl::unexpected(listener.error());
    return std::make_unique<KvpController>(std::move(cell), std::move(*listener), Timeout(slow_ms),
                                           Timeout(trigger_interval_ms), Timeout(approach_ms));
}

}  // namespace seamwright
