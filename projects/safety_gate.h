#pragma once
// What stands between a number and a robot.
//
// pass_gate() is a pure function on values: the same request has the same answer in the plant, in a replay
// and in a test. Only it can make a GatePass, and only push_region() writes to a robot and wants one, so
// nothing reaches a controller that was not judged. A pass holds the frame to write, computed by the gate
// itself from the taught frame and the displacement, and is good for one push.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "devices/profile_source.h"
#include "devices/robot_link.h"
#include "projects/project.h"
#include "projects/run.h"

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
    std::string calibration_verdict;
    SensorIdentity sensor, calibrated_sensor;  // as connected; as calibrated
    RobotIdentity robot, calibrated_robot;
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
    RobotMode required_mode = RobotMode::unknown;  // unknown = any but stopped and fault
};

class GatePass {
  public:
    GatePass(GatePass&& other) noexcept;
    GatePass& operator=(GatePass&&) = delete;
    const std::string& region_id() const { return region_id_; }
    const std::string& frame_name() const { return frame_name_; }
    const Pose& base_from_frame() const { return base_from_frame_; }
    bool spent() const { return spent_; }  // moved from, or used

  private:
    friend struct GateKeeper;
    GatePass() = default;
    std::string region_id_, frame_name_;
    Pose base_from_frame_ = Pose::Identity();
    bool spent_ = false;
};

struct GateVerdict {
    std::optional<GatePass> pass;
    std::vector<std::string> reasons;  // every reason, not the first; empty exactly when there is a pass
};
GateVerdict pass_gate(const GateRequest& request);

// What a controller may change in the last digits of a frame between writing and reading.
inline constexpr double kReadBackToleranceMm = 1e-3;
inline constexpr double kReadBackToleranceDeg = 1e-4;

// Records an event durably; an Error means that it is not recorded.
using EventSink =
    std::function<Expected<void>(EventKind kind, const std::string& subject, const std::string& text)>;

// Reads the old frame, records the attempt, writes, reads back and compares. If anything after the first byte
// sent goes wrong, that is an alarm: the old frame is written again and read back. Nothing is sent when the
// old frame cannot be read or the attempt cannot be recorded.
PushRecord push_region(GatePass&& pass, RobotLink& robot, const EventSink& record);

// Takes back a push that was written (precondition): a part is corrected with all its regions or with none.
// The old frame is written and read back, an alarm recorded, `push` brought up to date.
void withdraw_push(PushRecord& push, RobotLink& robot, const EventSink& record);

}  // namespace seamwright
