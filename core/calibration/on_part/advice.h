#pragma once
// What the passes leave open, in words, and the pass that would close it. Private to core/calibration/on_part.

#include "core/calibration/on_part/variances.h"

namespace seamwright::on_part {

// `seen`: covariance in the coordinates of view_of(), mm^2. One sentence a direction whose sigma is beyond
// kOnPartOpen_mm; and whether that is only the latency, which nothing else depends on.
struct Open {
    std::vector<Text> words;
    bool mounting = false, latency = false;
    double weakest_mm = 0;  // sigma
};
Open open_directions(const Eigen::MatrixXd& seen);

// Passes to make next, best first, each after those before it, until nothing is open and the sigma where the edge is
// seen is `enough_mm`, three at most.
std::vector<Text> next_passes(const Data& data, const State& state, const Variances& variances,
                              const Eigen::Vector2d& working_point, double enough_mm);

}  // namespace seamwright::on_part
