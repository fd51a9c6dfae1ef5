#pragma once
// What a script reaches of the simulated controller: the arm, digital inputs and outputs, registers, the
// screen. One thread, that of the controller's cycles: all that is read in a cycle is of the cycle's begin,
// motion goes on between two of them.

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/controllers/ur/script/value.h"
#include "devices/simulated/arm.h"

namespace seamwright::urscript {

struct Registers {
    std::array<std::int32_t, 48> ints{};
    std::array<double, 48> reals{};
    std::array<bool, 128> bits{};
    bool operator==(const Registers&) const = default;
};

struct ScriptRobotSettings {
    double cycle_s = 0.002;  // 500 Hz of an e-Series; a CB3 has 0.008
    double time_scale = 1;   // motion that much faster than real
    int trigger_output = 0;  // the standard digital output that is wired to the sensor
};

class ScriptRobot {
  public:
    ScriptRobot(std::shared_ptr<SimulatedCell> cell, const ScriptRobotSettings& settings, const Pose& start);

    // ---- cycles
    double cycle_s() const { return settings_.cycle_s; }
    double time_s() const { return time_s_; }  // since the making
    void begin_cycle();                        // looks where the robot stands
    void end_cycle();                          // moves it on; not called while a program is paused
    const Pose& base_from_flange() const { return base_from_flange_; }
    Eigen::Vector3d velocity_mm_s() const { return arm_.velocity_mm_s(); }

    // ---- motion. Poses are of the TCP that is set. Error (input): what the controller refuses to drive.
    PoseValue tcp_pose() const;
    PoseValue target_pose() const;  // where the last move goes
    const PoseValue& tcp_offset() const { return tcp_offset_; }
    Expected<void> set_tcp(const PoseValue& flange_from_tcp);
    Expected<void> movel(int thread, const PoseValue& tcp, double a, double v, double r);
    std::size_t moves_left() const { return arm_.pending(); }
    void stop();  // at once; forgets the moves that wait

    // ---- outside
    Registers inputs, outputs;
    std::array<bool, 8> digital_in{};
    void set_digital_out(int number, bool on);
    bool digital_out(int number) const { return arm_.output(number); }
    std::optional<std::string> popup;   // stands on the screen
    std::vector<std::string> messages;  // textmsg(), in order

  private:
    const std::shared_ptr<SimulatedCell> cell_;
    const ScriptRobotSettings settings_;
    SimulatedArm arm_;
    double time_s_ = 0;
    Pose base_from_flange_;
    PoseValue tcp_offset_{};
    std::optional<PoseValue> target_;
    Pose target_flange_;
    double radius_mm_ = 0;  // of the last move
    int mover_ = 0;         // the thread whose moves are under way
};

PoseValue pose_value(const Pose& pose);
Pose pose_of(const PoseValue& value);

}  // namespace seamwright::urscript
