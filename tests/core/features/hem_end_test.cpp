// The end of a hem: round to where there is too little light for a return, a flat before it.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "contours.h"
#include "core/features/feature.h"
#include "core/features/kinds/feature_registry.h"

namespace seamwright::test {
namespace {

// The light ends at 80 degrees, four more or less from part to part.
TEST(HemEnd, IsOnTheHemAndAsUnsureAsItSays) {
    const auto finder =
        make_feature_finder({"contour-end", {{"side", 1}}, {}, Eigen::Vector2d::Zero()}).value();
    for (const double radius : {0.8, 1.2, 2.0})
        for (const double noise : {0.01, 0.03}) {
            Random random(31);
            std::uniform_real_distribution<double> unit(0, 1);
            int covered = 0;
            double off_the_hem = 0;
            constexpr int kTrials = 300;
            for (int i = 0; i < kTrials; ++i) {
                Shape s;
                s.line_to(-6, radius);
                s.arc(0, 0, radius, 90, 10 + 8 * (unit(random) - 0.5));
                Profile p = sample(s, 0.03, unit(random));
                add_noise(p, noise, random);
                const Feature f = finder->find(p);
                ASSERT_EQ(f.status, FeatureStatus::ok) << f.message;
                const Eigen::Vector2d end(radius * std::cos(rad_from_deg(10)),
                                          radius * std::sin(rad_from_deg(10)));
                const Eigen::Vector2d e = f.point_mm - end;
                covered += e.dot(f.covariance_mm2.ldlt().solve(e)) < 5.991;
                off_the_hem += (f.point_mm.norm() - radius) / kTrials;
            }
            EXPECT_GE(covered, 0.93 * kTrials) << radius << " mm, noise " << noise;
            EXPECT_LT(std::abs(off_the_hem), 0.01) << radius << " mm, noise " << noise;
        }
}

}  // namespace
}  // namespace seamwright::test
