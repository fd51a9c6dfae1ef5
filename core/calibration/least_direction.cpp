#include "core/calibration/least_direction.h"

#include <Eigen/Eigenvalues>

namespace seamwright {

LeastDirection least_direction(const Eigen::MatrixXd& symmetric) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric);
    if (eigen.info() != Eigen::Success || symmetric.rows() < 2) return {};
    const auto& values = eigen.eigenvalues();
    return {eigen.eigenvectors().col(0), values(1) / values(values.size() - 1)};
}

}  // namespace seamwright
