#pragma once
// Teaching on the part as it stands: the reference of a spot, and the pass entry -> exit that shows whether
// the contour stands still. The robot makes the same moves as in a run; nothing is written to it.

#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "core/alignment/alignment.h"
#include "projects/measure/measure.h"
#include "projects/model/evidence.h"
#include "projects/model/run.h"
#include "projects/station/station.h"

namespace seamwright {

// A place to go to and stand still at, and how often to measure there: 0 on the way.
struct Standing {
    Pose base_from_flange = Pose::Identity();
    int measurements = 1;
};

// Goes to one after the other and measures `spot` (its recipe and sensor; it need not be in the project), with
// `visit` after each measurement, whatever became of it; `progress` counts the places. Error: not connected, a
// device, cancelled.
Expected<void> measure_standing(Station& station, const Spot& spot, std::span<const Standing> stands,
                                const std::stop_token& cancel,
                                const std::function<void(const RunProgress&)>& progress,
                                const std::function<void(std::size_t stand, const SpotMeasurer& measurer,
                                                         const SpotMeasurement& measurement)>& visit);

// Of the reference at every arrival.
inline constexpr int kTaughtAnArrival = 2;

struct TeachOptions {
    // Arrivals, 1 to 1000: each comes anew from the spot's entry, as in a run, so that the robot's scatter averages out of the
    // reference. Without a calibration, or an entry, the robot stands still all the time, which is one arrival.
    int repeats = 5;
    std::stop_token cancel;
    std::function<void(const RunProgress&)> progress;
};

// `spot` comes back with reference_mm (mean of the measurements, y = 0; ReferenceState::measured), reference_arrivals and reference_profile (that
// whose sigma is the middle one).
struct TaughtSpot {
    Spot spot;
    std::vector<SpotMeasurement> measurements;            // all, in order
    int left_out = 0;                                     // not found, or far from the others
    Eigen::Vector2d spread_mm = Eigen::Vector2d::Zero();  // standard deviation of x and z; 0 for a single one
    Profile mean;                                         // of what was not left out, for a template
};

// Goes to `draft` (its recipe, sensor and pose) `repeats` times and measures kTaughtAnArrival times each. Error: not connected, a
// device, cancelled, or taught_from()'s.
Expected<TaughtSpot> teach_spot(Station& station, const Spot& draft, const TeachOptions& options);

// What measurements of `draft` and their profiles (as many, filtered) make of it, kTaughtAnArrival an arrival and
// `arrivals` of them independent. Error: the feature was found, or agreed, in fewer than half of the measurements;
// the sentence carries the last reason.
Expected<TaughtSpot> taught_from(const Spot& draft, std::vector<SpotMeasurement> measurements,
                                 std::span<const Profile> profiles, int arrivals);

// `is`, the spot as the project has it by now, with what was measured of it: weights and limits may have been edited
// meanwhile, and the curve of an earlier pass was about the old reference. Error (input): it was changed so that what was
// measured does not hold for it.
Expected<Spot> with_taught(const Spot& is, const TaughtSpot& taught);

// Fewer points are no template.
inline constexpr std::size_t kTemplatePoints = 20;
// `spot`, of the kind template, with the piece of `profile` (filtered) inside the window, sensor frame (x, z), as its
// template; until told otherwise its landmark is the contour's point in the middle of the piece. Error (input): fewer
// than kTemplatePoints points are in the window.
Expected<Spot> with_template(const Spot& spot, const Profile& profile, const Eigen::AlignedBox2d& window);

// Whether what was measured with `a` holds for `b`: sensor, robot, feature, and the pose within a micrometre
// and 0.0001 degree (what a pose loses on its way through a text).
bool measured_alike(const Spot& a, const Spot& b);

// `after` without the reference profile and the curve of `before` when they were measured otherwise.
Spot with_reference_of(const Spot& before, Spot after);

struct PassOptions {
    double step_mm = 2.0;  // travel between two profiles; the ends are the spot's entry and exit
    std::stop_token cancel;
    std::function<void(const RunProgress&)> progress;
};

struct RecordedPass {
    std::vector<TravelProfile> profiles;  // filtered, in the sensor frame of their own pose, travel ascending
    std::vector<TravelPoint> references;  // where the spot's feature was found
};

// The robot stops at every step, so that travel is exact; the run itself triggers in motion.
Expected<RecordedPass> record_pass(Station& station, const Spot& spot, const PassOptions& options);

// As a spot's pass is judged: jitter, travel and the point whose drift counts are the spot's.
AlignmentOptions alignment_options(const Spot& spot);

struct JudgedPass {
    Spot spot;  // as it was when it was passed
    RecordedPass pass;
    AlignmentOptions options;
    AlignmentResult result;
    std::optional<ContourCurve>
        curve;  // of the spot's feature over the travel; nothing: found in too few profiles
    bool acceptable() const { return curve && result.status == AlignmentStatus::frozen; }
};
// Error (input): no profile was seen, or check_alignment()'s.
Expected<JudgedPass> judge_pass(const Spot& spot, RecordedPass pass, const AlignmentOptions& options);
// `is`, the spot as the project has it by now, with the pass accepted: curve and jitter. Beside it belongs the evidence,
// frozen_contour(). Error (input): not acceptable, or the spot was changed since it was passed.
Expected<Spot> with_pass(const Spot& is, const JudgedPass& judged);

// `spot` turned about its reference point by the rotation that cures the drift; reference profile and curve
// are gone with the pose that they were about.
Spot cured(const Spot& spot, const AlignmentResult& result, const Pose& flange_from_sensor);

// What the file keeps of an accepted pass: the verdict with what it was judged by, and the usable offsets.
FrozenContour frozen_contour(const std::string& spot_id, const AlignmentResult& result,
                             const AlignmentOptions& options);

}  // namespace seamwright
