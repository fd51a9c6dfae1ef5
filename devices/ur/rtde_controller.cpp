// A UR controller before the simulated cell: RTDE and dashboard servers, and the module's work on the
// registers.

#include <fmt/format.h>

#include <array>
#include <map>
#include <optional>
#include <thread>

#include "devices/exchange/settings.h"
#include "devices/net/socket.h"
#include "devices/robot_program.h"
#include "devices/ur/module.h"
#include "devices/ur/rtde.h"
#include "devices/ur/rtde_message.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
using rtde::Kind;
using rtde::Package;
using rtde::Value;
using ur::Command;
using ur::Status;
constexpr Timeout kTick{2};

struct ControllerSettings {
    std::string address = "127.0.0.1";
    int port = 30004, dashboard_port = 29999, slow_ms = 300, trigger_interval_ms = 40, approach_ms = 100,
        first_register = ur::kFirstRegister, protocol_version = 2;
    bool tells_tcp_offset = true;
};

bool is_stopped(RobotMode mode) {
    return mode == RobotMode::stopped || mode == RobotMode::fault;
}

// The registers as the module sees them.
struct Registers {
    std::array<std::int32_t, 48> ints{};
    std::array<double, 48> doubles{};
};

class RtdeController final : public SimulatedController {
  public:
    RtdeController(std::shared_ptr<SimulatedCell> cell, ControllerSettings settings, TcpListener rtde,
                   TcpListener dashboard)
        : cell_(std::move(cell)),
          settings_(std::move(settings)),
          rtde_(std::move(rtde)),
          dashboard_(std::move(dashboard)) {
        out(ur::kModule) = ur::kModuleVersion;
        rtde_thread_ = std::jthread([this](const std::stop_token& stop) { serve_rtde(stop); });
        dashboard_thread_ = std::jthread([this](const std::stop_token& stop) { serve_dashboard(stop); });
    }
    std::uint16_t port() const override { return rtde_.port(); }

  private:
    std::int32_t& out(int i) { return outputs_.ints[static_cast<std::size_t>(settings_.first_register + i)]; }
    std::int32_t in(int i) const {
        return inputs_.ints[static_cast<std::size_t>(settings_.first_register + i)];
    }

    // ---- the robot's programs, whether anybody is connected or not
    void run_module() {
        if (const auto part = take_start()) {
            part_begins();
            const auto registers = ur::part_registers(*part);
            for (int i = 0; i < 4; ++i) out(ur::kPart + i) = registers[static_cast<std::size_t>(i)];
            out(ur::kCall) = 1;
        }
        const auto [high, low] = ur::signature_numbers(program_signature(cell_->program()));
        out(ur::kSignatureHigh) = high;
        out(ur::kSignatureLow) = low;
        if (busy_ && Clock::now() >= next_trigger_) {
            next_trigger_ = Clock::now() + Timeout(settings_.trigger_interval_ms);
            if (const auto event = cell_->next_trigger()) {
                fired_.push_back(event->base_from_flange.value_or(Pose::Identity()));
                out(ur::kFired) = static_cast<std::int32_t>(fired_.size());
            } else {
                busy_ = false;
            }
        }
        out(ur::kReleased) = released() ? 1 : 0;
        if (in(ur::kNumber) == done_) return;
        done_ = in(ur::kNumber);
        const Status status = answer(static_cast<Command>(in(ur::kCommand)), in(ur::kArgument));
        out(ur::kReleased) = released() ? 1 : 0;
        out(ur::kStatus) = static_cast<std::int32_t>(status);
        out(ur::kAnswered) = fault() == ControllerFault::wrong_answer ? done_ + 7 : done_;
    }

