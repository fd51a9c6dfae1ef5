// F1 and jumps over the whole range of spacing and noise, by condition; the figures stand in the test's
// properties.

#include <gtest/gtest.h>

#include <cstdio>
#include <functional>

#include "core/profile/filter.h"
#include "tests/core/profile/synthetic_profiles.h"

namespace seamwright {
namespace {

using namespace synthetic;

struct Condition {
    const char* name;
    std::function<void(Recipe&)> change;
    double least_f1, least_jumps;
};

TEST(FilterGrid, EveryConditionOverSpacingAndNoise) {
    const std::vector<Condition> conditions = {
        {"plain", [](Recipe&) {}, 0.99, 0.985},
        {"equal steps along the contour", [](Recipe& r) { r.arc_spacing = true; }, 0.99, 0.985},
        {"noise in x and z", [](Recipe& r) { r.isotropic = true; }, 0.99, 0.985},
        {"irregular spacing", [](Recipe& r) { r.jitter = 0.4; }, 0.99, 0.985},
        {"straight pieces", [](Recipe& r) { r.curved = false; }, 0.99, 0.98},
        {"radius 4 mm", [](Recipe& r) { r.min_radius = 4; }, 0.99, 0.985},
        {"outliers to one side", [](Recipe& r) { r.outlier_sign = 1; }, 0.99, 0.98},
        {"10 % outliers", [](Recipe& r) { r.outlier_share = 0.1; }, 0.99, 0.975},
        {"many jumps and edges", [](Recipe& r) { r.jumps_per_1000 = r.edges_per_1000 = 20; }, 0.99, 0.985},
        {"4096 points", [](Recipe& r) { r.points = 4096; }, 0.99, 0.985},
        {"300 points", [](Recipe& r) { r.points = 300; }, 0.98, 0.97},
        {"outliers of 0.3 to 1 mm", [](Recipe& r) { r.outlier_max = 1; }, 0.97, 0.97},
    };
    for (const auto& condition : conditions) {
        Score s;
        std::uint64_t seed = 500;
        for (const double spacing : {0.02, 0.05, 0.1, 0.2})
            for (const double noise : {0.01, 0.02, 0.05})
                for (int k = 0; k < 8; ++k) {
                    Recipe r;
                    r.spacing = spacing, r.noise = noise;
                    condition.change(r);
                    Truth t = Maker(seed++).make(r);
                    ASSERT_TRUE(filter_profile(t.profile, {}).has_value());
                    s.add(t, t.profile.segment);
                }
        EXPECT_GE(s.f1(), condition.least_f1) << condition.name;
        EXPECT_GE(s.jumps_found, condition.least_jumps * s.jumps) << condition.name;
        EXPECT_LE(s.jumps_invented, 0.04 * s.jumps) << condition.name;
        std::printf("%-32s F1 %.4f  jumps %d of %d, invented %d\n", condition.name, s.f1(), s.jumps_found,
                    s.jumps, s.jumps_invented);
    }
}

}  // namespace
}  // namespace seamwright
