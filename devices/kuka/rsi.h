#pragma once
// KUKA.RobotSensorInterface over Ethernet: the first step to online correction. The controller runs
// seamwright_rsi.src with SeamwrightRsi.xml (resources/robot/kuka) and sends a telegram every 4 ms (IPO_FAST)
// or 12 ms (IPO); Seamwright answers each at once. Telegrams: rsi_telegram.h; ramp, alarms and lost packets:
// devices/cyclic/corrector.h; the frames and the common settings: devices/cyclic/link.h (port 49152).
//
// What RKorr means (object POSCORR): X, Y, Z shift the TCP, A, B, C turn the tool about its TCP. With p and R
// of the programmed pose RSol:
//   "reference": "base" (POSCORR's RefCorrSys Base): offset = B p - p along the axes of $BASE; the tool
//   becomes
//       R_corr R with R_corr = Rz(A) Ry(B) Rx(C) = R_B: the corrected pose is B * programmed
//   "reference": "tool" (RefCorrSys Tool): the same motion told in the tool: offset R^T (B p - p), turn R^T
//   R_B R
// `base_from_reference` is $BASE; it must be the one active while RSI moves.
//
// A correction is in force when the robot shows it: RIst against RSol, within the servo lag (evidence.h). A
// telegram without RIst, RSol or Delay is answered with zero, and confirm() names the element that is
// missing: without a position there is no B p - p.
//
// When an answer comes late (after the next telegram has gone out) the controller throws it away, counts it
// in Delay D, a run length that the next answer in time sets back to 0 (some print the sum since RSI_ON;
// both are understood), and lets the configuration decide what POSCORR gets instead:
//   HOLDON 1: the last RKorr once more. In absolute mode nothing changes; in relative mode the last increment
//             is added again in every late cycle.
//   HOLDON 0: zero. In relative mode nothing changes; in absolute mode the whole correction is dropped at
//             once.
// So absolute wants 1 and relative 0, which the files shipped say. The wrong way round is found by what the
// robot shows, told, and led back within the limit of a cycle from where the robot is. The IPOC is the
// controller's clock and goes on over RSI_OFF and RSI_ON; only RSI_ON sets the correction to zero.
//
// seamwright_rsi.src waits with the path for <Release>, which is 1 from confirm(corrected) on, and tells by
// <Path> when it runs: permission() is `given`, `running` while <Path> is 1 (where it is not sent: once RSol
// moves) and `taken` when it is over, that is <Path> is 0 again, or the session ends with RSol standing.
//
// Settings: kuka_rsi_settings().
// "mode" is that of RSI_ON: absolute tells the whole correction in every cycle, relative its increments,
// which the controller adds up axis by axis. Increments are the differences of what has been told after
// rounding, so their sum is the correction to half a unit of the last decimal at every moment. "tool" with
// relative is refused: increments along a turning tool do not add up.
//
// The controller counts late answers (Delay D) and stops by itself with RSITimeout after as many as its
// configuration allows; the correction is then gone with RSI_OFF.

#include <memory>
#include <nlohmann/json.hpp>

#include "devices/cyclic/link.h"
#include "devices/cyclic/measuring.h"
#include "devices/simulated/cell.h"
#include "devices/simulated/controller.h"

namespace seamwright {

const SettingTable& kuka_rsi_settings();
Expected<std::unique_ptr<RobotLink>> open_kuka_rsi(const nlohmann::json& settings, DeviceSession& session,
                                                   OpenRobot open_robot);

// The robot's side. Settings: {"address": "127.0.0.1", "port": 49152, "cycle_ms": 4, "mode", "reference",
// "sen_type" as above, "late_limit": 100 (late answers in a row until RSITimeout), "max_translation_mm": 20
// (POSCORR limit: beyond it RSI stops), "restart_ms": 100 (how long a stopped RSI stays off before the
// program starts it again), "delay": "run_length" | "sum" (of D), "hold_on": true for absolute, false for
// relative, "following_ms": 8 (servo lag), "application": true (the path waits for <Release>, takes "path_s":
// 2, and RSI is off for restart_ms; false: a circle without end), "speed_mm_s": 100, "slow_ms": 300,
// "measuring": {"driver", "settings"}}. Faults:
// silent sends nothing, slow sends late, wrong_answer repeats an old IPOC, half_message and disconnect cut
// telegrams (the latter stops sending after it), reject_write stops RSI as soon as a correction comes,
// out_of_range tells positions that no robot has. released() is true from <Release> on (without an
// application: while a correction is in force), and once the path is over (taken()).
class SimulatedRsi : public SimulatedController {
  public:
    struct Sample {
        Pose programmed = Pose::Identity(), corrected = Pose::Identity();  // reference_from_tcp
        std::array<double, 6> correction{};                                // as in force: X Y Z A B C
        std::uint64_t ipoc = 0;
    };
    virtual Sample newest() const = 0;
    virtual std::vector<Sample> history() const = 0;  // of all cycles since its making, at most 20000
    virtual std::uint64_t stops() const = 0;          // RSITimeout, limits
    virtual std::uint64_t late() const = 0;
    virtual SimulatedController* measuring() = 0;  // may be null
};
Expected<std::unique_ptr<SimulatedController>> start_kuka_rsi(std::shared_ptr<SimulatedCell> cell,
                                                              const nlohmann::json& settings,
                                                              StartController start_controller);

}  // namespace seamwright
