#pragma once
// A controller's files into a folder, as `robot-program` and `measure-trigger --program` write them.

#include <filesystem>
#include <vector>

#include "app/cli/command.h"
#include "devices/robot_program.h"

namespace seamwright::cli {

// Makes the folder; the paths become the answer's "files" and a line of its text each. Error (file).
Expected<void> write_program_files(const std::filesystem::path& folder, const std::vector<ProgramFile>& files,
                                   Answer& answer);

}  // namespace seamwright::cli
