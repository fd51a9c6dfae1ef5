#include "core/calibration/camera/block_solver.h"

#include "core/geometry/decompositions.h"

namespace seamwright {
namespace {

Matrix6 damped(const Matrix6& m, double damping) {
    Matrix6 d = m;
    d.diagonal() += damping * m.diagonal();
    for (int i = 0; i < 6; ++i)
        if (d(i, i) <= 0) d(i, i) = 1;
    return d;
}

}  // namespace

bool solve_blocks(const BlockNormal& normal, double damping, Eigen::VectorXd& step,
                  std::vector<Vector6>& view_steps) {
    const Eigen::Index shared = normal.gg.rows();
    Eigen::MatrixXd schur = normal.gg;
    schur.diagonal() += damping * normal.gg.diagonal();
    for (Eigen::Index i = 0; i < shared; ++i)
        if (schur(i, i) <= 0) schur(i, i) = 1;
    Eigen::VectorXd rhs = -normal.g;
    std::vector<Eigen::MatrixXd> by_shared(normal.vv.size());  // what a shared step does to the view
    std::vector<Vector6> alone(normal.vv.size());
    for (std::size_t k = 0; k < normal.vv.size(); ++k) {
        Eigen::MatrixXd right(6, shared + 1);
        right.leftCols(shared) = normal.gv[k].transpose();
        right.col(shared) = normal.v[k];
        const auto solved = solve_positive(damped(normal.vv[k], damping), right);
        if (!solved) return false;
        by_shared[k] = solved->leftCols(shared);
        alone[k] = solved->col(shared);
        schur.noalias() -= normal.gv[k] * by_shared[k];
        rhs.noalias() += normal.gv[k] * alone[k];
    }
    step.setZero(shared);
    if (shared > 0) {
        const auto solved = solve_positive(schur, rhs);
        if (!solved || !solved->allFinite()) return false;
        step = *solved;
    }
    view_steps.resize(normal.vv.size());
    for (std::size_t k = 0; k < normal.vv.size(); ++k) {
        view_steps[k] = -alone[k];
        view_steps[k].noalias() -= by_shared[k] * step;
        if (!view_steps[k].allFinite()) return false;
    }
    return true;
}

Eigen::MatrixXd shared_covariance(const BlockNormal& normal, double* condition) {
    if (condition) *condition = 0;
    Eigen::MatrixXd schur = normal.gg;
    for (std::size_t k = 0; k < normal.vv.size(); ++k) {
        const auto solved = solve_positive(normal.vv[k], normal.gv[k].transpose());
        if (!solved) return {};
        schur.noalias() -= normal.gv[k] * *solved;
    }
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < schur.rows(); ++i)
        if (normal.gg(i, i) > 0) free.push_back(i);
    const auto n = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd scaled(n, n);
    Eigen::VectorXd scale(n);
    for (Eigen::Index i = 0; i < n; ++i) scale(i) = 1 / std::sqrt(normal.gg(free[i], free[i]));
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j) scaled(i, j) = schur(free[i], free[j]) * scale(i) * scale(j);
    if (n == 0) return {};
    const SymmetricEigen eigen = symmetric_eigen(scaled);
    if (!eigen.converged) return {};
    const double smallest = eigen.values(0);
    if (condition) *condition = smallest;
    if (!(smallest > 1e-14)) return {};
    const Eigen::MatrixXd inverse =
        eigen.vectors * eigen.values.cwiseInverse().asDiagonal() * eigen.vectors.transpose();
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(schur.rows(), schur.rows());
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j)
            covariance(free[i], free[j]) = inverse(i, j) * scale(i) * scale(j);
    return covariance;
}

Matrix6 view_covariance(const BlockNormal& normal, const Eigen::MatrixXd& shared, std::size_t view) {
    const Matrix6 inverse = inverse_matrix(normal.vv[view]);
    const Eigen::MatrixXd t = inverse * normal.gv[view].transpose();
    return inverse + t * shared * t.transpose();
}

}  // namespace seamwright