    Status answer(Command command, std::int32_t argument) {
        switch (command) {
            case Command::read:
            case Command::write: {
                std::optional<std::string> name;
                for (const auto& [known, pose] : cell_->settings().robot.frames)
                    if (ur::frame_number(known) == argument) name = known;
                if (command == Command::write) {
                    withdraw();
                    if (fault() == ControllerFault::reject_write) return Status::in_use;
                    const auto pose = ur::pose_from_ur(input_pose(), "register");
                    if (!name || !pose || !cell_->write_frame(*name, *pose)) return Status::no_frame;
                }
                if (!name) return Status::no_frame;
                tell(cell_->read_frame(*name).value());
                return Status::done;
            }
            case Command::measure: {
                const auto mine = std::pair(out(ur::kSignatureHigh), out(ur::kSignatureLow));
                if (mine != std::pair(in(ur::kHigh), in(ur::kLow))) return Status::other_program;
                if (busy_) return Status::running;
                part_begins();
                fired_.clear();
                out(ur::kFired) = 0;
                busy_ = cell_->start_program().has_value();
                next_trigger_ = Clock::now() + Timeout(settings_.approach_ms);
                return Status::done;
            }
            case Command::trigger:
                if (argument < 1 || argument > static_cast<std::int32_t>(fired_.size()))
                    return Status::no_frame;
                tell(fired_[static_cast<std::size_t>(argument - 1)]);
                return Status::done;
            case Command::verdict:
                take_verdict(argument == 1   ? PartVerdict::corrected
                             : argument == 2 ? PartVerdict::refused
                                             : PartVerdict::failed);
                return Status::done;
            case Command::move: {
                const auto pose = ur::pose_from_ur(input_pose(), "register");
                if (!pose || cell_->mode() != RobotMode::manual_reduced) return Status::not_teaching;
                cell_->move_to(*pose);
                return Status::done;
            }
            case Command::taken:
                out(ur::kCall) = 0;
                return Status::done;
        }
        return Status::no_frame;
    }

    std::array<double, 6> input_pose() const {
        std::array<double, 6> pose;
        for (int i = 0; i < 6; ++i)
            pose[static_cast<std::size_t>(i)] =
                inputs_.doubles[static_cast<std::size_t>(settings_.first_register + i)];
        return pose;
    }
    void tell(const Pose& pose) {
        const auto wire = wire_pose(pose);
        for (int i = 0; i < 6; ++i)
            outputs_.doubles[static_cast<std::size_t>(settings_.first_register + i)] =
                wire[static_cast<std::size_t>(i)];
    }
    std::array<double, 6> wire_pose(const Pose& pose) const {
        auto wire = ur::ur_pose(pose);
        if (fault() == ControllerFault::out_of_range) wire[0] = 1e6;
        return wire;
    }

    // ---- RTDE
    // The kind of a variable, nothing where the controller has none of that name.
    std::optional<Kind> kind_of(const std::string& name) const {
        if (name == "actual_TCP_pose") return Kind::vector6;
        if (name == "tcp_offset" && settings_.tells_tcp_offset) return Kind::vector6;
        if (name == "robot_mode" || name == "safety_mode") return Kind::int32;
        if (name == "runtime_state") return Kind::uint32;
        if (name == "timestamp") return Kind::real;
        const bool number = name.find("_int_register_") != std::string::npos;
        if (!number && name.find("_double_register_") == std::string::npos) return std::nullopt;
        const long i = std::strtol(name.c_str() + name.rfind('_') + 1, nullptr, 10);
        if (i < 0 || i > ur::kLastRegister) return std::nullopt;
        return number ? Kind::int32 : Kind::real;
    }
    static std::size_t register_of(const std::string& name) {
        return static_cast<std::size_t>(std::strtol(name.c_str() + name.rfind('_') + 1, nullptr, 10));
    }

    Value value_of(const std::string& name) {
        const RobotMode mode = cell_->mode();
        if (name == "actual_TCP_pose") {
            const Pose flange = cell_->reported_flange().value_or(Pose::Identity());
            return wire_pose(settings_.tells_tcp_offset ? flange * tool_ : flange);
        }
        if (name == "tcp_offset") return ur::ur_pose(tool_);
        if (name == "robot_mode") return std::int32_t{7};
        if (name == "safety_mode")
            return std::int32_t{mode == RobotMode::fault ? 9 : mode == RobotMode::stopped ? 3 : 1};
        if (name == "runtime_state") return std::uint32_t{is_stopped(mode) ? 1U : 2U};
        if (name == "timestamp") return std::chrono::duration<double>(Clock::now() - begun_).count();
        const Registers& bank = name.starts_with("input") ? inputs_ : outputs_;
        if (name.find("_int_") != std::string::npos) return bank.ints[register_of(name)];
        return bank.doubles[register_of(name)];
    }

