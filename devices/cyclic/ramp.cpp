#include "devices/cyclic/ramp.h"

#include <algorithm>
#include <cmath>

namespace seamwright {
namespace {
// The greatest step, in units of the acceleration's a dt^2, from which discrete braking ends exactly after
// `rest` (same unit): steps n + f, n - 1 + f, ..., f have the sum n (n + 1) / 2 + f (n + 1).
double braking_step(double rest) {
    double n = std::floor((std::sqrt(1 + 8 * rest) - 1) / 2);
    while (n > 0 && n * (n + 1) / 2 > rest) --n;
    return n + (rest - n * (n + 1) / 2) / (n + 1);
}
}  // namespace

CorrectionRamp::CorrectionRamp(RampLimits limits, double cycle_s)
    : limits_(limits), cycle_s_(cycle_s), trail_(limits.speed_mm_s, limits.acceleration_mm_s2, cycle_s) {}

CorrectionRamp::State CorrectionRamp::blend(const State& a, const State& b, double s) {
    if (s >= 1) return b;
    State r;
    r.l = a.l + s * (b.l - a.l);
    r.t = a.t + s * (b.t - a.t);
    r.turn = a.turn + s * (b.turn - a.turn);
    r.zero = a.zero && (b.zero || s <= 0);
    return r;
}

void CorrectionRamp::set_target(const Pose& displacement) {
    target_ = {};
    if (!displacement.isApprox(Pose::Identity(), 0)) {
        target_.l = displacement.linear() - Eigen::Matrix3d::Identity();
        target_.t = displacement.translation();
        target_.turn = rotation_log(displacement.linear());
        target_.zero = target_.l.isZero(0) && target_.t.isZero(0);
    }
    pending_ = true;
    trail_.set_target(Eigen::Vector3d::Zero());
}

void CorrectionRamp::reset(const CyclicCorrection& held) {
    from_ = to_ = now_ = target_ = {};
    now_.t = held.offset_mm;
    now_.turn = held.turn_rad;
    now_.zero = held.offset_mm.isZero(0) && held.turn_rad.isZero(0);
    from_ = to_ = now_;
    target_ = now_;
    s_ = 1;
    step_ = 0;
    pending_ = false;
    trail_ = OffsetTrail(limits_.speed_mm_s, limits_.acceleration_mm_s2, cycle_s_);
}

void CorrectionRamp::begin() {
    from_ = now_;
    to_ = target_;
    s_ = 0;
    step_ = 0;
    pending_ = false;
}

CyclicCorrection CorrectionRamp::at(const Eigen::Vector3d& position_mm) const {
    return {now_.l * position_mm + now_.t + trail_.offset_mm(), now_.turn};
}

CyclicCorrection CorrectionRamp::step(const Eigen::Vector3d& position_mm) {
    const bool led_back = trail_.target_is_zero() && !trail_.zero();
    trail_.step();
    if (!led_back) step_displacement(position_mm);
    return at(position_mm);
}

void CorrectionRamp::step_displacement(const Eigen::Vector3d& position_mm) {
    if (s_ >= 1 && step_ > 0) {
        step_ = 0;  // the cycle in which the last step's speed ends
        return;
    }
    if (pending_ && step_ == 0) begin();
    if (s_ < 1) {
        const double length_mm = ((to_.l - from_.l) * position_mm + (to_.t - from_.t)).norm();
        const double angle_deg = deg_from_rad((to_.turn - from_.turn).norm());
        // Limits of s: the stricter of the two motions.
        const double tiny = 1e-12;
        const double speed = std::min(limits_.speed_mm_s / std::max(length_mm, tiny),
                                      limits_.speed_deg_s / std::max(angle_deg, tiny));
        const double acceleration = std::min(limits_.acceleration_mm_s2 / std::max(length_mm, tiny),
                                             limits_.acceleration_deg_s2 / std::max(angle_deg, tiny));
        const double unit = acceleration * cycle_s_ * cycle_s_;
        const double rest = 1 - s_;
        const double braked = std::max(0.0, step_ - unit);
        double next =
            pending_ ? braked : std::min({step_ + unit, speed * cycle_s_, braking_step(rest / unit) * unit});
        next = std::min(next, rest);
        s_ += next;
        step_ = next;
        // The last step: what is left is nothing but rounding.
        if (1 - s_ <= 1e-13) s_ = 1;
        now_ = blend(from_, to_, s_);
    }
}

bool CorrectionRamp::arrived() const {
    return !pending_ && s_ >= 1 && trail_.arrived();
}
bool CorrectionRamp::zero() const {
    return now_.zero && step_ == 0 && (!pending_ || target_.zero) && trail_.zero();
}

}  // namespace seamwright
