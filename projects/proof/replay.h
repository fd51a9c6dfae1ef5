#pragma once
// Stored runs computed again from their raw data, with the setup they were made with, through the code of the
// run, and compared with what was stored, bit for bit.

#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "projects/batch/parts.h"
#include "projects/file/project_file.h"

namespace seamwright {

struct ReplayOptions {
    std::int64_t run = 0;  // 0 = all
    int jobs = 1;          // threads; the outcome does not depend on it
    Portion portion;       // of the runs, by their place among all
    std::stop_token cancel;
    std::function<void(int done, int total)> progress;  // runs; called on one thread at a time
};

struct ReplayDifference {
    std::int64_t run = 0;
    Text what;           // "spot S3", "region left"
    Text text;           // "measured x 10.25 -> 10.26 mm"
    double size_mm = 0;  // of the difference where it is a length, else 0
};

struct ReplayResult {
    int runs = 0;
    std::int64_t captures = 0;                  // frames computed again
    std::vector<ReplayDifference> differences;  // by run, then by position; empty = everything reproduced
    bool cancelled = false;
};

// Each thread reads the file through its own connection.
Expected<ReplayResult> replay(const std::filesystem::path& file, const ReplayOptions& options);

// Spots and regions of one run again; captures, numbers and pushes are taken over.
Expected<RunRecord> recompute(const RunRecord& stored, const Project& setup);
std::vector<ReplayDifference> compare(const RunRecord& stored, const RunRecord& again);

}  // namespace seamwright
