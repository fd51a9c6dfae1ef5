// The corner of a rounded edge: where the two surfaces would meet, over radii, pitches and a noise so small that the
// radius itself falls into many straight stretches.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "core/features/kinds/feature_registry.h"
#include "core/profile/filter.h"

namespace seamwright::test {
namespace {

using Eigen::Vector2d;

struct RoundedEdge {
    double pitch, noise, radius;
};

class RoundedCorner : public testing::TestWithParam<RoundedEdge> {};

TEST_P(RoundedCorner, LiesWhereItsSurfacesMeet) {
    const RoundedEdge k = GetParam();
    const auto finder = make_feature_finder({"corner", {}, {}, Vector2d::Zero()}).value();
    std::mt19937_64 random(8);
    const auto uniform = [&](double from, double to) {
        return std::uniform_real_distribution<double>(from, to)(random);
    };
    std::normal_distribution<double> noise(0, k.noise);
    constexpr int kTrials = 60;
    int found = 0, within_x = 0, within_z = 0;
    for (int i = 0; i < kTrials; ++i) {
        const double left = uniform(-0.17, 0.17), right = left - uniform(0.52, 1.05);  // slopes, rad
        const Vector2d corner(uniform(-3, 3), uniform(-3, 3));
        // The arc's centre lies below the middle of the turn; it begins and ends where a surface has the arc's direction.
        const double middle = 0.5 * (left + right), half_turn = 0.5 * (left - right);
        const Vector2d centre =
            corner - k.radius / std::cos(half_turn) * Vector2d(-std::sin(middle), std::cos(middle));
        const double from = centre.x() - k.radius * std::sin(left),
                     to = centre.x() - k.radius * std::sin(right);
        Profile p;
        for (double x = -12 + k.pitch * uniform(0, 1); x < 12; x += k.pitch) {
            const double d = x - centre.x();
            const double z = x < from ? corner.y() + std::tan(left) * (x - corner.x())
                             : x > to ? corner.y() + std::tan(right) * (x - corner.x())
                                      : centre.y() + std::sqrt(k.radius * k.radius - d * d);
            p.x_mm.push_back(x);
            p.z_mm.push_back(z + noise(random));
        }
        ASSERT_TRUE(filter_profile(p, {}));
        const Feature f = finder->find(p);
        if (f.status != FeatureStatus::ok) continue;
        ++found;
        const Vector2d e = f.point_mm - corner;
        EXPECT_LT(e.norm(), 10 * k.noise);
        within_x += std::abs(e.x()) < 2 * std::sqrt(f.covariance_mm2(0, 0));
        within_z += std::abs(e.y()) < 2 * std::sqrt(f.covariance_mm2(1, 1));
    }
    EXPECT_GE(found, kTrials - 1);
    EXPECT_GE(within_x, 0.84 * found);
    EXPECT_GE(within_z, 0.84 * found);
}

INSTANTIATE_TEST_SUITE_P(Edges, RoundedCorner,
                         testing::Values(RoundedEdge{0.03, 0.001, 0.5}, RoundedEdge{0.05, 0.001, 3},
                                         RoundedEdge{0.03, 0.003, 0.5}, RoundedEdge{0.1, 0.001, 1},
                                         RoundedEdge{0.2, 0.001, 3}, RoundedEdge{0.05, 0.001, 0.5},
                                         RoundedEdge{0.1, 0.003, 1.5}));

}  // namespace
}  // namespace seamwright::test
