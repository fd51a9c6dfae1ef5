// What teaching makes of profiles: the mean's noise, its gaps, and the piece inside a window.

#include "core/profile/taught_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/profile/filter.h"

namespace seamwright {
namespace {

Profile roof(std::mt19937_64& random, double noise_mm) {
    std::normal_distribution<double> noise(0, noise_mm);
    Profile p;
    for (int i = 0; i < 400; ++i) {
        const double x = -20 + 0.1 * i;
        p.x_mm.push_back(x + noise(random));
        p.z_mm.push_back(-0.3 * std::abs(x) + noise(random));
        p.intensity.push_back(static_cast<float>(i % 7));
    }
    return p;
}

TEST(TaughtProfile, TheMeansNoiseFallsWithTheRootOfTheirNumber) {
    std::mt19937_64 random(3);
    constexpr double kNoise_mm = 0.03;
    constexpr int kProfiles = 16;
    double squares = 0;
    int points = 0;
    for (int trial = 0; trial < 20; ++trial) {
        std::vector<Profile> profiles(kProfiles);
        for (Profile& p : profiles) {
            p = roof(random, kNoise_mm);
            ASSERT_TRUE(filter_profile(p, {}));
        }
        const Profile mean = mean_profile(profiles);
        ASSERT_EQ(mean.size(), profiles[0].size());
        EXPECT_TRUE(mean.filtered());
        for (std::size_t i = 0; i < mean.size(); ++i) {
            const double x = -20 + 0.1 * static_cast<double>(i);
            if (!std::isfinite(mean.z_mm[i]) || std::abs(x) < 0.5) continue;
            squares += std::pow(mean.z_mm[i] + 0.3 * std::abs(x), 2);
            ++points;
            EXPECT_EQ(mean.intensity[i], profiles[0].intensity[i]);
        }
    }
    const double found = std::sqrt(squares / points), expected = kNoise_mm / std::sqrt(kProfiles);
    EXPECT_NEAR(found, expected, 0.05 * expected);
}

TEST(TaughtProfile, WhereOneHasNoPointTheMeanHasNone) {
    std::mt19937_64 random(4);
    std::vector<Profile> profiles(3);
    for (Profile& p : profiles) p = roof(random, 0.01);
    profiles[1].z_mm[100] = std::nan("");
    profiles[2].z_mm[200] += 5;  // a reflection
    for (Profile& p : profiles) ASSERT_TRUE(filter_profile(p, {}));
    ASSERT_EQ(profiles[2].segment[200], kOutlier);
    const Profile mean = mean_profile(profiles);
    EXPECT_TRUE(std::isnan(mean.z_mm[100]));
    EXPECT_TRUE(std::isnan(mean.z_mm[200]));
    EXPECT_TRUE(std::isfinite(mean.z_mm[101]));
}

TEST(TaughtProfile, ProfilesWithoutCommonLinesAreNotMixed) {
    std::mt19937_64 random(5);
    std::vector<Profile> profiles{roof(random, 0.01), roof(random, 0.01)};
    profiles[1].x_mm.pop_back();
    profiles[1].z_mm.pop_back();
    profiles[1].intensity.pop_back();
    EXPECT_EQ(mean_profile(profiles).z_mm, profiles[0].z_mm);
    EXPECT_EQ(mean_profile({}).size(), 0u);
}

TEST(TaughtProfile, APieceHoldsWhatIsInsideAndNoOutlier) {
    Profile p;
    p.x_mm = {0, 1, 2, 3, 4};
    p.z_mm = {0, 0, 9, 0, std::nan("")};
    EXPECT_EQ(cut_out(p, 1, 3).x_mm, (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(cut_out(p, 0, 9).x_mm, (std::vector<double>{0, 1, 2, 3})) << "no return is no point";
    p.segment = {0, 0, kOutlier, 0, kOutlier};
    const Profile piece = cut_out(p, 1, 3);
    EXPECT_EQ(piece.x_mm, (std::vector<double>{1, 3}));
    EXPECT_EQ(piece.segment, (std::vector<std::int32_t>{0, 0}));
    const Eigen::AlignedBox2d window(Eigen::Vector2d(0, -1), Eigen::Vector2d(3, -0.5));
    EXPECT_EQ(cut_out(p, window).size(), 0u);
}

// A sensor that filters by itself.
TEST(TaughtProfile, AsDeliveredEveryReturnCounts) {
    std::mt19937_64 random(6);
    Profile p = roof(random, 0.01);
    p.z_mm[50] += 7;
    p.z_mm[60] = std::nan("");
    FilterOptions options;
    options.as_delivered = true;
    ASSERT_TRUE(filter_profile(p, options));
    for (std::size_t i = 0; i < p.size(); ++i) EXPECT_EQ(p.segment[i], i == 60 ? kOutlier : 0);
}

}  // namespace
}  // namespace seamwright
