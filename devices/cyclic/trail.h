#pragma once
// An offset that follows a moving target within speed and acceleration.
//
// In discrete time, every cycle: the wanted velocity is the target's own plus what closes the distance d,
//     u = rate + (d / |d|) min(sqrt(a |d|), |d| / (4 cycle)),   |u| <= speed,
// and the velocity goes towards u by at most a cycle. So a target that moves within the limits is followed without
// lag, one that jumps is approached without overshoot, and at the end the offset lands on the target exactly.

#include <Eigen/Core>

namespace seamwright {

class OffsetTrail {
  public:
    OffsetTrail(double speed_mm_s, double acceleration_mm_s2, double cycle_s)
        : speed_(speed_mm_s), acceleration_(acceleration_mm_s2), cycle_s_(cycle_s) {}
    // From the next step on.
    void set_target(const Eigen::Vector3d& offset_mm,
                    const Eigen::Vector3d& rate_mm_s = Eigen::Vector3d::Zero()) {
        target_ = offset_mm;
        rate_ = rate_mm_s;
    }
    const Eigen::Vector3d& step();  // one cycle on
    const Eigen::Vector3d& offset_mm() const { return offset_; }
    const Eigen::Vector3d& target_mm() const { return target_; }
    void stand() { velocity_.setZero(); }  // it stood for a cycle
    bool arrived() const { return velocity_.isZero(0) && rate_.isZero(0) && offset_ == target_; }
    bool zero() const { return velocity_.isZero(0) && offset_.isZero(0); }
    bool target_is_zero() const { return target_.isZero(0) && rate_.isZero(0); }

  private:
    double speed_, acceleration_, cycle_s_;
    Eigen::Vector3d offset_ = Eigen::Vector3d::Zero(), velocity_ = offset_, target_ = offset_,
                    rate_ = offset_;
};

}  // namespace seamwright
