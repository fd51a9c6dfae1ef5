#include "core/calibration/problem.h"

#include <ceres/crs_matrix.h>
#include <ceres/solver.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Differences of unknowns (Minus) are for callers of Ceres that measure between two states; no solve asks.
class NoDifference : public ceres::Manifold {
  public:
    bool Minus(const double*, const double*, double*) const override { return false; }
    bool MinusJacobian(const double*, double*) const override { return false; }
};

// d quaternion / d rotation vector. Ceres aborts where a manifold has none, so what is no turn has zeros; the solve
// then refuses the start.
Eigen::Matrix<double, 4, 3> turn_by_tangent(const double* x) {
    const Eigen::Vector3d v(x[3], x[4], x[5]);
    Eigen::Matrix<double, 4, 3> j;
    j.topRows<3>() = 0.5 * (x[6] * Eigen::Matrix3d::Identity() - skew(v));
    j.bottomRows<1>() = -0.5 * v.transpose();
    if (!j.allFinite()) j.setZero();
    return j;
}

class PoseManifold final : public NoDifference {
  public:
    int AmbientSize() const override { return 7; }
    int TangentSize() const override { return 6; }
    bool Plus(const double* x, const double* delta, double* out) const override {
        const Eigen::Vector3d w(delta[3], delta[4], delta[5]);
        const double angle = w.norm();
        constexpr double kNoTurn_rad = 1e-12;  // below, sin(angle / 2) / angle is taken for its limit
        const double half = angle > kNoTurn_rad ? std::sin(0.5 * angle) / angle : 0.5;
        const Eigen::Quaterniond turn(std::cos(0.5 * angle), half * w.x(), half * w.y(), half * w.z());
        for (int i = 0; i < 3; ++i) out[i] = x[i] + delta[i];
        Eigen::Map<Eigen::Quaterniond>(out + 3) = (turn * turn_of(x)).normalized();
        return true;
    }
    bool PlusJacobian(const double* x, double* out) const override {
        Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>> j(out);
        j.setZero();
        j.topLeftCorner<3, 3>().setIdentity();
        j.bottomRightCorner<4, 3>() = turn_by_tangent(x);
        return true;
    }
};

class LinearManifold final : public NoDifference {
  public:
    explicit LinearManifold(const Eigen::MatrixXd& directions) : directions_(directions) {}
    int AmbientSize() const override { return static_cast<int>(directions_.rows()); }
    int TangentSize() const override { return static_cast<int>(directions_.cols()); }
    bool Plus(const double* x, const double* delta, double* out) const override {
        Eigen::Map<Eigen::VectorXd>(out, directions_.rows()) =
            Eigen::Map<const Eigen::VectorXd>(x, directions_.rows()) +
            directions_ * Eigen::Map<const Eigen::VectorXd>(delta, directions_.cols());
        return true;
    }
    bool PlusJacobian(const double*, double* out) const override {
        Eigen::Map<RowMajor>(out, directions_.rows(), directions_.cols()) = directions_;
        return true;
    }

  private:
    Eigen::MatrixXd directions_;
};

// Tangent: two turns of the normal (rad), then the offset. Ceres' own sphere has a tangent of half angles.
class PlaneManifold final : public NoDifference {
  public:
    int AmbientSize() const override { return 4; }
    int TangentSize() const override { return 3; }
    bool Plus(const double* x, const double* delta, double* out) const override {
        const Eigen::Vector3d normal(x[0], x[1], x[2]);
        Eigen::Map<Eigen::Vector3d>{out} =
            (normal + across(normal) * Eigen::Vector2d(delta[0], delta[1])).normalized();
        out[3] = x[3] + delta[2];
        return true;
    }
    bool PlusJacobian(const double* x, double* out) const override {
        Eigen::Map<Eigen::Matrix<double, 4, 3, Eigen::RowMajor>> j(out);
        j.setZero();
        j.topLeftCorner<3, 2>() = across({x[0], x[1], x[2]});
        if (!j.allFinite()) j.setZero();
        j(3, 2) = 1;
        return true;
    }

  private:
    static Eigen::Matrix<double, 3, 2> across(const Eigen::Vector3d& normal) {
        Eigen::Matrix<double, 3, 2> t;
        t.col(0) = normal.unitOrthogonal();
        t.col(1) = normal.cross(t.col(0));
        return t;
    }
};

class GemanMcClure final : public ceres::LossFunction {
  public:
    explicit GemanMcClure(double k) : k_(k) {}
    void Evaluate(double s, double* rho) const override {
        const double share = k_ / (s + k_);
        rho[0] = s * share;
        rho[1] = share * share;
        rho[2] = 0;  // Gauss-Newton of the weighted squares: the true curvature may be negative
    }

  private:
    double k_;
};

// Only Ceres logs by glog here, and what it would say stands in the answer: a person at the robot reads sentences,
// not lines of a library on stderr.
void hush() {
    static const bool once = [] {
        FLAGS_minloglevel = google::GLOG_FATAL;
        return true;
    }();
    static_cast<void>(once);
}

// Row-compressed derivatives by the tangents of `unknowns`, in this order.
bool evaluate(ceres::Problem& problem, const std::vector<double*>& unknowns, std::vector<double>& residuals,
              ceres::CRSMatrix& jacobian) {
    hush();
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks = unknowns;
    double cost = 0;
    return problem.Evaluate(options, &cost, &residuals, nullptr, &jacobian) && std::isfinite(cost);
}

