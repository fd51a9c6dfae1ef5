// The simulated ABB controller: the RAPID task's side of the protocol, one client at a time.

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <map>
#include <thread>

#include "core/geometry/notation.h"
#include "devices/abb/rapid.h"
#include "devices/abb/rapid_message.h"
#include "devices/exchange/json_fields.h"
#include "devices/net/socket.h"
#include "devices/robot_program.h"
#include "devices/simulated/cell.h"

namespace seamwright {
namespace {

using abb::Message;
using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::milliseconds;

constexpr Milliseconds kPoll{2};

struct ControllerSettings {
    std::string address = "127.0.0.1", serial, model = "IRB 6700 (simulated)";
    std::uint16_t port = 0;
    Milliseconds slow{300}, trigger_interval{20};
};

Expected<ControllerSettings> parse_controller_settings(const nlohmann::json& json) {
    const std::string where = "settings of the simulated abb-rapid controller";
    if (auto ok = only_fields(json, {"address", "port", "slow_ms", "trigger_interval_ms", "serial", "model"},
                              where);
        !ok)
        return tl::unexpected(ok.error());
    ControllerSettings s;
    for (auto [key, text] : {std::pair<const char*, std::string*>{"address", &s.address},
                             {"serial", &s.serial},
                             {"model", &s.model}}) {
        auto value = json_string_or(json, key, *text, where);
        if (!value) return tl::unexpected(value.error());
        *text = *value;
    }
    const auto number = [&](const char* key, double otherwise, double high) -> Expected<double> {
        auto value = json_number_or(json, key, otherwise, where);
        if (value && (*value < 0 || *value > high))
            return input_error(fmt::format("{} is not in 0 to {}", *value, high), json_path(where, key));
        return value;
    };
    const auto port = number("port", 0, 65535), slow = number("slow_ms", 300, 60000),
               interval = number("trigger_interval_ms", 20, 60000);
    for (const auto* value : {&port, &slow, &interval})
        if (!*value) return tl::unexpected(value->error());
    s.port = static_cast<std::uint16_t>(*port);
    s.slow = Milliseconds(static_cast<long>(*slow));
    s.trigger_interval = Milliseconds(static_cast<long>(*interval));
    return s;
}

// As RAPID keeps it: every number in single precision.
Pose as_num(const Pose& pose) {
    const AbbQuaternion q = abb_from_rotation(pose.linear());
    const auto single = [](double value) { return static_cast<double>(static_cast<float>(value)); };
    auto rotation = rotation_from_abb({single(q.w), single(q.x), single(q.y), single(q.z)}, "");
    const Eigen::Vector3d t = pose.translation();
    return make_pose(rotation ? *rotation : pose.linear(), {single(t.x()), single(t.y()), single(t.z())});
}

class Controller final : public SimulatedController {
  public:
    Controller(std::shared_ptr<SimulatedCell> cell, ControllerSettings settings, TcpListener listener)
        : cell_(std::move(cell)),
          settings_(std::move(settings)),
          listener_(std::move(listener)),
          port_(listener_.port()),
          thread_([this] { serve(); }) {}
    ~Controller() override {
        stop_ = true;
        thread_.join();
    }
    std::uint16_t port() const override { return port_; }

  private:
    struct Due {
        Clock::time_point time;
        Message message;
    };

    void serve() {
        while (!stop_) {
            auto client = listener_.accept(Milliseconds(50));
            if (!client) {
                if (!is_silence(client.error())) std::this_thread::sleep_for(Milliseconds(20));
                continue;
            }
            session(*client);
            withdraw();
            staged_.clear();
            measuring_ = false;
        }
    }

    void session(TcpConnection& client) {
        std::string received;
        outgoing_.clear();
        starts_ = 0;
        dead_ = false;
        char buffer[1024];
        while (!stop_) {
            auto got = client.receive_some(std::as_writable_bytes(std::span(buffer)), kPoll);
            if (!got && !is_silence(got.error())) return;
            if (got) received.append(buffer, *got);
            while (received.size() >= abb::kMessageBytes) {
                auto request =
                    abb::parse_message(std::string_view(received).substr(0, abb::kMessageBytes), "");
                received.erase(0, abb::kMessageBytes);
                if (!request || request->number == 0) return;  // the module closes what it cannot read
                owe(answer(*request));
            }
            tell_events();
            if (!flush(client)) return;
        }
    }