    std::string setup(const Package& request, rtde::Recipe& recipe, bool outputs) {
        std::string_view names = request.payload;
        recipe = {};
        recipe.id = 1;
        recipe.numbered = !outputs || version_ == 2;
        if (outputs && version_ == 2) names.remove_prefix(std::min<std::size_t>(8, names.size()));
        std::string types;
        bool all = true;
        while (!names.empty()) {
            const std::size_t comma = names.find(',');
            recipe.names.emplace_back(names.substr(0, comma));
            names.remove_prefix(comma == std::string_view::npos ? names.size() : comma + 1);
            const auto kind = kind_of(recipe.names.back());
            const bool writable = outputs || recipe.names.back().starts_with("input");
            types += types.empty() ? "" : ",";
            if (kind && writable) {
                recipe.kinds.push_back(*kind);
                types += rtde::kind_name(*kind);
            } else {
                all = false;
                types += "NOT_FOUND";
            }
        }
        if (!all) recipe = {};
        std::string answer;
        if (!outputs || version_ == 2) answer.push_back(static_cast<char>(all ? 1 : 0));
        return answer + types;
    }

    bool answer_package(const Package& package) {
        using rtde::Type;
        const auto reply = [&](std::string payload) { return send({package.type, std::move(payload)}); };
        switch (package.type) {
            case Type::protocol_version: {
                const auto wanted = rtde::version_of(package.payload);
                const bool yes = wanted && *wanted >= 1 && *wanted <= settings_.protocol_version;
                if (yes) version_ = *wanted;
                return wanted && reply(std::string(1, yes ? '\1' : '\0'));
            }
            case Type::setup_outputs:
                return reply(setup(package, output_recipe_, true));
            case Type::setup_inputs:
                return reply(setup(package, input_recipe_, false));
            case Type::start:
                streaming_ = !output_recipe_.names.empty();
                return reply(std::string(1, streaming_ ? '\1' : '\0'));
            case Type::pause:
                streaming_ = false;
                return reply(std::string(1, '\1'));
            case Type::data: {
                const auto values = rtde::values_of(package.payload, input_recipe_);
                if (!values) return false;
                for (std::size_t i = 0; i < values->size(); ++i) {
                    const std::size_t at = register_of(input_recipe_.names[i]);
                    if (const auto* number = std::get_if<std::int32_t>(&(*values)[i]))
                        inputs_.ints[at] = *number;
                    else
                        inputs_.doubles[at] = std::get<double>((*values)[i]);
                }
                return true;
            }
            default:
                return true;
        }
    }

    bool stream_state() {
        if (!streaming_) return true;
        std::vector<Value> values;
        for (const std::string& name : output_recipe_.names) values.push_back(value_of(name));
        return send({rtde::Type::data, rtde::data_payload(output_recipe_, values)});
    }

    bool send(const Package& package) {
        const ControllerFault now = fault();
        if (now == ControllerFault::silent || cut_) return true;
        if (now == ControllerFault::slow) std::this_thread::sleep_for(Timeout(settings_.slow_ms));
        std::string bytes = rtde::package_bytes(package);
        cut_ = now == ControllerFault::half_message;  // and nothing more on this connection
        if (cut_ || now == ControllerFault::disconnect) bytes.resize(bytes.size() / 2);
        return connection_->send(bytes_of(bytes), Timeout(500)) && now != ControllerFault::disconnect;
    }

    void serve_client(const std::stop_token& stop) {
        std::string stream;
        std::array<char, 4096> buffer;
        auto due = Clock::now();
        while (!stop.stop_requested()) {
            const auto got = connection_->receive_some(std::as_writable_bytes(std::span(buffer)), kTick);
            if (!got && !is_silence(got.error())) return;
            if (got) stream.append(buffer.data(), *got);
            for (;;) {
                const auto package = rtde::take_package(stream);
                if (!package) return;
                if (!*package) break;
                if (!answer_package(**package)) return;
            }
            run_module();
            if (Clock::now() < due) continue;
            due = Clock::now() + Timeout(8);
            if (!stream_state()) return;
        }
    }

