#include "app/cli/program_files.h"

#include "devices/exchange/files.h"

namespace seamwright::cli {

Expected<void> write_program_files(const std::filesystem::path& folder, const std::vector<ProgramFile>& files,
                                   Answer& answer) {
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed) return file_error(Text("the folder cannot be made: {}", failed.message()), folder.string());
    answer.json["files"] = nlohmann::json::array();
    for (const ProgramFile& f : files) {
        const auto path = folder / f.name;
        SEAM_OK(write_text_file(path, f.text));
        answer.json["files"].push_back(path.string());
        answer.text += path.string() + "\n";
    }
    return {};
}

}  // namespace seamwright::cli
