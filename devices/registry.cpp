#include "devices/registry.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>
#include <type_traits>
#include <utility>

#include "core/system_text.h"
#include "devices/abb/egm.h"
#include "devices/abb/program.h"
#include "devices/abb/rapid.h"
#include "devices/controllers/abb/controller.h"
#include "devices/controllers/abb/egm_controller.h"
#include "devices/controllers/kuka/controller.h"
#include "devices/controllers/kuka/rsi_controller.h"
#include "devices/controllers/ur/controller.h"
#include "devices/exchange/files.h"
#include "devices/genicam/genicam.h"
#include "devices/genicam/genicam_settings.h"
#include "devices/gocator/gocator.h"
#include "devices/kuka/eki.h"
#include "devices/kuka/kvp.h"
#include "devices/kuka/program.h"
#include "devices/kuka/rsi.h"
#include "devices/line/line_link.h"
#include "devices/replay/recording.h"
#include "devices/simulated/cell.h"
#include "devices/simulated/gripper_cell.h"
#include "devices/ur/program.h"
#include "devices/ur/rtde.h"

namespace seamwright {

bool is_simulated_cell(std::string_view driver) {
    return driver == "simulated";
}

bool is_own_device(std::string_view driver) {
    return is_simulated_cell(driver) || driver == "simulated-gripper" || driver == "replay";
}

const std::vector<SensorDriver>& sensor_drivers() {
    static const std::vector<SensorDriver> drivers = {
        {"simulated", "A car door before a stripe camera, rendered", &open_simulated_sensor,
         &simulated_cell_settings},
        {"simulated-gripper", "A panel in a gripper before a body's opening, rendered", &open_gripper_sensor,
         &gripper_cell_settings},
        {"replay", "A recorded capture, or profiles (CSV) or images of a folder, with poses",
         &open_replay_sensor, &replay_sensor_settings},
        {"genicam", "GigE Vision and USB3 Vision cameras, images or profiles (GenICam)", &open_genicam_sensor,
         &genicam_settings},
        {"gocator", "LMI Gocator, profiles or the results of its own tools over TCP", &open_gocator_sensor,
         &gocator_settings},
    };
    return drivers;
}

const std::vector<RobotDriver>& robot_drivers() {
    static const std::vector<RobotDriver> drivers = {
        {"simulated", "A robot with repeatability and trigger jitter", &open_simulated_robot,
         &simulated_cell_settings},
        {"simulated-gripper", "A robot whose gripper holds a panel", &open_gripper_robot,
         &gripper_cell_settings},
        {"kuka-eki", "KUKA, the controller connects by EthernetKRL", &open_kuka_eki, &kuka_eki_settings},
        {"kuka-kvp", "KUKA, variables of the controller by KUKAVARPROXY", &open_kuka_kvp, &kuka_kvp_settings},
        {"kuka-rsi", "KUKA path correction in every cycle (RSI)",
         [](const nlohmann::json& settings, DeviceSession& session) {
             return open_kuka_rsi(settings, session, &open_robot);
         },
         &kuka_rsi_settings},
        {"replay", "The poses and spots of a recorded capture or folder", &open_replay_robot,
         &replay_robot_settings},
        {"ur-rtde", "Universal Robots, registers and poses by RTDE", &open_ur_rtde, &ur_rtde_settings},
        {"abb-rapid", "ABB controller with our RAPID server task (TCP)", &open_abb_rapid,
         &abb_rapid_settings},
        {"abb-egm", "ABB path correction in every cycle (EGM)",
         [](const nlohmann::json& settings, DeviceSession& session) {
             return open_abb_egm(settings, session, &open_robot);
         },
         &abb_egm_settings},
    };
    return drivers;
}

std::optional<std::string> driver_text(std::string_view name) {
    std::string text;
    const auto add = [&](const char* kind, const auto& drivers) {
        for (const auto& d : drivers)
            if (d.name == name)
                text += fmt::format("{}{} {}: {}\n\n{}", text.empty() ? "" : "\n", kind, d.name, d.help,
                                    settings_text(d.settings()));
    };
    add("sensor", sensor_drivers());
    add("robot", robot_drivers());
    add("line", line_protocols());
    if (text.empty()) return std::nullopt;
    return text;
}

std::string settings_document() {
    std::string text =
        "# Settings of the drivers\n\nWritten by `seamwright devices --help all`. Each line: name, default, "
        "range or "
        "kind, meaning; the unit is the end of\nthe name. A pose is written as in project files.\n";
    std::vector<std::string_view> done;
    const auto add = [&](const auto& drivers) {
        for (const auto& d : drivers) {
            if (std::find(done.begin(), done.end(), d.name) != done.end()) continue;
            done.push_back(d.name);
            text += fmt::format("\n## {}\n\n```\n{}```\n", d.name, *driver_text(d.name));
        }
    };
    add(sensor_drivers());
    add(robot_drivers());
    add(line_protocols());
    return text;
}

const std::vector<ControllerDriver>& controller_drivers() {
    static const std::vector<ControllerDriver> drivers = {
        {"kuka-eki", "A KUKA controller that connects by EthernetKRL", &start_kuka_eki_controller},
        {"kuka-kvp", "A KUKA controller with KUKAVARPROXY", &start_kuka_kvp_controller},
        {"kuka-rsi", "A KUKA controller that asks for path corrections (RSI)",
         [](std::shared_ptr<SimulatedCell> cell, const nlohmann::json& settings) {
             return start_kuka_rsi(std::move(cell), settings, &start_controller);
         }},
        {"ur-rtde", "A Universal Robots controller with RTDE and dashboard", &start_ur_rtde_controller},
        {"abb-rapid", "An ABB controller with our RAPID server task", &start_abb_rapid},
        {"abb-egm", "An ABB controller that asks for path corrections (EGM)",
         [](std::shared_ptr<SimulatedCell> cell, const nlohmann::json& settings) {
             return start_abb_egm(std::move(cell), settings, &start_controller);
         }},
    };
    return drivers;
}

const std::vector<ProgramWriter>& program_writers() {
    static const std::vector<ProgramWriter> writers = {
        {"kuka", "KRL for EthernetKRL", &write_kuka_program, &write_kuka_path},
        {"abb", "RAPID with a server task", &write_abb_program, &write_abb_path},
        {"ur", "URScript for RTDE", &write_ur_program, &write_ur_path},
    };
    return writers;
}

namespace {
// Calls `open` of the driver of that name.
template <class Driver, class Open, class... Arguments>
auto call(const std::vector<Driver>& drivers, const char* what, const std::string& name, Open Driver::*open,
          Arguments&&... arguments) -> std::invoke_result_t<Open, Arguments...> {
    std::string known;
    for (const Driver& driver : drivers) {
        if (driver.name == name) return (driver.*open)(std::forward<Arguments>(arguments)...);
        known += (known.empty() ? "" : ", ") + std::string(driver.name);
    }
    return input_error(Text("there is no {} \"{}\"", what, name), {}, Text("known are {}", known));
}
}  // namespace

Expected<std::unique_ptr<ProfileSource>> open_sensor(const std::string& driver,
                                                     const nlohmann::json& settings, DeviceSession& session) {
    return call(sensor_drivers(), "sensor driver", driver, &SensorDriver::open, settings, session);
}

Expected<std::unique_ptr<ProfileSource>> open_sensor(const std::string& driver,
                                                     const nlohmann::json& settings, DeviceSession& session,
                                                     const Patience& patience) {
    using Clock = std::chrono::steady_clock;
    const auto until = Clock::now() + patience.most;
    auto tell_at = Clock::now();
    for (;;) {
        auto sensor = open_sensor(driver, settings, session);
        if (sensor || !is_in_use(sensor.error()) || Clock::now() >= until || patience.cancel.stop_requested())
            return sensor;
        if (patience.progress && Clock::now() >= tell_at) {
            patience.progress(sensor.error().text());
            tell_at += std::chrono::seconds(1);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
}

Expected<std::unique_ptr<RobotLink>> open_robot(const std::string& driver, const nlohmann::json& settings,
                                                DeviceSession& session) {
    return call(robot_drivers(), "robot driver", driver, &RobotDriver::open, settings, session);
}

Expected<std::unique_ptr<SimulatedController>> start_controller(const std::string& driver,
                                                                std::shared_ptr<SimulatedCell> cell,
                                                                const nlohmann::json& settings) {
    return call(controller_drivers(), "simulated controller", driver, &ControllerDriver::start,
                std::move(cell), settings);
}

Expected<std::vector<ProgramFile>> write_robot_program(const std::string& brand,
                                                       const ProgramRequest& request) {
    return call(program_writers(), "robot brand", brand, &ProgramWriter::write, request);
}

Expected<std::vector<ProgramFile>> write_robot_path(const std::string& brand,
                                                    const PathProgramRequest& request) {
    return call(program_writers(), "robot brand", brand, &ProgramWriter::write_path, request);
}

Expected<std::vector<std::filesystem::path>> write_program_files(const std::filesystem::path& folder,
                                                                 const std::vector<ProgramFile>& files) {
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed)
        return file_error(Text("the folder cannot be made: {}", system_text(failed)), folder.string());
    // A controller with one file of the old program and one of the new does neither: all stand written before the first
    // takes its name.
    std::vector<std::filesystem::path> written, beside;
    Expected<void> done;
    for (const ProgramFile& f : files) {
        written.push_back(folder / f.name);
        beside.push_back(folder / (f.name + ".new"));
        if (std::filesystem::is_directory(written.back(), failed))
            done = file_error("is a folder, not a file", written.back().string());
        if (done) done = check_replaceable(written.back());
        if (done) done = write_text_file(beside.back(), f.text);
        if (!done) break;
    }
    for (std::size_t i = 0; done && i < written.size(); ++i) {
        std::filesystem::rename(beside[i], behind_links(written[i]), failed);
        if (failed)
            done = file_error(Text("cannot be written ({})", system_text(failed)), written[i].string());
    }
    if (done) return written;
    for (const auto& path : beside) std::filesystem::remove(path, failed);
    return tl::unexpected(done.error());
}

}  // namespace seamwright
