#pragma once
// The common side of all simulated controllers: what a test, the demo and `seamwright sim-cell` can ask of a
// controller whatever protocol it speaks. The robot behind it is the simulated cell's: its mode, frames,
// program and triggers.

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/ids.h"
#include "devices/robot_link.h"

namespace seamwright {

class SimulatedCell;

// What the controller does wrong from the moment the fault is set, to every message that it owes from then
// on.
enum class ControllerFault {
    none,
    silent,        // takes everything, answers nothing, tells no event
    slow,          // everything comes `slow_ms` late (setting, 300)
    wrong_answer,  // well-formed, but not what was asked: another number, another name, another kind
    half_message,  // the first half of the message, then nothing more
    disconnect,    // half of the message, then the connection is closed
    reject_write,  // refuses to write, as the protocol says no; everything else works
    out_of_range   // numbers that no robot can mean: 1e9 mm, infinite, a mode that does not exist
};
std::string_view to_string(ControllerFault fault);
std::optional<ControllerFault> controller_fault_from(std::string_view name);
const std::vector<ControllerFault>& controller_faults();  // all but `none`

// Runs on threads of its own from its making to its destruction, on the loopback address unless told
// otherwise. Everything public is thread-safe.
class SimulatedController {
  public:
    virtual ~SimulatedController() = default;
    // Where it listens; of a robot that is the client, where it connects to.
    virtual std::uint16_t port() const = 0;
    // Somebody calls for the next part, as the line's PLC does.
    virtual void press_start(const PartId& part, const PartTypeId& type = {});
    void set_fault(ControllerFault fault) { fault_ = fault; }
    ControllerFault fault() const { return fault_; }
    // May the application run with the frames as they are? See RobotLink. False from the making, from a start
    // of measuring and from a lost connection on; true from PartVerdict::corrected on.
    virtual bool released() const { return released_; }
    // The application began with the frames as they are: from then on released() stays, whatever happens to
    // the connection, until the next part begins.
    virtual bool taken() const { return taken_; }
    virtual std::optional<PartVerdict> verdict() const;  // of the present part, as confirmed

  protected:
    // For the protocols: the call for a part is told once.
    struct Call {
        std::string part_id, part_type;  // no type: the program says its own
    };
    std::optional<Call> take_start();
    void part_begins();  // no verdict, not released
    void withdraw();     // not released, unless the application has taken it
    bool take();         // by the application, once it is released; says whether it was
    void take_verdict(PartVerdict verdict);
    // For a program that is executed: all three as its variables say.
    void tell(bool released, bool taken, std::optional<PartVerdict> verdict);

  private:
    std::atomic<ControllerFault> fault_ = ControllerFault::none;
    std::atomic<bool> released_ = false, taken_ = false;
    mutable std::mutex mutex_;
    std::optional<Call> start_;
    std::optional<PartVerdict> verdict_;
};

}  // namespace seamwright