    void serve_rtde(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            if (auto client = rtde_.accept(kTick)) {
                connection_.emplace(std::move(*client));
                cut_ = streaming_ = false;
                serve_client(stop);
                connection_.reset();
                withdraw();
            }
            run_module();
        }
    }

    // ---- dashboard
    std::string dashboard_answer(const std::string& question) const {
        if (question == "get robot model") return "UR10";
        if (question == "get serial number") return cell_->settings().serial;
        if (question == "is in remote control")
            return cell_->mode() == RobotMode::external ? "true" : "false";
        if (question == "get operational mode")
            return cell_->mode() == RobotMode::manual_reduced ? "MANUAL" : "AUTOMATIC";
        return "could not understand: " + question;
    }

    void serve_dashboard(const std::stop_token& stop) {
        std::optional<TcpConnection> client;
        std::string received;
        while (!stop.stop_requested()) {
            if (auto next = dashboard_.accept(kTick)) {  // a new client takes the place of the old
                client.emplace(std::move(*next));
                received.clear();
                if (!client->send(bytes_of("Connected: Universal Robots Dashboard Server\n"), Timeout(500)))
                    client.reset();
            }
            if (!client) continue;
            std::array<char, 256> buffer;
            const auto got = client->receive_some(std::as_writable_bytes(std::span(buffer)), kTick);
            if (!got) {
                if (!is_silence(got.error())) client.reset();
                continue;
            }
            received.append(buffer.data(), *got);
            for (std::size_t end; client && (end = received.find('\n')) != std::string::npos;) {
                const std::string answer = dashboard_answer(received.substr(0, end)) + "\n";
                received.erase(0, end + 1);
                if (fault() == ControllerFault::silent) continue;
                if (fault() == ControllerFault::slow) std::this_thread::sleep_for(Timeout(settings_.slow_ms));
                if (fault() == ControllerFault::disconnect || !client->send(bytes_of(answer), Timeout(500)))
                    client.reset();
            }
        }
    }

    std::shared_ptr<SimulatedCell> cell_;
    const ControllerSettings settings_;
    const Pose tool_ = make_pose(rotation_exp({0.1, 0.2, 0.3}), {10, -20, 150});  // set on the controller
    const Clock::time_point begun_ = Clock::now();
    TcpListener rtde_, dashboard_;
    std::optional<TcpConnection> connection_;
    // The RTDE thread's alone.
    int version_ = 1;
    bool cut_ = false, streaming_ = false, busy_ = false;
    rtde::Recipe output_recipe_, input_recipe_;
    Registers inputs_, outputs_;
    std::int32_t done_ = 0;
    std::vector<Pose> fired_;
    Clock::time_point next_trigger_{};
    std::jthread rtde_thread_, dashboard_thread_;  // last: everything above is there while they run
};

}  // namespace

Expected<std::unique_ptr<SimulatedController>> start_ur_rtde_controller(std::shared_ptr<SimulatedCell> cell,
                                                                        const nlohmann::json& settings) {
    ControllerSettings s;
    SettingsReader f(settings, "settings");
    f.only({"address", "port", "dashboard_port", "slow_ms", "trigger_interval_ms", "approach_ms",
            "first_register", "protocol_version", "tells_tcp_offset"});
    f.text("address", s.address);
    f.whole("port", s.port, 0, 65535);
    f.whole("dashboard_port", s.dashboard_port, 0, 65535);
    f.whole("slow_ms", s.slow_ms, 0, 60000);
    f.whole("trigger_interval_ms", s.trigger_interval_ms, 0, 60000);
    f.whole("approach_ms", s.approach_ms, 0, 60000);
    f.whole("first_register", s.first_register, 0, ur::kLastRegister + 1 - ur::kOutputs);
    f.whole("protocol_version", s.protocol_version, 1, 2);
    f.truth("tells_tcp_offset", s.tells_tcp_offset);
    if (f.failed()) return tl::unexpected(f.error());
    auto rtde = TcpListener::listen(s.address, static_cast<std::uint16_t>(s.port));
    if (!rtde) return tl::unexpected(rtde.error());
    auto dashboard = TcpListener::listen(s.address, static_cast<std::uint16_t>(s.dashboard_port));
    if (!dashboard) return tl::unexpected(dashboard.error());
    return std::make_unique<RtdeController>(std::move(cell), s, std::move(*rtde), std::move(*dashboard));
}

}  // namespace seamwright
