#include "devices/controllers/ur/controller.h"

#include <fmt/format.h>

#include <atomic>
#include <filesystem>
#include <optional>
#include <thread>

#include "devices/controllers/ur/dashboard_server.h"
#include "devices/controllers/ur/rtde_server.h"
#include "devices/controllers/ur/script/interpreter.h"
#include "devices/exchange/files.h"
#include "devices/exchange/settings.h"
#include "devices/ur/module.h"
#include "devices/ur/program.h"
#include "ur_controller_resources.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
using urscript::Interpreter;
using urscript::Program;
using urscript::Source;

struct ControllerSettings {
    std::string address = "127.0.0.1", scripts;
    int port = 30004, dashboard_port = 29999, slow_ms = 300, application_wait_ms = 200,
        first_register = ur::kFirstRegister, trigger_output = 0, protocol_version = 2, least_slice = 100,
        most_slice = 2000;
    std::uint64_t seed = 1;
    double time_scale = 1;
    bool tells_tcp_offset = true, cb3 = false;
    Pose flange_from_tool = Pose::Identity();

    double cycle_s() const { return cb3 ? 0.008 : 0.002; }
    // Where the line's controller writes: in the field bus's half, unless the module is there.
    std::size_t line() const { return first_register >= 24 ? 16 : 40; }  // eight of them
};

class UrController final : public SimulatedController {
  public:
    UrController(std::shared_ptr<SimulatedCell> cell, ControllerSettings settings, Program application,
                 Program teaching, TcpListener rtde, TcpListener dashboard)
        : cell_(std::move(cell)),
          settings_(std::move(settings)),
          application_(std::move(application)),
          teaching_(std::move(teaching)),
          robot_(cell_, {settings_.cycle_s(), settings_.time_scale, settings_.trigger_output},
                 cell_->reported_flange().value_or(home())),
          rtde_(std::move(rtde), rtde_settings(), [this] { return fault(); }),
          dashboard_(
              std::move(dashboard), settings_.slow_ms, [this] { return fault(); },
              [this](const std::string& question) { return dashboard_answer(question); }) {
        (void)robot_.set_tcp(urscript::pose_value(settings_.flange_from_tool));
        thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
    }
    ~UrController() override {
        thread_.request_stop();
        thread_.join();
    }
    std::uint16_t port() const override { return rtde_.port(); }

  private:
    enum class Play { stopped, playing, paused };

    Pose home() const {
        const auto program = cell_->program();
        return program.empty() ? make_pose(rotation_exp({kPi, 0, 0}), {600, 0, 600}) : program.front().entry;
    }

    urscript::RtdeServerSettings rtde_settings() const {
        urscript::RtdeServerSettings s;
        s.newest_protocol = settings_.protocol_version;
        s.cycle_s = settings_.cycle_s();
        if (settings_.cb3) s.version = {3, 15, 8, 106339};
        s.elsewhere.insert("input_bit_registers0_to_31");
        for (std::size_t i = 0; i < 8; ++i)
            s.elsewhere.insert(fmt::format("input_int_register_{}", settings_.line() + i));
        s.slow_ms = settings_.slow_ms;
        return s;
    }

