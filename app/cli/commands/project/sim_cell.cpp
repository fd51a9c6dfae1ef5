// seamwright sim-cell: the simulated cell as a process of its own, behind real protocols.

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <iostream>
#include <sstream>

#include "app/cli/command.h"
#include "app/cli/signal_watch.h"
#include "core/number_text.h"
#include "devices/cell_server.h"
#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "devices/exchange/settings.h"
#include "devices/served/served_gocator.h"
#include "projects/file/project_file.h"
#include "projects/model/part_types.h"
#include "projects/station/acquire.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct SimCellArguments {
    std::string settings, project, camera, gocator, fault;
    std::vector<std::string> controllers;
    double time_scale = 1;
};

constexpr const char* kWords =
    "start [PART] | type ID (its measuring program is loaded, calls say it) | part {JSON: displacement, "
    "bend_mm, twist_mm} | "
    "shift {JSON: pose} (the robot stands off by that in base) | scene part|sphere|plate|triangle (what "
    "stands "
    "before the sensor) | flange {JSON: pose} (somebody jogs the robot there by its own panel) | project "
    "FILE.seam "
    "(its measuring program is loaded) | camera on|off | mode MODE | fault FAULT | state | stop";

// "kuka-eki" or "kuka-eki:54600"
Expected<ServedController> controller_from(const std::string& text) {
    const auto colon = text.rfind(':');
    ServedController c{text.substr(0, colon), json::object()};
    if (colon == std::string::npos) return c;
    int port = -1;
    const auto digits = text.substr(colon + 1);
    if (!digits.empty() && digits.size() <= 5 && digits.find_first_not_of("0123456789") == std::string::npos)
        port = number_from<int>(digits).value_or(-1);
    if (port < 0 || port > 65535)
        return usage_error(Text("\"{}\" is no port", digits), Text("--controller {}", text),
                           "give NAME or NAME:PORT");
    c.settings["port"] = port;
    return c;
}

// What the settings say under "serve" ({"camera": ADDRESS, "controllers": [NAME:PORT]}, as the demo leaves
// it) is served where the command names nothing.
Expected<void> take_serve(json& cell_settings, SimCellArguments& a) {
    const auto serve = cell_settings.is_object() ? cell_settings.find("serve") : cell_settings.end();
    if (serve == cell_settings.end()) return {};
    SettingsReader f(*serve, "serve");
    f.only({"camera", "controllers"});
    std::string camera;
    f.text("camera", camera);
    if (f.failed()) return tl::unexpected(f.error());
    std::vector<std::string> controllers;
    if (const auto named = serve->find("controllers"); named != serve->end()) {
        if (!named->is_array()) return input_error("must be a list of NAME:PORT", "serve.controllers");
        for (const json& name : *named) {
            if (!name.is_string()) return input_error("must be a list of NAME:PORT", "serve.controllers");
            controllers.push_back(name.get<std::string>());
        }
    }
    if (a.camera.empty() && a.gocator.empty()) a.camera = camera;
    if (a.controllers.empty()) a.controllers = controllers;
    cell_settings.erase(serve);
    return {};
}

// The cell with what its PLC knows: the project, and of which type the next part is.
struct Serving {
    CellServer server;
    Project project;
    PartTypeId type;
    PartState part;
    Pose base_from_shifted = Pose::Identity();  // where the robot stands instead
};

// Seen by a robot that stands off, all that stands before it is moved the other way.
void place_part(Serving& serving) {
    SimulatedCell& cell = serving.server.cell();
    const Pose& base_from_workobject = cell.base_from_workobject();
    PartState seen = serving.part;
    seen.workobject_from_movedworkobject = base_from_workobject.inverse() *
                                           serving.base_from_shifted.inverse() * base_from_workobject *
                                           serving.part.workobject_from_movedworkobject;
    cell.set_part(seen);
}

// All robots' moves, one after the other.
std::vector<MeasuringMove> program_of(const Project& project) {
    std::vector<MeasuringMove> all;
    for (const RobotSetup& robot : project.robots) {
        auto moves = measuring_program(project, robot.id);
        all.insert(all.end(), moves.begin(), moves.end());
    }
    return all;
}