Eigen::Index tangents(const ceres::Problem& problem, const std::vector<double*>& unknowns) {
    Eigen::Index sum = 0;
    for (const double* u : unknowns)
        if (!problem.IsParameterBlockConstant(u)) sum += problem.ParameterBlockTangentSize(u);
    return sum;
}

}  // namespace

PoseBlock block_of(const Pose& pose) {
    PoseBlock block;
    block << pose.translation(), Eigen::Quaterniond(pose.linear()).normalized().coeffs();
    return block;
}

Pose pose_of(const PoseBlock& block) {
    return make_pose(turn_of(block.data()).toRotationMatrix(), block.head<3>());
}

Eigen::Matrix<double, 3, 4> tangent_by_turn(const double* block) {
    return 4 * turn_by_tangent(block).transpose();  // its columns are orthogonal, of length 1/2
}

ceres::Manifold* pose_manifold() {
    return new PoseManifold;
}
ceres::Manifold* linear_manifold(const Eigen::MatrixXd& directions) {
    return new LinearManifold(directions);
}
ceres::Manifold* plane_manifold() {
    return new PlaneManifold;
}
ceres::LossFunction* geman_mcclure(double k) {
    return new GemanMcClure(k);
}

Solved solve(ceres::Problem& problem, const std::vector<double*>& views, int most_iterations,
             double tolerance) {
    hush();
    std::vector<double*> known;
    std::copy_if(views.begin(), views.end(), std::back_inserter(known),
                 [&](const double* v) { return problem.HasParameterBlock(v); });
    std::vector<double*> all;
    problem.GetParameterBlocks(&all);
    const auto free = std::count_if(all.begin(), all.end(),
                                    [&](const double* p) { return !problem.IsParameterBlockConstant(p); });
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    if (!known.empty() && free > static_cast<std::ptrdiff_t>(known.size())) {
        options.linear_solver_type = ceres::DENSE_SCHUR;
        options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
        for (double* p : all)
            options.linear_solver_ordering->AddElementToGroup(
                p, std::find(known.begin(), known.end(), p) != known.end() ? 0 : 1);
    }
    options.max_num_iterations = most_iterations;
    options.function_tolerance = tolerance;
    // Relative step, and gradient, that end it besides `tolerance`.
    constexpr double kLeastStep = 1e-13, kLeastGradient = 1e-16;
    options.parameter_tolerance = kLeastStep;
    options.gradient_tolerance = kLeastGradient;
    options.max_num_consecutive_invalid_steps = 20;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    const bool usable = summary.IsSolutionUsable() && std::isfinite(summary.final_cost);
    return {summary.termination_type == ceres::CONVERGENCE && usable,
            usable ? 2 * summary.final_cost : kInfinity};
}

bool linearise(ceres::Problem& problem, const std::vector<double*>& unknowns, Eigen::VectorXd& residuals,
               Eigen::MatrixXd& jacobian) {
    std::vector<double> r;
    ceres::CRSMatrix j;
    if (!evaluate(problem, unknowns, r, j)) return false;
    residuals = Eigen::Map<const Eigen::VectorXd>(r.data(), static_cast<Eigen::Index>(r.size()));
    jacobian.setZero(j.num_rows, j.num_cols);
    for (int row = 0; row < j.num_rows; ++row)
        for (int k = j.rows[static_cast<std::size_t>(row)]; k < j.rows[static_cast<std::size_t>(row) + 1];
             ++k)
            jacobian(row, j.cols[static_cast<std::size_t>(k)]) = j.values[static_cast<std::size_t>(k)];
    return true;
}

NormalBlocks normal_blocks(ceres::Problem& problem, const std::vector<double*>& shared,
                           const std::vector<double*>& views) {
    const Eigen::Index g = tangents(problem, shared);
    NormalBlocks normal;
    normal.gg.setZero(g, g);
    normal.gv.assign(views.size(), Eigen::MatrixXd::Zero(g, 6));
    normal.vv.assign(views.size(), Matrix6::Identity());
    std::vector<double*> unknowns;
    for (double* s : shared)
        if (!problem.IsParameterBlockConstant(s)) unknowns.push_back(s);
    std::vector<std::size_t> known;
    for (std::size_t i = 0; i < views.size(); ++i)
        if (problem.HasParameterBlock(views[i])) {
            known.push_back(i);
            unknowns.push_back(views[i]);
            normal.vv[i].setZero();
        }
    std::vector<double> residuals;
    ceres::CRSMatrix j;
    if (!evaluate(problem, unknowns, residuals, j)) return normal;
    Eigen::VectorXd by_shared(g);
    Vector6 by_view;
    for (std::size_t row = 0; row + 1 < j.rows.size(); ++row) {
        by_shared.setZero();
        by_view.setZero();
        Eigen::Index view = -1;
        for (auto k = static_cast<std::size_t>(j.rows[row]); k < static_cast<std::size_t>(j.rows[row + 1]);
             ++k) {
            const Eigen::Index column = j.cols[k] - g;
            if (column < 0) {
                by_shared(j.cols[k]) = j.values[k];
            } else {
                view = column / 6;
                by_view(column % 6) = j.values[k];
            }
        }
        normal.gg.selfadjointView<Eigen::Lower>().rankUpdate(by_shared);
        if (view < 0) continue;
        const std::size_t i = known[static_cast<std::size_t>(view)];
        normal.gv[i].noalias() += by_shared * by_view.transpose();
        normal.vv[i].noalias() += by_view * by_view.transpose();
    }
    normal.gg = Eigen::MatrixXd(normal.gg.selfadjointView<Eigen::Lower>());
    return normal;
}

}  // namespace seamwright