    void owe(Message message) {
        const auto delay = fault() == ControllerFault::slow ? settings_.slow : Milliseconds(0);
        outgoing_.push_back({Clock::now() + delay, std::move(message)});
    }

    // False when the connection is to be closed.
    bool flush(TcpConnection& client) {
        while (!outgoing_.empty() && outgoing_.front().time <= Clock::now()) {
            Message message = std::move(outgoing_.front().message);
            outgoing_.pop_front();
            const ControllerFault now = fault();
            if (now == ControllerFault::silent || dead_) continue;
            if (now == ControllerFault::wrong_answer) {
                if (message.number == 0)
                    message.word = "COFFEE";
                else
                    message.number = message.number % abb::kHighestNumber + 1;
            }
            if (now == ControllerFault::out_of_range) spoil(message);
            std::string bytes = abb::message_bytes(message);
            if (now == ControllerFault::half_message || now == ControllerFault::disconnect) {
                bytes.resize(bytes.size() / 2);
                dead_ = true;
            }
            if (!client.send(bytes_of(bytes), Milliseconds(200))) return false;
            if (now == ControllerFault::disconnect) return false;
        }
        return true;
    }

    static void spoil(Message& message) {
        if (message.word == "MODE") message.fields = {"DREAM", "ON", "RUN"};
        if (message.word == "POSE" || message.word == "READ" || message.word == "WRITE" ||
            message.word == "TRIGGER")
            message.line2 = "1000000000.0000 0.0000 0.0000";
    }

    void tell_events() {
        if (auto part = take_start()) {
            part_begins();
            staged_.clear();
            owe({0, "START", {std::to_string(++starts_)}, *part, {}});
        }
        if (!measuring_ || Clock::now() < next_trigger_) return;
        const auto event = cell_->next_trigger();
        if (!event) {
            measuring_ = false;
            owe({0, "END", {std::to_string(triggers_)}, {}, {}});
            return;
        }
        ++triggers_;
        Message message{
            0, "TRIGGER", {std::to_string(triggers_), std::to_string(triggers_), event->spot_id}, {}, {}};
        abb::set_pose_lines(message, as_num(event->base_from_flange.value_or(Pose::Identity())));
        owe(std::move(message));
        next_trigger_ = Clock::now() + settings_.trigger_interval;
    }

    static Message refusal(const Message& request, std::string reason) {
        return {request.number, "NO", {request.word}, std::move(reason), {}};
    }

    Message answer(const Message& request) {
        Message reply{request.number, request.word, {}, {}, {}};
        const auto& f = request.fields;
        const std::string& word = request.word;
        if (word == "HELLO") {
            reply.fields = {"1"};
            reply.line2 = settings_.serial;
            reply.line3 = settings_.model;
        } else if (word == "MODE") {
            reply.fields = mode_words();
        } else if (word == "PING") {
        } else if (word == "POSE") {
            const auto pose = cell_->reported_flange();
            if (!pose) return refusal(request, "the robot has not moved anywhere yet");
            abb::set_pose_lines(reply, as_num(*pose));
        } else if (word == "READ" && f.size() == 1) {
            auto frame = staged_.count(f[0]) ? Expected<Pose>(staged_.at(f[0])) : cell_->read_frame(f[0]);
            if (!frame) return refusal(request, "there is no work object " + f[0]);
            reply.fields = f;
            abb::set_pose_lines(reply, as_num(*frame));
        } else if (word == "WRITE" && f.size() == 1) {
            if (fault() == ControllerFault::reject_write) return refusal(request, "writing is locked");
            auto pose = abb::parse_pose_lines(request, "");
            if (!pose) return refusal(request, pose.error().what);
            if (!cell_->read_frame(f[0])) return refusal(request, "there is no work object " + f[0]);
            withdraw();
            staged_[f[0]] = as_num(*pose);
            reply.fields = f;
            abb::set_pose_lines(reply, staged_.at(f[0]));
        } else if (word == "MEASURE" && f.size() == 2) {
            return measure(request, std::move(reply));
        } else if (word == "VERDICT" && f.size() == 1) {
            return take(request, std::move(reply));
        } else if (word == "MOVE") {
            if (fault() == ControllerFault::reject_write) return refusal(request, "moving is locked");
            auto pose = abb::parse_pose_lines(request, "");
            if (!pose) return refusal(request, pose.error().what);
            cell_->move_to(as_num(*pose));
        } else {
            return refusal(request, "unknown request " + word);
        }
        return reply;
    }

