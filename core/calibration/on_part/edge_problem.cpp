#include "core/calibration/on_part/edge_problem.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/cost_function.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/calibration/problem.h"
#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright::on_part {
namespace {

// Eigenvalues that a covariance has at least: scaled to unit diagonal, and of a profile's point.
constexpr double kLeastScaled = 1e-12, kLeastAcross_mm2 = 1e-10;
constexpr double kAlongEdge = 0.01;    // of its sigma: no point is known better across its edge
constexpr double kCostSettled = 1e-9;  // relative gain that ends a solution
constexpr double kIdle_s =
    0.1;  // a latency that nothing shows stays about where it began, and does not drift

// Whitening matrices of covariances: their inverses' roots.
Matrix6 root_of_inverse(const Matrix6& covariance) {
    const Vector6 scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
    const SymmetricEigen eigen = symmetric_eigen(scale.asDiagonal() * covariance * scale.asDiagonal());
    return eigen.values.cwiseMax(kLeastScaled).cwiseSqrt().cwiseInverse().asDiagonal() *
           eigen.vectors.transpose() * scale.asDiagonal();
}
Eigen::Matrix2d root_of_inverse2(const Eigen::Matrix2d& covariance) {
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
    eigen.computeDirect(covariance);
    return eigen.eigenvalues().cwiseMax(kLeastAcross_mm2).cwiseSqrt().cwiseInverse().asDiagonal() *
           eigen.eigenvectors().transpose();
}

// One profile. Blocks: H, pass, coefficients of its edge, latency. Derivatives by hand: thousands of solves from all
// sides take as long as they do.
class Profile final : public ceres::CostFunction {
  public:
    Profile(const Data& data, const Sight& sight, const State& at, double white)
        : pose_(data.motions[sight.pass].at(sight.time_s - at.latency_s)),
          twist_(data.motions[sight.pass].twist(sight.time_s - at.latency_s)),
          latency_(at.latency_s),
          point_(in_sensor(sight.point)),
          edge_(at.edges[sight.edge]) {
        const Eigen::Vector3d p = pose_ * (at.mounting * point_);
        const Eigen::Matrix<double, 2, 3> by_sensor =
            by_base(seamwright::on_part::at(edge_, along(p)).slope) * pose_.linear() * at.mounting.linear();
        Eigen::Matrix2d a;
        a << by_sensor.col(0), by_sensor.col(2);
        // Where the plane runs along the edge its point is not known along it: not a whole sigma less than isotropic.
        const Eigen::Matrix2d covariance = a * sight.covariance * a.transpose();
        const double floor = kAlongEdge * sight.covariance.trace();
        white_ = root_of_inverse2(covariance + floor * kAlongEdge * Eigen::Matrix2d::Identity()) / white;
        set_num_residuals(2);
        *mutable_parameter_block_sizes() = {7, 7, static_cast<int>(edge_.coefficients.size()), 1};
    }

    bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
        const double *h = blocks[0], *x = blocks[1];
        const Eigen::Map<const Eigen::VectorXd> c(blocks[2], edge_.coefficients.size());
        const Eigen::Vector3d turned = turn_of(h) * point_, in_flange = turned + shift_of(h);
        const Eigen::Vector3d moved = turn_of(x) * in_flange, flange = moved + shift_of(x);
        const double late = *blocks[3] - latency_;
        const Eigen::Vector3d velocity = twist_.head<3>() + twist_.tail<3>().cross(flange);
        const Eigen::Vector3d base = pose_ * (flange - late * velocity);
        const Eigen::Vector3d local = edge_.axes.transpose() * (base - edge_.origin);
        if (!local.allFinite()) return false;
        const SplineAt b = spline_at(edge_, local.x());
        const int n = edge_.per_axis();
        Eigen::Vector2d r = local.tail<2>(), slope = Eigen::Vector2d::Zero();
        for (int axis = 0; axis < 2; ++axis)
            for (int j = 0; j < 4; ++j) {
                r(axis) -= c(axis * n + b.first + j) * b.value[static_cast<std::size_t>(j)];
                slope(axis) += c(axis * n + b.first + j) * b.slope[static_cast<std::size_t>(j)];
            }
        Eigen::Map<Eigen::Vector2d>{residuals} = white_ * r;
        if (!jacobians) return true;
        using Row7 = Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>>;
        const Eigen::Matrix<double, 2, 3> by_flange_point =
            white_ * by_base(slope) * pose_.linear() *
            (Eigen::Matrix3d::Identity() - late * skew(twist_.tail<3>()));
        if (jacobians[0]) {
            Row7 j(jacobians[0]);
            const Eigen::Matrix<double, 2, 3> by_h = by_flange_point * turn_of(x).toRotationMatrix();
            j.leftCols<3>() = by_h;
            j.rightCols<4>() = -by_h * skew(turned) * tangent_by_turn(h);
        }
        if (jacobians[1]) {
            Row7 j(jacobians[1]);
            j.leftCols<3>() = by_flange_point;
            j.rightCols<4>() = -by_flange_point * skew(moved) * tangent_by_turn(x);
        }
        if (jacobians[2]) {
            Eigen::Map<Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>> j(jacobians[2], 2,
                                                                                    c.size());
            j.setZero();
            for (int axis = 0; axis < 2; ++axis)
                for (int k = 0; k < 4; ++k)
                    j.col(axis * n + b.first + k) = -white_.col(axis) * b.value[static_cast<std::size_t>(k)];
        }
        if (jacobians[3])
            Eigen::Map<Eigen::Vector2d>{jacobians[3]} = -white_ * by_base(slope) * pose_.linear() * velocity;
        return true;
    }

  private:
    double along(const Eigen::Vector3d& base) const { return edge_.axes.col(0).dot(base - edge_.origin); }
    Eigen::Matrix<double, 2, 3> by_base(const Eigen::Vector2d& slope) const {
        return edge_.axes.rightCols<2>().transpose() - slope * edge_.axes.col(0).transpose();
    }

    Pose pose_;
    Vector6 twist_;
    double latency_;
    Eigen::Vector3d point_;
    EdgeCurve edge_;  // its coefficients are the block's
    Eigen::Matrix2d white_;
};

struct NearPose {
    Pose mean;
    Matrix6 root;
    template <class T>
    bool operator()(const T* pose, T* residual) const {
        Eigen::Matrix<T, 6, 1> d;
        d << shift_of(pose) - mean.translation().cast<T>(),
            rotation_vector(Eigen::Quaternion<T>(turn_of(pose) *
                                                 Eigen::Quaterniond(mean.linear()).conjugate().cast<T>()));
        Eigen::Map<Eigen::Matrix<T, 6, 1>>{residual} = root.cast<T>() * d;
        return true;
    }
};
ceres::CostFunction* near_pose(const Pose& mean, const Matrix6& covariance) {
    return new ceres::AutoDiffCostFunction<NearPose, 6, 7>(new NearPose{mean, root_of_inverse(covariance)});
}

struct NearLatency {
    double mean_s;
    template <class T>
    bool operator()(const T* latency, T* residual) const {
        *residual = (*latency - mean_s) / kIdle_s;
        return true;
    }
};

// Curvatures of both axes.
class Straightness final : public ceres::CostFunction {
  public:
    Straightness(const EdgeCurve& edge, double curvature) : rows_(curvature_rows(edge) / curvature) {
        set_num_residuals(2 * static_cast<int>(rows_.rows()));
        *mutable_parameter_block_sizes() = {2 * static_cast<int>(rows_.cols())};
    }
    bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
        const Eigen::Index m = rows_.rows(), n = rows_.cols();
        for (Eigen::Index axis = 0; axis < 2; ++axis)
            Eigen::Map<Eigen::VectorXd>(residuals + axis * m, m) =
                rows_ * Eigen::Map<const Eigen::VectorXd>(blocks[0] + axis * n, n);
        if (jacobians && jacobians[0]) {
            Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> j(
                jacobians[0], 2 * m, 2 * n);
            j.setZero();
            j.topLeftCorner(m, n) = rows_;
            j.bottomRightCorner(m, n) = rows_;
        }
        return true;
    }

  private:
    Eigen::MatrixXd rows_;
};

