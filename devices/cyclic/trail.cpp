#include "devices/cyclic/trail.h"

#include <algorithm>
#include <cmath>

namespace seamwright {
namespace {
constexpr double kLandsMm = 1e-6;
}

const Eigen::Vector3d& OffsetTrail::step() {
    const double change_limit = acceleration_ * cycle_s_;
    const Eigen::Vector3d rest = target_ - offset_;
    const double distance = rest.norm();
    if (rate_.isZero(0) && distance <= kLandsMm && velocity_.norm() <= change_limit) {
        offset_ = target_;
        velocity_.setZero();
        return offset_;
    }
    Eigen::Vector3d wanted = rate_;
    if (distance > 0)
        wanted += rest / distance * std::min(std::sqrt(acceleration_ * distance), 0.25 * distance / cycle_s_);
    if (wanted.norm() > speed_) wanted *= speed_ / wanted.norm();
    Eigen::Vector3d change = wanted - velocity_;
    if (change.norm() > change_limit) change *= change_limit / change.norm();
    velocity_ += change;
    offset_ += velocity_ * cycle_s_;
    return offset_;
}

}  // namespace seamwright
