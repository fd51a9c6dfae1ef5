#pragma once
// A study of the measuring process made run by run on the Station. What is asked for is a StudyPlan in the project's
// file; what was done is in the file's runs, by the names of their parts. So whatever stops it (cancelled, a device,
// a crash), the same options go on where it stopped, and no run is lost or made twice.
//
// Steps. Type 1, stability: the unmoved part (zero_shift.h), or a part of that name, `runs` times. Type 3,
// correlation: each part put in `rehangs` times and measured `runs` times each time, all parts one after the other
// before the next rehang. A run counts where the gate let the region's correction pass; one that it refused is kept,
// counted and said, and after kRefusedInARow of them the study stops. Runs made with another setup than the plan's
// are another process: a changed project begins the study anew.

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "projects/acceptance/study/studies.h"
#include "projects/station/station.h"

namespace seamwright {

inline constexpr int kRefusedInARow = 3;
inline constexpr int kMostStudyRuns = 1000, kMostStudyParts = 1000, kMostRehangs = 100;

struct LiveStudyOptions {
    Study study = Study::type1;
    std::string region;              // may be empty where the project has one
    std::vector<std::string> parts;  // of type 1 and stability none or one, of type 3 two or more
    int rehangs = 1, runs = 0;
    bool anew = false;  // do not go on with what was begun
    std::stop_token cancel;
    std::function<void(const RunProgress&)> progress;  // runs of all steps
    // Before the first run of a step of type 3; false: the part does not stand there, the study waits. Absent: parts
    // are changed without a word.
    std::function<bool(const std::string& part, int rehang)> place;
    std::function<void(const RunRecord&)> measured;  // after each run, which is in the file
};

struct StudyStep {
    std::string part;  // empty: the unmoved one
    int rehang = 1;
    int wanted = 0, made = 0, refused = 0;
    int missing() const { return wanted > made ? wanted - made : 0; }
};

struct StudyProgress {
    StudyPlan plan;
    std::int64_t setup = 0;  // that its runs are made with, see ProjectFile::setup_of
    std::vector<StudyStep> steps;
    bool resumed = false;  // runs of before count
    int other_setup = 0;   // runs of an unfinished plan that do not: the project was changed since
    Text stopped;          // why it is not complete; empty when it is
    int made() const, wanted() const, refused() const;
    bool complete() const { return made() >= wanted(); }
    const StudyStep* next() const;  // nullptr when complete
};

// What the newest plan asks for that these options would go on with, and what is done of it; none: not begun.
// Nothing is written. Error (usage, input): options that are none; (file).
Expected<std::optional<StudyProgress>> study_progress(const ProjectFile& file, const Project& project,
                                                      const LiveStudyOptions& options);

// Makes the runs that are missing. Error (usage, input): options that are none, a study that is not measured this
// way; (device): its sentence; (file). Cancelled, not placed, refused too often: StudyProgress::stopped.
Expected<StudyProgress> measure_study(Station& station, const LiveStudyOptions& options);

// The part and rehang of the runs of type 3 plans with rehangs, by the name that their runs carry.
struct RehungPart {
    std::string part, rehang;
};
std::map<std::string, RehungPart> rehung_parts(const std::vector<Evidence>& evidence);

}  // namespace seamwright
