#pragma once
// What mean, scatter, capability, correlation and trend need of a row of values, without the values: sums that whoever holds
// the values adds up (a database, a day at a time), and that rows are put together from.
//
// With u_i = (1, x_i, t_i), value and time of the i-th in the order of time:
//     own = sum u_i u_i^T,    pairs = sum u_i u_(i-1)^T over neighbours,    ranges = sum |x_i - x_(i-1)|
// so that of every w the sum of squares of w^T u is w^T own w and that of its neighbours' products is w^T pairs w: with
// w = (-mean, 1, 0) what lag-1 correlation takes, with w = (-level, 1, -slope) that of a line's residuals.
// Rounding: sums of squares about 0, so the scatter has an error of about 1e-16 (mean / s)^2 of itself, and the slope one of
// 1e-16 (day / span)^2: days count from near the values, not from 1970.

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "core/numbers.h"

namespace seamwright {

struct RowSums {
    Eigen::Matrix3d own = Eigen::Matrix3d::Zero(), pairs = Eigen::Matrix3d::Zero();
    double ranges = 0;
    double lowest = kInfinity, highest = -kInfinity;
    Eigen::Vector3d first = Eigen::Vector3d::Zero(),
                    last = Eigen::Vector3d::Zero();  // u of the ends; 0: none

    std::int64_t values() const { return static_cast<std::int64_t>(own(0, 0)); }
    std::int64_t neighbours() const { return static_cast<std::int64_t>(pairs(0, 0)); }
    double mean() const { return own(0, 1) / own(0, 0); }
    // sum (w^T u)^2, and of neighbours.
    double squares(const Eigen::Vector3d& w) const { return w.dot(own * w); }
    double products(const Eigen::Vector3d& w) const { return w.dot(pairs * w); }

    // The row goes on with `later`: its first value is a neighbour of the last one here.
    void go_on(const RowSums& later);
    // The same with times of another origin, which lies so many days earlier.
    RowSums later_by(double days) const;
    // Values of another row, which has no neighbours here.
    void join(const RowSums& other);
};

// Precondition: as many days as values; days of any origin.
RowSums row_sums(std::span<const double> days, std::span<const double> values);

}  // namespace seamwright
