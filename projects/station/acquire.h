#pragma once
// From a robot's trigger to the sensor's frame: one way for runs, teaching and passes.

#include <chrono>
#include <deque>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "devices/profile_source.h"
#include "devices/robot_link.h"
#include "projects/model/project.h"

namespace seamwright {

// The robot fires the sensor by a wire (setting "hardware_trigger"): one exposure a spot, in the robot's order.
bool hardware_triggered(const SensorSetup& sensor);

struct AcquireLimits {
    std::chrono::milliseconds trigger_timeout{20000};  // robot: from one spot to the next
    std::chrono::milliseconds frame_timeout{3000};     // sensor: from trigger to frame
};

// Via points -> entry -> trigger -> exit, the pass along the sensor's Y with the orientation held.
MeasuringMove measuring_move(const Spot& spot, const Pose& flange_from_sensor);

// A region's number in the programs of a robot: its place, from 1, among the regions with spots of that robot. Disabled spots
// count, so that no number changes with them. 0: it has none.
int region_number(const Project& project, const std::string& region_id, const std::string& robot_id);

// The measuring program of a robot: its enabled spots in the project's order. A spot without calibration is
// passed with the flange's Y as its sensor's.
std::vector<MeasuringMove> measuring_program(const Project& project, const std::string& robot_id);

// Waiting in slices, so that `cancel` is heard within kCancelSlice whatever the time-out. Cancelled = Error
// whose `what` is kCancelled.
inline constexpr std::chrono::milliseconds kCancelSlice{200};
inline constexpr const char* kCancelled = "cancelled";
Expected<FramePtr> next_frame(ProfileSource& sensor, std::chrono::milliseconds timeout,
                              const std::stop_token& cancel);
Expected<TriggerEvent> next_trigger(RobotLink& robot, std::chrono::milliseconds timeout,
                                    const std::stop_token& cancel);

// Which frame belongs to which trigger, for one sensor during one run.
//
// A sensor that knows the spot says so in its frame; frames of other spots (a free-running sensor may still
// hold some of before) are dropped and told. A sensor wired to the robot (setting "hardware_trigger") knows
// only the order: the k-th trigger has the k-th frame, by the sequence number, so that a frame lost on the
// way leaves its own spot without measurement and not all the later ones with the wrong one. What the numbers
// cannot tell (the camera missed a trigger, or exposed without one) the times and the count do: a first frame that came
// kPairingWindow before or after its trigger, a later one whose time after its trigger is kPairingDrift off the median
// of those before, by the sensor's clock and by ours (arrivals are late where a machine is busy; without a clock of the
// sensor's: kPairingWindow again), or a frame left over at the end, make the run fail.
inline constexpr std::chrono::milliseconds kPairingWindow{1000}, kPairingDrift{400};
class TriggeredFrames {
  public:
    // `sensor` and `setup` must outlive it.
    TriggeredFrames(ProfileSource& sensor, const SensorSetup& setup) : sensor_(sensor), setup_(setup) {}
    // The frame of this trigger; one with status `incomplete` when it was lost. A sensor that is not wired to
    // the robot is triggered here.
    Expected<FramePtr> at(const TriggerEvent& trigger, std::chrono::milliseconds timeout,
                          const std::stop_token& cancel,
                          const std::function<void(const Frame& dropped)>& dropped);
    // After the last trigger: Error when the sensor has exposed more often than the robot fired. Waits as long as the last
    // trigger's own frame may still be on its way, had it been given an earlier one.
    // A frame that by the sensor's clock was exposed when the robot fired for the spot before or after is one, too: a pulse
    // that was missed and one that came twice leave as many frames as triggers.
    Expected<void> finish();
    // After an Error of at() or finish() that says that frames and triggers may belong together otherwise.
    bool in_doubt() const { return in_doubt_; }

  private:
    Expected<FramePtr> in_order(const TriggerEvent& trigger, std::chrono::milliseconds timeout,
                                const std::stop_token& cancel);
    bool is_far(const Frame& frame, const TriggerEvent& trigger) const;
    // A late or damaged frame that was told as lost when its turn was over; a sound one is never passed over.
    bool is_over(const Frame& frame) const {
        return frame.status != FrameStatus::ok && expected_ && frame.sequence < *expected_;
    }
    ProfileSource& sensor_;
    const SensorSetup& setup_;
    FramePtr early_;  // came already, belongs to a later trigger
    std::optional<std::uint64_t> expected_;
    // finish(): whether a frame was exposed when the robot fired for another spot.
    Expected<void> own_triggers() const;
    // Of sound frames: their time less that of their trigger. The clocks need not have the same beginning.
    std::vector<std::int64_t> device_after_ns_, host_after_ns_;
    std::vector<std::int64_t> trigger_ns_;
    std::vector<std::string> spots_;
    bool in_doubt_ = false;
    std::int64_t last_trigger_ns_ = 0, longest_ns_ = 0;
};

// Whether the robot can have fired for this spot: far from where it was taught it stands elsewhere, or says what is not
// so, whatever the part's place. Error (device). A robot that does not say where it stands is believed.
inline constexpr double kFarFromSpotMm = 300, kFarFromSpotDeg = 30;
Expected<void> fired_near(const TriggerEvent& trigger, const Spot& spot);

// For teaching: goes to `base_from_flange`. A robot that the program cannot move is jogged there by hand, and
// must stand there, within half a millimetre and a tenth of a degree. Returns where it says that it stands.
Expected<Pose> stand_at(RobotLink& robot, const std::string& spot_id, const Pose& base_from_flange);

// For teaching and calibrating: a sensor that is wired to the robot (parameter "trigger") listens to software
// triggers while this lives, then to its own source again. Does nothing with other sensors. Error: the sensor
// does not take it.
class SoftwareTriggered {
  public:
    static Expected<SoftwareTriggered> begin(ProfileSource& sensor);
    SoftwareTriggered(SoftwareTriggered&& other) noexcept;
    SoftwareTriggered& operator=(SoftwareTriggered&&) = delete;
    ~SoftwareTriggered();

  private:
    SoftwareTriggered() = default;
    ProfileSource* sensor_ = nullptr;  // to be set back
    double before_ = 0;
};

// Stops every started sensor, however the work ends; a sensor that keeps its start waiting is given up when
// `cancel` is asked for.
class StartedSensors {
  public:
    StartedSensors() = default;
    StartedSensors(const StartedSensors&) = delete;
    StartedSensors& operator=(const StartedSensors&) = delete;
    ~StartedSensors();
    Expected<void> start(ProfileSource& sensor, const std::stop_token& cancel = {});

  private:
    std::vector<ProfileSource*> started_;
    std::deque<std::stop_callback<std::function<void()>>> watches_;  // go first
};

}  // namespace seamwright
