#pragma once
// Drivers by name. Adding a sensor or a robot is one folder and one line in registry.cpp.

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "devices/device_session.h"
#include "devices/exchange/settings.h"
#include "devices/profile_source.h"
#include "devices/robot_link.h"
#include "devices/robot_program.h"
#include "devices/simulated/controller.h"

namespace seamwright {

struct SensorDriver {
    std::string_view name, help;
    // `settings` are the connection parameters stored in the project (address, serial, folder, seed, ...).
    Expected<std::unique_ptr<ProfileSource>> (*open)(const nlohmann::json& settings, DeviceSession& session);
    const SettingTable& (*settings)();  // what `open` takes
};
struct RobotDriver {
    std::string_view name, help;
    Expected<std::unique_ptr<RobotLink>> (*open)(const nlohmann::json& settings, DeviceSession& session);
    const SettingTable& (*settings)();
};
// A controller that speaks a robot driver's protocol from the other side, before a simulated cell. Same name
// as the driver. `settings`: {"address": "127.0.0.1", "port": 0 (of the driver's server, where the robot is
// the client; else where to listen, 0 = any free one)} and what the driver's folder documents.
struct ControllerDriver {
    std::string_view name, help;
    Expected<std::unique_ptr<SimulatedController>> (*start)(std::shared_ptr<SimulatedCell> cell,
                                                            const nlohmann::json& settings);
};
// Writes the controller's side: the fixed module of resources/robot/<brand> and what follows from the
// project. Refuses names and poses that the controller cannot hold.
struct ProgramWriter {
    std::string_view name, help;  // "kuka", "abb", "ur"
    Expected<std::vector<ProgramFile>> (*write)(const ProgramRequest& request);
    Expected<std::vector<ProgramFile>> (*write_path)(const PathProgramRequest& request);
};
// Of the cell in this program (devices/simulated/cell.h): its truth is known, its part can be displaced, and its robot
// is moved without a person beside it.
bool is_simulated_cell(std::string_view driver);
// Stands in this program alone, so that no other can have it at the same time: simulated cells, recordings.
bool is_own_device(std::string_view driver);
const std::vector<SensorDriver>& sensor_drivers();
const std::vector<RobotDriver>& robot_drivers();
const std::vector<ControllerDriver>& controller_drivers();
const std::vector<ProgramWriter>& program_writers();

// The table of a driver, for people; nullopt: no such driver. A sensor's and a robot's driver may share a name.
std::optional<std::string> driver_text(std::string_view name);
// Those of all drivers: devices/SETTINGS.md.
std::string settings_document();

// Opens by driver name; an unknown name is an Error that lists the known ones.
Expected<std::unique_ptr<ProfileSource>> open_sensor(const std::string& driver,
                                                     const nlohmann::json& settings, DeviceSession& session);
// The same, trying again while another program controls the sensor: one that was killed does until the
// camera's heartbeat time-out (3 s unless set) has run out. `progress` is told so once a second.
struct Patience {
    std::chrono::milliseconds most{6000};
    std::stop_token cancel = {};
    std::function<void(const Text& text)> progress = {};
};
Expected<std::unique_ptr<ProfileSource>> open_sensor(const std::string& driver,
                                                     const nlohmann::json& settings, DeviceSession& session,
                                                     const Patience& patience);
Expected<std::unique_ptr<RobotLink>> open_robot(const std::string& driver, const nlohmann::json& settings,
                                                DeviceSession& session);

Expected<std::unique_ptr<SimulatedController>> start_controller(const std::string& driver,
                                                                std::shared_ptr<SimulatedCell> cell,
                                                                const nlohmann::json& settings);
Expected<std::vector<ProgramFile>> write_robot_program(const std::string& brand,
                                                       const ProgramRequest& request);
Expected<std::vector<ProgramFile>> write_robot_path(const std::string& brand,
                                                    const PathProgramRequest& request);

// Makes the folder and writes all of them or none; where they are. Error (file, input).
Expected<std::vector<std::filesystem::path>> write_program_files(const std::filesystem::path& folder,
                                                                 const std::vector<ProgramFile>& files);

}  // namespace seamwright
