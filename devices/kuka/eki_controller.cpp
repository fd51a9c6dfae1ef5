// A KUKA controller with the module seamwright.src, from its side of the EthernetKRL connection.

#include <fmt/format.h>

#include <array>
#include <map>
#include <optional>
#include <thread>

#include "devices/exchange/settings.h"
#include "devices/kuka/eki.h"
#include "devices/kuka/eki_telegram.h"
#include "devices/net/socket.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
constexpr Timeout kEkiTick{5};

class EkiController final : public SimulatedController {
  public:
    EkiController(std::shared_ptr<SimulatedCell> cell, std::string address, std::uint16_t port, Timeout slow,
                  Timeout trigger_interval, Timeout approach)
        : cell_(std::move(cell)),
          address_(std::move(address)),
          port_(port),
          slow_(slow),
          trigger_interval_(trigger_interval),
          approach_(approach),
          thread_([this](const std::stop_token& stop) { serve(stop); }) {}
    std::uint16_t port() const override { return port_; }

  private:
    void serve(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            auto connected = TcpConnection::connect(address_, port_, Timeout(50));
            if (!connected) {
                std::this_thread::sleep_for(Timeout(20));
                continue;
            }
            connection_.emplace(std::move(*connected));
            talk(stop);
            connection_.reset();
            running_ = false;
            withdraw();
        }
    }

    void talk(const std::stop_token& stop) {
        EkiSplitter commands("Sensor");
        EkiTelegram hello{
            .kind = "hello", .name = cell_->settings().serial, .part = "#KR simulated", .text = "KSS 8.6"};
        if (!tell(hello)) return;
        while (!stop.stop_requested()) {
            std::array<char, 4096> buffer;
            const auto got = connection_->receive_some(std::as_writable_bytes(std::span(buffer)), kEkiTick);
            if (!got && !is_silence(got.error())) return;
            if (got && !commands.add({buffer.data(), *got})) return;
            for (std::string document; commands.next(document);) {
                const auto command = parse_eki_command(document);
                if (!command || !obey(*command)) return;
            }
            if (!go_on()) return;
        }
    }

    // The program in motion, and the line's call for a part.
    bool go_on() {
        if (const auto part = take_start()) {
            part_begins();
            if (!tell({.kind = "start", .part = *part})) return false;
        }
        if (!running_ || Clock::now() < next_trigger_) return true;
        next_trigger_ = Clock::now() + trigger_interval_;
        const auto event = cell_->next_trigger();
        if (!event) {
            running_ = false;
            return tell({.kind = "done"});
        }
        return tell({.kind = "trigger",
                     .id = ++triggers_,
                     .name = event->spot_id,
                     .pose = event->base_from_flange.value_or(Pose::Identity())});
    }

    bool obey(const EkiTelegram& c) {
        EkiTelegram answer{
            .kind = "answer", .id = c.id, .name = c.name, .mode = std::string(eki_from_mode(cell_->mode()))};
        const auto refuse = [&](const std::string& why) {
            answer.kind = "error";
            answer.text = why;
            return tell(answer);
        };
        const bool writes =
            c.kind == "write" || c.kind == "confirm" || c.kind == "measure" || c.kind == "move";
        if (writes && fault() == ControllerFault::reject_write) return refuse("write protected");
        if (c.kind == "state") {
            answer.pose = cell_->reported_flange().value_or(Pose::Identity());
        } else if (c.kind == "read") {
            auto frame = cell_->read_frame(c.name);
            if (!frame) return refuse("no frame " + c.name);
            answer.pose = *frame;
        } else if (c.kind == "write") {
            withdraw();  // until the next verdict
            if (!cell_->write_frame(c.name, c.pose)) return refuse("no frame " + c.name);
        } else if (c.kind == "measure") {
            part_begins();
            if (program_signature(cell_->program()) != c.name)
                return refuse("another measuring program is loaded than the project's");
            if (auto started = cell_->start_program(); !started) return refuse(started.error().what);
            triggers_ = 0;
            running_ = true;
            next_trigger_ = Clock::now() + approach_;
        } else if (c.kind == "confirm") {
            static const std::map<std::string_view, PartVerdict> kVerdicts = {
                {"corrected", PartVerdict::corrected},
                {"refused", PartVerdict::refused},
                {"failed", PartVerdict::failed}};
            const auto verdict = kVerdicts.find(c.name);
            if (verdict == kVerdicts.end()) return refuse("unknown verdict " + c.name);
            running_ = false;
            take_verdict(verdict->second);
        } else if (c.kind == "move") {
            const auto mode = cell_->mode();
            if (mode == RobotMode::stopped || mode == RobotMode::fault) return refuse("the robot is stopped");
            cell_->move_to(c.pose);
            answer.pose = c.pose;
        } else {
            return refuse("unknown command " + c.kind);
        }
        return tell(answer);
    }

    // False when the connection is to be closed.
    bool tell(EkiTelegram telegram) {
        const ControllerFault now = fault();
        if (now == ControllerFault::silent) return true;
        if (now == ControllerFault::slow) std::this_thread::sleep_for(slow_);
        if (now == ControllerFault::wrong_answer) {
            telegram.id += 7;
            telegram.name = telegram.kind == "hello" ? "" : "another";
        }
        std::string bytes = write_eki("Robot", telegram);
        if (now == ControllerFault::out_of_range) {
            const auto at = bytes.find("X=\"");
            bytes.replace(at, bytes.find('"', at + 3) - at, "X=\"1e+09");
        }
        const bool cut = now == ControllerFault::half_message || now == ControllerFault::disconnect;
        if (cut) bytes.resize(bytes.size() / 2);
        const auto sent = connection_->send(bytes_of(bytes), Timeout(500));
        return sent && now != ControllerFault::disconnect;
    }

    std::shared_ptr<SimulatedCell> cell_;
    const std::string address_;
    const std::uint16_t port_;
    const Timeout slow_, trigger_interval_, approach_;
    std::optional<TcpConnection> connection_;
    bool running_ = false;
    Clock::time_point next_trigger_{};
    std::int64_t triggers_ = 0;
    std::jthread thread_;  // last: everything above is there while it runs
};

}  // namespace

Expected<std::unique_ptr<SimulatedController>> start_kuka_eki_controller(std::shared_ptr<SimulatedCell> cell,
                                                                         const nlohmann::json& settings) {
    std::string address = "127.0.0.1";
    int port = 54600, slow_ms = 300, trigger_interval_ms = 40, approach_ms = 100;
    SettingsReader f(settings, "settings");
    f.only({"address", "port", "slow_ms", "trigger_interval_ms", "approach_ms"});
    f.text("address", address);
    f.whole("port", port, 1, 65535);
    f.whole("slow_ms", slow_ms, 0, 60000);
    f.whole("trigger_interval_ms", trigger_interval_ms, 0, 60000);
    f.whole("approach_ms", approach_ms, 0, 60000);
    if (f.failed()) return tl::unexpected(f.error());
    return std::make_unique<EkiController>(std::move(cell), address, static_cast<std::uint16_t>(port),
                                           Timeout(slow_ms), Timeout(trigger_interval_ms),
                                           Timeout(approach_ms));
}

}  // namespace seamwright
