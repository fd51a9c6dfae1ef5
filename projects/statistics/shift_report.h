#pragma once
// The statistics of a shift, written while the cell runs: FOLDER/<project file>_<start, local time>.html and .json as
// soon as the shift is over. Shifts follow each other from `first_s` after local midnight on. What ended while nobody
// ran is made up for when the reports begin: the last shift's, where it had parts and there is none yet.
// A reader's own connection on a thread of its own: the watching neither waits for it nor fails with it.

#include <filesystem>
#include <functional>
#include <thread>

#include "projects/statistics/statistics.h"

namespace seamwright {

struct ShiftReportOptions {
    std::filesystem::path file, folder;
    std::int64_t every_s = 8 * 3600;  // 1 s to a year
    std::int64_t first_s = 0;         // 0 to 86399
    Language language = Language::english;
    std::string program;
    StatisticsOptions statistics;                               // without a time
    std::function<void(const std::filesystem::path&)> written;  // on the reports' thread
    std::function<void(const Error&)> failed;
};

// A shift in seconds since 1970, and where it ends.
struct Shift {
    std::int64_t from_s = 0, until_s = 0;
};
// The one that holds `at_s`; `local_s` is what local time is ahead of UTC.
Shift shift_at(std::int64_t at_s, std::int64_t local_s, const ShiftReportOptions& options);

// Both files, all or nothing each; answers the page. Error: (file).
Expected<std::filesystem::path> write_shift_report(const Shift& shift, const ShiftReportOptions& options);
std::filesystem::path shift_report_path(const Shift& shift, const ShiftReportOptions& options);

// Reports until it goes.
class ShiftReports {
  public:
    explicit ShiftReports(ShiftReportOptions options);

  private:
    void run(const std::stop_token& stop);
    ShiftReportOptions options_;
    std::jthread thread_;
};

}  // namespace seamwright
