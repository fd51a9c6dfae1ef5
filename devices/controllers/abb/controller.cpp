#include "devices/controllers/abb/controller.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "abb_application.h"
#include "core/system_text.h"
#include "devices/abb/program.h"
#include "devices/controllers/abb/rapid/rapid_system.h"
#include "devices/exchange/files.h"
#include "devices/exchange/settings.h"
#include "devices/robot_program.h"
#include "devices/simulated/cell.h"

namespace seamwright {
namespace {

using rapid::Machine;
using rapid::RapidRobot;
using rapid::SourceText;
using rapid::Value;
using Milliseconds = std::chrono::milliseconds;

constexpr const char* kMotionTask = "T_ROB1";
constexpr const char* kServerTask = "SEAMWRIGHT";
constexpr const char* kServerEntry = "SW_Server";

struct Options {
    std::string address = "127.0.0.1", programs;
    int port = 0, application_wait_ms = 200;
    rapid::RobotSettings robot{"", "IRB 6700 (simulated)"};
};

Expected<Options> options_from(const nlohmann::json& json) {
    Options o;
    int slow = 300, ignored = 20;
    SettingsReader f(json, "settings of the simulated abb-rapid controller");
    f.only({"address", "port", "serial", "model", "slow_ms", "time_scale", "application_wait_ms", "programs",
            "trigger_interval_ms"});
    f.text("address", o.address);
    f.whole("port", o.port, 0, 65535);
    f.text("serial", o.robot.serial);
    f.text("model", o.robot.model);
    f.whole("slow_ms", slow, 0, 60000);
    f.number("time_scale", o.robot.time_scale, 0.01, 1000);
    f.whole("application_wait_ms", o.application_wait_ms, 0, 3600000);
    f.text("programs", o.programs);
    f.whole("trigger_interval_ms", ignored, 0, 60000);
    if (f.failed()) return tl::unexpected(f.error());
    o.robot.slow = Milliseconds(slow);
    return o;
}

std::string filled(std::string_view text, const std::vector<std::pair<std::string, std::string>>& values) {
    std::string out(text);
    for (const auto& [name, value] : values)
        for (std::size_t at; (at = out.find("@" + name + "@")) != std::string::npos;)
            out.replace(at, name.size() + 2, value);
    return out;
}

struct Sources {
    std::vector<SourceText> motion, server;
    bool has_main = false;
};

bool has_routine(const std::string& text, const std::string& file, const std::string& name) {
    const auto module = rapid::parse_module(text, file);
    return std::any_of(module->routines.begin(), module->routines.end(),
                       [&](const auto& r) { return r->name == rapid::folded(name); });
}

Sources sorted(const std::vector<ProgramFile>& files) {
    Sources sources;
    for (const ProgramFile& f : files) {
        const bool server = has_routine(f.text, f.name, kServerEntry);
        (server ? sources.server : sources.motion).push_back({f.name, f.text});
        sources.has_main = sources.has_main || has_routine(f.text, f.name, "main");
    }
    return sources;
}

Expected<std::vector<ProgramFile>> files_of_folder(const std::string& folder) {
    std::vector<ProgramFile> files;
    std::error_code failed;
    for (const auto& entry : std::filesystem::directory_iterator(folder, failed)) {
        const auto kind = entry.path().extension();
        if (kind != ".mod" && kind != ".sys") continue;
        SEAM_TRY(auto text, read_text_file(entry.path()));
        files.push_back({entry.path().filename().string(), std::move(text)});
    }
    if (failed) return file_error(Text("the folder cannot be read: {}", system_text(failed)), folder);
    std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
    return files;
}

Expected<std::vector<ProgramFile>> programs_of(const SimulatedCell& cell, const Options& o) {
    if (!o.programs.empty()) return files_of_folder(o.programs);
    ProgramRequest request;
    request.project = "the simulated cell";
    request.moves = cell.program();
    for (const auto& [name, pose] : cell.settings().robot.frames)
        request.frames.push_back({name, name, cell.read_frame(name).value_or(pose)});
    request.settings = {{"address", o.address}, {"port", o.port}};
    return write_abb_program(request);
}

std::string application(const SimulatedCell& cell, const Options& o) {
    const auto& frames = cell.settings().robot.frames;
    return filled(resources::SimApplication_mod,
                  {{"FRAME", frames.empty() ? "wobj0" : frames.begin()->first},
                   {"WAIT", fmt::format("{:.3f}", o.application_wait_ms / 1e3)}});
}

class Controller final : public AbbRapidController {
  public:
    Controller(std::shared_ptr<SimulatedCell> cell, const Options& o, TcpListener listener)
        : port_(listener.port()),
          robot_(std::move(cell), o.robot, std::move(listener), [this] { return fault(); }),
          machine_(rapid::make_instruction_set(rapid::instruction_set_text(), RapidRobot::signals()),
                   robot_.natives(), [this] { return robot_.may_move(); }) {
        robot_.attach(machine_);
    }
    ~Controller() override { machine_.stop(); }

