#include "core/features/resolution/resolution.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/profile/filter.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

// A sheet with a bend of 40 degrees at x = 0 that ends at x = 20.
Profile bent_sheet(double pitch, double noise, double step, unsigned seed, double missing = 0) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    Profile p;
    for (double along = -30 + pitch * uniform(random); along < 20; along += pitch) {
        const double x = along < 0 ? along : along * std::cos(0.7),
                     z = along < 0 ? 0 : -along * std::sin(0.7);
        double depth = z + noise * normal(random);
        if (step > 0) depth = step * std::round(depth / step);
        if (uniform(random) < missing) depth = std::nan("");
        p.x_mm.push_back(x);
        p.z_mm.push_back(depth);
    }
    EXPECT_TRUE(filter_profile(p, {}));
    return p;
}

FeatureRecipe recipe(const char* kind) {
    FeatureRecipe r;
    r.kind = kind;
    if (r.kind == "contour-end") r.parameters = {{"side", 1}};
    return r;
}

TEST(SensorNumbers, AreThoseThatTheProfileWasMadeWith) {
    for (const double pitch : {0.05, 0.2})
        for (const double noise : {0.004, 0.03}) {
            const auto n = sensor_numbers(bent_sheet(pitch, noise, 0, 3));
            ASSERT_TRUE(n) << n.error().sentence();
            EXPECT_NEAR(n->noise_mm, noise, 0.15 * noise);
            // Noise lengthens the way between neighbours.
            EXPECT_NEAR(n->pitch_mm, std::hypot(pitch, noise), 0.1 * pitch + 0.5 * noise);
            EXPECT_EQ(n->depth_step_mm, 0);
            EXPECT_EQ(n->missing_share, 0);
        }
    const auto stepped = sensor_numbers(bent_sheet(0.1, 0.01, 0.02, 5));
    ASSERT_TRUE(stepped);
    EXPECT_NEAR(stepped->depth_step_mm, 0.02, 1e-6);
    const auto sparse = sensor_numbers(bent_sheet(0.1, 0.01, 0, 6, 0.4));
    ASSERT_TRUE(sparse);
    EXPECT_NEAR(sparse->missing_share, 0.4, 0.08);
    EXPECT_FALSE(sensor_numbers(Profile{}));
}

// A grid twice as fine as what was measured resolves no more than that: neither its points nor their noise are the grid's.
TEST(SensorNumbers, OfAnInterpolatedGridAreThoseOfWhatWasMeasured) {
    constexpr double kGrid = 0.05, kNoise = 0.02;
    std::mt19937 random(9);
    std::normal_distribution<double> normal(0, kNoise);
    double pitch = 0, noise = 0;
    constexpr int kTrials = 50;
    for (int trial = 0; trial < kTrials; ++trial) {
        const double begin = -20 - 2 * kGrid * std::uniform_real_distribution<>(0, 1)(random);
        std::vector<double> z;
        for (double x = begin; x < 21; x += 2 * kGrid) z.push_back(normal(random));
        Profile p;
        for (int i = 0; i < 800; ++i) {
            const double x = -20 + kGrid * i, at = (x - begin) / (2 * kGrid);
            const auto k = static_cast<std::size_t>(at);
            p.x_mm.push_back(x);
            p.z_mm.push_back(z[k] + (at - double(k)) * (z[k + 1] - z[k]));
        }
        ASSERT_TRUE(filter_profile(p, {}));
        const auto n = sensor_numbers(p);
        ASSERT_TRUE(n) << n.error().sentence();
        pitch += n->pitch_mm / kTrials;
        noise += n->noise_mm / kTrials;
    }
    EXPECT_NEAR(pitch, 2 * kGrid, 0.3 * kGrid);
    EXPECT_NEAR(noise, std::sqrt(2.0 / 3) * kNoise, 0.2 * kNoise);
}

// At half the distance a camera's points lie half as far apart.
TEST(SensorNumbers, OfACameraGrowWithTheDistance) {
    SensorModel model;
    model.camera.fx = model.camera.fy = 1400, model.camera.cx = 640, model.camera.cy = 512;
    model.camera.width = 1280, model.camera.height = 1024;
    Eigen::Matrix3d r;
    const double c = std::cos(kPi / 6), s = std::sin(kPi / 6);
    r << 1, 0, 0, 0, -c, s, 0, -s, -c;
    model.camera_from_laser = make_pose(r, {0, 0, 280});
    const auto far = sensor_numbers(model, {0, 0}), near = sensor_numbers(model, {0, 80});
    ASSERT_TRUE(far && near);
    EXPECT_NEAR(far->pitch_mm, 280.0 / 1400, 0.002);
    EXPECT_LT(near->pitch_mm, 0.85 * far->pitch_mm);
    EXPECT_LT(near->noise_mm, 0.85 * far->noise_mm);
    EXPECT_FALSE(sensor_numbers(model, {5000, 0}));
}

TEST(Resolution, ACoarsePitchDoesNotResolveAnEnd) {
    const auto fine = check_resolution(bent_sheet(0.05, 0.005, 0, 1), recipe("contour-end"), 0.05);
    ASSERT_TRUE(fine) << fine.error().sentence();
    EXPECT_EQ(fine->verdict, ResolutionVerdict::resolves) << fine->reason.english();
    const auto coarse = check_resolution(bent_sheet(0.4, 0.005, 0, 1), recipe("contour-end"), 0.05);
    ASSERT_TRUE(coarse);
    EXPECT_EQ(coarse->verdict, ResolutionVerdict::does_not_resolve);
    EXPECT_THAT(coarse->reason.english(), HasSubstr("apart"));
    EXPECT_NEAR(coarse->reach, 0.4 / (0.05 * std::sqrt(12.0)), 0.4);
    EXPECT_THAT(coarse->cure.english(), HasSubstr("nearer"));
}

