#pragma once
// The hand-over report of a project: what stands in the cell, how it was calibrated, what was taught, what
// was proven and how well, what it lets through, what happened; with lines to sign. One page of blocks, made
// into HTML by report::Page or into PDF by widgets/print.

#include <string>
#include <vector>

#include "core/text.h"
#include "projects/file/project_file.h"
#include "projects/proof/checklist.h"
#include "projects/report/html.h"

namespace seamwright {

struct HandOverOptions {
    Language language = Language::english;
    std::string now_utc;             // ISO 8601; empty = the clock's
    std::string program;             // "Seamwright 0.1.0"
    std::size_t newest_events = 60;  // of the event log
};

// `project` is the document as it stands (the file's, or the studio's unsaved one). Error: the file cannot be
// read.
Expected<report::Page> hand_over_report(const ProjectFile& file, const Project& project, const Facts& facts,
                                        const HandOverOptions& options);

}  // namespace seamwright
