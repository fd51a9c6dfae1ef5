#pragma once
// The simulated cell of the evaluation: spots on a part, taught (taught_from, fit_contour_curve) and measured
// (SpotMeasurer, correct_regions) by the functions of the Station, on profiles cut from the part's mesh with noise per
// point (devices/simulated/scene/profile_cut.h). Read-only once made; any number of threads.

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "devices/frame.h"
#include "devices/simulated/scene/mesh.h"
#include "devices/simulated/scene/random.h"
#include "devices/simulated/scene/renderer.h"
#include "projects/measure/measure.h"

namespace seamwright {
class Parts;
}

namespace seamwright::evaluation {

inline constexpr int kOnline = 6;  // the online correction, simulated (online.h)

struct EvaluationSettings {
    int experiment = 0;  // 1..5, kOnline, 0 = all
    int trials = 2000;   // of the efficiency and NEES trials
    std::uint64_t seed = 1;
    int jobs = 0;                    // threads; 0 = all cores
    double noise_mm = 0.03;          // of a point, in x and in z
    double repeatability_mm = 0.01;  // of the robot, one sigma per axis
    double jitter_mm = 3;            // half width, uniform, along the sensor's Y, not reported
    double misalignment_deg = 5;
    double bend_mm = 0;  // of the measured door against the taught one
    // Of every sensor's believed pose, one sigma per axis, the same when teaching and when measuring.
    double calibration_mm = 0, calibration_deg = 0;
    Parts* parts = nullptr;  // of several processes; none: all of it here
};

// How a spot is measured.
struct Method {
    int number = 3;  // of the thesis's experiment
    const char* name = "filter and template matching, in motion";
    bool matched = true;  // filter, template and learnt contour curve; else contour end on the raw profile
    bool in_motion = true;
    bool misaligned = false;
};

struct CellSpot {
    std::string id;
    Pose workobject_from_sensor = Pose::Identity();
};

struct Cell {
    EvaluationSettings settings;
    OpticsSettings optics;
    std::vector<CellSpot> spots;
    std::shared_ptr<MeshTree> taught, measured;
    std::vector<Pose> sensor_from_believed;  // calibration error, one a spot
    double stated_jitter_mm = 0;  // what correct() reckons with: the settings' unless said otherwise
    std::atomic<std::size_t>* profiles = nullptr;  // counts
};

// The procedural door, its 12 suggested spots, and the measured one bent by `bend_mm`.
Cell door_cell(const EvaluationSettings& settings, std::atomic<std::size_t>& profiles);
// The same 12 spots, each before a straight piece of the door's rim: the model of a straight, rigid contour
// holds here.
Cell straight_cell(const EvaluationSettings& settings, std::atomic<std::size_t>& profiles);
// Three spots on each side of a rectangle of 900 x 700 mm with its sides along X and Y, every contour a
// circle of `radius_mm`. Opposite sides bend the same way, so that their errors add up.
Cell curved_cell(const EvaluationSettings& settings, double radius_mm, std::atomic<std::size_t>& profiles);

struct TaughtSpot {
    Spot spot;
    Pose workobject_from_sensor = Pose::Identity();
    Eigen::Vector3d landmark = Eigen::Vector3d::Zero();  // work object
    double spread_mm = 0;                                // of a measure when teaching, rms of x and z
    Profile clean;                                       // of the undisplaced part, without noise
    bool flagged = false;                                // the frozen-contour check says "drifting"
    double yaw_deg = 0;                                  // as it found
};

// What teaching leaves, as the desk would keep it: work object = base, flange = sensor as believed, every spot with a
// sensor of its own, since the calibration errors are; one region of all spots.
struct TaughtCell {
    Project project;
    std::vector<TaughtSpot> spots;  // in the project's order
};
using Measurers = std::vector<SpotMeasurer>;

// Error: a spot's feature is not found.
Expected<TaughtCell> teach_all(const Cell& cell, const Method& method);
Measurers make_measurers(const TaughtCell& taught);

// Spot `n` measured on the measured part displaced by `truth`. `frame` is a buffer; the answer stays until the
// measurer's next.
const SpotMeasurement& measure_spot(const Cell& cell, const Method& method, const TaughtSpot& spot,
                                    std::size_t n, SpotMeasurer& measurer, const Pose& truth, Random& random,
                                    Frame& frame);
SpotObservation observation_of(const TaughtSpot& spot, const SpotMeasurement& measurement);

// The project's first region. None when refused.
std::optional<RegionCorrection> correct(const Project& project,
                                        std::span<const SpotMeasurement> measurements);

// Runs `work(i)` for all i < count on the cell's threads, each with a worker of its own; results lie where
// the index says, so that they do not depend on the number of threads.
void spread_out(int jobs, std::size_t count, const std::function<std::function<void(std::size_t)>()>& worker);

}  // namespace seamwright::evaluation
