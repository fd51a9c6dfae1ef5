#pragma once
// Captures from a file as the command line takes it.

#include "projects/calibrate/session/capture.h"

namespace seamwright {

// With the file's own settings in place of `settings`. Error: no JSON of this method, an empty list, an entry or a setting that
// the method cannot read: nothing of such a file is taken.
Expected<ReadCaptures> read_capture_file(const CalibrationMethod& method, const nlohmann::json& settings,
                                         const std::filesystem::path& path);

// Those that are not yet in the list, nor twice among themselves; live ones are never the same.
struct NewCaptures {
    std::vector<CalibrationCapture> captures;
    std::size_t known = 0;  // left out
};
NewCaptures without_known(const SessionState& state, std::vector<CalibrationCapture> captures);

}  // namespace seamwright
