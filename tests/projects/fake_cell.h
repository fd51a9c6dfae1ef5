#pragma once
// A cell small enough to be exact: at every spot the part is a half plane whose edge runs along the taught
// sensor's Y and ends at the reference point. The displaced half plane is cut with the laser plane of where
// the sensor really stands.

#include <algorithm>
#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <set>
#include <thread>

#include "devices/capture/capture.h"
#include "devices/registry.h"
#include "devices/silence.h"
#include "projects/model/project.h"

namespace seamwright {

struct FakeCell {
    FakeCell();
    ~FakeCell();

    Project project;
    Pose workobject_from_movedworkobject = Pose::Identity();
    double noise_mm = 0;
    std::mt19937 rng{11};

    // What the robot reports and where it stands, per spot; absent = taught.
    std::map<std::string, Pose> reported, actual;

    // Faults.
    std::vector<Text> notices;  // the robot link tells them once
    std::string silent_sensor_at, silent_robot_at, damaged_at, empty_at, wrong_spot_at;
    bool dead_sensor = false;  // cannot be started
    bool gone_sensor = false;  // the same, and says so when it is asked
    SensorIdentity sensor_identity{"fake", "Seamwright", "S1", "0001"};
    RobotIdentity robot_identity{"fake", "KUKA", "KR", "0002"};
    RobotMode mode = RobotMode::external;
    std::string write_spoils, write_fails;  // frame names
    std::map<std::string, Pose> frames;
    // What reading answers instead from the verdict on: the controller kept another one than it had shown.
    std::map<std::string, Pose> frames_after_verdict;
    bool frames_unread_after_verdict = false;
    int writes = 0;
    std::vector<PartVerdict> verdicts;         // as confirmed
    std::optional<PartVerdict> deaf_to;        // does not acknowledge this one
    Permission permission = Permission::none;  // as the controller would tell it
    bool application = true;                   // begins as soon as it may
    bool deaf_but_obeys = false;               // the verdict arrives, its acknowledgement does not
    std::function<void()> on_permission;       // before each look
    std::deque<Expected<StartSignal>> starts;  // what wait_start() answers in turn; then silence
    std::function<void(const std::string& spot)> on_trigger;
    std::function<void()> on_refused;

    Profile cut(const Spot& spot);
};

class FakeSensor : public ProfileSource {
  public:
    explicit FakeSensor(FakeCell& cell) : cell_(cell) {}
    SensorIdentity identity() const override;
    Expected<void> start() override;
    void stop() override;
    Expected<void> trigger(const std::string& spot_id) override;
    Expected<FramePtr> wait_next(std::chrono::milliseconds) override;
    FramePtr latest() const override;
    SourceCounters counters() const override;
    Expected<void> answers() override;
    std::vector<ParameterInfo> parameters() const override { return {}; }
    Expected<double> get(const std::string&) const override;
    Expected<void> set(const std::string&, double) override;
    bool started = false;

  private:
    FakeCell& cell_;
    std::string waiting_;
    std::uint64_t sequence_ = 0;
    bool wrong_sent_ = false;
};

class FakeRobot : public RobotLink {
  public:
    explicit FakeRobot(FakeCell& cell) : cell_(cell) {}
    Expected<RobotIdentity> identity() override;
    Expected<RobotMode> mode() override;
    std::vector<Text> take_notices() override { return std::exchange(cell_.notices, {}); }
    Expected<Pose> base_from_flange() override;
    Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) override;
    Expected<TriggerEvent> wait_trigger(std::chrono::milliseconds) override;
    Expected<Pose> read_frame(const std::string& name) override;
    Expected<void> write_frame(const std::string& name, const Pose& pose) override;

    Expected<StartSignal> wait_start(std::chrono::milliseconds timeout) override;
    Expected<void> confirm(PartVerdict verdict, const std::string&) override;
    Expected<Permission> permission() override;

  private:
    FakeCell& cell_;
    std::vector<MeasuringMove> moves_;
    std::size_t next_ = 0;
    std::set<std::string> written_;
};

// Six spots round a part of about a metre, edges in all directions; two regions.
std::unique_ptr<FakeCell> make_fake_cell(int spots = 6);

}  // namespace seamwright
