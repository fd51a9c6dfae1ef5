#pragma once
// The motion task of a controller with EGM: it executes SeamwrightEgm.mod as it is delivered, on a robot whose
// motions run along a simulated path: MoveL brings it to the path's begin, EGMMoveL takes `lead_s` of it (or
// never ends), what comes behind the permission `path_s`. EGM is off, connected (MCI_STOPPED), running, or in error,
// as the instructions have it, and talks from EGMSetupUC to EGMReset.
//
// The permission is that of the measuring controller beside it, which SW_Take of the small application
// (resources/robot/simulated/SimEgmApplication.mod) waits for. The operator starts the program again
// `restart_ms` after it stands.

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "devices/abb/egm_message.h"
#include "devices/controllers/abb/rapid/rapid_machine.h"
#include "devices/controllers/cyclic/simulated_path.h"
#include "devices/robot_program.h"

namespace seamwright::rapid {

struct EgmApplicationSettings {
    SimulatedPath path;
    double lead_s = 0.6, path_s = 2;
    bool ends = true;  // false: the lead-in goes on for ever
    int cycle_ms = 4, restart_ms = 700;
};

class EgmApplication {
  public:
    // `modules` of T_ROB1, SeamwrightEgm.mod among them. Throws LoadError for what a controller does not load.
    EgmApplication(const EgmApplicationSettings& settings, const std::vector<SourceText>& modules);
    ~EgmApplication();

    // For the cycle in which EGM asks: everything by one look.
    struct Now {
        bool talks = false;
        EgmMci mci = EgmMci::undefined;
        Pose programmed = Pose::Identity();
        Eigen::Vector3d travel = Eigen::Vector3d::Zero();
        std::uint64_t paths = 0;  // run to their end
        std::uint64_t stops = 0;  // CommTimeout and egm_fails()
    };
    // `ms` later. `answered`: since the last look; `permitted`: the application may run its path.
    Now cycle(int ms, bool answered, bool permitted);
    // EGM ends by itself (a limit): the robot stops.
    void egm_fails();
    std::vector<std::string> messages() const { return machine_->messages(); }

  private:
    struct Failure {
        int number;
        std::string what;
    };
    std::map<std::string, Native> natives();
    void set_up(const Call& c);
    Value egm_move(Task& task, const Call& c, double seconds);
    void stop(Failure why);  // precondition: locked
    void operate(int ms);

    const EgmApplicationSettings settings_;
    mutable std::mutex mutex_;  // of what follows; taken with the machine's lock held, never the other way
    EgmMci mci_ = EgmMci::undefined;
    bool set_up_ = false, active_ = false;
    std::optional<Failure> failure_;
    double timeout_ms_ = 0, silent_ms_ = 0, path_ms_ = 0;
    std::deque<double> ends_ms_;  // of the EGM motions not yet at their end
    std::uint64_t paths_ = 0, stops_ = 0;
    int stood_ms_ = 0;                  // of the program
    std::unique_ptr<Machine> machine_;  // last: its tasks use everything above
};

}  // namespace seamwright::rapid