// The unknowns as Ceres holds them, and the problem on them.
struct Unknowns {
    PoseBlock mounting;
    double latency;
    std::vector<Eigen::VectorXd> edges;
    std::vector<PoseBlock> passes;
    ceres::Problem problem;

    Unknowns(const Data& data, const Variances& variances, const SolveOptions& options, bool priors,
             const State& state)
        : mounting(block_of(state.mounting)), latency(state.latency_s) {
        for (const EdgeCurve& e : state.edges) edges.push_back(e.coefficients);
        for (const Vector6& p : state.passes)
            passes.push_back(block_of(make_pose(rotation_exp(p.tail<3>()), p.head<3>())));
        std::vector<bool> known(passes.size());
        problem.AddParameterBlock(mounting.data(), 7, pose_manifold());
        problem.AddParameterBlock(&latency, 1);
        if (!data.latency_free) problem.SetParameterBlockConstant(&latency);
        for (const Sight& s : data.sights) {
            if (!s.used) continue;
            if (!known[s.pass]) {
                problem.AddParameterBlock(passes[s.pass].data(), 7, pose_manifold());
                if (!options.passes) problem.SetParameterBlockConstant(passes[s.pass].data());
                known[s.pass] = true;
            }
            problem.AddResidualBlock(new Profile(data, s, state, variances.white),
                                     options.robust_mm > 0
                                         ? new ceres::HuberLoss(options.robust_mm / variances.white /
                                                                std::sqrt(0.5 * s.covariance.trace()))
                                         : nullptr,
                                     mounting.data(), passes[s.pass].data(), edges[s.edge].data(), &latency);
        }
        if (!priors) {  // an edge that nobody sees has its columns too
            for (Eigen::VectorXd& e : edges) problem.AddParameterBlock(e.data(), static_cast<int>(e.size()));
            return;
        }
        Matrix6 covariance = Matrix6::Zero();
        covariance.diagonal() << Eigen::Vector3d::Constant(variances.pass_mm * variances.pass_mm),
            Eigen::Vector3d::Constant(variances.pass_rad * variances.pass_rad);
        for (std::size_t p = 0; p < passes.size(); ++p)
            if (known[p] && options.passes) {
                problem.AddResidualBlock(near_pose(Pose::Identity(), covariance), nullptr, passes[p].data());
            }
        for (std::size_t e = 0; e < edges.size(); ++e)
            if (problem.HasParameterBlock(edges[e].data()))
                problem.AddResidualBlock(new Straightness(state.edges[e], variances.curvature[e]), nullptr,
                                         edges[e].data());
        if (data.latency_free)
            problem.AddResidualBlock(
                new ceres::AutoDiffCostFunction<NearLatency, 1, 1>(new NearLatency{data.latency_s}), nullptr,
                &latency);
        if (data.prior)
            problem.AddResidualBlock(near_pose(data.prior->flange_from_sensor, data.prior->covariance),
                                     nullptr, mounting.data());
    }

    void into(State& state) const {
        state.mounting = pose_of(mounting);
        state.latency_s = latency;
        for (std::size_t e = 0; e < edges.size(); ++e) state.edges[e].coefficients = edges[e];
        for (std::size_t p = 0; p < passes.size(); ++p) {
            const Pose pose = pose_of(passes[p]);
            state.passes[p] << pose.translation(), rotation_log(pose.linear());
        }
    }
};

}  // namespace

Eigen::Vector3d in_sensor(const Eigen::Vector2d& point) {
    return {point.x(), 0, point.y()};
}

Eigen::Vector3d in_base(const Data& data, const State& state, const Sight& sight) {
    return data.motions[sight.pass].at(sight.time_s - state.latency_s) *
           (state.mounting * in_sensor(sight.point));
}

