#include "core/calibration/normal_blocks.h"

#include <cmath>

#include "core/geometry/decompositions.h"

namespace seamwright {

Eigen::MatrixXd shared_covariance(const NormalBlocks& normal) {
    Eigen::MatrixXd schur = normal.gg;
    for (std::size_t k = 0; k < normal.vv.size(); ++k) {
        const auto solved = solve_positive(normal.vv[k], normal.gv[k].transpose());
        if (!solved) return {};
        schur.noalias() -= normal.gv[k] * *solved;
    }
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < schur.rows(); ++i)
        if (normal.gg(i, i) > 0) free.push_back(i);
    if (free.empty()) return {};
    const Eigen::VectorXd scale = normal.gg.diagonal()(free).cwiseSqrt().cwiseInverse();
    const SymmetricEigen eigen =
        symmetric_eigen(scale.asDiagonal() * Eigen::MatrixXd(schur(free, free)) * scale.asDiagonal());
    constexpr double kSingular = 1e-14;  // of the information scaled to unit diagonal
    if (!eigen.converged || !(eigen.values(0) > kSingular)) return {};
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(schur.rows(), schur.rows());
    covariance(free, free) = scale.asDiagonal() * eigen.vectors * eigen.values.cwiseInverse().asDiagonal() *
                             eigen.vectors.transpose() * scale.asDiagonal();
    return covariance;
}

Matrix6 view_covariance(const NormalBlocks& normal, const Eigen::MatrixXd& shared, std::size_t view) {
    const Matrix6 inverse = inverse_matrix(normal.vv[view]);
    const Eigen::MatrixXd t = inverse * normal.gv[view].transpose();
    return inverse + t * shared * t.transpose();
}

}  // namespace seamwright
