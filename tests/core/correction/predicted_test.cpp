#include "core/correction/predicted.h"

#include <gtest/gtest.h>

#include "core/correction/sigma.h"
#include "tests/core/correction/doors.h"

namespace seamwright {
namespace {

using namespace testing_doors;

TEST(Forecast, CovarianceIsThePlans) {
    Rng rng(1);
    for (int trial = 0; trial < 20; ++trial) {
        const auto spots = door(rng, 3 + trial % 5, {500, 0, 900});
        EXPECT_EQ(predicted_covariance(spots, {})->sum, plan_region(spots, {})->covariance);
    }
    EXPECT_FALSE(predicted_covariance({}, {}));
}

// Monte Carlo: what a carried point scatters.
TEST(Forecast, SigmaAtAPointIsItsScatter) {
    Rng rng(2);
    auto spots = door(rng, 5, {500, 0, 900});
    const Pose d = random_displacement(rng, 10, 2, {500, 0, 900});
    const Eigen::Vector3d point(700, 200, 950);
    const Matrix6 covariance = predicted_covariance(spots, {})->sum;
    const Eigen::Matrix<double, 6, 6> root = covariance.llt().matrixL();
    std::normal_distribution<double> normal;
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    constexpr int kTrials = 20000;
    for (int i = 0; i < kTrials; ++i) {
        Vector6 n;
        for (int k = 0; k < 6; ++k) n[k] = normal(rng);
        const Vector6 e = root * n;
        // pose.h's tangent: translation added, rotation from the left.
        const Eigen::Vector3d carried =
            rotation_exp(e.tail<3>()) * (d.linear() * point) + e.head<3>() + d.translation() - d * point;
        scatter += carried * carried.transpose() / kTrials;
    }
    EXPECT_NEAR(sigma_at_mm(covariance, d, point) / worst_sigma(scatter), 1, 0.03);
    EXPECT_TRUE(std::isnan(worst_sigma(-Eigen::Matrix3d::Identity())));
    EXPECT_TRUE(std::isnan(worst_sigma(Eigen::Matrix3d::Constant(std::nan("")))));
}

// The advice put to the proof: adding the spot brings more than adding it anywhere else that was taught.
TEST(Forecast, FurtherSpotHelpsMost) {
    Rng rng(3);
    const auto worst = [](const std::vector<SpotObservation>& all) {
        return plan_region(all, {})->sigma_at_spots_mm;
    };
    for (int trial = 0; trial < 20; ++trial) {
        const auto spots = door(rng, 4, {500, 0, 900});
        const auto further = best_further_spot(spots, {});
        ASSERT_TRUE(further);
        EXPECT_FALSE(further->edge.empty());
        auto with = spots;
        with.push_back(further->spot);
        with.back().id = "new";
        const double best = worst(with);
        EXPECT_LT(best, worst(spots));
        for (const SpotObservation& twice : spots) {
            with.back() = twice;
            with.back().id = "new";
            // A doubled spot keeps its own orientation, which is not among the places tried exactly.
            EXPECT_LT(best, 1.25 * worst(with));
        }
    }
}

}  // namespace
}  // namespace seamwright
