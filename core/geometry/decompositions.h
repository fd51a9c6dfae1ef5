#pragma once
// Decompositions of run-time size, each compiled once for the whole house: instantiated where they are used,
// Eigen's cost the compiler 3 to 10 s per source and size, unrolled for 12 x 12 a minute. They allocate;
// loops that must not, and sizes up to 3, use Eigen's own (eigenvalues of 2 x 2 by computeDirect).

#include <Eigen/Core>
#include <optional>

namespace seamwright {

// Eigenvalues, smallest first, and unit eigenvectors as columns. Reads the lower triangle.
struct SymmetricEigen {
    Eigen::VectorXd values;
    Eigen::MatrixXd vectors;
    bool converged = false;
};
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& symmetric);

// m = u diag(values) v^T, largest value first; u has as many columns as there are values, v is square.
struct SingularValues {
    Eigen::MatrixXd u;
    Eigen::VectorXd values;
    Eigen::MatrixXd v;
};
SingularValues singular_values(const Eigen::MatrixXd& m);

// a x = b in least squares, of all such x the shortest, and the rank of a to rounding.
struct LeastSquares {
    Eigen::MatrixXd x;
    Eigen::Index rank = 0;
};
LeastSquares least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// a^-1 b for a symmetric a that is positive to rounding (LDL^T; reads the lower triangle).
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
// The same by L L^T: nullopt when a is not positive definite.
std::optional<Eigen::MatrixXd> solve_positive(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
// By LU; not finite when m is singular.
Eigen::MatrixXd inverse_matrix(const Eigen::MatrixXd& m);

}  // namespace seamwright
