#include "core/calibration/problem.h"

#include <ceres/autodiff_cost_function.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>

namespace seamwright {
namespace {

TEST(CalibrationProblem, APoseMovesInTheTangentOfTheHouse) {
    const Pose pose = make_pose(rotation_exp({2.9, 0.4, -0.7}), {100, -20, 700});
    const std::unique_ptr<ceres::Manifold> manifold(pose_manifold());
    for (const double size : {0.0, 1e-9, 0.3, 3.0}) {
        const Vector6 delta = size * (Vector6() << 3, -4, 5, 0.5, -0.6, 0.4).finished();
        const PoseBlock from = block_of(pose);
        PoseBlock to;
        ASSERT_TRUE(manifold->Plus(from.data(), delta.data(), to.data()));
        EXPECT_LT((pose_of(to).matrix() - retract(pose, delta).matrix()).cwiseAbs().maxCoeff(), 1e-12)
            << size;
    }
}

// Distances of a point of each view from places, and of a number that all views share.
struct Pull {
    Eigen::Vector3d on, place;
    template <class T>
    bool operator()(const T* shared, const T* pose, T* residual) const {
        const Vector3<T> p = turn_of(pose) * Vector3<T>(on * shared[0]) + shift_of(pose) - place;
        for (int i = 0; i < 3; ++i) residual[i] = p[i];
        return true;
    }
};

struct Scene {
    double scale = 1;
    std::vector<PoseBlock> poses;
    std::vector<double*> views;
    ceres::Problem problem;
    Scene(double truth, int points) {
        const Eigen::Vector3d body[] = {{0, 0, 0}, {50, 0, 0}, {0, 40, 0}, {10, 20, 30}};
        for (int v = 0; v < 3; ++v) poses.push_back(block_of(Pose::Identity()));
        for (auto& pose : poses) views.push_back(pose.data());
        for (std::size_t v = 0; v < poses.size(); ++v) {
            const Pose at = make_pose(rotation_exp({0.3 * static_cast<double>(v), -0.4, 0.5}), {10, 20, 30});
            problem.AddParameterBlock(views[v], 7, pose_manifold());
            for (int i = 0; i < points; ++i)
                problem.AddResidualBlock(
                    new ceres::AutoDiffCostFunction<Pull, 3, 1, 7>(new Pull{body[i], at * (truth * body[i])}),
                    nullptr, &scale, views[v]);
        }
    }
};

TEST(CalibrationProblem, SharedAndViewsAreFoundAndTheirNormalEquationsAreTheJacobians) {
    Scene scene(1.3, 4);
    const Solved solved = solve(scene.problem, scene.views, 100, 1e-12);
    EXPECT_TRUE(solved.converged);
    EXPECT_LT(solved.cost, 1e-12);
    EXPECT_NEAR(scene.scale, 1.3, 1e-9);
    const NormalBlocks normal = normal_blocks(scene.problem, {&scene.scale}, scene.views);
    Eigen::VectorXd residuals;
    Eigen::MatrixXd jacobian;
    std::vector<double*> all{&scene.scale};
    all.insert(all.end(), scene.views.begin(), scene.views.end());
    ASSERT_TRUE(linearise(scene.problem, all, residuals, jacobian));
    const Eigen::MatrixXd covariance = (jacobian.transpose() * jacobian).inverse();
    EXPECT_NEAR(shared_covariance(normal)(0, 0) / covariance(0, 0), 1, 1e-9);
    for (std::size_t v = 0; v < 3; ++v)
        EXPECT_LT((view_covariance(normal, shared_covariance(normal), v) -
                   covariance.block<6, 6>(1 + 6 * static_cast<Eigen::Index>(v),
                                          1 + 6 * static_cast<Eigen::Index>(v)))
                      .norm(),
                  1e-9 * covariance.norm());
}

// Numbers that say nothing, unknowns that nothing holds: an answer, and no line of a library on stderr.
TEST(CalibrationProblem, NaNAndFreedomWithoutDataEndInAnAnswerAndInSilence) {
    testing::internal::CaptureStderr();
    {
        Scene open(1.3, 1);  // one point a view: turns and scale are free
        EXPECT_TRUE(std::isfinite(solve(open.problem, open.views, 100, 1e-12).cost));
        EXPECT_EQ(shared_covariance(normal_blocks(open.problem, {&open.scale}, open.views)).size(), 0);
    }
    {
        Scene broken(std::numeric_limits<double>::quiet_NaN(), 4);
        const Solved solved = solve(broken.problem, broken.views, 100, 1e-12);
        EXPECT_FALSE(solved.converged);
        EXPECT_TRUE(std::isinf(solved.cost));
        EXPECT_EQ(shared_covariance(normal_blocks(broken.problem, {&broken.scale}, broken.views)).size(), 0);
    }
    {
        Scene start(1.3, 4);
        start.scale = std::numeric_limits<double>::infinity();
        EXPECT_TRUE(std::isinf(solve(start.problem, start.views, 100, 1e-12).cost));
    }
    for (const double none : {std::numeric_limits<double>::quiet_NaN(), 0.0}) {
        Pose lost = Pose::Identity();
        lost.linear().setConstant(none);
        PoseBlock pose = block_of(lost);
        Eigen::Vector4d plane = Eigen::Vector4d::Constant(none);
        double scale = 1;
        ceres::Problem problem;
        problem.AddParameterBlock(plane.data(), 4, plane_manifold());
        problem.AddParameterBlock(pose.data(), 7, pose_manifold());
        problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<Pull, 3, 1, 7>(new Pull{{1, 2, 3}, {4, 5, 6}}), nullptr, &scale,
            pose.data());
        solve(problem, {pose.data()}, 100, 1e-12);
    }
    {
        ceres::Problem nothing;
        EXPECT_FALSE(std::isnan(solve(nothing, {}, 100, 1e-12).cost));
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(CalibrationProblem, TheRobustLossCountsAsItsWeight) {
    const std::unique_ptr<ceres::LossFunction> loss(geman_mcclure(4));
    double rho[3], ahead[3];
    loss->Evaluate(3, rho);
    loss->Evaluate(3 + 1e-6, ahead);
    EXPECT_NEAR(rho[0], 12.0 / 7, 1e-12);
    EXPECT_NEAR(rho[1], (ahead[0] - rho[0]) / 1e-6, 1e-5);
}

}  // namespace
}  // namespace seamwright
