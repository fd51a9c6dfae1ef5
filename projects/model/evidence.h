#pragma once
// What was proven on the cell, as it stays in the project's file: the contours that stood still, the unmoved
// part that read zero, the known shifts that were recovered, the run without a screen, the returns of a robot and
// the passes that told its trigger. Value types; made by zero_shift.h, known_shift.h, measure_robot.h,
// measure_trigger.h and the pass of a spot, judged by checklist.h, printed by hand_over.h.
//
// Evidence is never edited. It refers to the project as it was proven with (Evidence::setup), so that it is
// stale when what it rests on was changed, and it can be said what was.

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/acceptance/equipment/robot_study.h"
#include "core/acceptance/equipment/trigger_study.h"
#include "core/alignment/alignment.h"
#include "core/geometry/pose.h"
#include "core/text.h"

namespace seamwright {

// The accepted pass of a spot, see core/alignment/alignment.h.
struct FrozenContour {
    std::string spot_id;
    AlignmentStatus status = AlignmentStatus::not_enough_profiles;
    double yaw_deg = 0, pitch_deg = 0;
    double radius_mm = 0;  // infinity when straight
    double expected_error_mm = 0, tolerance_mm = 0, jitter_mm = 0;
    std::vector<TravelOffset> offsets;  // usable ones
};

// The unmoved part measured several times.
struct ZeroShiftRegion {
    std::string region_id;
    // x, y, z (mm), a, b, c (degree) of the displacement: mean and 3 sigma over the runs, and what the
    // correction states as its own 3 sigma.
    std::array<double, 6> mean{}, three_sigma{}, stated_three_sigma{};
    double worst_mean_mm = 0;  // longest mean deviation of a spot's reference point
};
struct ZeroShift {
    std::vector<std::int64_t> runs;
    int refused = 0;  // runs that did not end ok
    std::vector<ZeroShiftRegion> regions;
};

enum class ShiftBy {
    simulated_part,  // the simulated part moves
    robot_moves,     // the measuring moves are shifted the other way (a base shift done from here)
    by_hand          // a person shifts the controller's base, or the part
};
enum class ShiftKind { translation, rotation, both };  // the three columns of chapter 5.2

struct ShiftOutcome {
    std::string region_id;
    bool ok = false;         // a correction was found and the gate let it pass
    double mean_abs_mm = 0;  // mean length of the deviations at the region's spots
    // D_found p - D_true p of each spot's reference point p, work object, three components a spot.
    std::vector<double> deviations_mm;
    Text message;  // why not ok
};
struct ShiftTest {
    ShiftKind kind = ShiftKind::translation;
    int axis = 0;       // 0 X, 1 Y, 2 Z of the work object
    double amount = 0;  // signed mm; degree for rotation; mm for both, which turns in proportion
    Pose workobject_from_movedworkobject = Pose::Identity();
    std::int64_t run = 0;
    std::vector<ShiftOutcome> regions;
};
struct KnownShift {
    ShiftBy realised_by = ShiftBy::simulated_part;
    double range_mm = 0, range_deg = 0;
    std::vector<ShiftTest> tests;
};

// A run of `seamwright run` that ended ok.
struct HeadlessRun {
    std::int64_t run = 0;
    std::string part_id;
    bool push = false;
    std::string host;
};

// What a robot's repeatability follows from (robot_study()), and the covariance of arrivals that it replaced.
struct RobotReturns {
    std::string robot_id;
    std::vector<SpotReturns> spots;
    int not_found = 0;  // profiles without the feature, or far off those of the same return
    Matrix6 replaced_covariance = Matrix6::Zero();
};

// What latency and jitter of a trigger follow from (trigger_study()), and what they replaced.
struct TriggerPasses {
    std::string spot_id;
    double travel_deg = 0;                            // of the passes, from the sensor's Y towards its X
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();  // of (x, z) per mm of travel
    double slope_sigma = 0;
    std::vector<TriggerPass> passes;
    int not_found = 0;
    double replaced_latency_ms = 0;
    std::map<std::string, double> replaced_jitter_mm;  // by spot
};

// A study of the measuring process that is made run by run (projects/acceptance/study/live_study.h): what is asked for.
// What was done is in the runs, by the names of their parts; so it goes on where it stopped, whatever stopped it.
struct StudyPlan {
    std::string study;  // "type1", ...
    std::string region_id;
    std::vector<std::string> parts;  // names; none: the unmoved part
    int rehangs = 1;                 // times that each part is put in
    int runs = 0;                    // each time
    std::int64_t after_run = 0;      // runs of higher numbers are its own
};

struct Evidence {
    std::int64_t id = 0;     // given by the file
    std::string utc;         // ISO 8601; empty = when stored
    std::int64_t setup = 0;  // ProjectFile::load_setup
    std::variant<FrozenContour, ZeroShift, KnownShift, HeadlessRun, RobotReturns, TriggerPasses, StudyPlan>
        what;
};

// The runs that were measured for it: of a proof, not of production.
inline std::set<std::int64_t> proof_runs(const std::vector<Evidence>& all) {
    std::set<std::int64_t> runs;
    for (const Evidence& evidence : all) {
        if (const auto* zero = std::get_if<ZeroShift>(&evidence.what))
            runs.insert(zero->runs.begin(), zero->runs.end());
        if (const auto* known = std::get_if<KnownShift>(&evidence.what))
            for (const ShiftTest& test : known->tests) runs.insert(test.run);
    }
    return runs;
}

// The words of the kinds on disk.
inline constexpr std::string_view kFrozenContour = "frozen contour", kZeroShift = "zero shift",
                                  kKnownShift = "known shift", kHeadlessRun = "headless run",
                                  kRobotReturns = "robot returns", kTriggerPasses = "trigger passes",
                                  kStudyPlan = "study plan";
inline std::string_view kind_of(const Evidence& evidence) {
    constexpr std::array<std::string_view, 7> names{kFrozenContour, kZeroShift,     kKnownShift, kHeadlessRun,
                                                    kRobotReturns,  kTriggerPasses, kStudyPlan};
    return names[evidence.what.index()];
}

}  // namespace seamwright
