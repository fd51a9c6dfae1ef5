#pragma once
// What a panel job (panel_job.h) makes of its frames: frame -> profile, two of a double head -> one, then
// gap and flush with the points of panel and body that they lie between; all places -> the gripper's motion.
// Pure functions of the captures: a run and its replay call the same.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "projects/model/project.h"
#include "projects/model/run.h"

namespace seamwright {

// The place's frame on the gripper; nothing when a sensor of it is unknown or has no calibration.
std::optional<Pose> gripper_from_place(const Project& project, const PanelPlace& place);

// A place made ready; keeps copies of what it needs. One thread at a time.
class PanelMeasurer {
  public:
    // Refuses an unknown sensor, one without calibration (where it stands on the gripper is not known), and
    // a gauge that is none.
    static Expected<PanelMeasurer> make(const Project& project, const PanelJob& job, const PanelPlace& place);
    PanelMeasurer(PanelMeasurer&&) noexcept;
    PanelMeasurer& operator=(PanelMeasurer&&) noexcept;
    ~PanelMeasurer();

    // `second`: of the double head, nullptr with a single one. `reported`: where the gripper stood. The
    // captures are left in capture(0) and capture(1).
    PanelMeasurement measure(const Frame& first, const Frame* second, const std::optional<Pose>& reported);
    // From stored captures; same code, same bits.
    PanelMeasurement measure(const Capture& first, const Capture* second);

    const PanelPlace& place() const;
    int heads() const;  // 1 or 2
    const Capture& capture(int head) const;
    const Profile& profile() const;               // merged, of the last measurement; the place's frame
    const Profile& head_profile(int head) const;  // of one head in it, that head's own frame
    double surface_deg() const;                   // of the body's surface there, as the gauge found it

  private:
    struct Impl;
    explicit PanelMeasurer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

// The motion from the measured places. No spot is left out: what does not fit stays as residual ("best fit")
// and is judged by the job's tolerances. Error: fewer places than a motion needs, or fit_panel's.
Expected<PanelFit> fit_places(const Project& project, const PanelJob& job,
                              std::span<const PanelMeasurement> measurements);

// Why the best fit is not good enough, one sentence a place; empty when gap and flush will lie in tolerance.
std::vector<Text> beyond_tolerance(const PanelJob& job, const PanelFit& fit);
// The same of what was measured after the motion.
std::vector<Text> beyond_tolerance(const PanelJob& job, std::span<const PanelMeasurement> measured);
PanelVerdict judge_panel(const PanelJob& job, std::span<const PanelMeasurement> after);

// Where the gripper goes: base_from_gripper * G.
Pose moved_gripper(const Pose& base_from_gripper, const PanelFit& fit);
// The motion as a displacement D of the gripper's taught pose T, T D = base_from_gripper G, so that the frame
// T D T^-1 base_from_frame (corrected_frame) takes the taught pose to where the gripper must go, wherever it
// measured. Covariance, sigma and status are the fit's, in T's frame.
RegionCorrection motion_as_correction(const PanelJob& job, const Pose& base_from_gripper,
                                      const PanelFit& fit);

// The poses and the frame of a record by its servo's motion; `servo` is there.
void place_servo(const PanelJob& job, PanelRecord& record);

// Servoing beside the single step from the same first measurement: gap and flush against taught, rms over all values, mm.
struct ServoComparison {
    int moves = 0;
    double before_rms_mm = 0, after_rms_mm = 0;  // as measured; NaN where it was not
    double single_rms_mm = 0;                    // as the single step foresees it; NaN without a fit
    double apart_mm = 0, apart_deg = 0;          // of the two motions; NaN without a fit
};
ServoComparison compare_servo(const PanelRecord& record);

// Fit, poses and frame of a record from its `before`, verdict from `after`; what replay computes again.
// Of a run that servoed the poses are those of its motion.
void compute_panel(const Project& project, const PanelJob& job, PanelRecord& record);

}  // namespace seamwright
