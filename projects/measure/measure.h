#pragma once
// The data's way, one function per arrow: frame -> peaks -> candidates -> tracked profile -> feature ->
// measurement
// -> observation. Each is usable alone; SpotMeasurer strings them together with buffers that are allocated
// once.
//
// Where the measured point goes. A spot was taught with the flange at base_from_flange; while the robot
// moves, or repeats badly, the controller reports a slightly different pose at the trigger. The point m = (x,
// 0, z) seen from the reported pose B' is carried into the taught sensor frame:
//     m' = (B * F)^-1 * (B' * F) * m,      B = taught, B' = reported base_from_flange, F =
//     flange_from_sensor,
// so that the correction sees the part's motion and not the robot's. m' has a small y: the cut was made
// there, which the spot's contour curve can use; with weight 0 along Y it changes nothing else. Jitter that
// the controller does not report stays in the measurement; Spot::sigma_mm holds what it does to the contour
// as taught.

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "projects/model/project.h"
#include "projects/model/run.h"

namespace seamwright {

// Frame -> capture (raw): peaks and candidates of an image, or the finished profile as it came. A damaged
// frame keeps only its status. Buffers of `capture` and `peaks` are reused. `model` may be null for finished
// profiles. Returns the reason when the frame holds nothing to measure.
SpotStatus capture_frame(const Frame& frame, const PeakOptions& peak_options, const SensorModel* model,
                         StripePeaks& peaks, Capture& capture, Text& message);

// Capture -> tracked, filtered profile. Error: the filter's.
Expected<void> track_capture(const Capture& capture, const FilterOptions& options, Profile& profile);

// m' of above.
Eigen::Vector3d in_taught_sensor(const Eigen::Vector2d& point_mm, const Pose& flange_from_sensor,
                                 const Pose& base_from_flange_taught,
                                 const std::optional<Pose>& base_from_flange_reported);

// The correction's input of a measured spot. W = base_from_workobject^-1 * base_from_flange *
// flange_from_sensor. Where x and z weigh the same the feature's whole covariance counts: the end of a
// contour is unsure along it, and well known across.
SpotObservation observation(const Spot& spot, const Pose& base_from_workobject,
                            const Pose& flange_from_sensor, const SpotMeasurement& measurement);

// The plan's input of a region: each of its enabled spots standing at its reference, with the noise that its
// feature has in the reference profile, and all that repeats (correction.h): its sensor, the reference's
// covariance as its feature states it in the reference profile, one arrival of its robot. Spots without
// calibration are left out, as they are in a run.
std::vector<SpotObservation> planned_observations(const Project& project, const Region& region);

// Half the window in which a spot's trigger may come (add_travel() of core/correction/travel.h): the contour
// stands still over it as taught, not as displaced. 0 where the robot stops.
double travel_window_mm(const Spot& spot);

// The calibration in use at a sensor, at a spot's sensor; nullptr when there is none.
const Calibration* calibration_of(const Project& project, const std::string& sensor_id);
const Calibration* calibration_of(const Project& project, const Spot& spot);
const PanelJob* find_panel_job(const Project& project, const std::string& id);
const SensorSetup* find_sensor(const Project& project, const std::string& id);
const RobotSetup* find_robot(const Project& project, const std::string& id);
const Spot* find_spot(const Project& project, const std::string& id);

// A spot made ready. Where an image shows a second contour beside the stripe, the spot's reference profile tells which is
// the stripe (TaughtStripe); where it cannot, the spot is not measured. Keeps copies of what it needs from the project. One
// thread at a time; no allocation after the first profile of a size (a longer profile than ever before grows the buffers
// once).
class SpotMeasurer {
  public:
    // Refuses an unknown spot or sensor and a recipe its kind refuses. A missing calibration is no error
    // here: images are then not measured (SpotStatus::no_calibration), finished profiles give their feature
    // in the sensor frame, which no correction uses.
    static Expected<SpotMeasurer> make(const Project& project, const std::string& spot_id);
    SpotMeasurer(SpotMeasurer&&) noexcept;
    SpotMeasurer& operator=(SpotMeasurer&&) noexcept;
    ~SpotMeasurer();

