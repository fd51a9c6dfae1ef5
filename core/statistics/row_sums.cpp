#include "core/statistics/row_sums.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace seamwright {

void RowSums::go_on(const RowSums& later) {
    if (later.values() == 0) return;
    if (values() > 0) {
        pairs += later.first * last.transpose();
        ranges += std::abs(later.first.y() - last.y());
    }
    join(later);
}

void RowSums::join(const RowSums& other) {
    if (other.values() == 0) return;
    if (values() == 0 || other.first.z() < first.z()) first = other.first;
    if (values() == 0 || other.last.z() >= last.z()) last = other.last;
    own += other.own;
    pairs += other.pairs;
    ranges += other.ranges;
    lowest = std::min(lowest, other.lowest);
    highest = std::max(highest, other.highest);
}

RowSums RowSums::later_by(double days) const {
    RowSums out = *this;
    if (values() == 0) return out;
    Eigen::Matrix3d shift = Eigen::Matrix3d::Identity();
    shift(2, 0) = days;
    out.own = shift * own * shift.transpose();
    out.pairs = shift * pairs * shift.transpose();
    out.first = shift * first;
    out.last = shift * last;
    return out;
}

RowSums row_sums(std::span<const double> days, std::span<const double> values) {
    assert(days.size() == values.size());
    RowSums all;
    for (std::size_t i = 0; i < values.size(); ++i) {
        RowSums one;
        one.first = one.last = {1, values[i], days[i]};
        one.own = one.first * one.first.transpose();
        one.lowest = one.highest = values[i];
        all.go_on(one);
    }
    return all;
}

}  // namespace seamwright
