#pragma once
// The robot's interpreter of a controller with RSI: it executes seamwright_rsi.src as it is delivered, on a
// robot whose every LIN is `path_s` of a simulated path. RSI_CREATE reads the delivered context: through which
// $OUT program and telegrams meet.
//
// The operator starts the program, again `restart_ms` after it has ended and from its beginning, and presses
// the start key as long after a HALT.

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "devices/controllers/cyclic/simulated_path.h"
#include "devices/controllers/kuka/krl/machine.h"
#include "devices/robot_program.h"

namespace seamwright::krl {

struct RsiApplicationSettings {
    SimulatedPath path;
    double path_s = 2;
    int restart_ms = 100;
    std::function<bool()> stop_message = [] { return false; };  // $STOPMESS
    // The program has run its path to the end, and says so. On the program's thread.
    std::function<void()> path_over = [] {};
};

class RsiApplication final : public Host {
  public:
    // `files` as write_rsi_program() writes them. Error (KrlError) for what the controller does not load.
    RsiApplication(RsiApplicationSettings settings, const std::vector<ProgramFile>& files);
    ~RsiApplication() override;

    // For the interpolation cycle: everything by one look.
    struct Now {
        bool on = false;            // between RSI_ON and RSI_OFF
        bool relative = false;      // as RSI_ON said
        std::uint64_t session = 0;  // counts RSI_ON
        bool under_way = false;     // what the context reads for <Path>
        Pose programmed = Pose::Identity();
    };
    Now cycle(int ms);  // that much later
    void set_release(bool released);
    // RSI ends by itself (RSITimeout, a limit): the robot stops and the program is cancelled.
    void rsi_fails();
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
    void brake(Task& task) override;
    void give_up_motions(Task& task) override;
    void interrupt_ended(Task& task) override;

  private:
    void operate(const std::stop_token& stop);
    std::optional<Value> rsi(Task& task, const std::string& name, const std::vector<Argument>& arguments);
    void create(const std::string& context);
    bool out(int number) const;  // precondition: locked

    const RsiApplicationSettings settings_;
    std::map<std::string, std::string> files_;  // of the folder SensorInterface, by name
    Machine machine_;
    mutable std::mutex mutex_;  // of what follows; never held while another lock is taken
    std::map<int, bool> outputs_;
    int path_output_ = 0, release_output_ = 0;  // of the context; 0 = none is created
    bool on_ = false, relative_ = false, prepared_ = false, at_block_ = false, braking_ = false;
    std::uint64_t sessions_ = 0;
    double path_ms_ = 0, rate_ = 1;  // along the path, and its pace: 1 = as programmed
    std::deque<double> ends_ms_;     // of the motions not yet at their end
    std::vector<std::string> messages_;
    std::stop_source run_;
    std::jthread operator_;  // last
};

}  // namespace seamwright::krl