// What is promised of the end is what it errs by: many phases of the pitch.
TEST(Resolution, TheStatedSigmaOfAnEndHolds) {
    double squares = 0, stated = 0;
    int n = 0;
    for (unsigned seed = 1; seed <= 60; ++seed) {
        const auto r = check_resolution(bent_sheet(0.3, 0.01, 0, seed), recipe("contour-end"), 1);
        ASSERT_TRUE(r);
        if (r->feature.status != FeatureStatus::ok) continue;
        const Eigen::Vector2d end(20 * std::cos(0.7), -20 * std::sin(0.7));
        squares += std::pow((r->feature.point_mm - end).dot(end.normalized()), 2);
        stated += r->sigma_mm * r->sigma_mm;
        ++n;
    }
    ASSERT_GT(n, 50);
    EXPECT_LT(std::sqrt(squares / n), 2.5 * std::sqrt(stated / n));
}

TEST(Resolution, StepsNoiseAndGapsAreNamed) {
    const auto stepped = check_resolution(bent_sheet(0.05, 0.01, 0.2, 2), recipe("corner"), 0.02,
                                          SensorNumbers{0.05, 0.2, 0.01, 0});
    ASSERT_TRUE(stepped);
    if (stepped->feature.status == FeatureStatus::ok) {
        EXPECT_EQ(stepped->verdict, ResolutionVerdict::does_not_resolve);
        EXPECT_THAT(stepped->reason.english(), HasSubstr("steps"));
    }
    const auto quiet = check_resolution(bent_sheet(0.05, 0.01, 0, 2), recipe("corner"), 0.03);
    ASSERT_TRUE(quiet);
    EXPECT_EQ(quiet->verdict, ResolutionVerdict::resolves) << quiet->reason.english();
    const auto dark = check_resolution(bent_sheet(0.05, 0.01, 0, 2, 0.5), recipe("corner"), 0.1);
    ASSERT_TRUE(dark);
    if (dark->feature.status == FeatureStatus::ok) {
        EXPECT_EQ(dark->verdict, ResolutionVerdict::does_not_resolve);
        EXPECT_THAT(dark->reason.english(), HasSubstr("no point"));
    }
}

// The sheet with a hem, half a millimetre high, and free air beside its end.
Profile hemmed_sheet(double pitch, double noise, unsigned seed) {
    Profile p = bent_sheet(pitch, noise, 0, seed);
    for (std::size_t i = 0; i < p.size(); ++i)
        if (p.x_mm[i] < -12) p.z_mm[i] += 0.5;
    for (int i = 0; i < static_cast<int>(30 / pitch); ++i) {
        p.x_mm.push_back(20 + pitch * i);
        p.z_mm.push_back(std::nan(""));
    }
    p.segment.clear();
    EXPECT_TRUE(filter_profile(p, {}));
    return p;
}

// At a kink or a jump two neighbours are a piece of the contour, which says nothing about the template; air beside the part
// does not return.
TEST(Resolution, ATemplateWithAKinkAndAirBesideThePartIsResolvedByAFinePitchAlone) {
    for (const double pitch : {0.08, 4.0}) {
        FeatureRecipe r = recipe("template");
        const Profile taught = hemmed_sheet(pitch, 0.01, 1);
        for (std::size_t i = 0; i < taught.size(); ++i)
            if (taught.segment[i] != kOutlier && std::isfinite(taught.z_mm[i])) {
                r.template_profile.x_mm.push_back(taught.x_mm[i]);
                r.template_profile.z_mm.push_back(taught.z_mm[i]);
                r.template_profile.segment.push_back(taught.segment[i]);
            }
        const Profile seen = hemmed_sheet(pitch, 0.01, 2);
        const auto check = check_resolution(
            seen, r, 0.05,
            SensorNumbers{pitch, 0, 0.01,
                          sensor_numbers(taught) ? sensor_numbers(taught)->missing_share : 0});
        ASSERT_TRUE(check) << check.error().sentence();
        if (pitch < 1) {
            EXPECT_EQ(check->verdict, ResolutionVerdict::resolves) << check->reason.english();
            EXPECT_LT(check->sensor.missing_share, 0.01);
        } else {
            EXPECT_NE(check->verdict, ResolutionVerdict::resolves);
        }
    }
}

TEST(Resolution, WhatIsNotThereIsNotFound) {
    Profile flat;
    for (int i = 0; i < 300; ++i) {
        flat.x_mm.push_back(0.1 * i);
        flat.z_mm.push_back(0.001 * (i % 7));
    }
    ASSERT_TRUE(filter_profile(flat, {}));
    const auto r = check_resolution(flat, recipe("corner"), 0.05);
    ASSERT_TRUE(r);
    EXPECT_EQ(r->verdict, ResolutionVerdict::not_found);
    EXPECT_FALSE(check_resolution(flat, recipe("corner"), -1));
    EXPECT_FALSE(check_resolution(flat, recipe("nobody"), 0.05));
}

}  // namespace
}  // namespace seamwright
