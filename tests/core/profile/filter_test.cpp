#include "core/profile/filter.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/allocations.h"
#include "tests/core/profile/synthetic_candidates.h"
#include "tests/core/profile/synthetic_profiles.h"

namespace seamwright {
namespace {

using synthetic::Maker;
using synthetic::Recipe;
using synthetic::Score;
using synthetic::Truth;

const double nan = std::numeric_limits<double>::quiet_NaN();
const double inf = std::numeric_limits<double>::infinity();

Score score(const Recipe& recipe, int profiles, std::uint64_t seed) {
    Score s;
    for (int k = 0; k < profiles; ++k) {
        Truth t = Maker(seed + std::uint64_t(k)).make(recipe);
        EXPECT_TRUE(filter_profile(t.profile, {}).has_value());
        s.add(t, t.profile.segment);
    }
    return s;
}

TEST(Filter, FindsOutliersAndJumpsOverNoiseAndSpacing) {
    for (const double spacing : {0.02, 0.2})
        for (const double noise : {0.01, 0.05}) {
            Recipe r;
            r.spacing = spacing, r.noise = noise;
            const Score s = score(r, 8, 40);
            EXPECT_GE(s.f1(), 0.98) << spacing << ' ' << noise;
            EXPECT_GE(s.jumps_found, 0.97 * s.jumps) << spacing << ' ' << noise;
            EXPECT_LE(s.jumps_invented, 2) << spacing << ' ' << noise;
        }
}

TEST(Filter, LeavesASharpEdgeWhole) {
    for (const double noise : {0.005, 0.02}) {
        Maker random(5);
        Profile p;
        const double slope = std::tan(70 * std::numbers::pi / 180);
        for (int k = 0; k < 200; ++k) {
            p.x_mm.push_back(0.1 * k);
            p.z_mm.push_back(slope * (10 - std::abs(0.1 * k - 10.03)) + noise * random.normal());
        }
        ASSERT_TRUE(filter_profile(p, {}).has_value());
        EXPECT_EQ(std::count(p.segment.begin(), p.segment.end(), 0), 200) << noise;
    }
}

TEST(Filter, BurstAtTheEndsAndAStepWithMissingReturns) {
    Maker random(6);
    Profile p;
    for (int k = 0; k < 120; ++k) {
        p.x_mm.push_back(0.1 * k);
        p.z_mm.push_back((k < 60 ? 0 : 3) + 0.01 * random.normal());
    }
    for (const int k : {0, 1, 2}) p.z_mm[std::size_t(k)] += 2;
    for (const int k : {117, 118, 119}) p.z_mm[std::size_t(k)] -= 1;
    for (int k = 55; k < 65; ++k) p.z_mm[std::size_t(k)] = nan;
    ASSERT_TRUE(filter_profile(p, {}).has_value());
    for (int k = 0; k < 120; ++k) {
        const int expected = k < 3 || k >= 117 || (k >= 55 && k < 65) ? kOutlier : k < 60 ? 0 : 1;
        EXPECT_EQ(p.segment[std::size_t(k)], expected) << k;
    }
}

// A step in which the light of the edge falls on both sheets: up to three points stand in between.
struct BlurredStep {
    Profile profile;
    int edge = 0, mixed = 0;
};
BlurredStep blurred_step(Maker& random, bool mirrored) {
    BlurredStep s;
    const double pitch = random.uniform(0.03, 0.2), noise = random.uniform(0.03, 0.3) * pitch;
    const double height = random.uniform(5, 40) * pitch, part = random.uniform(0, 1);
    s.mixed = int(random.uniform(0, 3.99));
    s.edge = 50 + int(random.uniform(0, 60));
    const int n = 200;
    for (int i = 0; i < n; ++i) {
        double z = i < s.edge ? height : 0;
        if (i >= s.edge && i < s.edge + s.mixed) z = height * (1 - (i - s.edge + part) / s.mixed);
        s.profile.x_mm.push_back((mirrored ? -i : i) * pitch);
        s.profile.z_mm.push_back(z + noise * random.normal());
    }
    if (mirrored) {
        std::reverse(s.profile.x_mm.begin(), s.profile.x_mm.end());
        std::reverse(s.profile.z_mm.begin(), s.profile.z_mm.end());
        s.edge = n - s.edge - s.mixed;
    }
    return s;
}

TEST(Filter, ASegmentBeginsWhereItsSurfaceBegins) {
    for (const bool mirrored : {false, true}) {
        Maker random(31);
        int parted = 0, misplaced = 0, trials = 300;
        for (int trial = 0; trial < trials; ++trial) {
            BlurredStep s = blurred_step(random, mirrored);
            ASSERT_TRUE(filter_profile(s.profile, {}));
            const auto& segment = s.profile.segment;
            const std::int32_t before = segment[std::size_t(s.edge - 25)],
                               behind = segment[std::size_t(s.edge + s.mixed + 25)];
            if (before == behind || before == kOutlier || behind == kOutlier) continue;
            ++parted;
            bool right = true;
            for (int i = 2; i < 25; ++i)
                right = right && segment[std::size_t(s.edge - i)] == before &&
                        segment[std::size_t(s.edge + s.mixed - 1 + i)] == behind;
            misplaced += !right;
        }
        EXPECT_GT(parted, 0.8 * trials);
        EXPECT_LT(misplaced, 0.03 * parted) << (mirrored ? "mirrored" : "");
    }
}

TEST(Filter, PointsBeforeAndInABurstAtTheStartBelongToTheSegmentBehindIt) {
    Maker random(91);
    for (int trial = 0; trial < 400; ++trial) {
        const int burst = 1 + trial % 3;
        Profile p;
        for (int i = 0; i < 120; ++i) {
            p.x_mm.push_back(0.25 * i);
            p.z_mm.push_back(0.05 * random.normal() + (i > 60 ? 8 : 0));
            if (i < burst && i + 2 != burst)
                p.z_mm.back() += random.uniform(0.5, 5) * (random.chance(0.5) ? 1 : -1);
        }
        ASSERT_TRUE(filter_profile(p, {}));
        for (std::size_t i = 0; i < 55; ++i) {
            if (p.segment[i] != kOutlier) {
                EXPECT_EQ(p.segment[i], p.segment[30]) << trial << " " << i;
            }
        }
    }
}

// Seven to ten points on two flanks: more than a burst, and each side's straight knows nothing of them.
TEST(Filter, AGrooveOrRidgeOfAFewPointsIsContour) {
    Maker random(92);
    int marked = 0, all = 0;
    for (int trial = 0; trial < 300; ++trial) {
        const double half = random.uniform(0.9, 1.3), depth = half * random.uniform(1, 1.7);
        const double sign = random.chance(0.5) ? 1 : -1, middle = random.uniform(14, 16);
        Profile p;
        for (int i = 0; i < 120; ++i) {
            const double x = 0.25 * i, off = std::max(0., 1 - std::abs(x - middle) / half);
            p.x_mm.push_back(x);
            p.z_mm.push_back(0.1 * x + sign * depth * off + 0.05 * random.normal());
        }
        ASSERT_TRUE(filter_profile(p, {}));
        for (std::size_t i = 0; i < p.size(); ++i)
            if (std::abs(p.x_mm[i] - middle) < half) ++all, marked += p.segment[i] == kOutlier;
    }
    EXPECT_LE(marked, 0.02 * all) << all;
}

// Between two far outliers a third that lies nearer is judged by both sides of the burst, not by the last points alone.
TEST(Filter, ANearOutlierAmongFarOnesIsMarked) {
    Maker random(93);
    int missed = 0;
    constexpr int kTrials = 500;
    for (int trial = 0; trial < kTrials; ++trial) {
        Profile p;
        for (int i = 0; i < 120; ++i) {
            p.x_mm.push_back(0.25 * i);
            p.z_mm.push_back(0.002 * 0.25 * i * i + 0.05 * random.normal());
        }
        for (const int i : {59, 60, 61})
            p.z_mm[std::size_t(i)] += (random.chance(0.5) ? 1 : -1) * (i == 60 ? 0.4 : random.uniform(2, 8));
        ASSERT_TRUE(filter_profile(p, {}));
        missed += p.segment[60] != kOutlier;
    }
    EXPECT_LE(missed, 0.08 * kTrials);
}

// A rim of radius 0.5 to 8 that turns out of sight: its last points are as far apart as dust lies off the contour.
TEST(Filter, TheLastPointsOfARimAreContourAndDustBeforeItIsNot) {
    Maker random(94);
    int marked = 0, last = 0, missed = 0;
    constexpr int kTrials = 600;
    for (int trial = 0; trial < kTrials; ++trial) {
        const double radius = 0.5 * std::pow(16., random.uniform(0, 1)), begin = random.uniform(14.8, 15.2);
        const bool mirrored = random.chance(0.5), down = random.chance(0.5);
        Profile p;
        std::vector<std::size_t> rim;
        std::size_t dust = 0;
        for (int i = 0; i < 160; ++i) {
            const double x = 0.25 * i, s = std::max(0., x - begin);
            p.x_mm.push_back(mirrored ? -x : x);
            p.z_mm.push_back(nan);
            if (s > 0.99 * radius) continue;
            p.z_mm.back() = std::sqrt(radius * radius - s * s) - radius + 0.05 * x + 0.05 * random.normal();
            if (s > 0) rim.push_back(std::size_t(i));
            dust = std::size_t(i) - 3;
        }
        p.z_mm[dust] += 3;
        if (down)
            for (double& z : p.z_mm) z = -z;
        ASSERT_TRUE(filter_profile(p, {}));
        for (const std::size_t i : rim) marked += i != dust && p.segment[i] == kOutlier;
        last += int(rim.size());
        missed += p.segment[dust] != kOutlier;
    }
    EXPECT_LE(marked, 0.02 * last) << last;
    EXPECT_LE(missed, 0.005 * kTrials);
}

TEST(Filter, AGapOfMissingReturnsOnOneContourIsNoJump) {
    Maker random(7);
    Profile p;
    for (int k = 0; k < 200; ++k) {
        const bool missing = (k > 50 && k < 56) || (k > 100 && k < 130);
        p.x_mm.push_back(missing ? nan : 0.1 * k);
        p.z_mm.push_back(missing ? nan : 0.04 * k + 0.01 * random.normal());
    }
    ASSERT_TRUE(filter_profile(p, {}).has_value());
    for (int k = 0; k < 200; ++k)
        EXPECT_EQ(p.segment[std::size_t(k)], std::isnan(p.z_mm[std::size_t(k)]) ? kOutlier : 0) << k;
}

// Share of equal marks (accepted or not).
double agreement(const Profile& a, const Profile& b) {
    std::size_t same = 0;
    for (std::size_t k = 0; k < a.size(); ++k) same += (a.segment[k] < 0) == (b.segment[k] < 0);
    return double(same) / double(a.size());
}

TEST(Filter, Invariances) {
    Recipe r;
    r.isotropic = true;  // so that a rotated profile obeys the same law
    r.max_slope_deg = 50;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        Profile p = Maker(seed).make(r).profile;
        ASSERT_TRUE(filter_profile(p, {}).has_value());
        const auto transformed = [&](auto f) {
            Profile q = p;
            for (std::size_t k = 0; k < q.size(); ++k)
                std::tie(q.x_mm[k], q.z_mm[k]) = f(p.x_mm[k], p.z_mm[k]);
            EXPECT_TRUE(filter_profile(q, {}).has_value());
            return q;
        };
        const auto pair = [](double x, double z) { return std::pair{x, z}; };
        EXPECT_EQ(transformed([&](double x, double z) { return pair(1024 * x, 1024 * z); }).segment,
                  p.segment);
        EXPECT_GE(agreement(transformed([&](double x, double z) { return pair(x + 1000, z - 500); }), p),
                  0.999);
        EXPECT_EQ(transformed([&](double x, double z) { return pair(-x, z); }).segment, p.segment);
        const double c = std::cos(0.3), s = std::sin(0.3);
        EXPECT_GE(
            agreement(transformed([&](double x, double z) { return pair(c * x - s * z, s * x + c * z); }), p),
            0.99);

        Profile mirrored = p;
        std::reverse(mirrored.x_mm.begin(), mirrored.x_mm.end());
        std::reverse(mirrored.z_mm.begin(), mirrored.z_mm.end());
        ASSERT_TRUE(filter_profile(mirrored, {}).has_value());
        std::reverse(mirrored.segment.begin(), mirrored.segment.end());
        EXPECT_GE(agreement(mirrored, p), 0.99);

        Profile padded = p;
        for (auto* v : {&padded.x_mm, &padded.z_mm})
            v->insert(v->begin(), 30, nan), v->insert(v->end(), 7, nan);
        ASSERT_TRUE(filter_profile(padded, {}).has_value());
        EXPECT_TRUE(std::equal(p.segment.begin(), p.segment.end(), padded.segment.begin() + 30));
    }
}

TEST(Filter, SegmentsAreNumberedInOrder) {
    Profile p = Maker(9).make({}).profile;
    ASSERT_TRUE(filter_profile(p, {}).has_value());
    std::int32_t highest = -1;
    for (const auto s : p.segment) {
        ASSERT_LE(s, highest + 1);
        ASSERT_TRUE(s < 0 || s >= highest);
        highest = std::max(highest, s);
    }
    EXPECT_GE(highest, 1);
}

TEST(Filter, HostileInput) {
    const auto filtered = [](std::vector<double> x, std::vector<double> z) {
        Profile p;
        p.x_mm = std::move(x), p.z_mm = std::move(z);
        EXPECT_TRUE(filter_profile(p, {}).has_value());
        EXPECT_EQ(p.segment.size(), p.size());
        for (std::size_t k = 0; k < p.size(); ++k) {
            EXPECT_TRUE((std::isfinite(p.z_mm[k]) && std::isfinite(p.x_mm[k])) || p.segment[k] == kOutlier);
        }
        return p.segment;
    };
    EXPECT_TRUE(filtered({}, {}).empty());
    filtered({1}, {2});
    filtered({1, 2}, {2, 2});
    EXPECT_EQ(filtered({1, 2, nan}, {nan, nan, nan}), std::vector<std::int32_t>(3, kOutlier));
    EXPECT_EQ(filtered(std::vector<double>(50, 1.), std::vector<double>(50, 2.)),
              std::vector<std::int32_t>(50, 0));
    filtered({inf, -inf, 1, 2, 3}, {1, 1, 1, inf, 1});
    filtered({1e300, -1e300, 1, 2, 3, 1e99}, {1, 1, 1e300, 1, 1, 1e99});
    Maker random(10);
    std::vector<double> x(3000), z(3000);
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = random.uniform(-1, 1), z[k] = random.uniform(-1, 1);
    filtered(x, z);  // nothing but noise, unsorted
    for (std::size_t k = 0; k < x.size(); ++k)
        x[k] = std::pow(10, random.uniform(-300, 300)), z[k] = std::pow(10, random.uniform(-300, 300));
    filtered(x, z);
}

TEST(Filter, RefusesWithASentence) {
    Profile p;
    p.x_mm = {1, 2}, p.z_mm = {1};
    const auto mismatch = filter_profile(p, {});
    ASSERT_FALSE(mismatch.has_value());
    EXPECT_FALSE(mismatch.error().sentence().empty());
    p.z_mm = {1, 2};
    p.intensity = {1};
    EXPECT_FALSE(filter_profile(p, {}).has_value());
    p.intensity.clear();
    const auto refuses = [&](auto change) {
        FilterOptions o;
        change(o);
        ProfileCandidates none;
        Profile q;
        return !filter_profile(p, o).has_value() && !track_stripe(none, o, q).has_value();
    };
    EXPECT_TRUE(refuses([](FilterOptions& o) { o.noise_mm = -1; }));
    EXPECT_TRUE(refuses([](FilterOptions& o) { o.noise_mm = nan; }));
    EXPECT_TRUE(refuses([](FilterOptions& o) { o.band_sigmas = 0; }));
    EXPECT_TRUE(refuses([](FilterOptions& o) { o.lookahead = 0; }));
    EXPECT_TRUE(refuses([](FilterOptions& o) { o.average = 2; }));
    EXPECT_TRUE(refuses([](FilterOptions& o) { o.initial_sigma = 0; }));
    EXPECT_TRUE(refuses([](FilterOptions& o) { o.min_segment_points = 0; }));
}

TEST(Filter, AllocatesNothingAfterTheFirstProfileOfASize) {
    Recipe r;
    r.points = 2048;
    Profile p = Maker(11).make(r).profile;
    ASSERT_TRUE(filter_profile(p, {}).has_value());
    const auto scene = synthetic::reflections({}, 1);
    Profile tracked;
    ASSERT_TRUE(track_stripe(scene.candidates, {}, tracked).has_value());
    const long before = allocations_so_far();
    const bool ok =
        filter_profile(p, {}).has_value() && track_stripe(scene.candidates, {}, tracked).has_value();
    EXPECT_EQ(allocations_so_far() - before, 0);
    EXPECT_TRUE(ok);
}

}  // namespace
}  // namespace seamwright
