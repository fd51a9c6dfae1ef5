#pragma once
// The ABB controller before the simulated cell: two tasks that execute the delivered RAPID, SEAMWRIGHT
// (semi-static, SeamwrightServer.mod) and T_ROB1 (Seamwright.mod, the spots' module, and a small application
// as a customer writes it, resources/robot/simulated/SimApplication.mod). Nothing here knows what the
// programs do: what is released, taken or told is what their variables hold.
//
// The application waits for a part: press_start() is the line's call for one, and a run that somebody starts
// at the computer is measured without. Then it asks for the permission, lays a short path in the first frame
// where it gets it, and waits for the next part. In manual mode it serves moves for teaching.
//
// clang-format off
// Settings, all optional:
//   {"address": "127.0.0.1", "port": 0,   where the server task listens; 0 = any free port
//    "serial": that of the cell, "model": "IRB 6700 (simulated)",
//    "slow_ms": 300,                      of the fault `slow`
//    "time_scale": 1,                     2 = the arm moves twice as fast as a real one
//    "application_wait_ms": 200,          so long the application lets the permission lie before it takes it
//    "programs": "",                      a folder of *.mod to load instead of what the cell's program and frames give;
//                                         the module with SW_Server goes to SEAMWRIGHT, all others to T_ROB1, and the
//                                         application is loaded unless one of them has a PROC main
//    "trigger_interval_ms": 20}           without effect: the arm takes its time
// clang-format on

#include <nlohmann/json.hpp>

#include "devices/controllers/abb/rapid/rapid_robot.h"
#include "devices/robot_program.h"

namespace seamwright {

class AbbRapidController : public SimulatedController {
  public:
    // What the tasks said: TPWrite, and why one of them stands.
    virtual std::vector<std::string> messages() const = 0;
    // A number, truth value (1 or 0) or text of a task, "T_ROB1" or "SEAMWRIGHT"; nothing when there is none.
    virtual std::optional<double> number(const std::string& task, const std::string& name) const = 0;
    virtual bool set_number(const std::string& task, const std::string& name, double value) = 0;
};

// Error (input) with file, line and reason where a controller would not load the programs.
Expected<std::unique_ptr<AbbRapidController>> start_abb_rapid_controller(std::shared_ptr<SimulatedCell> cell,
                                                                         const nlohmann::json& settings);
// The same, for the registry.
Expected<std::unique_ptr<SimulatedController>> start_abb_rapid(std::shared_ptr<SimulatedCell> cell,
                                                               const nlohmann::json& settings);

// Does a controller load these modules as one task (and the server's as the other)? For tests and for what
// writes programs. Error (input) with file, line and reason.
Expected<void> check_rapid(const std::vector<ProgramFile>& motion,
                           const std::vector<ProgramFile>& server = {});

}  // namespace seamwright