    std::vector<std::string> mode_words() const {
        switch (cell_->mode()) {
            case RobotMode::automatic:
            case RobotMode::external:
                return {"AUTO", "ON", "RUN"};
            case RobotMode::manual_reduced:
                return {"MANR", "ON", "RUN"};
            case RobotMode::manual_full:
                return {"MANF", "ON", "RUN"};
            case RobotMode::stopped:
                return {"AUTO", "OFF", "HALT"};
            case RobotMode::fault:
                return {"AUTO", "ESTOP", "HALT"};
            case RobotMode::unknown:
                break;
        }
        return {"UNDEF", "ON", "RUN"};
    }

    Message measure(const Message& request, Message reply) {
        const auto program = cell_->program();
        part_begins();
        staged_.clear();
        if (program.empty()) return refusal(request, "the controller holds no measuring program");
        if (request.fields[0] != std::to_string(program.size()))
            return refusal(request, fmt::format("the program here has {} spots", program.size()));
        if (request.fields[1] != program_signature(program))
            return refusal(request, "the program here was made from other spots");
        if (auto started = cell_->start_program(); !started) return refusal(request, started.error().what);
        measuring_ = true;
        triggers_ = 0;
        next_trigger_ = Clock::now() + settings_.trigger_interval;
        reply.fields = {request.fields[0]};
        return reply;
    }

    Message take(const Message& request, Message reply) {
        const std::string& verdict = request.fields[0];
        reply.fields = request.fields;
        if (verdict == "CORRECTED") {
            for (const auto& [name, pose] : staged_)
                if (!cell_->write_frame(name, pose))
                    return refusal(request, "the frame " + name + " cannot be set");
            take_verdict(PartVerdict::corrected);
        } else if (verdict == "REFUSED" || verdict == "FAILED") {
            take_verdict(verdict == "REFUSED" ? PartVerdict::refused : PartVerdict::failed);
        } else {
            return refusal(request, "unknown verdict " + verdict);
        }
        staged_.clear();
        return reply;
    }

    const std::shared_ptr<SimulatedCell> cell_;
    const ControllerSettings settings_;
    TcpListener listener_;
    const std::uint16_t port_;
    std::atomic<bool> stop_ = false;
    // Of the thread:
    std::deque<Due> outgoing_;
    std::map<std::string, Pose> staged_;
    bool measuring_ = false, dead_ = false;
    std::uint32_t triggers_ = 0, starts_ = 0;
    Clock::time_point next_trigger_{};
    std::thread thread_;  // last: it uses all the others
};

}  // namespace

Expected<std::unique_ptr<SimulatedController>> start_abb_rapid(std::shared_ptr<SimulatedCell> cell,
                                                               const nlohmann::json& settings) {
    auto parsed = parse_controller_settings(settings);
    if (!parsed) return tl::unexpected(parsed.error());
    if (parsed->serial.empty()) parsed->serial = cell->settings().serial;
    auto listener = TcpListener::listen(parsed->address, parsed->port);
    if (!listener) return tl::unexpected(listener.error());
    return std::make_unique<Controller>(std::move(cell), std::move(*parsed), std::move(*listener));
}

}  // namespace seamwright
