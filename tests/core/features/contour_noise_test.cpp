// Laws of a contour's noise: how large it is, how far neighbours share it, and that what is fitted to such points is as
// unsure as it says.

#include "core/features/contour/contour_noise.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>

#include "contours.h"
#include "core/features/contour/apex.h"
#include "core/features/contour/line_fit.h"
#include "core/features/gap/gap_flush.h"
#include "core/features/kinds/feature_registry.h"
#include "core/profile/z_quantum.h"

namespace seamwright::test {
namespace {

// Points of a surface measured `apart` lines of an even grid apart, with independent noise, and laid on that grid by straight
// lines between them.
template <class Height>
Profile interpolated(double from_x, double to_x, double pitch, double apart, double noise, Height height,
                     Random& random) {
    std::normal_distribution<double> normal(0, noise);
    const double step = apart * pitch,
                 begin = from_x - step * std::uniform_real_distribution<double>(0, 1)(random);
    std::vector<double> z;
    for (double x = begin; x < to_x + 2 * step; x += step) z.push_back(height(x) + normal(random));
    Profile p;
    for (double x = from_x; x <= to_x; x += pitch) {
        const double at = (x - begin) / step;
        const auto k = static_cast<std::size_t>(at);
        p.x_mm.push_back(x);
        p.z_mm.push_back(z[k] + (at - double(k)) * (z[k + 1] - z[k]));
    }
    return p;
}

TEST(ContourNoiseLaws, IndependentNoiseIsThatOfNeighbours) {
    Random random(11);
    std::vector<double> scratch;
    std::normal_distribution<double> normal;
    for (const bool even : {true, false}) {
        int seen = 0;
        double mean = 0;
        for (int i = 0; i < 300; ++i) {
            Profile p = sample(hem(-15, 15), 0.05);
            add_noise(p, 0.02, random);
            if (!even)
                for (double& x : p.x_mm) x += 0.01 * normal(random);
            const ContourNoise noise = contour_noise(p.x_mm, p.z_mm, scratch);
            seen += noise.measured_apart > 0;
            mean += noise.point_mm / 300;
        }
        EXPECT_LE(seen, even ? 3 : 0);
        EXPECT_NEAR(mean, 0.02, 0.002);
    }
}

// A point between two measured ones has sqrt(2 / 3) of their noise in the mean.
TEST(ContourNoiseLaws, InterpolationIsSeenAndItsNoiseKept) {
    Random random(12);
    std::vector<double> scratch;
    for (const double apart : {1.3, 1.6, 2.0, 2.5})
        for (const double scale : {1.0, 25.4}) {
            const double noise = 0.02 * scale;
            double mean = 0, told = 0;
            for (int i = 0; i < 100; ++i) {
                const Profile p = interpolated(
                    -30 * scale, 30 * scale, 0.05 * scale, apart, noise,
                    [&](double x) { return 0.002 / scale * x * x; }, random);
                const ContourNoise n = contour_noise(p.x_mm, p.z_mm, scratch);
                mean += n.point_mm / 100;
                told += n.measured_apart / 100;
            }
            EXPECT_NEAR(mean, std::sqrt(2.0 / 3) * noise, 0.2 * noise) << apart;
            EXPECT_NEAR(told, apart, 0.2 * apart) << apart;
        }
}

TEST(ContourNoiseLaws, WithoutNoiseNothingIsSeen) {
    std::vector<double> scratch;
    for (const double pitch : {0.02, 0.3}) {
        const Profile p = sample(hem(-15, 15), pitch);
        EXPECT_EQ(contour_noise(p.x_mm, p.z_mm, scratch).measured_apart, 0) << pitch;
    }
}

// Of neighbours alone the noise is a fifth of what it is, and a flat beside the rim passes for a part of it.
TEST(ContourNoiseLaws, TheCentreOfAnInterpolatedRimIsWhereItSays) {
    Random random(13);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto finder = make_feature_finder({"circle", {}, {}, Eigen::Vector2d::Zero()}).value();
    int ok = 0, wrong = 0;
    for (int i = 0; i < 200; ++i) {
        const double radius = 3 + 4 * unit(random), far = radius * std::sin(rad_from_deg(70));
        const Profile p = interpolated(
            -0.5, far, 0.03 + 0.05 * unit(random), 2, 0.01 + 0.04 * unit(random),
            [&](double x) { return x < 0 ? 0 : std::sqrt(std::max(radius * radius - x * x, 0.0)) - radius; },
            random);
        const Feature f = finder->find(p);
        if (f.status != FeatureStatus::ok) continue;
        ++ok;
        const double error = (f.point_mm - Eigen::Vector2d(0, -radius)).norm();
        wrong += error > 0.3 && error > 5 * std::sqrt(f.covariance_mm2.trace());
    }
    EXPECT_GT(ok, 150);
    EXPECT_LE(wrong, 4);
}

// Mean of `many` neighbours, at the ends of those that there are: what a sensor's own smoothing makes of its profile.
Profile smoothed(const Profile& p, int many) {
    Profile out = p;
    const int n = static_cast<int>(p.size()), half = many / 2;
    for (int i = 0; i < n; ++i) {
        const int from = std::max(i - half, 0), to = std::min(i + half, n - 1);
        double sum = 0;
        for (int k = from; k <= to; ++k) sum += p.z_mm[std::size_t(k)];
        out.z_mm[std::size_t(i)] = sum / (to - from + 1);
    }
    return out;
}

TEST(ProfileNoiseLaws, AMeanOfManyNeighboursCountsAsOnePoint) {
    Random random(14);
    std::vector<double> scratch;
    for (const int many : {1, 3, 5}) {
        double apart = 0;
        constexpr int kTrials = 200;
        for (int i = 0; i < kTrials; ++i) {
            Profile p = sample(hem(-15, 15), 0.05);
            add_noise(p, 0.03, random);
            p = smoothed(p, many);
            apart += profile_noise(p.x_mm, p.z_mm, scratch).apart() / kTrials;
        }
        EXPECT_NEAR(apart, many, 0.2 * many) << many;
    }
}

// Between points measured f lines apart a straight line: the long-run variance is f times the measured points', a point's own
// two thirds of theirs.
TEST(ProfileNoiseLaws, InterpolationBetweenTwoLinesIsSeen) {
    Random random(15);
    std::vector<double> scratch;
    double apart = 0;
    for (int i = 0; i < 100; ++i) {
        const Profile p = interpolated(
            -30, 30, 0.05, 2, 0.02, [](double x) { return 0.002 * x * x; }, random);
        apart += profile_noise(p.x_mm, p.z_mm, scratch).apart() / 100;
    }
    EXPECT_NEAR(apart, 3, 0.5);
}

// What stands out of the noise is shape: it says nothing of neighbours.
TEST(ProfileNoiseLaws, ShapeIsNoLikeness) {
    Random random(16);
    std::vector<double> scratch;
    for (const double noise : {0.0, 1e-4, 1e-3, 0.01}) {
        Profile p;
        for (int i = 0; i < 800; ++i) {
            p.x_mm.push_back(0.05 * i);
            p.z_mm.push_back(2 * std::sin(0.05 * i));
        }
        if (noise > 0) add_noise(p, noise, random);
        EXPECT_LT(profile_noise(p.x_mm, p.z_mm, scratch).apart(), 1.5) << noise;
    }
    const ProfileNoise none = profile_noise({}, {}, scratch);
    EXPECT_EQ(none.points, 0);
    EXPECT_EQ(none.apart(), 1);
}

TEST(PooledSigma, NeverSmallerAndKnownBetter) {
    ProfileNoise profile;
    EXPECT_EQ(pooled_sigma(0.01, 2, profile).sigma_mm, 0.01);
    EXPECT_EQ(pooled_sigma(0.01, 2, profile).widening, 2);
    profile.point_mm = 0.05;
    const PooledSigma few = pooled_sigma(0, 2, profile), larger = pooled_sigma(0.1, 2, profile);
    EXPECT_GT(few.sigma_mm, 0.03);
    EXPECT_LT(few.sigma_mm, 0.05);
    EXPECT_EQ(larger.sigma_mm, 0.1);
    EXPECT_LT(few.widening, 2);
    EXPECT_NEAR(pooled_sigma(0.05, 1000, profile).sigma_mm, 0.05, 1e-12);
}

// The stated sigma holds whatever the sensor makes of its noise: of 1000 parts 95 % lie within. Raw, a mean of three and of
// five, and interpolated from every second line; a corner of two short flanks and a rim's centre.
class SharedNoise : public testing::TestWithParam<int> {
  protected:
    Profile profile(double pitch, double noise, const std::function<double(double)>& height, double from,
                    double to) {
        if (GetParam() == 2) return interpolated(from, to, pitch, 2, noise, height, random_);
        Profile p;
        std::normal_distribution<double> normal(0, noise);
        for (double x = from; x <= to; x += pitch) {
            p.x_mm.push_back(x);
            p.z_mm.push_back(height(x) + normal(random_));
        }
        return smoothed(p, GetParam());
    }
    void covers(const FeatureFinder& finder, const Profile& p, const Eigen::Vector2d& truth) {
        const Feature f = finder.find(p);
        if (f.status != FeatureStatus::ok) return;
        const Eigen::Vector2d e = f.point_mm - truth;
        ++found_;
        within_ += e.dot(f.covariance_mm2.ldlt().solve(e)) < 5.991;
    }
    void expect_honest(int least_found, double least = 0.93) const {
        EXPECT_GT(found_, least_found);
        EXPECT_GE(within_, least * found_);
        EXPECT_LE(within_, 0.996 * found_);
    }
    Random random_{17};
    int found_ = 0, within_ = 0;
};

TEST_P(SharedNoise, ACornerIsAsUnsureAsItSays) {
    std::uniform_real_distribution<double> unit(0, 1);
    const auto finder =
        make_feature_finder({"corner", {{"blend_mm", 0.5}}, {}, Eigen::Vector2d::Zero()}).value();
    for (int i = 0; i < 1000; ++i) {
        const double pitch = 0.03 + 0.1 * unit(random_),
                     slope = std::tan(rad_from_deg(20 + 20 * unit(random_))), at = unit(random_) - 0.5,
                     reach = 40 * pitch;
        // Away from the bend the smoothing takes nothing of the flanks.
        const Profile p = profile(
            pitch, 0.01 + 0.03 * unit(random_),
            [&](double x) { return x < at ? 0.1 * (x - at) : -slope * (x - at); }, at - 3 * reach,
            at + reach);
        covers(*finder, p, {at, 0});
    }
    expect_honest(950);
}

TEST_P(SharedNoise, ARimsCentreIsAsUnsureAsItSays) {
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < 1000; ++i) {
        const double radius = 4 + 4 * unit(random_), far = radius * std::sin(rad_from_deg(60));
        const Profile p = profile(
            0.03 + 0.07 * unit(random_), 0.005 + 0.02 * unit(random_),
            [&](double x) {
                return x < -far
                           ? -0.5 * radius
                           : std::sqrt(std::max(radius * radius - x * x, 0.25 * radius * radius)) - radius;
            },
            -4 * far, far);
        const auto finder =
            make_feature_finder({"circle", {{"window_x_min_mm", -0.9 * far}}, {}, Eigen::Vector2d::Zero()})
                .value();
        covers(*finder, p, {0, -radius});
    }
    expect_honest(900);
}

// At an end a sensor's mean is of the points inwards alone: where the surface slopes, the end is drawn off it. Across the
// surface; along it the end is known to a pitch. Of a mean of five it says a little too little.
TEST_P(SharedNoise, AnEndIsAsUnsureAsItSays) {
    std::uniform_real_distribution<double> unit(0, 1);
    const auto finder =
        make_feature_finder({"contour-end", {{"side", 1}}, {}, Eigen::Vector2d::Zero()}).value();
    for (int i = 0; i < 1000; ++i) {
        const double pitch = 0.03 + 0.1 * unit(random_),
                     slope = std::tan(rad_from_deg(50 * unit(random_) - 25));
        const Profile p = profile(
            pitch, 0.01 + 0.03 * unit(random_), [&](double x) { return slope * x; }, -20, 0);
        const Feature f = finder->find(p);
        if (f.status != FeatureStatus::ok) continue;
        const Eigen::Vector2d across = Eigen::Vector2d(-slope, 1).normalized();
        ++found_;
        within_ += std::abs(across.dot(f.point_mm)) < 1.96 * std::sqrt(across.dot(f.covariance_mm2 * across));
    }
    expect_honest(950, GetParam() == 5 ? 0.86 : 0.93);
}

// The end of a round rim, where means of the points inwards draw it along the contour as well.
TEST_P(SharedNoise, ARoundEndIsAsUnsureAsItSays) {
    std::uniform_real_distribution<double> unit(0, 1);
    const auto finder =
        make_feature_finder({"contour-end", {{"side", 1}}, {}, Eigen::Vector2d::Zero()}).value();
    for (int i = 0; i < 500; ++i) {
        const double pitch = 0.03 + 0.1 * unit(random_), radius = 2 + 6 * unit(random_),
                     end = radius * std::sin(rad_from_deg(30 + 25 * unit(random_)));
        const auto height = [&](double x) {
            return x < 0 ? 0.0 : std::sqrt(radius * radius - x * x) - radius;
        };
        // The surface ends anywhere between the last point and the next.
        const double from = end - (std::floor(20 / pitch) + unit(random_)) * pitch;
        const Profile p = profile(pitch, 0.01 + 0.03 * unit(random_), height, from, end);
        covers(*finder, p, {end, height(end)});
    }
    EXPECT_GT(found_, 480);
    EXPECT_GE(within_, (GetParam() == 5 ? 0.85 : 0.9) * found_);
}

// Means of more lines: over a fit of a few of them the end is known badly, and says so for the most part (means of 9 lines on
// edges: 85 % where the noise of neighbours alone would say 53 %; on round ends 81 and 35 %).
TEST(SharedNoiseOfMany, AnEndTellsItForTheMostPart) {
    Random random(18);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto finder =
        make_feature_finder({"contour-end", {{"side", 1}}, {}, Eigen::Vector2d::Zero()}).value();
    for (const int many : {7, 9})
        for (const bool round : {false, true}) {
            int found = 0, within = 0;
            for (int i = 0; i < 400; ++i) {
                const double pitch = 0.03 + 0.1 * unit(random), noise = 0.01 + 0.03 * unit(random),
                             slope = std::tan(rad_from_deg(50 * unit(random) - 25)),
                             radius = 2 + 6 * unit(random),
                             end = round ? radius * std::sin(rad_from_deg(30 + 25 * unit(random))) : 0;
                const auto height = [&](double x) {
                    if (!round) return slope * x;
                    return x < 0 ? 0.0 : std::sqrt(radius * radius - x * x) - radius;
                };
                Profile p;
                for (double x = end - (std::floor(20 / pitch) + unit(random)) * pitch; x <= end; x += pitch) {
                    p.x_mm.push_back(x);
                    p.z_mm.push_back(height(x));
                }
                add_noise(p, noise, random);
                p = smoothed(p, many);
                const Feature f = finder->find(p);
                if (f.status != FeatureStatus::ok) continue;
                const Eigen::Vector2d e = f.point_mm - Eigen::Vector2d(end, height(end));
                ++found;
                within += e.dot(f.covariance_mm2.ldlt().solve(e)) < 5.991;
            }
            EXPECT_GT(found, 280) << many << " " << round;
            EXPECT_GE(within, (many == 7 ? 0.85 : 0.72) * found) << many << " " << round << " of " << found;
        }
}

// Two sheets that a sensor smooths each by itself: nothing is measured between them.
TEST_P(SharedNoise, FlushIsAsUnsureAsItSays) {
    std::uniform_real_distribution<double> unit(0, 1);
    GapFlushSettings settings;
    settings.edge_skip_mm = 0.5;
    GapFlushGauge gauge(settings);
    for (int i = 0; i < 1000; ++i) {
        const double pitch = 0.03 + 0.1 * unit(random_), noise = 0.01 + 0.03 * unit(random_),
                     slope = 0.2 * (unit(random_) - 0.5), gap = 2 + 3 * unit(random_),
                     flush = 2 * unit(random_) - 1;
        Profile p = profile(
            pitch, noise, [&](double x) { return slope * x; }, -12, 0);
        const double cosine = 1 / std::hypot(1, slope);
        const Profile other = profile(
            pitch, noise, [&](double x) { return slope * x + flush / cosine; }, gap, gap + 12);
        p.x_mm.insert(p.x_mm.end(), other.x_mm.begin(), other.x_mm.end());
        p.z_mm.insert(p.z_mm.end(), other.z_mm.begin(), other.z_mm.end());
        const GapFlush m = gauge.measure(p);
        if (m.status != GapFlushStatus::ok) continue;
        const double e = m.flush_mm - flush;
        ++found_;
        within_ += e * e < 3.841 * m.covariance(1, 1);
    }
    expect_honest(950);
}

// Flanks flatter than 45 degrees: of the apex's two directions the one along the stripe is the worse.
TEST_P(SharedNoise, AnApexIsAsUnsureAsItSays) {
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < 1000; ++i) {
        const double half = 150 + 200 * unit(random_), height = half * (0.6 + 0.3 * unit(random_));
        const Eigen::Vector2d tip(600 + 80 * unit(random_), 300 + 100 * unit(random_));
        const Profile p = profile(
            1, 0.1 + 0.4 * unit(random_),
            [&](double x) { return tip.y() + std::min(height, height * std::abs(x - tip.x()) / half); }, 0,
            1279);
        std::vector<Eigen::Vector2d> points;
        for (std::size_t k = 0; k < p.size(); ++k) points.emplace_back(p.x_mm[k], p.z_mm[k]);
        const auto apex = find_apex(points);
        if (!apex) continue;
        ++found_;
        within_ += std::abs(apex->point.x() - tip.x()) < 1.96 * apex->sigma;
    }
    expect_honest(950);
}

