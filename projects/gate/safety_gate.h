#pragma once
// What stands between a number and a robot.
//
// pass_gate() is a pure function on values: the same request has the same answer in the plant, in a replay
// and in a test. Only it can make a GatePass, and only push_region() (push.h) writes to a robot and wants one, so
// nothing reaches a controller that was not judged. A pass holds the frame to write, computed by the gate
// itself from the taught frame and the displacement, and is good for one push.
//
// Judged are the numbers (every one finite, covariances symmetric and not indefinite, limits that are some),
// what they were made with (spots, part, times, calibrations with their age, identities), the robot's mode,
// and the jump: the frame that the controller holds now must be within the region's limits of the taught one,
// by the measure of the displacement itself, D_now = workobject_from_base now taught^-1 base_from_workobject.
// So must the frame to write; a taught frame in another unit or of another robot ends here. The limits bind what moves: no
// spot moves farther than a shift and a turn within them move it about a point of the part (the limit in mm, and that in
// degrees over the largest distance of two spots), wherever the work object's origin lies.

#include <optional>
#include <string>
#include <vector>

#include "core/text.h"
#include "devices/profile_source.h"
#include "devices/robot_link.h"
#include "projects/model/project.h"
#include "projects/model/run.h"

namespace seamwright {

// The frame that carries the taught path onto the displaced part. D = workobject_from_movedworkobject is
// expressed in the work object, the frame in base: a path point q of the frame lies on the part at p =
// base_from_workobject^-1 base_from_frame q; after the motion that part point is at base_from_workobject D p.
// Hence
//     corrected = base_from_workobject * D * base_from_workobject^-1 * base_from_frame.
Pose corrected_frame(const Pose& base_from_workobject, const Displacement& displacement,
                     const Pose& base_from_frame);

// What the gate knows about one spot of the region.
struct GateSpot {
    std::string id;
    bool required = true;
    bool measured = false;
    std::string part_id;                                            // of the measurement
    std::int64_t measured_at_ns = 0;                                // steady clock
    Eigen::Vector3d point_workobject_mm = Eigen::Vector3d::Zero();  // its reference: where sigma is judged
    std::string calibration_id;                                     // empty = none
    Verdict calibration_verdict = Verdict::undetermined;
    std::string calibrated_utc;
    std::string collided_utc;  // when its robot collided last; empty: never. An older calibration is refused
    SensorIdentity sensor, calibrated_sensor;  // as connected; as calibrated
    RobotIdentity robot, calibrated_robot;
    // One from the drawing refuses the region, measured or not: where the part's contour is nobody has seen yet.
    ReferenceState reference = ReferenceState::measured;
};

struct GateRequest {
    Region region;
    RegionCorrection correction;
    std::vector<GateSpot> spots;  // those of region.spot_ids
    Pose base_from_workobject = Pose::Identity();
    std::string part_id;                  // the part that stands there
    std::int64_t part_since_ns = 0;       // since when, steady clock; what was measured before is stale
    std::int64_t now_ns = 0;              // steady clock; a measurement from later is as wrong as a stale one
    RobotMode mode = RobotMode::unknown;  // as read from the controller
    bool tells_mode = true;               // RobotLink::tells_mode()
    // unknown = any but stopped and fault; and but unknown, unless the robot cannot tell its mode.
    RobotMode required_mode = RobotMode::unknown;
    std::string now_utc;                // wall clock, as utc_now()
    double calibration_age_days = 365;  // an older calibration is refused (Requirements)
    // Of the bead by its nozzle, one standard deviation; joins sigma at the path. 0: no nozzle is calibrated.
    double nozzle_sigma_mm = 0;
    Text nozzle_trouble;                    // why the nozzle's calibration does not hold; the gate refuses
    std::vector<std::string> other_frames;  // that the project's other regions and panel jobs write
    // What the controller holds under region.frame_name now. Absent: nothing is to be pushed, and the pass
    // is good for none; or it could not be read, then `frame_trouble` says why and the gate refuses.
    std::optional<Pose> base_from_frame_now;
    Text frame_trouble;
    // Those of other part types that are pushed into the same frame of this robot: the part before may have been
    // theirs, so the frame that stands there is judged by theirs too, within their own limits. One whose limits are
    // none (limits_that_are_none()) counts for nothing.
    std::vector<Region> frame_of_other_types = {};
    Text drift_trouble =
        {};  // why the drift watch stops production: a step, a drift beyond what may be compensated
    Text project_trouble =
        {};  // what of the project was changed since it was loaded: what is judged with is old
};

// Limits beyond these are none.
inline constexpr double kMostTranslationMm = 1000, kMostRotationDeg = 45;
inline constexpr double kMostSigmaMm = 10, kMostSigmaDeg = 10;

class GatePass {
  public:
    GatePass(GatePass&& other) noexcept;
    GatePass& operator=(GatePass&&) = delete;
    const std::string& region_id() const { return region_id_; }
    const std::string& frame_name() const { return frame_name_; }
    const Pose& base_from_frame() const { return base_from_frame_; }
    // As judged; absent: the pass of a dry run, which writes nothing.
    const std::optional<Pose>& base_from_frame_now() const { return base_from_frame_now_; }
    bool spent() const { return spent_; }  // moved from, or used

  private:
    friend struct GateKeeper;
    GatePass() = default;
    std::string region_id_, frame_name_;
    Pose base_from_frame_ = Pose::Identity();
    std::optional<Pose> base_from_frame_now_;
    bool spent_ = false;
};

// Controllers do not tell upper from lower case. An empty name is no frame.
bool same_frame(const std::string& a, const std::string& b);

// Limits of a region that limit nothing, one sentence each: not above 0, not finite, or beyond the ones
// above.
std::vector<Text> limits_that_are_none(const Region& region);

struct GateVerdict {
    std::optional<GatePass> pass;
    std::vector<Text> reasons;  // every reason, not the first; empty exactly when there is a pass
};
GateVerdict pass_gate(const GateRequest& request);

}  // namespace seamwright
