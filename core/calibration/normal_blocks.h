#pragma once
// Normal matrix of a problem with a few shared unknowns and one pose per view, and the covariances it holds
// (B.2.2 in block form).

#include <Eigen/Core>
#include <vector>

#include "core/geometry/pose.h"

namespace seamwright {

struct NormalBlocks {
    Eigen::MatrixXd gg;               // J^T J of the shared unknowns' tangents
    std::vector<Eigen::MatrixXd> gv;  // per view [shared, 6]
    std::vector<Matrix6> vv;          // per view
};

// Inverse of the Schur complement: covariance of the shared unknowns for unit residual variance. Computed by
// eigenvalues of the complement scaled to unit diagonal. Unknowns with a zero diagonal (held fixed) get zero rows.
// Empty when singular to rounding.
Eigen::MatrixXd shared_covariance(const NormalBlocks& normal);

// Covariance of one view's pose for unit residual variance, the shared unknowns' covariance included.
Matrix6 view_covariance(const NormalBlocks& normal, const Eigen::MatrixXd& shared, std::size_t view);

}  // namespace seamwright
