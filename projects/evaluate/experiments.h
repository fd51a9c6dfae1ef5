#pragma once
// The thesis's five experiments (chapter 5.2, methods.md 7) on the procedural door, what each source of error
// adds, and how far from the bound of the sensor's noise the method ends on straight contours.
//
// One region of all 12 spots. Experiments: 1 standard, triggered in motion, contour end on the unfiltered
// profile; 2 the same standing still; 3 as 1 with filter, template matching and the learnt contour curve; 4
// sensors turned about their Z by `misalignment_deg`, in motion; 5 the same standing still.
//
// Each runs over displacements -10..10 mm (step 0.5), -1..1 degree (step 0.05) and both, along and about X, Y
// and Z of the work object, turned about the door's middle: 3 x 41 a column. A deviation is D_found p -
// D_true p of a spot's landmark, its three components pooled, as the thesis does.

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/statistics.h"
#include "projects/evaluate/cell.h"
#include "projects/evaluate/curves.h"
#include "projects/evaluate/online.h"

namespace seamwright::evaluation {

// One displacement of one column.
struct EvaluationTrial {
    double displacement = 0;  // mm or degree
    bool ok = false;
    double mean_abs_mm = 0;             // mean length of the deviations at the spots
    std::vector<double> deviations_mm;  // 3 per spot
    double nees = 0;
    double stated_variance_mm2 =
        0;  // of a deviation's coordinate by the stated covariance, mean over the spots
};

// Deviation of the translation column against the displacement d along one axis: a + b d, every coordinate of
// every spot its own a and b.
struct Growth {
    char axis = 'X';             // where it grows most
    double slope_mm_per_mm = 0;  // rms of b over the coordinates
    double linear_share = 0;     // of the variance about a that b d explains
    double bend_share = 0;       // that d^2 and d^3 explain on top
    bool grows() const { return slope_mm_per_mm > 0.01; }
    bool linear() const { return linear_share > 0.8 && bend_share < 0.05 * linear_share; }
};

struct ExperimentResult {
    Method method;
    std::array<std::vector<EvaluationTrial>, 3> trials;  // translation, rotation, both
    std::array<Summary, 3> summary;
    // 3 sigma of a deviation's coordinate as the stated covariances have it, rms over the trials.
    std::array<double, 3> stated_three_sigma{};
    std::array<int, 3> refused{};  // trials without a correction
    double sigma_mm = 0;           // of a measured coordinate, rms over the spots, from the teaching's spread
    double nees = 0;               // mean over the trials of the table
    int spots = 0, flagged = 0;    // spots that the frozen-contour check calls drifting beforehand
    double worst_yaw_deg = 0;
    Growth growth;
};

// Experiment 3's way on straight contours, where its model holds.
struct StraightTrials {
    int trials = 0;
    // Part in its place, sensor noise alone: rms displacement of the spots, Cramer-Rao and reached.
    // Efficiency = bound^2 / found^2; of a single spot's landmark beside it, mean over spots, x and z.
    double bound_mm = 0, found_mm = 0, efficiency = 0, landmark_efficiency = 0;
    double efficiency_one_sigma = 0;  // had every spot stated one sigma for x and z
    // Random displacements of +-10 mm and +-1 degree about and along every axis, with the robot's
    // repeatability, and with the trigger's jitter too.
    double nees_still = 0, nees_in_motion = 0;
    double three_sigma_mm = 0;  // in motion, deviations as in the table
    int refused = 0;
};

struct BudgetLine {
    std::string name;
    double three_sigma_mm = 0;  // of experiment 3's "both" column with this source alone
    double stated_mm = 0;       // 3 sigma as the covariances of these trials state it
    double adds_mm = 0;         // above what noise-free measures of the same door leave
};

struct EvaluationResult {
    EvaluationSettings settings;
    std::vector<ExperimentResult> experiments;
    // With experiment 3 only.
    StraightTrials straight;
    std::vector<BudgetLine> budget;
    std::vector<CurvedContour> curved;
    std::optional<OnlineExperiment> online;
    double seconds = 0;
    std::size_t profiles = 0;
};

// Size of the budget's sources that an experiment itself is free of.
inline constexpr double kBudgetBendMm = 0.3, kBudgetCalibrationMm = 0.1, kBudgetCalibrationDeg = 0.1;

// Deterministic for a seed, whatever the number of jobs, and of parts that are collected; of a part alone only what stands in
// settings.parts is of use. Error: a spot cannot be taught.
Expected<EvaluationResult> evaluate(const EvaluationSettings& settings,
                                    const std::function<void(const std::string&)>& progress);

Expected<StraightTrials> straight_trials(const EvaluationSettings& settings,
                                         std::atomic<std::size_t>& profiles);

}  // namespace seamwright::evaluation
