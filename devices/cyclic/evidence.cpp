#include "devices/cyclic/evidence.h"

#include <algorithm>
#include <cmath>

namespace seamwright {
namespace {
// The point of a line from a to b that lies nearest to zero.
Eigen::Vector3d nearest(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    const Eigen::Vector3d way = b - a;
    const double length2 = way.squaredNorm();
    return length2 > 0 ? Eigen::Vector3d(a + way * std::clamp(-a.dot(way) / length2, 0.0, 1.0)) : a;
}
const CyclicTold kNothing;
}  // namespace

HeldHistory::HeldHistory(double cycle_s)
    : capacity_(std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(kLargestLag_s / cycle_s)) + 1, 2,
                                        cycles_.size())) {}

void HeldHistory::add(const CyclicTold& held, const Pose& programmed) {
    cycles_[next_] = {held, programmed};
    next_ = (next_ + 1) % capacity_;
    count_ = std::min(count_ + 1, capacity_);
}

CyclicTold HeldHistory::rest(std::size_t i, const CyclicTold& shown, const CyclicPacket& newest,
                             CyclicProtocol& protocol, const CyclicTold* instead) const {
    const Cycle& cycle = cycles_[(next_ + 2 * capacity_ - 1 - i) % capacity_];
    const CyclicTold& held = instead ? *instead : cycle.held;
    const Pose& now = *newest.programmed;
    CyclicTold back;
    back.mm = cycle.programmed.translation() - now.translation();
    back.turn_rad = rotation_log(cycle.programmed.linear() * now.linear().transpose());
    back = protocol.motion_shown(newest, back);
    return {shown.mm - held.mm - back.mm, shown.turn_rad - held.turn_rad - back.turn_rad};
}

Misfit HeldHistory::misfit(const CyclicTold& shown, const CyclicPacket& newest, CyclicProtocol& protocol,
                           const CyclicTold* instead) const {
    if (count_ == 0 || !newest.programmed) {
        const CyclicTold& held = instead ? *instead : kNothing;
        return {(shown.mm - held.mm).norm(), (shown.turn_rad - held.turn_rad).norm()};
    }
    CyclicTold before = rest(0, shown, newest, protocol, instead);
    Misfit best{before.mm.norm(), before.turn_rad.norm()};
    for (std::size_t i = 1; i < count_; ++i) {
        const CyclicTold here = rest(i, shown, newest, protocol, instead);
        best.mm = std::min(best.mm, nearest(before.mm, here.mm).norm());
        best.rad = std::min(best.rad, nearest(before.turn_rad, here.turn_rad).norm());
        before = here;
    }
    return best;
}

CyclicTold HeldHistory::without_lag(const CyclicTold& shown, const CyclicPacket& newest,
                                    CyclicProtocol& protocol) const {
    CyclicTold least = shown;
    if (count_ == 0 || !newest.programmed) return least;
    CyclicTold before = rest(0, shown, newest, protocol, &kNothing);
    for (std::size_t i = 1; i < count_; ++i) {
        const CyclicTold here = rest(i, shown, newest, protocol, &kNothing);
        const Eigen::Vector3d mm = nearest(before.mm, here.mm),
                              turn = nearest(before.turn_rad, here.turn_rad);
        if (mm.norm() < least.mm.norm()) least.mm = mm;
        if (turn.norm() < least.turn_rad.norm()) least.turn_rad = turn;
        before = here;
    }
    return least;
}

}  // namespace seamwright