    // Throws rapid::LoadError.
    void load(const Sources& sources) {
        machine_.add(kMotionTask, sources.motion, "main", true);
        machine_.add(kServerTask, sources.server, kServerEntry, false);
    }
    Expected<void> start() {
        machine_.start();
        for (int i = 0; i < 5000 && !robot_.listening(); ++i) {
            if (!machine_.task(rapid::folded(kServerTask))->running()) break;
            std::this_thread::sleep_for(Milliseconds(1));
        }
        if (robot_.listening()) return {};
        const auto said = messages();
        return device_error(
            Text("the server task does not listen{}", (said.empty() ? "" : ": " + said.back())),
            "simulated abb-rapid controller");
    }

    std::uint16_t port() const override { return port_; }
    void press_start(const PartId& part_id, const PartTypeId& part_type) override {
        const std::lock_guard lock(machine_.mutex());
        Value* part = machine_.find(kMotionTask, "simPart");
        Value* called = machine_.find(kMotionTask, "simCalled");
        if (!part || !called) return;  // another application than ours
        part->text = part_id.text().substr(0, rapid::kLongestString);
        if (Value* type = machine_.find(kMotionTask, "swType"); type && !part_type.empty())
            type->text = part_type.text().substr(0, rapid::kLongestString);
        called->number = 1;
    }
    bool released() const override { return given() && (number(kMotionTask, "swGone") == 0.0 || taken()); }
    bool taken() const override { return given() && number(kMotionTask, "swGone") == 1.0; }
    std::optional<PartVerdict> verdict() const override {
        const int told = static_cast<int>(number(kMotionTask, "swVerdict").value_or(0));
        if (told == 1) return PartVerdict::corrected;
        if (told == 2) return PartVerdict::refused;
        if (told == 3) return PartVerdict::failed;
        return std::nullopt;
    }
    std::vector<std::string> messages() const override { return machine_.messages(); }
    std::optional<double> number(const std::string& task, const std::string& name) const override {
        const std::lock_guard lock(machine_.mutex());
        const Value* v = machine_.find(task, name);
        return v ? std::optional<double>(v->number) : std::nullopt;
    }
    bool set_number(const std::string& task, const std::string& name, double value) override {
        const std::lock_guard lock(machine_.mutex());
        Value* v = machine_.find(task, name);
        if (v) v->number = rapid::as_num(value);
        return v != nullptr;
    }

  private:
    // The permission is that of a part; of the next part it is none.
    bool given() const {
        const auto part = number(kMotionTask, "swGivenFor");
        return part && *part != 0;
    }

    const std::uint16_t port_;
    RapidRobot robot_;
    mutable Machine machine_;
};

}  // namespace

Expected<std::unique_ptr<AbbRapidController>> start_abb_rapid_controller(std::shared_ptr<SimulatedCell> cell,
                                                                         const nlohmann::json& settings) {
    SEAM_TRY(auto options, options_from(settings));
    if (options.robot.serial.empty()) options.robot.serial = cell->settings().serial;
    SEAM_TRY(auto listener, TcpListener::listen(options.address, static_cast<std::uint16_t>(options.port)));
    options.port = listener.port();
    SEAM_TRY(auto files, programs_of(*cell, options));
    try {
        Sources sources = sorted(files);
        if (!sources.has_main) sources.motion.push_back({"SimApplication.mod", application(*cell, options)});
        auto controller = std::make_unique<Controller>(std::move(cell), options, std::move(listener));
        controller->load(sources);
        SEAM_OK(controller->start());
        return controller;
    } catch (const rapid::LoadError& e) {
        return input_error(e.what(), "programs of the ABB controller");
    }
}

Expected<std::unique_ptr<SimulatedController>> start_abb_rapid(std::shared_ptr<SimulatedCell> cell,
                                                               const nlohmann::json& settings) {
    SEAM_TRY(auto controller, start_abb_rapid_controller(std::move(cell), settings));
    return controller;
}

Expected<void> check_rapid(const std::vector<ProgramFile>& motion, const std::vector<ProgramFile>& server) {
    try {
        const auto set = rapid::make_instruction_set(rapid::instruction_set_text(), RapidRobot::signals());
        rapid::Persistents shared;
        for (const auto* files : {&motion, &server}) {
            std::vector<SourceText> sources;
            for (const ProgramFile& f : *files) sources.push_back({f.name, f.text});
            (void)rapid::link_task(files == &motion ? kMotionTask : kServerTask, sources, set, shared);
        }
        return {};
    } catch (const rapid::LoadError& e) {
        return input_error(e.what(), "RAPID");
    }
}

}  // namespace seamwright
