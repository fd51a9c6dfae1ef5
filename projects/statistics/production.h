#pragma once
// The runs of production in one or several project files. What was measured to prove something is not of it: unmoved
// parts and known shifts (by their evidence and the names of their parts), parts of a study of the measuring process.
// Cancelled and interrupted runs are none either. All of them are counted.

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "projects/file/project_file.h"
#include "projects/proof/path_direction.h"

namespace seamwright {

struct ProductionRun {
    std::size_t file = 0;  // in Production::files
    double day = 0;        // of its start, since 1970
    RunValues values;
};
struct ProductionFile {
    std::filesystem::path path;                                          // of a fleet: the station's name
    Project project;                                                     // as it stands
    std::map<std::string, std::vector<PathDirection>> path_points = {};  // by region
};
struct Production {
    std::vector<ProductionFile> files;
    std::vector<ProductionRun> runs;  // in the order of time
    int proofs = 0, studies = 0, unfinished = 0;
    std::size_t setups = 0;  // different ones, over all files
};

enum class RunPurpose { production, proof, study };

// What the runs of one file were made for, by its evidence.
class RunPurposes {
  public:
    explicit RunPurposes(const std::vector<Evidence>& evidence);
    RunPurpose of(const RunValues& run) const;

  private:
    std::set<std::int64_t> proofs_;
    std::set<std::string> rehung_;
    std::vector<StudyPlan> plans_;
};

std::map<std::string, std::vector<PathDirection>> path_points_of(const Project& project);

// Error (file): one that cannot be read; (input): the same file twice.
Expected<Production> production_of(const std::vector<std::filesystem::path>& files,
                                   const RunValuesWanted& wanted);

// A time as a person gives it, "2024-05-01", "2024-05-01T06:00", "2024-05-01T06:00:00Z" (local time unless it ends in
// Z), or an age, "90min", "8h", "7d", before `now_utc`; answered as utc_now() writes it. Error (usage).
Expected<std::string> time_argument(const std::string& text, const std::string& option,
                                    const std::string& now_utc);
// "30s", "90min", "8h", "7d". Error (usage): another form, below a second, beyond a year.
Expected<std::int64_t> seconds_argument(const std::string& text, const std::string& option);
// As utc_now() writes it.
std::string utc_text(std::int64_t seconds_since_1970);
// Milliseconds since 1970 of what utc_now() wrote.
std::optional<std::int64_t> utc_milliseconds(const std::string& utc);

}  // namespace seamwright