Expected<Serving> serve(SimCellArguments a, json cell_settings) {
    SEAM_OK(take_serve(cell_settings, a));
    CellServerOptions options;
    options.cell = cell_settings;
    options.camera_address = a.camera;
    if (!a.gocator.empty()) options.gocator = {{"address", a.gocator}};
    for (const std::string& text : a.controllers) {
        SEAM_TRY(auto controller, controller_from(text));
        if (a.time_scale != 1) controller.settings["time_scale"] = a.time_scale;
        options.controllers.push_back(std::move(controller));
    }
    Project project;
    if (!a.project.empty()) {
        SEAM_TRY(auto file, ProjectFile::open(a.project, FileAccess::read_only));
        SEAM_TRY(project, file.load());
        options.program = program_of(project);
    }
    SEAM_TRY(auto server, CellServer::start(options));
    const PartState part = server.cell().part();
    return Serving{std::move(server), std::move(project), {}, part};
}

json state_json(Serving& serving) {
    CellServer& server = serving.server;
    json state = {{"mode", to_string(server.cell().mode())},
                  {"part", server.cell().describe()},
                  {"type", serving.type.text()},
                  {"shift", pose_json(serving.base_from_shifted)},
                  {"frames", json::object()},
                  {"controllers", json::array()}};
    for (const auto& [name, taught] : server.cell().settings().robot.frames)
        if (const auto frame = server.cell().read_frame(name)) state["frames"][name] = pose_json(*frame);
    for (const auto& [name, controller] : server.controllers()) {
        json c = {{"name", name},
                  {"port", controller->port()},
                  {"fault", to_string(controller->fault())},
                  {"released", controller->released()},
                  {"taken", controller->taken()},
                  {"verdict", nullptr}};
        if (const auto verdict = controller->verdict()) c["verdict"] = to_string(*verdict);
        state["controllers"].push_back(std::move(c));
    }
    if (server.camera_address().empty())
        state["camera"] = nullptr;
    else
        state["camera"] = {{"address", server.camera_address()},
                           {"serial", server.cell().settings().serial},
                           {"plugged", server.camera_plugged()}};
    state["gocator"] = nullptr;
    if (const ServedGocator* gocator = server.gocator())
        state["gocator"] = {{"control_port", gocator->control_port()},
                            {"data_port", gocator->data_port()},
                            {"ascii_port", gocator->ascii_port()}};
    return state;
}

// One line of standard input. The answer is one line of JSON.
json obey(Serving& serving, const std::string& line, bool& stop) {
    CellServer& server = serving.server;
    std::istringstream words(line);
    std::string word, rest;
    words >> word;
    std::getline(words >> std::ws, rest);
    const auto refuse = [&](const std::string& why) { return json{{"ok", false}, {"error", why}}; };
    if (word == "start") {
        for (const auto& [name, controller] : server.controllers())
            controller->press_start(PartId(rest), serving.type);
    } else if (word == "project") {
        auto file = ProjectFile::open(rest, FileAccess::read_only);
        if (!file) return refuse(file.error().sentence());
        auto project = file->load();
        if (!project) return refuse(project.error().sentence());
        serving.project = std::move(*project);
        serving.type = {};
        server.cell().store_program(program_of(serving.project));
    } else if (word == "type") {
        const auto type = called_type(serving.project, rest);
        if (!type) return refuse(type.error().sentence());
        serving.type = PartTypeId(*type);
        server.cell().store_program(program_of(of_type(serving.project, *type)));
    } else if (word == "part") {
        const auto state = parse_json(rest, "part");
        if (!state) return refuse(state.error().sentence());
        auto part = parse_part_state(*state);
        if (!part) return refuse(part.error().sentence());
        serving.part = *part;
        place_part(serving);
    } else if (word == "shift") {
        const auto said = parse_json(rest, "shift");
        if (!said) return refuse(said.error().sentence());
        const auto shift = parse_pose(*said, "shift");
        if (!shift) return refuse(shift.error().sentence());
        serving.base_from_shifted = *shift;
        place_part(serving);
    } else if (word == "scene") {
        const auto scene = scene_from_string(rest);
        if (!scene) return refuse("there is no scene \"" + rest + "\"");
        server.cell().set_scene(*scene);
    } else if (word == "flange") {
        const auto said = parse_json(rest, "flange");
        if (!said) return refuse(said.error().sentence());
        const auto flange = parse_pose(*said, "flange");
        if (!flange) return refuse(flange.error().sentence());
        server.cell().move_to(*flange);
    } else if (word == "camera") {
        if (rest != "on" && rest != "off") return refuse("say: camera on, or camera off");
        if (const auto plugged = server.plug_camera(rest == "on"); !plugged)
            return refuse(plugged.error().sentence());
    } else if (word == "mode") {
        const auto mode = robot_mode_from_string(rest);
        if (!mode) return refuse("there is no mode \"" + rest + "\"");
        server.cell().set_mode(*mode);
    } else if (word == "fault") {
        const auto fault = controller_fault_from(rest);
        if (!fault) return refuse("there is no fault \"" + rest + "\"");
        for (const auto& [name, controller] : server.controllers()) controller->set_fault(*fault);
    } else if (word == "stop") {
        stop = true;
    } else if (word != "state") {
        return refuse("\"" + word + "\" is none of: " + kWords);
    }
    json answer = state_json(serving);
    answer["ok"] = true;
    return answer;
}