Eigen::Vector2d distance(const Data& data, const State& state, const Sight& sight) {
    const EdgeCurve& edge = state.edges[sight.edge];
    const Eigen::Vector3d local = edge.axes.transpose() * (in_base(data, state, sight) - edge.origin);
    return local.tail<2>() - at(edge, local.x()).across;
}

double solve_state(const Data& data, const Variances& variances, const SolveOptions& options, State& state) {
    Unknowns unknowns(data, variances, options, true, state);
    std::vector<double*> views;
    if (options.passes)
        for (PoseBlock& p : unknowns.passes) views.push_back(p.data());
    const Solved solved = solve(unknowns.problem, views, options.most_iterations, kCostSettled);
    if (!std::isfinite(solved.cost)) return kInfinity;
    unknowns.into(state);
    return solved.cost;
}

Blocks linearised(const Data& data, const Variances& variances, const State& state) {
    Blocks b;
    Unknowns unknowns(data, variances, {}, false, state);
    b.wanted = data.latency_free ? 7 : 6;
    std::vector<double*> list{unknowns.mounting.data()};
    if (data.latency_free) list.push_back(&unknowns.latency);
    b.shared = b.wanted;
    std::vector<Eigen::Index> at_pass(unknowns.passes.size(), -1);
    for (Eigen::VectorXd& e : unknowns.edges) {
        list.push_back(e.data());
        b.shared += e.size();
    }
    Eigen::Index column = b.shared;
    for (std::size_t p = 0; p < unknowns.passes.size(); ++p) {
        if (!unknowns.problem.HasParameterBlock(unknowns.passes[p].data())) continue;
        list.push_back(unknowns.passes[p].data());
        at_pass[p] = column;
        column += 6;
    }
    if (!linearise(unknowns.problem, list, b.residuals, b.jacobian)) return b;
    for (std::size_t i = 0; i < data.sights.size(); ++i)
        if (data.sights[i].used) b.sight_of.push_back(i);
    const std::size_t n = unknowns.passes.size();
    const Eigen::MatrixXd shared = b.jacobian.leftCols(b.shared);
    b.ss = shared.transpose() * shared;
    b.sr = shared.transpose() * b.residuals;
    b.rr = b.residuals.squaredNorm();
    b.sp.assign(n, Eigen::MatrixXd::Zero(b.shared, 6));
    b.pp.assign(n, Matrix6::Zero());
    b.pr.assign(n, Vector6::Zero());
    b.rows.assign(n, 0);
    for (std::size_t k = 0; k < b.sight_of.size(); ++k) {
        const std::size_t p = data.sights[b.sight_of[k]].pass;
        const auto row = static_cast<Eigen::Index>(2 * k);
        const Eigen::Matrix<double, 2, 6> own = b.jacobian.block<2, 6>(row, at_pass[p]);
        b.sp[p].noalias() += shared.middleRows<2>(row).transpose() * own;
        b.pp[p].noalias() += own.transpose() * own;
        b.pr[p].noalias() += own.transpose() * b.residuals.segment<2>(row);
        b.rows[p] += 2;
    }
    return b;
}

Blocks without_pass(const Blocks& blocks, const Data& data, std::size_t pass) {
    Blocks b = blocks;
    b.jacobian.resize(0, 0);
    for (std::size_t k = 0; k < b.sight_of.size(); ++k) {
        if (data.sights[b.sight_of[k]].pass != pass) continue;
        const auto row = static_cast<Eigen::Index>(2 * k);
        const Eigen::Matrix<double, 2, Eigen::Dynamic> j = blocks.jacobian.block(row, 0, 2, b.shared);
        const Eigen::Vector2d r = blocks.residuals.segment<2>(row);
        b.ss.noalias() -= j.transpose() * j;
        b.sr.noalias() -= j.transpose() * r;
        b.rr -= r.squaredNorm();
    }
    b.sp[pass].setZero();
    b.pp[pass].setZero();
    b.pr[pass].setZero();
    b.rows[pass] = 0;
    return b;
}

}  // namespace seamwright::on_part
