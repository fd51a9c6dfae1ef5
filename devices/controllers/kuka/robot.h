#pragma once
// The controller around the KRL machine: system variables, motions on the simulated arm in real time,
// outputs, timers, and the EthernetKRL functions.

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "devices/controllers/kuka/eki_channel.h"
#include "devices/controllers/kuka/krl/machine.h"
#include "devices/simulated/arm.h"
#include "devices/simulated/cell.h"

namespace seamwright::krl {

enum class ProgramState { free, active, stopped, ended };  // $PRO_STATE1

struct RobotSettings {
    double time_scale = 1;
    Timeout slow{300};
    int serial = 1;  // $KR_SERIALNO
    std::function<ControllerFault()> fault = [] { return ControllerFault::none; };
    std::function<void()> before_telegram = [] {};
    std::map<std::string, std::string> channels = {};  // XML by the channel's name in capitals
};

class KukaRobot final : public Host {
  public:
    KukaRobot(std::shared_ptr<SimulatedCell> cell, RobotSettings settings, const Pose& start,
              int trigger_output);
    ~KukaRobot() override;

    SimulatedArm& arm() { return arm_; }
    // The program that is selected and how it stands, as the operator has it.
    void select(const std::string& program);
    void set_state(ProgramState state) { state_ = state; }
    ProgramState state() const { return state_; }
    bool halted() const { return halted_; }
    void start_key() { halted_ = false; }
    void tick();  // ends pulses; to be called every few milliseconds
    std::vector<std::string> messages() const;

    std::optional<Value> system_value(Task& task, const Place& place) override;
    bool set_system(Task& task, const Place& place, const Value& value) override;
    std::optional<Value> call(Task& task, const std::string& name, std::vector<Argument>& arguments) override;
    void move(Task& task, Motion motion, const Value& target, bool approximates,
              std::vector<PathTrigger> triggers) override;
    void pulse(Task& task, const Place& output, bool level, double seconds) override;
    void wait_main_run(Task& task) override;
    void wait_seconds(Task& task, double seconds) override;
    void halt(Task& task) override;
    void told(const std::string& message) override;

  private:
    using Clock = std::chrono::steady_clock;
    struct Timer {
        double value_ms = 0;
        bool stopped = true;
        Clock::time_point since{};
    };
    struct Frames {  // $BASE and $TOOL, of the advance run or of the main run
        std::optional<Pose> base, tool;
        bool fixed_tool = false;  // $IPO_MODE #TCP
    };
    Value flag(int number) const;
    std::optional<Value> eki(Task& task, const std::string& name, std::vector<Argument>& arguments);
    EkiChannel& channel(const std::string& name);

    const std::shared_ptr<SimulatedCell> cell_;
    const RobotSettings settings_;
    std::atomic<ProgramState> state_ = ProgramState::free;
    std::atomic<bool> halted_ = false;
    mutable std::mutex mutex_;  // of what follows; never held while another lock is taken
    std::string program_;
    bool at_block_ = false;  // block coincidence: a motion was done since the selection
    Frames advance_, main_;
    std::optional<double> velocity_m_s_;
    double cdis_mm_ = 0;
    int advance_moves_ = 3;
    Pose planned_;  // flange at the end of the last motion that was handed to the arm
    std::map<int, bool> flags_, outputs_;
    std::map<int, Timer> timers_;
    struct Pulse {
        int output;
        bool level;
        Clock::time_point until;
    };
    std::vector<Pulse> pulses_;
    std::vector<std::string> messages_;
    std::map<std::string, std::shared_ptr<EkiChannel>> channels_;
    SimulatedArm arm_;  // last: its thread calls back
};

}  // namespace seamwright::krl
