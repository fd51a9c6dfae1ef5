#include "app/cli/program_files.h"

#include "devices/registry.h"

namespace seamwright::cli {

Expected<void> write_program_files(const std::filesystem::path& folder, const std::vector<ProgramFile>& files,
                                   Answer& answer) {
    SEAM_TRY(const auto written, seamwright::write_program_files(folder, files));
    answer.json["files"] = nlohmann::json::array();
    for (const auto& path : written) {
        answer.json["files"].push_back(path.string());
        answer.text += path.string() + "\n";
    }
    return {};
}

}  // namespace seamwright::cli
