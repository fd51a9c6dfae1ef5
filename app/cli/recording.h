#pragma once
// Captures on the command line: what records, and what tells of a recording.

#include <memory>

#include "app/cli/command.h"
#include "devices/capture/recorder.h"

namespace seamwright::cli {

// nullptr where `file` is empty.
Expected<std::shared_ptr<Recorder>> open_recorder(const std::string& file, const RecorderOptions& options);

// Finishes the recording, if there is one, and adds "recording" to the answer. Error: the disk failed; what
// was committed before is in the file.
Expected<void> tell_recording(Recorder* recorder, const std::string& file, Answer& answer);

Expected<Answer> capture_info(const std::string& file);
// 0 sound, 3 damaged.
Expected<Answer> capture_check(const std::string& file);

}  // namespace seamwright::cli
