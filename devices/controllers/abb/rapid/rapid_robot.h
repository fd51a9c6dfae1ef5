#pragma once
// What the interpreted programs act on: the arm of the simulated cell, the I/O of the configuration that our
// programs document, the cell's frames behind the work objects of the same names, and sockets, on which the
// faults of controller.h are put: whatever a program sends, a fault changes on its way.

#include <memory>
#include <optional>
#include <set>

#include "devices/controllers/abb/rapid/rapid_machine.h"
#include "devices/net/socket.h"
#include "devices/simulated/arm.h"
#include "devices/simulated/controller.h"

namespace seamwright::rapid {

Pose pose_from(const Value& pose);               // a pose, or the head of a robtarget: trans and rot
void store_pose(Value& pose, const Pose& from);  // into trans and rot, in single precision

struct RobotSettings {
    std::string serial, model;
    double time_scale = 1;
    std::chrono::milliseconds slow{300};
};

class RapidRobot {
  public:
    // `listener` is taken by the program that binds its port.
    RapidRobot(std::shared_ptr<SimulatedCell> cell, RobotSettings settings, TcpListener listener,
               std::function<ControllerFault()> fault);

    static std::map<std::string, std::string> signals();
    // Precondition of their execution: attach().
    std::map<std::string, Native> natives();
    void attach(Machine& machine) { machine_ = &machine; }
    bool may_move() const;  // motors on, not stopped
    bool listening() const { return listening_; }

  private:
    using Natives = std::map<std::string, Native>;
    void add_motion(Natives& n);
    void add_places(Natives& n);
    void add_system(Natives& n);
    void add_sockets(Natives& n);
    void add_socket_bytes(Natives& n);
    struct Socket;
    struct Trigger;
    Socket& socket(const Call& c, std::string_view name) const;
    Value move(Task& task, const Call& c, std::vector<PathEvent> events);
    Value trigger_move(Task& task, const Call& c);
    Value data_value(Task& task, const Call& c, bool set);
    bool send(Task& task, Socket& to, const std::string& bytes);
    bool send_message(Task& task, Socket& to, std::string bytes);
    void fill(Task& task, Socket& from, std::chrono::milliseconds at_most) const;
    int output(const std::string& signal) const;

    const std::shared_ptr<SimulatedCell> cell_;
    const RobotSettings settings_;
    std::optional<TcpListener> listener_;
    const std::function<ControllerFault()> fault_;
    Machine* machine_ = nullptr;
    std::atomic<bool> listening_ = false;
    std::map<std::string, Pose> mirrored_;  // work objects as they were last in the cell
    std::unique_ptr<SimulatedArm> arm_;
};

}  // namespace seamwright::rapid
