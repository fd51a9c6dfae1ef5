#pragma once
// A rigid displacement that is brought onto a running path without a step.
//
// B (in the reference frame of the controller) moves every point of the programmed path. At the programmed
// pose with position p (mm) the correction is
//     offset = B p - p = L p + t,  L = R_B - 1,          turn = log(R_B)  (rotation vector, rad)
// Both are linear in what the ramp blends: with s from 0 to 1,
//     L(s) = L0 + s (L1 - L0),  t(s), turn(s) the same,
// so at standing p the correction runs on a straight line: no detour, no overshoot, and it stays between its
// ends. s obeys a trapezoid in discrete time: the offset's speed is at most `speed_mm_s`, the turn's
// `speed_deg_s`, and from one cycle to the next neither speed changes by more than acceleration * cycle. The
// last step lands on the end exactly (the stopping distance of discrete steps n(n+1)/2 a dt^2 is solved, not
// approximated). While the path runs, L(s) dp of the path's own motion is added; that part is the displaced
// path, not the ramp. A new end in the middle brakes on the old line first. A ramp is a value: who does not
// know yet whether the robot took a step keeps the one before it.
//
// Who steers (steering.h) adds an offset on top, which follows its target within the same limits (trail.h). A
// steered offset that is led back is at zero before B begins to go: their speeds never add.

#include <Eigen/Core>

#include "core/geometry/pose.h"
#include "devices/cyclic/trail.h"

namespace seamwright {

struct RampLimits {
    double speed_mm_s = 20, speed_deg_s = 2;
    double acceleration_mm_s2 = 100, acceleration_deg_s2 = 10;
};

// In the reference frame.
struct CyclicCorrection {
    Eigen::Vector3d offset_mm = Eigen::Vector3d::Zero();
    Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();
};

class CorrectionRamp {
  public:
    CorrectionRamp(RampLimits limits, double cycle_s);
    void set_target(const Pose& displacement);  // identity = withdraw
    // Standing at this correction wherever the path is; what was wanted is forgotten. Nothing: at zero, the
    // robot has dropped its correction.
    void reset(const CyclicCorrection& held = {});
    void steer(const Eigen::Vector3d& offset_mm, const Eigen::Vector3d& rate_mm_s) {
        trail_.set_target(offset_mm, rate_mm_s);
    }
    const Eigen::Vector3d& steered_mm() const { return trail_.offset_mm(); }
    void stand() {
        step_ = 0;
        trail_.stand();
    }  // the robot stood for a cycle: its speed begins anew from zero
    // One cycle on; the correction for the programmed position.
    CyclicCorrection step(const Eigen::Vector3d& position_mm);
    CyclicCorrection at(const Eigen::Vector3d& position_mm) const;  // as it is, without a step
    bool arrived() const;                                           // at the target, standing
    bool zero() const;                                              // no correction, standing
    bool target_is_zero() const { return target_.zero && trail_.target_is_zero(); }

  private:
    struct State {
        Eigen::Matrix3d l = Eigen::Matrix3d::Zero();
        Eigen::Vector3d t = Eigen::Vector3d::Zero(), turn = Eigen::Vector3d::Zero();
        bool zero = true;
    };
    static State blend(const State& a, const State& b, double s);
    void begin();
    void step_displacement(const Eigen::Vector3d& position_mm);

    RampLimits limits_;
    double cycle_s_;
    State from_, to_, now_, target_;
    OffsetTrail trail_;
    double s_ = 1, step_ = 0;  // step_: of s in the last cycle
    bool pending_ = false;     // target_ is another end than to_
};

}  // namespace seamwright
