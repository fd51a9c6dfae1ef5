#pragma once
// Levenberg-Marquardt for problems with a few shared unknowns and six unknowns per view: cameras and their
// plate poses, camera, laser plane and plate poses. The views are eliminated (Schur complement), so a step
// costs the views once and one system of the shared unknowns (B.2.2 in block form).

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "core/geometry/pose.h"

namespace seamwright {

// Normal equations sum J^T J, sum J^T r with shared unknowns g and the tangent of each view's pose v.
struct BlockNormal {
    Eigen::MatrixXd gg;               // [G, G]
    Eigen::VectorXd g;                // [G] gradient J^T r
    std::vector<Eigen::MatrixXd> gv;  // per view [G, 6]
    std::vector<Matrix6> vv;          // per view
    std::vector<Vector6> v;           // per view gradient
    double cost = 0;                  // sum of squares of all residuals, priors included
    void reset(Eigen::Index shared, std::size_t views) {
        gg.setZero(shared, shared);
        g.setZero(shared);
        gv.resize(views);
        for (auto& m : gv) m.setZero(shared, 6);
        vv.assign(views, Matrix6::Zero());
        v.assign(views, Vector6::Zero());
        cost = 0;
    }
};

// Step of the shared unknowns and of each view; false when the damped system is not positive definite.
bool solve_blocks(const BlockNormal& normal, double damping, Eigen::VectorXd& step,
                  std::vector<Vector6>& view_steps);

// Inverse of the Schur complement: covariance of the shared unknowns for unit residual variance. Computed by
// eigenvalues of the complement scaled to unit diagonal; `condition` is their smallest (1 = orthogonal, 0 =
// singular). Unknowns with a zero diagonal (held fixed) get zero rows. Empty when singular to rounding.
Eigen::MatrixXd shared_covariance(const BlockNormal& normal, double* condition = nullptr);

// Covariance of one view's pose for unit residual variance, the shared unknowns' covariance included.
Matrix6 view_covariance(const BlockNormal& normal, const Eigen::MatrixXd& shared, std::size_t view);

// `State` is copied per trial. evaluate(state, normal or nullptr) returns the cost (infinity where the state
// is impossible) and fills the normal equations; apply(state, step, view_steps) moves it. Converged when the
// predicted relative gain is below `tolerance` or the steps vanish. Returns whether it converged; the state
// is the best seen.
template <class State, class Evaluate, class Apply>
bool minimise_blocks(State& state, BlockNormal& normal, const Evaluate& evaluate, const Apply& apply,
                     int max_iterations = 60, double tolerance = 1e-10) {
    double cost = evaluate(state, &normal);
    if (!std::isfinite(cost)) return false;
    double damping = 1e-4;
    Eigen::VectorXd step;
    std::vector<Vector6> view_steps;
    for (int iteration = 0; iteration < max_iterations; ++iteration) {
        bool better = false;
        for (int attempt = 0; attempt < 12 && !better; ++attempt) {
            if (!solve_blocks(normal, damping, step, view_steps)) {
                damping = damping * 10 + 1e-9;
                continue;
            }
            State trial = state;
            apply(trial, step, view_steps);
            const double trial_cost = evaluate(trial, nullptr);
            if (std::isfinite(trial_cost) && trial_cost <= cost) {
                better = true;
                const double gain = cost - trial_cost;
                state = std::move(trial);
                cost = evaluate(state, &normal);
                damping *= 0.1;
                if (damping < 1e-12) damping = 1e-12;
                if (gain <= tolerance * cost + 1e-26) return true;
            } else {
                damping = damping < 1e-6 ? 1e-5 : damping * 8;
            }
        }
        if (!better) return damping < 1e12;  // no descent left: at the minimum to rounding
    }
    return false;
}

}  // namespace seamwright
