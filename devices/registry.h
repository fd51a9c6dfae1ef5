#pragma once
// Drivers by name. Adding a sensor or a robot is one folder and one line in registry.cpp.

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "devices/profile_source.h"
#include "devices/robot_link.h"

namespace seamwright {

// Opens the devices of one cell. Sensors and robot of a driver that simulates or replays share one world, so a cell is
// opened as a whole: `session` carries what they share and is created empty by the caller.
class DeviceSession {
public:
    // The object stored under `key`, made by `make` at the first call. Drivers of one world agree on the key.
    template <class T, class Make>
    Expected<std::shared_ptr<T>> shared(const std::string& key, Make make) {
        auto it = objects_.find(key);
        if (it == objects_.end()) {
            Expected<std::shared_ptr<T>> made = make();
            if (!made) return made;
            it = objects_.emplace(key, *made).first;
        }
        return std::static_pointer_cast<T>(it->second);
    }

private:
    std::map<std::string, std::shared_ptr<void>> objects_;
};

struct SensorDriver {
    std::string_view name, help;
    // `settings` are the connection parameters stored in the project (address, serial, folder, seed, ...).
    Expected<std::unique_ptr<ProfileSource>> (*open)(const nlohmann::json& settings, DeviceSession& session);
};
struct RobotDriver {
    std::string_view name, help;
    Expected<std::unique_ptr<RobotLink>> (*open)(const nlohmann::json& settings, DeviceSession& session);
};
const std::vector<SensorDriver>& sensor_drivers();
const std::vector<RobotDriver>& robot_drivers();

// Opens by driver name; an unknown name is an Error that lists the known ones.
Expected<std::unique_ptr<ProfileSource>> open_sensor(const std::string& driver, const nlohmann::json& settings,
                                                     DeviceSession& session);
Expected<std::unique_ptr<RobotLink>> open_robot(const std::string& driver, const nlohmann::json& settings,
                                                DeviceSession& session);

}  // namespace seamwright
