#pragma once
// Where a session lies beside its project.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/ids.h"

namespace seamwright {

// Device names come from people: what a folder cannot be called becomes '_'.
std::string file_name(const std::string& text);

// The other devices of the project: what is of one of them is nobody else's.
struct OtherDevices {
    std::vector<std::string> sensors, robots;
};

// Several names make one name of a folder ("K ä", "K ö"), and one sensor is calibrated on several robots: each has a folder of
// its own, the second ends in -2: a session that is in the folder, of another sensor or captured with one of the other robots, is
// passed over. A renamed sensor's session stays where it was begun and is found by what it says; where the project has not
// kept the new name, by the former one. The folder may not be there yet.
std::filesystem::path session_folder(const std::filesystem::path& project_file, const MethodId& method,
                                     const SensorId& sensor, const OtherDevices& others);

// Of all methods, those that were put aside left out; each holds a session.json.
std::vector<std::filesystem::path> session_folders(const std::filesystem::path& project_file);

// Whether session.json is of that sensor, whatever robot it was captured with.
bool is_session_of(const nlohmann::json& list, const std::string& sensor,
                   const std::vector<std::string>& other_sensors);
// The names that the sensor of session.json had, the newest last, when it is called `sensor` now.
std::vector<std::string> former_sensors(const nlohmann::json& list, const std::string& sensor);

Expected<void> move_folder(const std::filesystem::path& from, const std::filesystem::path& to);
// Beside itself, under the time. Where it went; empty: there was none.
Expected<std::filesystem::path> put_folder_aside(const std::filesystem::path& folder);

}  // namespace seamwright