    // The whole way. The reference stays valid until the next call. `reported` (the trigger event's pose) is
    // preferred to the frame's own.
    const SpotMeasurement& measure(const Frame& frame, const std::optional<Pose>& reported = std::nullopt);
    // Several exposures of a scene and a robot that stood still, merged into one stripe (merge_exposures()); `light`: of each
    // frame, exposure times gain. Images alone, all of one size. The pose and the times are the first frame's.
    const SpotMeasurement& measure(std::span<const FramePtr> exposures, std::span<const double> light,
                                   const std::optional<Pose>& reported = std::nullopt);
    // From a stored capture: from the image where it was kept, else from candidates or profile. Same code,
    // same bits.
    const SpotMeasurement& measure(const Capture& capture);

    const Spot& spot() const;
    const Capture& capture() const;    // of the last frame
    const Profile& profile() const;    // tracked profile of the last measurement
    const StripePeaks& peaks() const;  // of the last image

  private:
    struct Impl;
    explicit SpotMeasurer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

// What correction and plan of a region are asked for: its free degrees and limits; a direction that the
// region's sigma limits would refuse anyway by far is not observed at all. What its sensors err by is the
// covariance of their calibrations' flange_from_sensor, turned into the sensor, scale and shear as the calibration states
// them, and its robot's latency and change of speed; the path's work object is the part's. `drift`: of a run, the standing
// of a watch that takes nothing off.
CorrectionOptions correction_options(const Project& project, const Region& region,
                                     const ActingDrift* drift = nullptr);
// Of a part to come: with what the drift watch lets pass. It is uniform within the watch's limit; where it compensates, a
// point's own sigma is left. Without a watch that has learnt, nothing is stated.
CorrectionOptions planned_options(const Project& project, const Region& region);

// A region's correction from what its spots say. Solved twice: where the part lies tells how far the contour of
// each spot moves in the laser plane while the trigger jitters over Spot::jitter_mm (uniform, half width;
// travel.h), and that is part of the covariance of the measured point. A spot with stop_at_trigger does not
// jitter. Keeps its memory from part to part. The project must outlive it.
class RegionCorrector {
  public:
    RegionCorrector(const Project& project, const Region& region, const ActingDrift* drift = nullptr);
    RegionCorrector(const Project& project, CorrectionOptions options);
    // `observations` are left with the travel's covariance in them.
    Expected<void> correct(std::vector<SpotObservation>& observations, RegionCorrection& correction);

  private:
    const Project* project_;
    CorrectionOptions options_, roughly_;
    RegionSolver solver_;
};

// What the measured, enabled and calibrated spots of a region say; without the travel, which RegionCorrector adds.
// Spots without a calibration are counted.
std::vector<SpotObservation> region_observations(const Project& project, const Region& region,
                                                 std::span<const SpotMeasurement> measurements,
                                                 int* uncalibrated = nullptr);

// Corrections of all regions from the measurements of a part: pure, the same for a run and for its replay.
// What repeats is stated as in planned_observations().
// Spots that are not measured are left out; a region without any, or whose solver refuses the input, has no
// correction and says why in `refusals`. Where a region's modes are switched on, RegionRecord::modes says
// whether they act; the frame stays rigid, a path is bent (path.h). A kept offset that acts is taken off, and said in RegionRecord::offset.
// `drift`: what the drift watch says of the run, and takes off the measurements of its sensor or robot where it compensates
// (without_drift()); in every record then.
std::vector<RegionRecord> correct_regions(const Project& project,
                                          std::span<const SpotMeasurement> measurements,
                                          const ActingDrift* drift = nullptr);

// The measurements with what is compensated taken off: sensor frame, or base turned into each spot's sensor frame. As they
// are where nothing is.
std::vector<SpotMeasurement> without_drift(const Project& project,
                                           std::span<const SpotMeasurement> measurements,
                                           const ActingDrift* drift);

}  // namespace seamwright
