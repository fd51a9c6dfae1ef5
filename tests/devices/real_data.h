#pragma once
// The camera frames and poses of real cells, where they are.

#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace seamwright {

// ../shared/data, or SEAMWRIGHT_DATA; empty when it is not there.
inline std::filesystem::path real_data() {
    const char* set = std::getenv("SEAMWRIGHT_DATA");
    const std::filesystem::path folder = set ? set : SEAMWRIGHT_DATA_FOLDER;
    std::error_code ignored;
    return std::filesystem::is_directory(folder, ignored) ? folder : std::filesystem::path();
}

}  // namespace seamwright
