#include "core/geometry/decompositions.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace seamwright {

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& symmetric) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric);
    return {eigen.eigenvalues(), eigen.eigenvectors(), eigen.info() == Eigen::Success};
}

SingularValues singular_values(const Eigen::MatrixXd& m) {
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(m, Eigen::ComputeThinU | Eigen::ComputeFullV);
    return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

LeastSquares least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> qr(a);
    return {qr.solve(b), qr.rank()};
}

Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return a.ldlt().solve(b);
}

std::optional<Eigen::MatrixXd> solve_positive(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    const Eigen::LLT<Eigen::MatrixXd> llt(a);
    if (llt.info() != Eigen::Success) return std::nullopt;
    return llt.solve(b);
}

Eigen::MatrixXd inverse_matrix(const Eigen::MatrixXd& m) {
    return m.inverse();
}

}  // namespace seamwright
