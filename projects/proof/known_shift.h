#pragma once
// The known-shift proof (thesis 5.2; methods.md 7): the part is displaced by amounts that are known, measured
// each time, and what was found is compared with what was done. This is the accuracy of this project on this
// cell, before the first real part.
//
// Displacements. A grid along and about X, Y and Z of the work object: translation alone, rotation alone, and
// both in proportion; rotations turn about the middle of the spots. Deviation of a spot's reference point p:
//     D_found p - D_true p,     three components, pooled over spots and displacements as the thesis does.
//
// How the part is displaced:
//   simulated_part  the simulated cell moves its part; sensors and robots must be of driver "simulated".
//   robot_moves     the robot does what it would do in a base shifted by S = B D^-1 B^-1 (B: base from work
//                   object), which is the same to the sensor; poses it reports are carried back by S^-1. For
//                   robots that take their measuring moves from here.
//   by_hand         a person sets the controller's base to be shifted by S, or moves the part by D on a
//                   measured stand; asked before each. For controllers that hold their own program.

#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "core/evaluation/statistics.h"
#include "projects/model/evidence.h"
#include "projects/proof/zero_shift.h"
#include "projects/station/station.h"

namespace seamwright {

inline constexpr const char* kKnownShiftPrefix = "known shift ";  // parts of its runs: "known shift X +5 mm"
// Parts of the proofs' runs, also of those that no evidence names: of a proof that was cancelled.
inline bool is_part_of_proof(std::string_view part_id) {
    return part_id.starts_with(kZeroShiftPrefix) || part_id.starts_with(kKnownShiftPrefix);
}

struct ShiftGrid {
    double range_mm = 10, step_mm = 2.5;    // -range .. range; 0 itself is the zero shift
    double range_deg = 1, step_deg = 0.25;  // steps of `both` follow the translation
};
// Error (usage): a range or step that is not positive and finite, a step above its range, more than 2000
// tests.
Expected<std::vector<ShiftTest>> shift_tests(const Project& project, const ShiftGrid& grid);

// "X +5 mm", "Z -0.5 deg", "Y +5 mm and +0.5 deg".
std::string shift_name(const ShiftTest& test, const KnownShift& proof);

struct KnownShiftOptions {
    ShiftBy by = ShiftBy::simulated_part;
    ShiftGrid grid;
    std::string part_type;  // of the part (RunOptions::part_type); the evidence is that type's
    std::stop_token cancel;
    std::function<void(const RunProgress&)> progress;    // tests
    std::function<void(const RunRecord& run)> measured;  // after each run
    // by_hand: makes the displacement come true, S in base as above; false = cancelled. Called on the running
    // thread.
    std::function<bool(const ShiftTest& test, const Pose& base_from_shiftedbase)> place;
};

// The regions' limits of displacement do not count here: they are set by what is proven. Opens the project's
// devices for itself and connects the station anew afterwards where it was connected.
// Nothing is written to the robot. Runs are in the file as always, the outcome as evidence when this returns.
// Error: devices that do not go with `by`, a device failure, cancelled (the runs made until then stay, the
// evidence does not come about), no region.
Expected<KnownShift> prove_known_shift(Station& station, const KnownShiftOptions& options);

// What a run found of a displacement that is known.
std::vector<ShiftOutcome> judge_shift(const Project& setup, const RunRecord& run,
                                      const Pose& workobject_from_movedworkobject);

// A line of the table of chapter 5. 3 sigma is about the mean, as there; about_truth counts the mean as error
// too: 3 rms.
struct ShiftStatistic {
    std::string region_id;  // empty = all
    ShiftKind kind = ShiftKind::translation;
    int tests = 0, refused = 0;
    Summary summary;
    double about_truth_mm = 0;
};
// Each region and each kind that was tested, then all regions together when there are several.
std::vector<ShiftStatistic> statistics(const KnownShift& proof);

// Of a region over all kinds (empty = all regions).
struct ProvenAccuracy {
    int tests = 0, refused = 0;
    double three_sigma_mm = 0;  // about the truth: 3 rms
    double worst_mm = 0;        // largest component
};
ProvenAccuracy proven_accuracy(const KnownShift& proof, const std::string& region_id);

// The largest displacement recovered everywhere, as the gate's limits measure it: translation of D (mm) and
// angle (degree).
struct ProvenRange {
    double translation_mm = 0, rotation_deg = 0;
};
ProvenRange proven_range(const KnownShift& proof);
// The same as limits of a region can be set to it: rounded down to 0.01 mm and 0.001 degree.
CorrectionLimits proven_limits(const KnownShift& proof);

}  // namespace seamwright
