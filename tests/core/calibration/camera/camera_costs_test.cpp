// The residuals that the cameras are solved by, and their derivatives beside differences along the tangents.

#include "core/calibration/camera/camera_costs.h"

#include <gtest/gtest.h>

#include <memory>

#include "core/calibration/camera/projection.h"

namespace seamwright {
namespace {

struct Unknown {
    Eigen::VectorXd at;
    std::unique_ptr<ceres::Manifold> moves;  // none: every coordinate
};

Unknown pose_unknown(const Eigen::Vector3d& turn, const Eigen::Vector3d& shift) {
    return {block_of(make_pose(rotation_exp(turn), shift)),
            std::unique_ptr<ceres::Manifold>(pose_manifold())};
}

Intrinsics a_lens() {
    Intrinsics k;
    k << 540, 543, 325, 236, -0.25, 0.08, 0.0012, -0.0008, 0.02;
    return k;
}

PlateShape a_place() {
    PlateShape place;
    place.middle_mm = {60, 40};
    place.half_mm = 60;
    return place;
}

Eigen::VectorXd residual_of(const ceres::CostFunction& cost, const std::vector<Unknown>& unknowns) {
    std::vector<const double*> at;
    for (const Unknown& u : unknowns) at.push_back(u.at.data());
    Eigen::VectorXd r(cost.num_residuals());
    EXPECT_TRUE(cost.Evaluate(at.data(), r.data(), nullptr));
    return r;
}

// Largest difference between the derivatives along the tangents and central differences, over the larger of 1
// and the largest derivative.
double worst_derivative(const ceres::CostFunction& cost, std::vector<Unknown> unknowns) {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    std::vector<RowMajor> jacobian;
    std::vector<double*> jacobians;
    std::vector<const double*> at;
    for (const Unknown& u : unknowns) jacobian.emplace_back(cost.num_residuals(), u.at.size());
    for (std::size_t b = 0; b < unknowns.size(); ++b) {
        jacobians.push_back(jacobian[b].data());
        at.push_back(unknowns[b].at.data());
    }
    Eigen::VectorXd r(cost.num_residuals());
    EXPECT_TRUE(cost.Evaluate(at.data(), r.data(), jacobians.data()));
    double worst = 0;
    for (std::size_t b = 0; b < unknowns.size(); ++b) {
        const Eigen::VectorXd centre = unknowns[b].at;
        RowMajor plus = RowMajor::Identity(centre.size(), centre.size());
        if (const auto* m = unknowns[b].moves.get()) {
            plus.resize(centre.size(), m->TangentSize());
            EXPECT_TRUE(m->PlusJacobian(centre.data(), plus.data()));
        }
        for (Eigen::Index i = 0; i < plus.cols(); ++i) {
            const double h = 1e-5;
            Eigen::VectorXd sides[2];
            for (int side = 0; side < 2; ++side) {
                const Eigen::VectorXd step = (side ? h : -h) * Eigen::VectorXd::Unit(plus.cols(), i);
                if (const auto* m = unknowns[b].moves.get())
                    EXPECT_TRUE(m->Plus(centre.data(), step.data(), unknowns[b].at.data()));
                else
                    unknowns[b].at = centre + step;
                sides[side] = residual_of(cost, unknowns);
            }
            unknowns[b].at = centre;
            const Eigen::VectorXd along = jacobian[b] * plus.col(i);
            const double size = std::max(1.0, along.cwiseAbs().maxCoeff());
            worst = std::max(worst, (along - (sides[1] - sides[0]) / (2 * h)).cwiseAbs().maxCoeff() / size);
        }
    }
    return worst;
}

TEST(CameraCosts, TheProjectionIsTheSensorModels) {
    const Intrinsics k = a_lens();
    const Eigen::Vector2d pixel = camera_of(k, 640, 480).project({80, -60, 400});
    EXPECT_LT((pixel_of_ray(k.data(), 0.2, -0.15) - pixel).norm(), 1e-9);
    const Eigen::Matrix2d by_ray = pixel_by_ray(k.data(), 0.2, -0.15);
    const double h = 1e-6;
    EXPECT_LT((by_ray.col(0) -
               (pixel_of_ray(k.data(), 0.2 + h, -0.15) - pixel_of_ray(k.data(), 0.2 - h, -0.15)) / (2 * h))
                  .norm(),
              1e-5);
    EXPECT_LT((by_ray.col(1) -
               (pixel_of_ray(k.data(), 0.2, -0.15 + h) - pixel_of_ray(k.data(), 0.2, -0.15 - h)) / (2 * h))
                  .norm(),
              1e-5);
}

TEST(CameraCosts, DerivativesMatchDifferences) {
    const std::vector<camera_costs::Corner> seen{{{10, 20, 0}, {300, 250}, 2},
                                                 {{100, 70, 5}, {410, 300}, 0.5}};
    const Eigen::VectorXd shape = (Eigen::VectorXd(5) << 0.004, -0.003, 0.6, -0.3, 0.9).finished();
    const auto camera = [&] {
        std::vector<Unknown> u;
        u.push_back({a_lens(), nullptr});
        u.push_back({shape, nullptr});
        return u;
    };
    const Eigen::Vector3d tilt(0.4, -0.3, 0.2), far(-50, -30, 420);
    {
        auto u = camera();
        u.push_back(pose_unknown(tilt, far));
        const std::unique_ptr<ceres::CostFunction> cost(camera_costs::corners(seen, a_place()));
        EXPECT_LT(worst_derivative(*cost, std::move(u)), 1e-6);
    }
    {
        auto u = camera();
        u.push_back(pose_unknown(tilt, far));
        const std::unique_ptr<ceres::CostFunction> cost(
            camera_costs::corners(seen, a_place(), make_pose(rotation_exp({0.1, 0.2, 0}), {30, 5, 20})));
        EXPECT_LT(worst_derivative(*cost, std::move(u)), 1e-6);
    }
    {
        std::vector<Unknown> u;
        u.push_back(pose_unknown({0.2, -0.4, 0.9}, {60, -40, 130}));
        u.push_back(pose_unknown({3.0, 0.1, 0.2}, {900, 150, 250}));
        u.push_back(pose_unknown(tilt, far));
        const std::unique_ptr<ceres::CostFunction> cost(
            camera_costs::robot(make_pose(rotation_exp({2.5, 0.5, -0.8}), {700, 100, 500}), 0.3, 5e-4));
        EXPECT_LT(worst_derivative(*cost, std::move(u)), 1e-6);
    }
    for (const bool on_bow : {false, true}) {
        auto u = camera();
        u.push_back({(Eigen::VectorXd(4) << Eigen::Vector3d(0.8, 0.1, 0.6).normalized(), -240).finished(),
                     std::unique_ptr<ceres::Manifold>(plane_manifold())});
        u.push_back(pose_unknown(tilt, far));
        const std::unique_ptr<ceres::CostFunction> cost(
            camera_costs::stripe({335, 250}, a_place(), on_bow, 640, 480, 0.2));
        EXPECT_LT(worst_derivative(*cost, std::move(u)), 1e-4) << on_bow;
    }
}

TEST(CameraCosts, AnImpossibleStateIsRefusedAndNotNaN) {
    Pose behind = make_pose(Eigen::Matrix3d::Identity(), {0, 0, -400});
    testing::internal::CaptureStderr();
    const auto fit =
        camera_costs::solve_pose({{a_lens(), Pose::Identity(), {{{10, 20, 0}, {300, 250}, 1}}}}, behind);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_TRUE(std::isinf(fit.cost));
}

}  // namespace
}  // namespace seamwright
