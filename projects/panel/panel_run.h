#pragma once
// A run of a panel job on the station's devices, step by step: what the single step (panel_station.cpp) and servoing
// (panel_servo.cpp) have in common. The inside of both, not for others.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "projects/gate/push.h"
#include "projects/gate/safety_gate.h"
#include "projects/panel/panel_measure.h"
#include "projects/panel/panel_station.h"
#include "projects/station/run_release.h"

namespace seamwright::panel_running {

// How far a controller may report itself off the corrected position when it fires there.
inline constexpr double kArrivedMm = 1, kArrivedDeg = 0.1;

std::vector<std::string> sensors_of(const PanelPlace& place);  // one or, of a double head, two

// The places of a job with their devices, all connected.
struct Places {
    std::vector<PanelMeasurer> measurers;  // enabled ones
    std::map<std::string, ProfileSource*> sensors;
    RobotLink* robot = nullptr;
};

// Error: a device that is not connected, a sensor at two places, a place without a reference, none enabled.
Expected<Places> prepare(Station& station, const PanelJob& job);

// The single step; a run in several moves judges and moves otherwise (panel_servo.cpp). `station`, `job`, `places` and
// `options` outlive it. run_ is stored by begin(), store_or_tell() and end(), in that order.
class PanelRun {
  public:
    virtual ~PanelRun() = default;
    PanelRun(const PanelRun&) = delete;
    PanelRun& operator=(const PanelRun&) = delete;
    PanelRun(Station& station, const PanelJob& job, Places& places, const RunOptions& options)
        : station_(station), job_(job), places_(places), options_(options) {}

    Expected<RunRecord> run();

  protected:
    Expected<void> begin();
    Expected<void> store_or_tell();
    void tell_not_moved();
    Expected<RunRecord> end();

    PanelRecord& panel() { return *run_.panel; }
    bool cancelled() const { return cancel_.stop_requested(); }
    void progress(int done, Text text) const;
    // Before the judged run is stored events go with it, afterwards each by itself.
    Expected<void> event(EventKind kind, const std::string& subject, const Text& text);

    // One firing of the robot's program, all sensors there.
    Expected<void> measure(const Pose& base_from_gripper, std::vector<PanelMeasurement>& into,
                           Pose& stands_at);
    void keep(PanelMeasurer& measurer, const std::vector<FramePtr>& frames,
              const std::optional<Pose>& reported, PanelMeasurement& into);

    // Of the measurements that the correction rests on.
    GateRequest gate_request(RegionCorrection correction, const std::vector<PanelMeasurement>& measured);

    // What of the measurement may be moved; refusals say why nothing.
    virtual std::optional<GatePass> judge();
    std::optional<GatePass> measure_and_judge();
    Expected<void> store_judged();
    Expected<void> store_outcome();
    std::map<std::string, RobotLink*> link() const { return {{job_.robot_id, places_.robot}}; }
    EventSink sink();

    // A person's word, then the gate again: meanwhile the robot's mode may have changed.
    bool confirmed(std::optional<GatePass>& pass);

    bool tell(PartVerdict verdict) { return tell(verdict, run_.message); }
    bool tell(PartVerdict verdict, const Text& text);

    // What was written goes back, the robot is told first: nothing runs in a frame that changes.
    void take_back_motion(RunStatus status, Text message);

    // Durable before the robot may move in the frame.
    bool record_pushed(const char* message);

    // From the first write to the end nothing is cancelled: the panel is in place as a whole or its frame is
    // taken back.
    void move_and_verify(GatePass pass);

    // Where the frame has taken the gripper, into `after`.
    Expected<void> measure_moved();
    void judge_moved_and_release();

    Station& station_;
    const PanelJob& job_;
    Places& places_;
    const RunOptions& options_;
    std::stop_token cancel_ = options_.cancel;
    RunRecord run_;
    std::int64_t since_ns_ = 0;
    bool judged_ = false;
    int starts_ = 0;  // of the robot's program
    StoredMeasurements stored_;
};

}  // namespace seamwright::panel_running