Expected<Answer> sim_cell(const SimCellArguments& a) {
    json settings = json::object();
    if (!a.settings.empty()) {
        SEAM_TRY(auto read, read_json_file(a.settings));
        settings = std::move(read);
    }
    const auto stop = stop_on_signal();
    SEAM_TRY(auto serving, serve(a, settings));
    if (!a.fault.empty()) {
        const auto fault = controller_fault_from(a.fault);
        if (!fault) return usage_error(Text("there is no fault \"{}\"", a.fault), "--fault");
        for (const auto& [name, controller] : serving.server.controllers()) controller->set_fault(*fault);
    }
    std::cout << state_json(serving).dump() << std::endl;
    bool done = false, input = true;
    std::string pending;
    while (!done && !stop.stop_requested()) {
        pollfd in{input ? STDIN_FILENO : -1, POLLIN, 0};
        if (poll(&in, 1, 100) <= 0) continue;
        char buffer[4096];
        const auto got = read(STDIN_FILENO, buffer, sizeof buffer);
        if (got <= 0) {
            input = false;  // started in the background: runs until a signal
            continue;
        }
        pending.append(buffer, static_cast<std::size_t>(got));
        for (std::size_t end; !done && (end = pending.find('\n')) != std::string::npos;) {
            const std::string line = pending.substr(0, end);
            pending.erase(0, end + 1);
            if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
            std::cout << obey(serving, line, done).dump(-1, ' ', false, json::error_handler_t::replace)
                      << std::endl;
        }
        if (pending.size() > 65536) return input_error("a line of over 65536 bytes", "standard input");
    }
    Answer answer;
    answer.json = state_json(serving);
    answer.json["status"] = "stopped";
    answer.text = "stopped\n";
    return answer;
}

}  // namespace

void add_sim_cell(CommandLine& line) {
    auto a = std::make_shared<SimCellArguments>();
    CLI::App* command = line.add(
        "sim-cell",
        std::string(
            "The simulated cell behind real protocols until stopped: a GigE Vision camera or a Gocator and "
            "robot "
            "controllers "
            "on the loopback address. Writes its state as one line of JSON, then obeys lines on standard "
            "input: ") +
            kWords,
        "seamwright sim-cell --camera 127.0.0.1 --controller kuka-eki:54600 --project door_left.seam");
    std::string known, faults = "none";
    for (const ControllerDriver& d : controller_drivers())
        known += (known.empty() ? "" : " | ") + std::string(d.name);
    for (const ControllerFault f : controller_faults()) faults += " | " + std::string(to_string(f));
    command
        ->add_option(
            "settings", a->settings,
            "The cell's settings; what they name under \"serve\" is served where the command names nothing")
        ->type_name("CELL.json");
    command->add_option("--project", a->project, "Its spots are the measuring program on the controllers")
        ->type_name("FILE.seam");
    command
        ->add_option("--camera", a->camera,
                     "Serve the sensor as a GigE Vision camera on this address; free: one that is found free")
        ->type_name("ADDRESS");
    command->add_option("--gocator", a->gocator, "Serve it as a Gocator on this address instead")
        ->type_name("ADDRESS");
    command->add_option("--controller", a->controllers, "Repeatable: " + known)->type_name("NAME[:PORT]");
    command
        ->add_option(
            "--time-scale", a->time_scale,
            "The robots do everything so many times as fast; of controllers whose programs are executed")
        ->check(CLI::Range(0.01, 100.0))
        ->capture_default_str();
    command->add_option("--fault", a->fault, "What the controllers do wrong: " + faults);
    line.on(command, [a] { return sim_cell(*a); });
}

}  // namespace seamwright::cli
