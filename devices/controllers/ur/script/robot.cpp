#include "devices/controllers/ur/script/robot.h"

#include <fmt/format.h>

#include <cmath>

#include "core/geometry/notation.h"
#include "devices/ur/module.h"

namespace seamwright::urscript {
namespace {

constexpr double kFastest_m_s = 3, kMostAcceleration_m_s2 = 25, kReach_m = 10;

ArmSettings arm_settings(const ScriptRobotSettings& s) {
    ArmSettings arm;
    arm.acceleration_mm_s2 = 1200;  // what the module asks for
    arm.time_scale = s.time_scale;
    arm.trigger_output = s.trigger_output;
    arm.driven = true;
    return arm;
}

}  // namespace

PoseValue pose_value(const Pose& pose) {
    return ur::ur_pose(pose);
}

Pose pose_of(const PoseValue& v) {
    return make_pose(rotation_from_ur({v[3], v[4], v[5]}), {1000 * v[0], 1000 * v[1], 1000 * v[2]});
}

ScriptRobot::ScriptRobot(std::shared_ptr<SimulatedCell> cell, const ScriptRobotSettings& settings,
                         const Pose& start)
    : cell_(std::move(cell)),
      settings_(settings),
      arm_(cell_, arm_settings(settings), start),
      base_from_flange_(start),
      target_flange_(start) {}

void ScriptRobot::begin_cycle() {
    if (arm_.pending() == 0)
        if (const auto at = cell_->reported_flange()) arm_.place(*at);
    base_from_flange_ = arm_.position();
}

void ScriptRobot::end_cycle() {
    arm_.advance(settings_.cycle_s);
    time_s_ += settings_.cycle_s;
}

PoseValue ScriptRobot::tcp_pose() const {
    return pose_value(base_from_flange_ * pose_of(tcp_offset_));
}

PoseValue ScriptRobot::target_pose() const {
    return arm_.pending() > 0 && target_ ? *target_ : tcp_pose();
}

Expected<void> ScriptRobot::set_tcp(const PoseValue& flange_from_tcp) {
    for (const double v : flange_from_tcp)
        if (!std::isfinite(v)) return input_error("set_tcp() got a number that is not finite");
    tcp_offset_ = flange_from_tcp;
    return {};
}

Expected<void> ScriptRobot::movel(int thread, const PoseValue& tcp, double a, double v, double r) {
    for (const double x : tcp)
        if (!std::isfinite(x)) return input_error("movel() got a number that is not finite");
    if (!(v > 0 && v <= kFastest_m_s)) return input_error(Text("movel() at {} m/s", v));
    if (!(a > 0 && a <= kMostAcceleration_m_s2)) return input_error(Text("movel() at {} m/s^2", a));
    if (!(r >= 0)) return input_error(Text("movel() with a blend radius of {} m", r));
    if (std::hypot(tcp[0], tcp[1], tcp[2]) > kReach_m)
        return input_error(Text("movel() to a point {:.1f} m away", std::hypot(tcp[0], tcp[1], tcp[2])));
    const bool moving = arm_.pending() > 0;
    if (moving && mover_ != thread) return input_error("another thread moves the robot already");
    const Pose flange = pose_of(tcp) * pose_of(tcp_offset_).inverse();
    const Pose from = moving ? target_flange_ : arm_.position();
    // Blends that overlap: with that of the move before, or with its beginning.
    const double room = distance_mm(from, flange);
    if (1000 * r + (moving ? radius_mm_ : 0) > room + 1e-6)
        return input_error(Text("blends overlap: {:.2f} mm on a way of {:.2f} mm",
                                1000 * r + (moving ? radius_mm_ : 0), room));
    mover_ = thread;
    target_ = tcp;
    target_flange_ = flange;
    radius_mm_ = 1000 * r;
    arm_.move({flange, 1000 * v, 1000 * r, {}});
    return {};
}

void ScriptRobot::stop() {
    arm_.halt();
    target_.reset();
}

void ScriptRobot::set_digital_out(int number, bool on) {
    arm_.set_output(number, on);
}

}  // namespace seamwright::urscript
