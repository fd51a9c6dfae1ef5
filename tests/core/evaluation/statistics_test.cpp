#include "core/evaluation/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace seamwright {
namespace {

TEST(EvaluationStatistics, SummaryLeavesOutWhatIsNoNumber) {
    const std::vector<double> v{1, 2, std::numeric_limits<double>::quiet_NaN(), 3, 6};
    const Summary s = summarise(v);
    EXPECT_EQ(s.count, 4u);
    EXPECT_DOUBLE_EQ(s.mean, 3);
    EXPECT_DOUBLE_EQ(s.minimum, 1);
    EXPECT_DOUBLE_EQ(s.maximum, 6);
    EXPECT_NEAR(s.variance, 14.0 / 3, 1e-12);
    EXPECT_NEAR(s.three_sigma, 3 * std::sqrt(14.0 / 3), 1e-12);
}

TEST(EvaluationStatistics, NeesIntervalIsTheChiSquareOne) {
    // chi-square quantiles of 60 degrees: 40.4817 and 83.2977.
    const NeesInterval i = nees_interval(6, 10);
    EXPECT_NEAR(i.low, 4.04817, 2e-3);
    EXPECT_NEAR(i.high, 8.32977, 2e-3);
}

TEST(EvaluationStatistics, LandmarkBoundOfACrossOfPoints) {
    // 100 points whose normals are x, 100 whose normals are z, all lever-free: sigma^2 / 100 each; phi from
    // two far points.
    std::vector<Eigen::Vector2d> points(200, Eigen::Vector2d::Zero()), normals;
    for (int i = 0; i < 200; ++i) normals.push_back(i < 100 ? Eigen::Vector2d(1, 0) : Eigen::Vector2d(0, 1));
    points[0] = {0, 50};
    points[1] = {0, -50};
    const Eigen::Matrix2d bound = landmark_bound(points, normals, Eigen::Vector2d::Zero(), 0.03);
    EXPECT_NEAR(bound(0, 0), 0.0009 / 100, 1e-12);
    EXPECT_NEAR(bound(1, 1), 0.0009 / 100, 1e-12);
}

}  // namespace
}  // namespace seamwright