INSTANTIATE_TEST_SUITE_P(OfSensors, SharedNoise, testing::Values(1, 3, 5, 2));

// Heights rounded to steps wider than their noise show less of it than the rounding adds; what is not rounded has no step.
TEST(ContourNoiseLaws, RoundedHeightsAreNoLessNoisyThanTheirRounding) {
    Random random(17);
    std::vector<double> scratch;
    for (const double quantum : {0.005, 0.02, 0.04})
        for (const double noise : {0.0, 0.1, 0.3}) {
            for (int trial = 0; trial < 20; ++trial) {
                Profile p = sample(hem(-15, 15), 0.05, 0.01 + 0.045 * trial);
                add_noise(p, noise * quantum, random);
                const double at = 0.13 + 0.01 * trial;
                for (double& z : p.z_mm) z = at + quantum * std::round(z / quantum);
                EXPECT_NEAR(z_quantum_mm(p.x_mm, p.z_mm), quantum, 1e-9);
                const double sigma = contour_noise_mm(p.x_mm, p.z_mm, scratch);
                EXPECT_GE(sigma, 0.999 * quantum / std::sqrt(12.0));
                EXPECT_LE(sigma, 0.6 * quantum);
            }
        }
    for (int trial = 0; trial < 300; ++trial) {
        Profile p = sample(trial % 2 == 0 ? hem(-15, 15) : bead(-15, 15, 1, 8, 2), 0.05);
        add_noise(p, 1e-4 * std::pow(10.0, 0.01 * trial), random);
        EXPECT_EQ(z_quantum_mm(p.x_mm, p.z_mm), 0);
    }
    // Drawn: a roof whose corners lie on the grid, a staircase, a level.
    std::vector<double> x, roof, stairs, level;
    for (int i = 0; i < 400; ++i) {
        x.push_back(0.05 * i);
        roof.push_back(0.05 * std::max(0, 100 - std::abs(i - 200)));
        stairs.push_back(0.25 * (i / 10));
        level.push_back(1.25);
    }
    for (const auto* z : {&roof, &stairs, &level}) EXPECT_EQ(z_quantum_mm(x, *z), 0);
}

}  // namespace
}  // namespace seamwright::test
