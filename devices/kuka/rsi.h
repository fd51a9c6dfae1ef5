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
// <Release> falls with the permission, by an alarm too. On the path that stops the robot (an interrupt of the
// program), and RSI ends with <Path> at 1: a path that was stopped is never told as over.
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

namespace seamwright {

const SettingTable& kuka_rsi_settings();
Expected<std::unique_ptr<RobotLink>> open_kuka_rsi(const nlohmann::json& settings, DeviceSession& session,
                                                   OpenRobot open_robot);

}  // namespace seamwright