    // ---- cycles
    void run(const std::stop_token& stop) {
        const auto cycle =
            std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(settings_.cycle_s()));
        auto next = Clock::now();
        while (!stop.stop_requested()) {
            step();
            next += cycle;
            // Late cycles follow each other at once, so that time goes on as real; a machine that was away
            // for long lost that time.
            if (Clock::now() - next > std::chrono::milliseconds(200)) next = Clock::now();
            std::this_thread::sleep_until(next);
        }
    }

    void step() {
        rtde_.take_inputs(inputs_);
        follow_mode();
        call_for_part();
        take_outside();
        robot_.begin_cycle();
        if (play_ == Play::playing) {
            interpreter_->cycle();
            if (!interpreter_->running()) ended();
        }
        tell_state();
        publish();
        if (play_ == Play::playing) robot_.end_cycle();
        ++cycle_;
    }

    void follow_mode() {
        const RobotMode mode = cell_->mode();
        const bool fresh = mode != mode_.exchange(mode);
        const bool teach = mode == RobotMode::manual_reduced;
        if (mode == RobotMode::fault) {
            stop_program();
        } else if (mode == RobotMode::stopped) {
            if (play_ == Play::playing) play_ = Play::paused;
        } else if (fresh || (teach != teaching_now_ && play_ != Play::stopped)) {
            if (play_ == Play::stopped || teach != teaching_now_)
                start_program(teach);
            else
                play_ = Play::playing;
        }
        switch (asked_.exchange(Asked::nothing)) {
            case Asked::play:
                if (mode == RobotMode::fault || mode == RobotMode::stopped) break;
                if (play_ == Play::paused)
                    play_ = Play::playing;
                else if (play_ == Play::stopped)
                    start_program(teach);
                break;
            case Asked::pause:
                if (play_ == Play::playing) play_ = Play::paused;
                break;
            case Asked::stop:
                stop_program();
                break;
            case Asked::close_popup:
                robot_.popup.reset();
                break;
            case Asked::nothing:
                break;
        }
        playing_ = static_cast<int>(play_);
    }

    void start_program(bool teach) {
        stop_program();
        teaching_now_ = teach;
        robot_.popup.reset();
        robot_.outputs.bits[0] = false;
        interpreter_.emplace(teach ? teaching_ : application_, robot_,
                             urscript::InterpreterSettings{settings_.seed + starts_++, settings_.least_slice,
                                                           settings_.most_slice});
        play_ = Play::playing;
    }
    void stop_program() {
        if (interpreter_) interpreter_->stop();
        interpreter_.reset();
        play_ = Play::stopped;
    }
    void ended() {
        if (const auto& error = interpreter_->error()) rtde_.say("Runtime error: " + error->sentence(), 0);
        if (robot_.popup) rtde_.say(*robot_.popup, 1);
        stop_program();
    }

    // The line's controller on its field bus.
    void call_for_part() {
        auto& bits = inputs_.registers.bits;
        if (bits[0]) {
            if (robot_.outputs.bits[0]) bits[0] = false;
            return;
        }
        if (robot_.outputs.bits[0]) return;
        if (const auto call = take_start()) {
            const auto part = ur::part_registers(call->part_id), type = ur::part_registers(call->part_type);
            for (std::size_t i = 0; i < 4; ++i) {
                inputs_.registers.ints[settings_.line() + i] = part[i];
                inputs_.registers.ints[settings_.line() + 4 + i] = type[i];
            }
            bits[0] = true;
        }
    }

    void take_outside() {
        robot_.inputs = inputs_.registers;
        for (int i = 0; i < 8; ++i)
            if ((inputs_.digital_mask >> i & 1) != 0)
                robot_.set_digital_out(i, (inputs_.digital >> i & 1) != 0);
        inputs_.digital_mask = 0;
        for (int i = 0; i < 8; ++i)
            if ((inputs_.configurable_mask >> i & 1) != 0) {
                const std::uint64_t bit = std::uint64_t{1} << i;
                configurable_ =
                    (inputs_.configurable >> i & 1) != 0 ? configurable_ | bit : configurable_ & ~bit;
            }
        inputs_.configurable_mask = 0;
        for (std::size_t i = 0; i < 2; ++i)
            if ((inputs_.analog_mask >> i & 1) != 0) analog_[i] = inputs_.analog[i];
        // A push refused by the controller: it takes no frame of that name any more.
        if (fault() == ControllerFault::reject_write) {
            const auto first = static_cast<std::size_t>(settings_.first_register);
            if (robot_.inputs.ints[first + ur::kCommand] == static_cast<std::int32_t>(ur::Command::write))
                robot_.inputs.ints[first + ur::kArgument] ^= 0x5a5a5a5a;
        }
    }

    // What the line sees of the program: its variables.
    std::int32_t number(const char* name) const {
        const urscript::Value* value = interpreter_ ? interpreter_->global(name) : nullptr;
        const auto* number = value ? std::get_if<std::int32_t>(&value->is) : nullptr;
        return number ? *number : 0;
    }
    void tell_state() {
        const std::int32_t permission = number("sw_permission"), verdict = number("sw_verdict");
        std::optional<PartVerdict> said;
        if (verdict == 1) said = PartVerdict::corrected;
        if (verdict == 2) said = PartVerdict::refused;
        if (verdict == 3) said = PartVerdict::failed;
        tell(permission >= 1, permission >= 2, said);
        tell_frames();
    }
    // The cell's frames are those of the program, under the same names.
    void tell_frames() {
        const urscript::Value* frames = interpreter_ ? interpreter_->global("sw_frames") : nullptr;
        const urscript::Value* names = interpreter_ ? interpreter_->global("sw_names") : nullptr;
        if (!frames || !names || (told_frames_ && *told_frames_ == *frames)) return;
        told_frames_ = *frames;
        const auto& poses = std::get<urscript::ListValue>(frames->is);
        const auto& numbers = std::get<urscript::ListValue>(names->is);
        for (std::size_t i = 0; i < poses.size() && i < numbers.size(); ++i)
            for (const auto& [name, pose] : cell_->settings().robot.frames)
                if (numbers[i] == urscript::Value{ur::frame_number(name)})
                    (void)cell_->write_frame(name,
                                             urscript::pose_of(std::get<urscript::PoseValue>(poses[i].is)));
    }

    void publish() {
        urscript::ControllerState s;
        s.cycle = cycle_;
        s.cycle_s = settings_.cycle_s();
        // The controller was switched on a while before the program began.
        s.timestamp_s = 100 + static_cast<double>(cycle_) * settings_.cycle_s();
        s.inputs = robot_.inputs;
        s.outputs = robot_.outputs;
        s.tcp_pose = robot_.tcp_pose();
        s.target_pose = robot_.target_pose();
        s.tcp_offset = robot_.tcp_offset();
        const Eigen::Vector3d speed = robot_.velocity_mm_s() / 1000;
        s.tcp_speed = {speed.x(), speed.y(), speed.z(), 0, 0, 0};
        joints_ = urscript::joints_towards(robot_.base_from_flange(), joints_, cycle_ == 0 ? 100 : 3);
        s.joints = joints_;
        const RobotMode mode = mode_;
        s.safety_mode = mode == RobotMode::fault ? 9 : mode == RobotMode::stopped ? 3 : 1;
        s.runtime = play_ == Play::playing ? 2 : play_ == Play::paused ? 4 : 1;
        for (int i = 0; i < 8; ++i) s.digital_out |= static_cast<std::uint64_t>(robot_.digital_out(i)) << i;
        s.configurable_out = configurable_;
        s.analog_out = analog_;
        s.analog_types = inputs_.analog_type;
        s.speed_slider = inputs_.slider_mask != 0 ? inputs_.slider : 1;
        s.tells_tcp_offset = settings_.tells_tcp_offset;
        const auto first = static_cast<std::size_t>(settings_.first_register);
        if (fault() == ControllerFault::wrong_answer) s.outputs.ints[first + ur::kAnswered] += 7;
        if (fault() == ControllerFault::out_of_range) s.tcp_pose[0] = s.outputs.reals[first] = 1e6;
        rtde_.publish(s);
    }

    // ---- dashboard, on its clients' threads
    std::string dashboard_answer(const std::string& question) {
        const RobotMode mode = mode_;
        const auto play = static_cast<Play>(playing_.load());
        const bool external = mode == RobotMode::external,
                   safe = mode != RobotMode::fault && mode != RobotMode::stopped;
        const std::string file = "cell.urp";
        const auto command = [&](Asked what, const char* said, const char* name) -> std::string {
            if (!settings_.cb3 && !external) return fmt::format("Failed to execute: {}", name);
            asked_ = what;
            return said;
        };
        const std::string safety = mode == RobotMode::fault ? "FAULT" : safe ? "NORMAL" : "PROTECTIVE_STOP";
        if (question == "get robot model") return settings_.cb3 ? "UR10" : "UR10e";
        if (question == "get serial number") return cell_->settings().serial;
        if (question == "running")
            return play == Play::playing ? "Program running: true" : "Program running: false";
        if (question == "robotmode") return "Robotmode: RUNNING";
        if (question == "safetymode") return "Safetymode: " + safety;
        if (question == "safetystatus") return "Safetystatus: " + safety;
        if (question == "programState")
            return (play == Play::playing  ? "PLAYING "
                    : play == Play::paused ? "PAUSED "
                                           : "STOPPED ") +
                   file;
        if (question == "get loaded program") return "Loaded program: /programs/" + file;
        if (question == "isProgramSaved") return "true " + file;
        if (question == "PolyscopeVersion")
            return settings_.cb3 ? "URSoftware 3.15.8.106339 (May 10 2021)"
                                 : "URSoftware 5.12.0.1101319 (Mar 22 2022)";
        if (question == "play") return command(Asked::play, "Starting program", "play");
        if (question == "pause") return command(Asked::pause, "Pausing program", "pause");
        if (question == "stop") return command(Asked::stop, "Stopped", "stop");
        if (question == "close popup") return command(Asked::close_popup, "closing popup", "close popup");
        if (question.starts_with("addToLog ")) return "Added log message";
        if (question == "quit") return "Disconnected";
        if (!settings_.cb3) {
            if (question == "version") return "5.12.0.1101319";
            if (question == "is in remote control") return external ? "true" : "false";
            if (question == "get operational mode")
                return mode == RobotMode::manual_reduced || mode == RobotMode::manual_full ? "MANUAL"
                                                                                           : "AUTOMATIC";
        }
        return "could not understand: '" + question + "'";
    }

    enum class Asked { nothing, play, pause, stop, close_popup };

    const std::shared_ptr<SimulatedCell> cell_;
    const ControllerSettings settings_;
    const Program application_, teaching_;
    // The cycles' thread's alone.
    urscript::ScriptRobot robot_;
    std::optional<Interpreter> interpreter_;
    Play play_ = Play::stopped;
    bool teaching_now_ = false;
    std::uint64_t starts_ = 0, cycle_ = 0, configurable_ = 0;
    std::array<double, 2> analog_{};
    urscript::ControllerInputs inputs_;
    urscript::Joints joints_{0, -kPi / 2, kPi / 2, 0, kPi / 2, 0};
    std::optional<urscript::Value> told_frames_;
    // Between threads.
    std::atomic<RobotMode> mode_ = RobotMode::unknown;
    std::atomic<int> playing_ = 0;
    std::atomic<Asked> asked_ = Asked::nothing;
    urscript::RtdeServer rtde_;
    urscript::DashboardServer dashboard_;
    std::jthread thread_;  // last
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    if (const std::size_t at = text.find(what); at != std::string::npos) text.replace(at, what.size(), by);
    return text;
}

