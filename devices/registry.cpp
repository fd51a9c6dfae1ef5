#include "devices/registry.h"

#include "devices/replay/recording.h"
#include "devices/simulated/cell.h"

namespace seamwright {

const std::vector<SensorDriver>& sensor_drivers() {
    static const std::vector<SensorDriver> drivers = {
        {"simulated", "A car door before a stripe camera, rendered", &open_simulated_sensor},
        {"replay", "Recorded profiles (CSV) or images of a folder, with poses", &open_replay_sensor},
    };
    return drivers;
}

const std::vector<RobotDriver>& robot_drivers() {
    static const std::vector<RobotDriver> drivers = {
        {"simulated", "A robot with repeatability and trigger jitter", &open_simulated_robot},
        {"replay", "The poses and spots of a recorded folder", &open_replay_robot},
    };
    return drivers;
}

namespace {
template <class Driver>
auto open(const std::vector<Driver>& drivers, const char* what, const std::string& name,
          const nlohmann::json& settings, DeviceSession& session)
    -> decltype(drivers.front().open(settings, session)) {
    std::string known;
    for (const Driver& driver : drivers) {
        if (driver.name == name) return driver.open(settings, session);
        known += (known.empty() ? "" : ", ") + std::string(driver.name);
    }
    return input_error("there is no " + std::string(what) + " driver \"" + name + "\"", {},
                       "known are " + known);
}
}  // namespace

Expected<std::unique_ptr<ProfileSource>> open_sensor(const std::string& driver,
                                                     const nlohmann::json& settings, DeviceSession& session) {
    return open(sensor_drivers(), "sensor", driver, settings, session);
}

Expected<std::unique_ptr<RobotLink>> open_robot(const std::string& driver, const nlohmann::json& settings,
                                                DeviceSession& session) {
    return open(robot_drivers(), "robot", driver, settings, session);
}

}  // namespace seamwright
