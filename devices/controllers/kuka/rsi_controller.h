#pragma once
// A KUKA controller with RSI before a simulated cell. seamwright_rsi.src decides when the robot waits, moves,
// stops and ends, as it is delivered and with its context (rsi_application.h); here are the telegrams of the
// interpolation cycle and what RSI makes of the answers.
//
// Settings: {"address": "127.0.0.1", "port": 49152, "cycle_ms": 4, "mode", "reference", "sen_type" as in
// devices/kuka/rsi.h, "late_limit": 100 (late answers in a row until RSITimeout), "max_translation_mm": 20
// (POSCORR limit: beyond it RSI stops), "restart_ms": 100 (how long the operator takes: until a program that
// has ended, or was cancelled with RSI, is started again, and from a HALT to the start key), "delay":
// "run_length" | "sum" (of D), "hold_on": true for absolute, false for relative, "following_ms": 8 (servo
// lag), "application": true (the delivered program, whose path takes "path_s": 2; false: RSI is on always, on
// a circle without end), "speed_mm_s": 100, "path" and "flange_from_tcp" of simulated_path.h, "slow_ms": 300, "measuring": {"driver", "settings"}}. Faults:
// silent sends nothing, slow sends late, wrong_answer repeats an old IPOC, half_message and disconnect cut
// telegrams (the latter stops sending after it), reject_write stops RSI as soon as a correction comes,
// out_of_range tells positions that no robot has. released() is true while <Release> is (without an
// application: while a correction is in force), and once the path is over (taken()).

#include <array>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/geometry/pose.h"
#include "devices/controllers/cyclic/measuring_controller.h"
#include "devices/simulated/cell.h"
#include "devices/simulated/controller.h"

namespace seamwright {

class SimulatedRsi : public SimulatedController {
  public:
    struct Sample {
        Pose programmed = Pose::Identity(), corrected = Pose::Identity();  // reference_from_tcp
        std::array<double, 6> correction{};                                // as in force: X Y Z A B C
        std::uint64_t ipoc = 0;
    };
    virtual Sample newest() const = 0;
    virtual std::vector<Sample> history() const = 0;  // of all cycles, RSI on or off, at most 20000
    virtual std::uint64_t stops() const = 0;          // RSITimeout, limits
    virtual std::uint64_t late() const = 0;
    virtual SimulatedController* measuring() = 0;           // may be null
    virtual std::vector<std::string> messages() const = 0;  // of the program
};
Expected<std::unique_ptr<SimulatedController>> start_kuka_rsi(std::shared_ptr<SimulatedCell> cell,
                                                              const nlohmann::json& settings,
                                                              StartController start_controller);

}  // namespace seamwright
