// One candidate a line: the stripe among its reflections.

#include <gtest/gtest.h>

#include <limits>

#include "core/profile/filter.h"
#include "tests/core/profile/synthetic_candidates.h"

namespace seamwright {
namespace {

void track_share(const synthetic::Scenery& scenery, int scenes, double& tracked, double& strongest) {
    synthetic::KeptShare a, b;
    for (int k = 1; k <= scenes; ++k) {
        const auto scene = synthetic::reflections(scenery, std::uint64_t(k));
        Profile p;
        ASSERT_TRUE(track_stripe(scene.candidates, {}, p).has_value());
        ASSERT_EQ(p.size(), std::size_t(scenery.lines));
        a.add(scene, p);
        b.add(scene, synthetic::strongest(scene.candidates));
    }
    tracked = a.share(), strongest = b.share();
}

TEST(Track, KeepsTheStripeUnderDoubleReflections) {
    for (const double pitch : {1.0, 0.05}) {  // pixel and millimetre alike
        synthetic::Scenery s;
        s.pitch = pitch;
        double tracked = 0, strongest = 0;
        track_share(s, 25, tracked, strongest);
        RecordProperty("strongest_percent", std::to_string(100 * strongest));
        EXPECT_GE(tracked, 0.98);
        EXPECT_LE(strongest, 0.9);
    }
}

TEST(Track, AStepBesideAReflectionIsStillBetterThanTheStrongest) {
    synthetic::Scenery s;
    s.jumps = 2;
    double tracked = 0, strongest = 0;
    track_share(s, 25, tracked, strongest);
    EXPECT_GE(tracked, strongest + 0.08);
}

TEST(Track, OrderOfCandidatesDoesNotMatter) {
    synthetic::Scenery s;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        auto scene = synthetic::reflections(s, seed);
        Profile a, b;
        ASSERT_TRUE(track_stripe(scene.candidates, {}, a).has_value());
        auto& c = scene.candidates;
        for (int line = 0; line < c.lines; ++line) {
            const auto n = c.count[std::size_t(line)];
            for (auto* v : {&c.x_mm, &c.z_mm})
                std::reverse(v->begin() + c.index(line, 0), v->begin() + c.index(line, n));
            std::reverse(c.intensity.begin() + c.index(line, 0), c.intensity.begin() + c.index(line, n));
        }
        ASSERT_TRUE(track_stripe(c, {}, b).has_value());
        EXPECT_EQ(a.segment, b.segment);
    }
}

TEST(Track, HostileInput) {
    ProfileCandidates c;
    Profile p;
    EXPECT_TRUE(track_stripe(c, {}, p).has_value());
    c.lines = 3, c.per_line = 2;
    EXPECT_FALSE(track_stripe(c, {}, p).has_value());
    c.count = {2, 0, 1};
    c.x_mm = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 0, 0, 2, 2},
    c.z_mm = {1, 1, 0, 0, 2, 2};
    ASSERT_TRUE(track_stripe(c, {}, p).has_value());
    EXPECT_EQ(p.size(), 3u);
    EXPECT_TRUE(std::isnan(p.z_mm[0]) && std::isnan(p.z_mm[1]));
    c.count = {3, 0, 1};
    EXPECT_FALSE(track_stripe(c, {}, p).has_value());
    c.per_line = 0;
    EXPECT_FALSE(track_stripe(c, {}, p).has_value());
    c.lines = -1;
    EXPECT_FALSE(track_stripe(c, {}, p).has_value());
}

}  // namespace
}  // namespace seamwright