// The files as they are delivered to a customer, or those of the folder.
Expected<std::vector<Source>> sources_of(const SimulatedCell& cell, const ControllerSettings& s) {
    std::string application =
        replaced(std::string(resources::application_script), "@LINE@", std::to_string(s.line()));
    application = replaced(application, "@WAIT@", fmt::format("{:.3f}", s.application_wait_ms / 1000.0));
    std::vector<Source> sources;
    if (s.scripts.empty()) {
        ProgramRequest request;
        request.project = "simulated cell";
        request.moves = cell.program();
        for (const auto& [name, taught] : cell.settings().robot.frames)
            request.frames.push_back({name, name, cell.read_frame(name).value_or(taught)});
        request.settings = {{"first_register", s.first_register}, {"trigger_output", s.trigger_output}};
        SEAM_TRY(auto files, write_ur_program(request));
        for (ProgramFile& file : files) sources.push_back({file.name, std::move(file.text)});
    } else {
        const std::filesystem::path folder = s.scripts;
        SEAM_TRY(auto module, read_text_file(folder / "seamwright.script"));
        sources.push_back({"seamwright.script", std::move(module)});
        if (std::error_code none; std::filesystem::exists(folder / "application.script", none)) {
            SEAM_TRY(auto own, read_text_file(folder / "application.script"));
            application = std::move(own);
        }
    }
    sources.push_back({"application.script", std::move(application)});
    return sources;
}

}  // namespace

