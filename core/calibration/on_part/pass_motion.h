#pragma once
// The flange's motion during one pass, between the poses of its profiles. Private to core/calibration/on_part.
//
// Four neighbours a pose: displacements log(F_i^-1 F_j) (shift, rotation vector) interpolated by the cubic through them
// (Lagrange), exact for a constant twist to third order. Beyond the ends the nearest twist goes on. Poses that scatter
// one by one are smoothed by the cubic nearest to seven of them: interpolation averages their noise between the samples
// and not at them, which would draw the latency towards half an interval.

#include <vector>

#include "core/geometry/pose.h"

namespace seamwright::on_part {

class PassMotion {
  public:
    PassMotion() = default;
    PassMotion(std::vector<double> times_s, std::vector<Pose> poses);
    Pose at(double time_s) const;
    // Body twist (mm/s, rad/s): at(t + dt) = at(t) * (turn by w dt, shift by v dt), to first order.
    Vector6 twist(double time_s) const;
    // Not more than a fiftieth of an interval beyond the ends.
    bool inside(double time_s) const;
    bool timed() const { return times_.size() > 1; }

  private:
    Pose smoothed(double time_s, std::size_t nearest) const;
    std::vector<double> times_;
    std::vector<Pose> poses_;
    bool noisy_ = false;
};

}  // namespace seamwright::on_part
