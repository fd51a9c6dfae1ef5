#include "core/features/contour/apex.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace seamwright {
namespace {

// A body of the given half base and height with its apex at `tip`, on a level plate, as the stripe shows it.
std::vector<Eigen::Vector2d> body(const Eigen::Vector2d& tip, double half_base, double height, double noise,
                                  unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> n(0, 1);
    std::vector<Eigen::Vector2d> points;
    for (int u = 0; u < 1280; ++u) {
        const double away = std::abs(u - tip.x());
        const double v = away < half_base ? tip.y() + height * away / half_base : tip.y() + height;
        points.emplace_back(u, v + noise * n(random));
    }
    return points;
}

TEST(Apex, IsWhereTheFlanksMeet) {
    const Eigen::Vector2d tip(612.3, 401.7);
    const auto apex = find_apex(body(tip, 380, 330, 0.3, 1));
    ASSERT_TRUE(apex);
    EXPECT_LT((apex->point - tip).norm(), 5 * apex->sigma);
    EXPECT_LT(apex->sigma, 0.2);
    EXPECT_NEAR(apex->left.x(), tip.x() - 380, 8);
    EXPECT_NEAR(apex->right.x(), tip.x() + 380, 8);
    EXPECT_NEAR(apex->angle_rad, 2 * std::atan2(380, 330), 0.03);
}

TEST(Apex, ItsSigmaIsTheScatter) {
    const Eigen::Vector2d tip(700.2, 333.1);
    double squares = 0, sigma = 0;
    constexpr int kTrials = 200;
    for (int i = 0; i < kTrials; ++i) {
        const auto apex = find_apex(body(tip, 380, 330, 0.5, 100U + static_cast<unsigned>(i)));
        ASSERT_TRUE(apex);
        squares += (apex->point - tip).squaredNorm() / 2;
        sigma += apex->sigma / kTrials;
    }
    const double scatter = std::sqrt(squares / kTrials);
    EXPECT_LT(scatter, 1.3 * sigma);
    EXPECT_GT(scatter, 0.5 * sigma);
}

TEST(Apex, HoldsAgainstGlintsOnAFlank) {
    const Eigen::Vector2d tip(612.3, 401.7);
    auto points = body(tip, 380, 330, 0.2, 2);
    for (std::size_t i = 520; i < 535; ++i) points[i].y() += 6;
    const auto apex = find_apex(points);
    ASSERT_TRUE(apex);
    EXPECT_LT((apex->point - tip).norm(), 0.5);
}

TEST(Apex, APlateHasNone) {
    EXPECT_FALSE(find_apex(body({2000, 400}, 100, 0, 0.3, 3)));
    EXPECT_FALSE(find_apex({}));
    EXPECT_FALSE(find_apex(body({612, 400}, 380, 30, 0.3, 4))) << "too flat";
}

TEST(Apex, AHalfHiddenBodyHasNone) {
    auto points = body({640, 400}, 380, 330, 0.2, 5);
    points.erase(points.begin() + 645, points.end());  // the other flank is out of the picture
    EXPECT_FALSE(find_apex(points));
}

}  // namespace
}  // namespace seamwright
