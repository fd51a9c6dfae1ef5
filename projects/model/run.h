#pragma once
// What one measuring run leaves behind: the captures as the sensors delivered them, what was measured in
// them, the corrections, what the safety gate said, what was written to the robot. Value types; stored by
// project_file.h, made by station.h, computed again by replay.h.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/correction/correction.h"
#include "core/features/feature.h"
#include "core/panel/panel_fit.h"
#include "core/panel/servoing.h"
#include "core/profile/profile.h"
#include "core/profile/stripe/stripe_light.h"
#include "core/text.h"
#include "core/value_type.h"
#include "devices/capture/capture.h"
#include "projects/model/drift_watch.h"
#include "projects/model/elastic_modes.h"

namespace seamwright {

enum class SpotStatus {
    measured,        // the feature was found; only this one enters a correction
    not_measured,    // no frame came: sensor silent, robot error, run cancelled
    damaged_frame,   // a frame came, but not whole; it is never measured
    no_stripe,       // no usable profile in the frame
    no_calibration,  // an image without a sensor model, or the sensor has no calibration
    no_feature       // feature.status says why
};
std::string_view to_string(SpotStatus status);

struct SpotMeasurement {
    SEAM_VALUE_TYPE(SpotMeasurement);
    std::string spot_id;
    SpotStatus status = SpotStatus::not_measured;
    Text message;                                           // empty when measured, else why, in plain words
    Feature feature;                                        // sensor frame at the pose of the exposure
    Eigen::Vector3d measured_mm = Eigen::Vector3d::Zero();  // in the taught sensor frame, see measure.h
    double sigma_mm = 0;             // of an observed coordinate: spot's own and the feature's
    bool pose_reported = false;      // false: taught pose taken
    std::string part_id;             // the part it was measured on
    std::int64_t host_time_ns = 0;   // of the frame, steady clock
    int capture = -1;                // index in RunRecord::captures, -1 = none
    std::optional<SeenLight> light;  // of a spot with settings of its own
};

enum class PushStatus {
    not_pushed,  // dry run, or the gate refused
    written,     // written, read back, equal
    failed,      // nothing was written: the old frame could not be read or the attempt could not be recorded
    restored,    // alarm: write or read-back failed; the old frame stands on the controller again (read back,
                 // equal)
    not_restored  // alarm: and the old frame could not be put back either
};
std::string_view to_string(PushStatus status);

// What became of a robot's permission to run its application in the frames of a run.
enum class Release {
    none,       // never given
    given,      // the frames stand and are recorded; that the robot was told, and what became of it, is not
    taken,      // the application runs, or ran, in the frames
    not_taken,  // the application did not begin in time: the robot was told so, the old frames stand again
    withdrawn   // the same after a failure, by the user, or by the robot itself
};
std::string_view to_string(Release release);
std::optional<Release> release_from(std::string_view name);

struct PushRecord {
    PushStatus status = PushStatus::not_pushed;
    std::string frame_name;
    std::string robot_id;  // that holds the frame
    Release release = Release::none;
    std::optional<Pose> before, read_back;
    Text message;
};

// The kept offset that acted on a region's correction (KeptOffset): it is in the correction already.
struct ActingOffset {
    int version = 0;
    Eigen::Vector3d offset_mm = Eigen::Vector3d::Zero();  // taken off, work object
};

Text said_of(const ActingOffset& offset);  // "kept offset 2 acts: X 0.100 ... mm are taken off"

struct RegionRecord {
    SEAM_VALUE_TYPE(RegionRecord);
    std::string region_id;
    std::optional<RegionCorrection>
        correction;  // absent when too little was measured to solve; `refusals` says so
    Pose base_from_frame = Pose::Identity();  // the frame that carries the path onto the displaced part
    bool gate_passed = false;
    std::vector<Text> refusals;  // why the gate refuses, in words; empty when passed
    PushRecord push;
    std::optional<ActingOffset> offset;
    std::optional<ActingModes> modes;  // where they were switched on
    std::optional<ActingDrift> drift;  // of a project with a drift watch
};

// One place of a panel job (panel_job.h), in the place's frame.
struct PanelMeasurement {
    SEAM_VALUE_TYPE(PanelMeasurement);
    std::string place_id;
    SpotStatus status = SpotStatus::not_measured;
    Text message;  // empty when measured
    Eigen::Vector3d panel_mm = Eigen::Vector3d::Zero(), body_mm = Eigen::Vector3d::Zero();
    double sigma_mm = 0;              // of an observed coordinate
    double gap_mm = 0, flush_mm = 0;  // by the gauge
    Eigen::Matrix2d gap_flush_covariance = Eigen::Matrix2d::Zero();
    // Double heads: see core/panel/double_head.h. 0 with a single head.
    double head_disagreement_mm = 0, head_offset_mm = 0, head_overlap_mm = 0;
    std::string part_id;
    std::int64_t host_time_ns = 0;          // of the later frame, steady clock
    int capture = -1, second_capture = -1;  // in RunRecord::captures
};

enum class PanelVerdict {
    not_verified,  // nothing was moved, or what stands there afterwards could not be measured
    in_tolerance,  // gap and flush after the motion lie within the job's tolerance of the taught ones
    out_of_tolerance
};
std::string_view to_string(PanelVerdict verdict);

// Servoing (core/panel/servoing.h) in place of the single step: the motion in several moves.
struct PanelServoMove {
    Pose motion =
        Pose::Identity();  // base_from_gripper of the first measurement to where it stood, its own frame
    double rms_mm = 0;     // of gap and flush against taught, measured there
};
struct PanelServo {
    ServoingStatus status = ServoingStatus::not_converged;
    std::vector<PanelServoMove> moves;  // the first one is where it was measured first, moved by nothing
    Pose motion = Pose::Identity();     // of all moves
};

struct PanelRecord {
    SEAM_VALUE_TYPE(PanelRecord);
    std::string job_id;
    std::vector<PanelMeasurement> before, after;  // enabled places; `after` the motion, empty without one
    std::optional<PanelFit> fit;  // of `before`; absent when it could not be solved, `refusals` says so
    // Where the gripper stood when it measured, where it goes, and the frame that takes it there.
    Pose base_from_gripper = Pose::Identity(), base_from_moved_gripper = Pose::Identity();
    Pose base_from_frame = Pose::Identity();
    bool gate_passed = false;
    std::vector<Text> refusals;
    PushRecord push;
    PanelVerdict verdict = PanelVerdict::not_verified;
    // Of a run that servoed: where the gripper goes is its motion, and `fit` the single step beside it.
    std::optional<PanelServo> servo;
};

enum class EventKind { note, refusal, push_attempt, push, alarm, device };
std::string_view to_string(EventKind kind);
std::optional<EventKind> event_kind_from(std::string_view name);

struct EventRecord {
    std::int64_t id = 0;   // given by the file
    std::string utc;       // ISO 8601 with milliseconds, "2024-05-01T12:00:00.000Z"
    std::int64_t run = 0;  // 0 = outside any run
    EventKind kind = EventKind::note;
    std::string subject;  // region, frame, sensor, robot
    Text text;
    std::string person = {};  // who was signed in, as the file's chain says; empty: nobody
};

enum class RunStatus {
    interrupted,  // the program ended while measuring (no spots and regions; the captures until then), or
                  // between judging and the last push; the events tell how far it came
    pushed,       // every region written, read back and recorded, the robots were allowed to run or about to
                  // be; what became of that is not recorded: the program ended, or still waits for it
    ok,           // every region solved and passed the gate (and, in a push run, written and read back, and
                  // the application runs in the frames)
    refused,      // at least one region refused by the gate or not solvable
    not_taken,    // pushed, but the application did not begin in the frames: they were taken back
    alarm,        // a push went wrong
    device,       // a sensor or robot failed; nothing was pushed
    cancelled     // by the user; nothing was pushed
};
std::string_view to_string(RunStatus status);
std::optional<RunStatus> run_status_from(std::string_view name);

struct RunRecord {
    SEAM_VALUE_TYPE(RunRecord);
    std::int64_t number = 0;  // given by the file, 1..
    std::string part_id;
    std::string type_id;  // of the part; empty: of a project without types
    std::string started_utc, finished_utc;
    bool push = false;  // false = dry run
    RunStatus status = RunStatus::ok;
    Text message;                        // one sentence
    std::vector<SpotMeasurement> spots;  // enabled spots, in the order of the project
    std::vector<RegionRecord> regions;
    std::optional<PanelRecord> panel;  // of a panel job's run, which has no spots and regions
    std::vector<Capture> captures;
    std::vector<EventRecord> events;
};
// What the drift watch said of it and took off: one for all regions. It follows from the runs before, so it is taken from the
// record and never computed again. nullptr: no watch, or no region.
const ActingDrift* acting_drift(const RunRecord& run);

}  // namespace seamwright
