#pragma once
// An ABB controller with EGM before a simulated cell. SeamwrightEgm.mod decides when the robot moves, stops, ends and
// talks, as it is delivered (egm_application.h); here are the messages of EGM's cycle and what EGM makes of the answers.
//
// Settings: {"address": "127.0.0.1", "port": 6510, "cycle_ms": 4, "late_limit": 100 (cycles without an answer until
// EGM stops: CommTimeout), "max_translation_mm": 20, "restart_ms": 700 (between two paths, and until a program that
// stands is started again), "ramp_out_ms": 200 (in which a stopped EGM leads the correction away), "speed_mm_s": 100,
// "straight": false (a line instead of a circle), "path" and "flange_from_tcp" of simulated_path.h, "application": true, "path_s": 2 (of the path behind its lead-in;
// "application" false: the lead-in never ends), "slow_ms": 300, "measuring": {"driver", "settings"}}. Faults:
// silent, slow, half_message and disconnect as for RSI; wrong_answer is a message of another type; reject_write ends EGM
// with MCI_ERROR as soon as a correction comes; out_of_range tells positions that no robot has. released() is true
// while a correction is in force, and once the path is over (taken()).

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/geometry/pose.h"
#include "devices/controllers/cyclic/measuring_controller.h"
#include "devices/simulated/cell.h"
#include "devices/simulated/controller.h"

namespace seamwright {

class SimulatedEgm : public SimulatedController {
  public:
    struct Sample {
        Pose programmed = Pose::Identity(), corrected = Pose::Identity();
        Eigen::Vector3d told_mm = Eigen::Vector3d::Zero(), travel = Eigen::Vector3d::Zero();
    };
    virtual Sample newest() const = 0;
    virtual std::vector<Sample> history() const = 0;
    virtual std::uint64_t stops() const = 0;
    virtual SimulatedController* measuring() = 0;           // may be null
    virtual std::vector<std::string> messages() const = 0;  // of the program
};
Expected<std::unique_ptr<SimulatedController>> start_abb_egm(std::shared_ptr<SimulatedCell> cell,
                                                             const nlohmann::json& settings,
                                                             StartController start_controller);

}  // namespace seamwright