Expected<std::unique_ptr<SimulatedController>> start_ur_rtde_controller(std::shared_ptr<SimulatedCell> cell,
                                                                        const nlohmann::json& settings) {
    ControllerSettings s;
    double unused = 0;
    SettingsReader f(settings, "settings");
    f.only({"address", "port", "dashboard_port", "scripts", "first_register", "trigger_output",
            "application_wait_ms", "time_scale", "cb3", "protocol_version", "tells_tcp_offset", "tool",
            "least_slice", "most_slice", "seed", "slow_ms", "trigger_interval_ms", "approach_ms"});
    f.text("address", s.address);
    f.text("scripts", s.scripts);
    f.whole("port", s.port, 0, 65535);
    f.whole("dashboard_port", s.dashboard_port, 0, 65535);
    f.whole("slow_ms", s.slow_ms, 0, 60000);
    f.whole("application_wait_ms", s.application_wait_ms, 0, 3600000);
    f.whole("first_register", s.first_register, 0, ur::kLastRegister + 1 - ur::kOutputs);
    f.whole("trigger_output", s.trigger_output, 0, 7);
    f.whole("protocol_version", s.protocol_version, 1, 2);
    f.whole("least_slice", s.least_slice, 1, 100000);
    f.whole("most_slice", s.most_slice, 1, 100000);
    f.whole("seed", s.seed, 0, 9e15);
    f.number("time_scale", s.time_scale, 0.1, 100);
    f.number("trigger_interval_ms", unused, 0, 60000);
    f.number("approach_ms", unused, 0, 60000);
    f.truth("tells_tcp_offset", s.tells_tcp_offset);
    f.truth("cb3", s.cb3);
    f.pose("tool", s.flange_from_tool);
    if (f.failed()) return tl::unexpected(f.error());
    s.most_slice = std::max(s.least_slice, s.most_slice);
    SEAM_TRY(auto sources, sources_of(*cell, s));
    SEAM_TRY(auto application, urscript::compile(sources));
    sources.back() = {"teach", "sw_teach()\n"};
    SEAM_TRY(auto teaching, urscript::compile(sources));
    SEAM_TRY(auto rtde, TcpListener::listen(s.address, static_cast<std::uint16_t>(s.port)));
    SEAM_TRY(auto dashboard, TcpListener::listen(s.address, static_cast<std::uint16_t>(s.dashboard_port)));
    return std::make_unique<UrController>(std::move(cell), s, std::move(application), std::move(teaching),
                                          std::move(rtde), std::move(dashboard));
}

}  // namespace seamwright
