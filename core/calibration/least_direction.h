#pragma once
// The direction that a symmetric positive semi-definite matrix maps to least: the answer of every DLT.

#include <Eigen/Core>

namespace seamwright {

// `vector` has length 1, empty when the solver does not converge; `second_share` is the second smallest
// eigenvalue over the largest: near 0 when more than one direction is as good. Reads the lower triangle.
// Compiled once for all sizes: unrolled for 12 x 12, Eigen's solver takes the compiler a minute.
struct LeastDirection {
    Eigen::VectorXd vector;
    double second_share = 0;
};
LeastDirection least_direction(const Eigen::MatrixXd& symmetric);

}  // namespace seamwright
