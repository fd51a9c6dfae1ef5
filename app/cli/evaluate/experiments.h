#pragma once
// The thesis's five experiments (chapter 5.2, methods.md 7) on the procedural door, and how far from the
// bound of the sensor's noise they end.
//
// Profiles are cut from the door's mesh with noise per point (devices/simulated/profile_cut.h) and measured
// by the functions of a run: filter_profile, the feature's finder, fit_contour_curve, solve_region. One
// region of all spots. Experiments: 1 standard, triggered in motion, contour end on the unfiltered profile; 2
// the same standing still; 3 as 1 with filter, template matching and the learnt contour curve; 4 sensors
// turned about their Z by `misalignment_deg`, in motion; 5 the same standing still.
//
// Each runs over displacements -10..10 mm (step 0.5), -1..1 degree (step 0.05) and both, along and about X, Y
// and Z of the work object, turned about the door's middle: 3 x 41 a column. A deviation is D_found p -
// D_true p of a spot's landmark, its three components pooled, as the thesis does.

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/evaluation/statistics.h"

namespace seamwright::cli {

struct EvaluationSettings {
    int experiment = 0;  // 1..5, 0 = all
    int trials = 2000;   // of the efficiency and NEES trials
    std::uint64_t seed = 1;
    int jobs = 0;                    // threads; 0 = all cores
    double noise_mm = 0.03;          // of a point, in x and in z
    double repeatability_mm = 0.01;  // of the robot, one sigma per axis
    double jitter_mm = 3;            // half width, uniform, along the sensor's Y, not reported
    double misalignment_deg = 5;
    double bend_mm = 0;  // of the measured door against the taught one
};

// One displacement of one column.
struct EvaluationTrial {
    double displacement = 0;  // mm or degree
    bool ok = false;
    double mean_abs_mm = 0;             // mean length of the deviations at the spots
    std::vector<double> deviations_mm;  // 3 per spot
    double nees = 0;
};

struct ExperimentResult {
    int number = 0;
    std::string name;
    std::array<std::vector<EvaluationTrial>, 3> trials;  // translation, rotation, both
    std::array<Summary, 3> summary;
    std::array<int, 3> refused{};  // trials without a correction
    double sigma_mm = 0;           // stated for a coordinate, rms over the spots, from the teaching's spread
    double nees = 0;               // mean over the trials of the table
    int spots = 0, flagged = 0;    // spots that the frozen-contour check calls drifting beforehand
    double worst_yaw_deg = 0;
    // Straight line through mean deviation against |displacement| of the translation column, along the axis
    // where it is steepest.
    char steepest = 'X';
    double slope_mm_per_mm = 0, linear_share = 0;  // and the share of variance that it explains
};

// Experiment 3's way with the door in its place: sensor noise alone, and with the robot's.
struct NoiseTrials {
    double bound_mm = 0, found_mm = 0;  // rms displacement of the spots: Cramer-Rao, and reached
    double efficiency = 0;              // bound^2 / found^2
    double nees = 0;                    // with the robot's repeatability
    int trials = 0;
};

struct BudgetLine {
    std::string name;
    double three_sigma_mm = 0;  // of experiment 3's "both" column with this source alone
};

struct EvaluationResult {
    EvaluationSettings settings;
    std::vector<ExperimentResult> experiments;
    NoiseTrials noise;  // with experiment 3 only
    std::vector<BudgetLine> budget;
    double seconds = 0;
    std::size_t profiles = 0;
};

// Deterministic for a seed, whatever the number of jobs. Error: a spot cannot be taught.
Expected<EvaluationResult> evaluate(const EvaluationSettings& settings,
                                    const std::function<void(const std::string&)>& progress);

}  // namespace seamwright::cli
