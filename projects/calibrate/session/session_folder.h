#pragma once
// Where a session lies beside its project.

#include <filesystem>
#include <string>
#include <vector>

#include "core/ids.h"

namespace seamwright {

// Device names come from people: what a folder cannot be called becomes '_'.
std::string file_name(const std::string& text);

// Several names make one name of a folder ("K ä", "K ö"), and one sensor is calibrated on several robots: each has a folder of
// its own, the second ends in -2: a session that is in the folder, of another sensor or captured with one of `other_robots`, is
// passed over. The folder may not be there yet.
std::filesystem::path session_folder(const std::filesystem::path& project_file, const MethodId& method,
                                     const SensorId& sensor, const std::vector<std::string>& other_robots);

}  // namespace seamwright
