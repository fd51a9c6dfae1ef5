#pragma once
// What the drift watch says now: a pure function of the project, the stored points and the time.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "projects/model/project.h"
#include "projects/model/run.h"

namespace seamwright {

inline constexpr std::size_t kDriftKept = 400;  // points that a judgement looks back over at most

struct DriftStanding {
    bool watched = false;  // the project has a watch; all else is empty without
    DriftVerdict verdict = DriftVerdict::learning;
    Text text;                     // one sentence
    bool stopped = false;          // by a step that nobody has acknowledged
    std::int64_t stopped_by = 0;   // point
    int points = 0;                // that count: of this mark, not set aside
    std::string last_utc;          // of the last one
    std::int64_t parts_since = 0;  // runs since
    double minutes_since = 0;
    bool due = false, old = false;  // over its interval; over twice
    std::vector<double> level_mm,
        level_sigma_mm;  // off the learnt place, by direction (LearntDrift::directions)
    std::vector<DriftRule> rules;
    DriftChange change = DriftChange::none;
    ActingDrift acting;  // for the next run
    Text trouble;        // for the gate: why nothing may be pushed; empty: it may
};

// The newest of `points` judged against those before: what DriftPoint::verdict, step and text become. A point of another mark
// than the learnt one is `learning`.
void judge_point(const Project& project, std::span<const DriftPoint> points, DriftPoint& newest);

// `points` as the file has them, oldest first. `parts_since`: runs after the last of them.
DriftStanding drift_standing(const Project& project, std::span<const DriftPoint> points,
                             const std::string& now_utc, std::int64_t parts_since);

// How the watch's shift follows from its levels: weighted least squares of the one translation, in the sensor frame or in
// base, that explains all directions; what no direction shows stays 0. `probability` that what is left is noise: below 0.001
// the references contradict each other, and it is no such drift.
struct DriftShift {
    Eigen::Vector3d shift_mm = Eigen::Vector3d::Zero();
    double sigma_mm = 0;  // worst direction that is shown
    double probability = 1;
};
Expected<DriftShift> drift_shift(const Project& project, const DriftWatch& watch,
                                 std::span<const double> level_mm, std::span<const double> sigma_mm);

// Of a direction: "X of W1".
std::string name_of(const LearntDirection& direction);

}  // namespace seamwright
