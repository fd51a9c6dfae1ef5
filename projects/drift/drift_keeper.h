#pragma once
// The drift watch beside a station: takes each run in, keeps its point in the file and says what it means for this run.

#include <optional>

#include "projects/drift/drift_standing.h"
#include "projects/file/project_file.h"

namespace seamwright {

struct DriftTaken {
    DriftStanding standing;
    std::optional<DriftPoint> point;  // this run made one; with its id
    bool stopped_now = false;         // by it
    bool worse = false;               // its verdict is worse than that of the point before
};

class DriftKeeper {
  public:
    // A run that has measured and is not judged yet. The point is in the file when this returns. The watch is the file's, not
    // `project`'s: a person may have acknowledged since. Error: the file.
    Expected<DriftTaken> take(ProjectFile& file, const Project& project, const RunRecord& run);
    // The next take() reads the file again: it was written by others, or is another.
    void forget() { loaded_ = false; }

  private:
    Expected<void> load(const ProjectFile& file, std::int64_t run);
    std::vector<DriftPoint> points_;  // the newest kDriftKept
    bool loaded_ = false;
    std::optional<double> last_s_;  // when the last run ended, or began where that is not known
    double session_s_ = 0, pause_s_ = -1;
    std::int64_t parts_since_ = 0;
};

// For who only looks: `file` read, `now_utc` the time.
Expected<DriftStanding> stored_standing(const ProjectFile& file, const Project& project,
                                        const std::string& now_utc);

// A time of the file's with its milliseconds. nullopt: none.
std::optional<double> exact_utc_seconds(const std::string& utc);

}  // namespace seamwright
