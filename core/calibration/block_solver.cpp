#include "core/calibration/block_solver.h"

#include <Eigen/Eigenvalues>

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
    std::vector<Eigen::LLT<Matrix6>> factors(normal.vv.size());
    for (std::size_t k = 0; k < normal.vv.size(); ++k) {
        factors[k].compute(damped(normal.vv[k], damping));
        if (factors[k].info() != Eigen::Success) return false;
        const Eigen::MatrixXd t = factors[k].solve(normal.gv[k].transpose());
        schur.noalias() -= normal.gv[k] * t;
        rhs.noalias() += t.transpose() * normal.v[k];
    }
    step.setZero(shared);
    if (shared > 0) {
        const Eigen::LLT<Eigen::MatrixXd> llt(schur);
        if (llt.info() != Eigen::Success) return false;
        step = llt.solve(rhs);
        if (!step.allFinite()) return false;
    }
    view_steps.resize(normal.vv.size());
    for (std::size_t k = 0; k < normal.vv.size(); ++k) {
        view_steps[k] = factors[k].solve(-normal.v[k] - normal.gv[k].transpose() * step);
        if (!view_steps[k].allFinite()) return false;
    }
    return true;
}

Eigen::MatrixXd shared_covariance(const BlockNormal& normal, double* condition) {
    if (condition) *condition = 0;
    Eigen::MatrixXd schur = normal.gg;
    for (std::size_t k = 0; k < normal.vv.size(); ++k) {
        const Eigen::LLT<Matrix6> llt(normal.vv[k]);
        if (llt.info() != Eigen::Success) return {};
        schur.noalias() -= normal.gv[k] * llt.solve(normal.gv[k].transpose());
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
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
    if (eigen.info() != Eigen::Success || n == 0) return {};
    const double smallest = eigen.eigenvalues()(0);
    if (condition) *condition = smallest;
    if (!(smallest > 1e-14)) return {};
    const Eigen::MatrixXd inverse = eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() *
                                    eigen.eigenvectors().transpose();
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(schur.rows(), schur.rows());
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j)
            covariance(free[i], free[j]) = inverse(i, j) * scale(i) * scale(j);
    return covariance;
}

Matrix6 view_covariance(const BlockNormal& normal, const Eigen::MatrixXd& shared, std::size_t view) {
    const Matrix6 inverse = normal.vv[view].inverse();
    const Eigen::MatrixXd t = inverse * normal.gv[view].transpose();
    return inverse + t * shared * t.transpose();
}

}  // namespace seamwright
