// Laws of the contour end: as sharp as its points allow on a straight end, and as unsure as it is on a
// rounded, a fading and a hidden one.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "contours.h"
#include "core/features/feature.h"
#include "core/features/kinds/feature_registry.h"
#include "core/profile/filter.h"

namespace seamwright::test {
namespace {

using Eigen::Vector2d;

std::unique_ptr<FeatureFinder> right_end(double fit_length_mm = 1.5) {
    return make_feature_finder(
               {"contour-end", {{"side", 1}, {"fit_length_mm", fit_length_mm}}, {}, Vector2d::Zero()})
        .value();
}

struct Honesty {
    double nees = 0;     // mean of e^T C^-1 e / 2: 1 when the covariance is right
    double covered = 0;  // share within the stated 95 % ellipse
    double stated_mm = 0, error_mm = 0;
};

// `trial` makes a profile and says where it ends.
Honesty honesty(const std::function<Profile(Random&, Vector2d&)>& trial, int trials = 2000) {
    const auto finder = right_end();
    Random random(7);
    Honesty h;
    for (int i = 0; i < trials; ++i) {
        Vector2d truth;
        const Feature f = finder->find(trial(random, truth));
        EXPECT_EQ(f.status, FeatureStatus::ok) << f.message;
        const Vector2d e = f.point_mm - truth;
        const double nees = e.dot(f.covariance_mm2.ldlt().solve(e));
        h.nees += 0.5 * nees / trials;
        h.covered += (nees < 5.991) / double(trials);
        h.stated_mm += f.covariance_mm2.trace() / trials;
        h.error_mm += e.squaredNorm() / trials;
    }
    h.stated_mm = std::sqrt(h.stated_mm);
    h.error_mm = std::sqrt(h.error_mm);
    return h;
}

double phase(Random& random) {
    return std::uniform_real_distribution<double>(0, 1)(random);
}

// Flat, then bent down with the radius to a slope, and there it ends.
Profile rounded(double radius, double slope_deg, double noise, Random& random, Vector2d& end) {
    Shape s;
    s.line_to(-4, radius);
    s.arc(0, 0, radius, 90, 90 - slope_deg);
    end = {s.x.back(), s.z.back()};
    Profile p = sample(s, 0.08, phase(random));
    add_noise(p, noise, random);
    return p;
}

// Sigma of an end beyond the last point of an even grid, in steps: evenly over one, and over 0.9 more as if one grid in six
// were an interpolated one.
const double kOfEvenGrid = std::sqrt(1 / 12.0 + 0.81 / 36);

TEST(ContourEndLaws, AStraightEndIsAsSharpAsItsPoints) {
    for (const double pitch : {0.05, 0.1})
        for (const double noise : {0.002, 0.01, 0.03})
            for (const double slope : {0.0, 0.5, -0.5}) {
                const Honesty h = honesty([&](Random& random, Vector2d& end) {
                    Shape s;
                    s.line_to(6, 6 * slope);
                    s.line_to(10, 10 * slope);
                    end = {10, 10 * slope};
                    Profile p = sample(s, pitch, phase(random));
                    add_noise(p, noise, random);
                    return p;
                });
                // A line through n points at even steps, half a step beyond the last one.
                const double c = 1 / std::hypot(1, slope), step = pitch / c, n = std::floor(1.5 / step) + 1;
                const double across = noise * noise * c * c * (1 / n + 3 * n / (n * n - 1));
                const double along = std::pow(kOfEvenGrid * step, 2) + std::pow(noise * c * slope, 2);
                const double sharp = std::sqrt(across + along);
                EXPECT_LT(h.stated_mm, 1.2 * sharp) << pitch << " " << noise << " " << slope;
                EXPECT_LT(h.error_mm, 1.1 * sharp) << pitch << " " << noise << " " << slope;
                EXPECT_NEAR(h.nees, 0.95, 0.25) << pitch << " " << noise << " " << slope;
                EXPECT_NEAR(h.covered, 0.965, 0.03) << pitch << " " << noise << " " << slope;
            }
}

// Where x is measured as z is, the last point lies as unsurely along the contour as across it.
TEST(ContourEndLaws, NoiseInXMakesAnEndUnsure) {
    for (const double noise : {0.02, 0.05, 0.1}) {
        const Honesty h = honesty([&](Random& random, Vector2d& end) {
            Shape s;
            s.line_to(6, 0.2);
            s.line_to(10, 0.2 + 4 * 0.2);
            end = {10, 0.2 + 4 * 0.2};
            Profile p = sample(s, 0.15, phase(random));
            add_noise(p, noise, random);
            std::normal_distribution<double> normal;
            for (double& x : p.x_mm) x += noise * normal(random);
            return p;
        });
        EXPECT_NEAR(h.covered, 0.95, 0.03) << noise;
    }
}

// A sheet of seven points in a sensor's coarse steps: those before its end may all lie on one line, and yet they are not
// known without an error.
TEST(ContourEndLaws, FewPointsInCoarseStepsAreNotExact) {
    const double step = 0.05;
    double least = 1;
    const Honesty h = honesty(
        [&](Random& random, Vector2d& end) {
            Shape s;
            s.line_to(0, 0);
            s.line_to(20, 0);
            end = {20, 0};
            Profile p = sample(s, 0.3, phase(random));
            add_noise(p, 0.5 * step, random);
            for (double& z : p.z_mm) z = step * std::round(z / step);
            const Feature f = right_end()->find(p);
            least = std::min(least, f.covariance_mm2.eigenvalues().real().minCoeff());
            return p;
        },
        500);
    EXPECT_GT(least, 0.01 * step * step);
    EXPECT_GE(h.covered, 0.92);
}

TEST(ContourEndLaws, ARoundedEndIsAsUnsureAsItSays) {
    for (const double radius : {2.0, 3.0, 4.0, 6.0})
        for (const double slope : {30.0, 45.0, 60.0}) {
            const Honesty h = honesty(
                [&](Random& random, Vector2d& end) { return rounded(radius, slope, 0.01, random, end); });
            EXPECT_GE(h.covered, 0.92) << radius << " " << slope;
            // An even spread has no tails: along a steep end nearly all of it lies within the ellipse.
            EXPECT_LE(h.covered, 0.999) << radius << " " << slope;
            EXPECT_GT(h.nees, 0.5) << radius << " " << slope << ": too unsure";
            EXPECT_LT(h.nees, 1.4) << radius << " " << slope;
        }
}

// A hem rolls on to where its light ends, steep: the sensor's next line would have been far below.
TEST(ContourEndLaws, AHemIsFollowedToItsSteepEnd) {
    for (const double radius : {1.0, 1.5, 2.0})
        for (const double pitch : {0.03, 0.06}) {
            const Honesty h = honesty(
                [&](Random& random, Vector2d& end) {
                    Shape s;
                    s.line_to(-4, radius);
                    s.arc(0, 0, radius, 90, 14);
                    end = {s.x.back(), s.z.back()};
                    Profile p = sample(s, pitch, phase(random));
                    add_noise(p, 0.005, random);
                    return p;
                },
                1000);
            EXPECT_GE(h.covered, 0.92) << radius << " " << pitch;
            EXPECT_LT(h.nees, 1.4) << radius << " " << pitch;
        }
}

// A sensor that measures coarser than the even grid which it delivers: the noise runs from point to point, and the surface
// ends up to one of the sensor's own steps beyond the last of them.
TEST(ContourEndLaws, AnInterpolatedGridIsSeenByItsNoise) {
    for (const double apart : {1.25, 1.5, 2.0}) {
        const double pitch = 0.1, noise = 0.02;
        const Honesty h = honesty(
            [&](Random& random, Vector2d& end) {
                end = {22 + phase(random) * apart * pitch, 1};
                const double begin = phase(random) * apart * pitch;
                std::normal_distribution<double> normal(0, noise);
                std::vector<double> z;
                for (double x = begin; x <= end.x(); x += apart * pitch) z.push_back(1 + normal(random));
                Profile p;
                for (double x = 1; x <= begin + double(z.size() - 1) * apart * pitch; x += pitch) {
                    const double at = (x - begin) / (apart * pitch);
                    const auto k = std::min(static_cast<std::size_t>(at), z.size() - 2);
                    p.x_mm.push_back(x);
                    p.z_mm.push_back(z[k] + (at - double(k)) * (z[k + 1] - z[k]));
                }
                return p;
            },
            1000);
        EXPECT_GE(h.covered, 0.88) << apart;
        EXPECT_LT(h.nees, 1.8) << apart;
    }
}

// The flat reaches into the fit, or the curvature hardly shows in the noise: still no confident error.
TEST(ContourEndLaws, AHalfSeenRoundingCostsLittleHonesty) {
    for (const auto& [radius, slope, noise] : {std::array{1.15, 30.0, 0.01},
                                               {1.15, 60.0, 0.01},
                                               {1.15, 60.0, 0.03},
                                               {2.0, 60.0, 0.03},
                                               {4.0, 30.0, 0.03},
                                               {8.0, 60.0, 0.03},
                                               {16.0, 30.0, 0.01},
                                               {32.0, 60.0, 0.01}}) {
        const Honesty h =
            honesty([&, radius = radius, slope = slope, noise = noise](Random& random, Vector2d& end) {
                return rounded(radius, slope, noise, random, end);
            });
        EXPECT_GE(h.covered, 0.88) << radius << " " << slope << " " << noise;
        EXPECT_GT(h.nees, 0.45) << radius << " " << slope << " " << noise;
        EXPECT_LT(h.nees, 2.6) << radius << " " << slope << " " << noise;
    }
}

// The light falls to nothing over `fade` mm; returns stop at a threshold that differs from part to part, with
// speckle. The surface ends anywhere between the last return and the dark.
Profile fading(double radius, double fade, bool with_intensities, Random& random, Vector2d& end) {
    Vector2d dark;
    const Profile whole = rounded(radius, 30, 0, random, dark);
    const double threshold = 0.05 + 0.35 * phase(random);
    std::normal_distribution<double> speckle(1, 0.15);
    Profile p;
    for (std::size_t i = 0; i < whole.size(); ++i) {
        const Vector2d at(whole.x_mm[i], whole.z_mm[i]);
        const double light = std::min(1.0, (dark - at).norm() / fade) * speckle(random);
        if (light < threshold) continue;
        p.x_mm.push_back(at.x());
        p.z_mm.push_back(at.y());
        if (with_intensities) p.intensity.push_back(static_cast<float>(200 * light));
    }
    const auto angle = [&](double x) { return std::acos(std::clamp(x / radius, -1.0, 1.0)); };
    const double a = angle(p.x_mm.back()), to = angle(dark.x()), at = a + phase(random) * (to - a);
    end = {radius * std::cos(at), radius * std::sin(at)};
    add_noise(p, 0.01, random);
    return p;
}

TEST(ContourEndLaws, AFadingEndIsUnsureOverItsFading) {
    for (const double radius : {3.0, 6.0})
        for (const double fade : {0.2, 0.5, 0.8}) {
            const auto over = [&](bool with_intensities) {
                return honesty([&](Random& random, Vector2d& end) {
                    return fading(radius, fade, with_intensities, random, end);
                });
            };
            const Honesty h = over(true), blind = over(false);
            EXPECT_GE(h.covered, 0.87) << radius << " " << fade;
            EXPECT_GT(h.nees, 0.5) << radius << " " << fade << ": too unsure";
            EXPECT_LT(h.nees, 2) << radius << " " << fade;
            EXPECT_GT(h.covered, blind.covered);
        }
}

TEST(ContourEndLaws, ABrightEndIsTheSameWithoutIntensities) {
    Random random(8);
    std::normal_distribution<double> speckle(1, 0.1);
    const auto finder = right_end();
    for (int i = 0; i < 200; ++i) {
        Vector2d end;
        Profile p = rounded(3, 40, 0.01, random, end);
        const Feature dark = finder->find(p);
        for (std::size_t k = 0; k < p.size(); ++k)
            p.intensity.push_back(static_cast<float>(150 * speckle(random)));
        const Feature bright = finder->find(p);
        EXPECT_EQ(bright.point_mm, dark.point_mm);
        EXPECT_EQ(bright.covariance_mm2, dark.covariance_mm2);
    }
}

TEST(ContourEndLaws, MirroredShiftedScaledItIsTheSame) {
    Random random(9);
    for (int i = 0; i < 200; ++i) {
        Vector2d end;
        const Profile p = i % 2 ? rounded(2 + 0.05 * i, 50, 0.01, random, end)
                                : fading(2 + 0.05 * i, 0.5, true, random, end);
        const Feature f = right_end()->find(p);
        ASSERT_EQ(f.status, FeatureStatus::ok);

        Profile mirrored = p;
        for (double& x : mirrored.x_mm) x = -x;
        const Feature left =
            make_feature_finder({"contour-end", {{"side", 0}}, {}, Vector2d::Zero()}).value()->find(mirrored);
        EXPECT_NEAR(left.point_mm.x(), -f.point_mm.x(), 1e-9);
        EXPECT_NEAR(left.point_mm.y(), f.point_mm.y(), 1e-9);
        EXPECT_NEAR(left.covariance_mm2(0, 1), -f.covariance_mm2(0, 1), 1e-9);
        EXPECT_NEAR(left.covariance_mm2(1, 1), f.covariance_mm2(1, 1), 1e-9);

        Profile reversed = p;  // the sensor's order does not matter
        std::reverse(reversed.x_mm.begin(), reversed.x_mm.end());
        std::reverse(reversed.z_mm.begin(), reversed.z_mm.end());
        std::reverse(reversed.intensity.begin(), reversed.intensity.end());
        const Feature back = right_end()->find(reversed);
        EXPECT_LT((back.point_mm - f.point_mm).norm(), 1e-9);
        EXPECT_TRUE(back.covariance_mm2.isApprox(f.covariance_mm2, 1e-6));

        Profile other = p;
        const double scale = 7;
        const Vector2d shift(30, -12);
        for (std::size_t k = 0; k < p.size(); ++k) {
            other.x_mm[k] = scale * p.x_mm[k] + shift.x();
            other.z_mm[k] = scale * p.z_mm[k] + shift.y();
        }
        const Feature g = right_end(1.5 * scale)->find(other);
        EXPECT_LT((g.point_mm - scale * f.point_mm - shift).norm(), 1e-6);
        EXPECT_TRUE(g.covariance_mm2.isApprox(scale * scale * f.covariance_mm2, 1e-4));
    }
}

// Lines without return between the contour's end and the rim of the sensor's field.
void leave_room_in_the_field(Profile& p) {
    for (int i = 0; i < 20; ++i) {
        p.x_mm.push_back(p.x_mm.back() + 0.1);
        p.z_mm.push_back(std::nan(""));
        if (!p.segment.empty()) p.segment.push_back(kOutlier);
    }
}

TEST(ContourEndLaws, WhatTheFilterRejectedBeyondTheEndMakesItUnsure) {
    Profile p;
    for (int i = 0; i < 100; ++i) {
        p.x_mm.push_back(0.1 * i);
        p.z_mm.push_back(0);
        p.segment.push_back(0);
    }
    const double sharp = std::sqrt(right_end()->find(p).covariance_mm2(0, 0));
    EXPECT_NEAR(sharp, 0.1 * kOfEvenGrid, 1e-9);
    double before = sharp;
    for (int hidden = 1; hidden <= 3; ++hidden) {
        p.x_mm.push_back(p.x_mm.back() + 0.1);
        p.z_mm.push_back(4 + 0.3 * hidden);
        p.segment.push_back(kOutlier);
        const Feature f = right_end()->find(p);
        EXPECT_NEAR(f.point_mm.x(), 9.95, 1e-9) << "where it was";
        const double sigma = std::sqrt(f.covariance_mm2(0, 0));
        // The surface may go on under all of them.
        EXPECT_GT(2 * sigma, 0.05 + 0.1 * hidden);
        EXPECT_GT(sigma, before);
        before = sigma;
    }
    // A line without a return lies between: the surface has ended. More follow up to the field's rim.
    p.z_mm[100] = std::nan("");
    leave_room_in_the_field(p);
    EXPECT_NEAR(std::sqrt(right_end()->find(p).covariance_mm2(0, 0)), sharp, 1e-9);
}

// Where a sheet runs up to a higher one, the light of that edge falls on both: the last point stands a little higher.
TEST(ContourEndLaws, BesideAHigherSheetALastPointInBetweenIsNoArc) {
    const auto finder =
        make_feature_finder({"contour-end", {{"side", 1}, {"segment", 1}}, {}, Vector2d::Zero()}).value();
    Random random(5);
    constexpr double kNoise_mm = 0.02;
    std::normal_distribution<double> noise(0, kNoise_mm);
    for (int i = 0; i < 300; ++i) {
        Profile p;
        for (int k = 0; k <= 160; ++k) {
            p.x_mm.push_back(0.157 * k);
            p.z_mm.push_back((k < 100 ? 0 : 0.8) + noise(random));
        }
        p.z_mm[99] = 0.05 + 0.25 * phase(random);
        const Feature f = finder->find(p);
        ASSERT_EQ(f.status, FeatureStatus::ok) << f.message;
        EXPECT_LT(std::abs(f.point_mm.y()), 6 * kNoise_mm) << i;
    }
}

TEST(ContourEndLaws, MissingReturnsBeforeTheEndMakeItUnsure) {
    Profile p;
    for (int i = 0; i < 100; ++i) {
        p.x_mm.push_back(0.1 * i);
        p.z_mm.push_back(0);
    }
    leave_room_in_the_field(p);
    const auto sigma = [&](int missing) {
        Profile q = p;
        q.z_mm[std::size_t(missing)] = std::nan("");
        return std::sqrt(right_end()->find(q).covariance_mm2(0, 0));
    };
    EXPECT_GT(sigma(98), 1.9 * sigma(90));
    EXPECT_NEAR(sigma(90), 0.1 * kOfEvenGrid, 1e-4) << "one of a hundred is chance";
}

// Where returns are missing all over the surface, its last ones may be.
TEST(ContourEndLaws, WhereAShareOfTheReturnsIsMissingTheLastOnesMayBe) {
    for (const double share : {0.05, 0.15, 0.25})
        for (const bool listed : {true, false}) {
            const Honesty h = honesty([&](Random& random, Vector2d& end) {
                const double pitch = 0.03 + 0.1 * phase(random);
                std::normal_distribution<double> noise(0, 0.02);
                Profile p;
                double x = -12 + pitch * phase(random);
                for (; x < 0; x += pitch) {
                    const bool missing = phase(random) < share;
                    if (missing && !listed) continue;
                    p.x_mm.push_back(x);
                    p.z_mm.push_back(missing ? std::nan("") : noise(random));
                }
                // Beyond the end the field goes on.
                for (int k = 0; k < 60 && listed; ++k, x += pitch) {
                    p.x_mm.push_back(x);
                    p.z_mm.push_back(std::nan(""));
                }
                end = {0, 0};
                EXPECT_TRUE(filter_profile(p, {}));
                return p;
            });
            EXPECT_GE(h.covered, 0.93) << share << " " << listed;
            EXPECT_LT(h.nees, 1.3) << share << " " << listed;
            EXPECT_GT(h.nees, 0.55) << share << " " << listed;
        }
}

// A sheet folded over, its rim rolled down to where no line meets it any more.
Profile quantised_hem(double radius, double pitch, double noise, double quantum, Random& random,
                      Vector2d& end) {
    std::normal_distribution<double> normal;
    const double at_x = 2 * phase(random) - 1, at_z = 2 * phase(random) - 1,
                 begin = -26 + pitch * phase(random);
    Profile p;
    for (int i = 0; begin + i * pitch < 0; ++i) {
        const double x = begin + i * pitch, over = x + radius;
        double z = std::clamp(5 * (x + 8), 0.0, 1.0);
        if (over > 0) z = 1 - radius + std::sqrt(radius * radius - over * over);
        z += at_z + noise * normal(random);
        p.x_mm.push_back(x + at_x);
        p.z_mm.push_back(quantum > 0 ? quantum * std::round(z / quantum) : z);
    }
    end = Vector2d(at_x, at_z + 1 - radius);
    return p;
}

// Heights in steps far coarser than the noise, or without noise, lose no piece of a rim.
TEST(ContourEndLaws, QuantisedHeightsKeepTheRim) {
    struct Kind {
        double radius, pitch, noise, quantum;
    };
    for (const Kind& k : {Kind{0.9, 0.05, 0.005, 0.02}, Kind{0.9, 0.05, 0.0025, 0.01},
                          Kind{0.9, 0.05, 0.001, 0.005}, Kind{0.9, 0.05, 0.01, 0.02},
                          Kind{2, 0.05, 0.002, 0.02}, Kind{0.9, 0.05, 0.005, 0}, Kind{0.9, 0.05, 0, 0}}) {
        const auto finder = right_end();
        Random random(21);
        int far = 0;
        for (int trial = 0; trial < 60; ++trial) {
            Vector2d end;
            Profile p = quantised_hem(k.radius, k.pitch, k.noise, k.quantum, random, end);
            ASSERT_TRUE(filter_profile(p, FilterOptions{}));
            const Feature f = finder->find(p);
            if (f.status != FeatureStatus::ok || (f.point_mm - end).cwiseAbs().maxCoeff() > 0.5) ++far;
        }
        EXPECT_LE(far, 1) << "noise " << k.noise << " mm, quantum " << k.quantum << " mm";
    }
}

// On a level sheet all points are rounded alike, and none of them says by how much.
TEST(ContourEndLaws, ALevelSheetIsNoSurerThanItsQuantum) {
    const auto finder = right_end();
    constexpr double kQuantum = 0.02;
    Random random(22);
    std::normal_distribution<double> normal(0, 0.25 * kQuantum);
    int covered = 0;
    double error2 = 0, stated2 = 0;
    for (int trial = 0; trial < 300; ++trial) {
        Vector2d end;
        const double height = phase(random);
        Profile p;
        for (int i = 0; i < 500; ++i) {
            // A slope beside the level piece, so that the quantum shows.
            const double slope = 0.05 * std::max(0.0, 100.0 - i) * 0.05;
            p.x_mm.push_back(0.05 * i);
            p.z_mm.push_back(kQuantum * std::round((height + slope + normal(random)) / kQuantum));
        }
        ASSERT_TRUE(filter_profile(p, FilterOptions{}));
        const Feature f = finder->find(p);
        ASSERT_EQ(f.status, FeatureStatus::ok) << f.message;
        const double error = f.point_mm.y() - height, variance = f.covariance_mm2(1, 1);
        covered += error * error < 3.84 * variance;
        error2 += error * error, stated2 += variance;
    }
    EXPECT_GE(covered, 285);
    EXPECT_LT(stated2, 6 * error2);
}

}  // namespace
}  // namespace seamwright::test
