#include "core/profile/stripe/stripe_light.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/profile/stripe/peaks.h"
#include "tests/core/profile/stripe_frames.h"

namespace seamwright {
namespace {

using testing::Frame;
using testing::gaussian_stripe;
using testing::render;

// A camera of our own: grey = black + light * (ambient + stripe), clipped. `reflection`: of a line, grey values of full scale
// per unit of light.
struct Scene {
    std::function<double(int line)> reflection;
    double ambient = 0.002, black = 0.01;  // full scales; ambient per unit of light
    int lines = 300, depth = 8;
    double spread_px = 1.3;

    double centre(int line) const { return 60 + 12 * std::sin(0.02 * line) + 0.013 * line; }

    StripePeaks seen(double light, std::mt19937& random, double* surrounding = nullptr) const {
        Frame frame(lines, 130, depth);
        const double full = frame.image().full_scale();
        testing::Noise noise;
        noise.read = 0.004 * full;
        noise.electrons_per_grey = 12000 / full;
        render(
            frame, ScanLines::columns,
            [&](int line, double at) {
                return full * (black + light * (ambient + gaussian_stripe(at, centre(line), spread_px,
                                                                          reflection(line))));
            },
            noise, random);
        StripePeaks peaks;
        EXPECT_TRUE(find_peaks(frame.image(), {}, peaks));
        if (surrounding) *surrounding = surrounding_level(frame.image());
        return peaks;
    }
    int full_scale() const { return (1 << depth) - 1; }
};

struct Quality {
    int good = 0, lit = 0;
    double rms_px = 0;
};
Quality quality(const Scene& scene, const StripePeaks& peaks) {
    Quality q;
    for (int line = 0; line < peaks.lines; ++line) {
        if (!peaks.count[static_cast<std::size_t>(line)]) continue;
        ++q.lit;
        const double off =
            peaks.position_px[static_cast<std::size_t>(peaks.index(line, 0))] - scene.centre(line);
        if (std::abs(off) < 0.25) ++q.good;
        q.rms_px += off * off;
    }
    q.rms_px = std::sqrt(q.rms_px / std::max(1, q.lit));
    return q;
}

TEST(StripeLight, LevelsAreThoseOfTheScene) {
    std::mt19937 random(3);
    for (const int depth : {8, 10, 12, 16}) {
        Scene scene{.reflection = [](int) { return 0.5; }, .depth = depth};
        const StripeLight light = stripe_light(scene.seen(1, random), scene.full_scale());
        EXPECT_GE(light.lit, 298);
        EXPECT_NEAR(light.middle, 0.51, 0.04) << depth;
        EXPECT_LE(light.saturated, 3) << depth;
        EXPECT_NEAR(light.width_px, 2.355 * 1.3, 0.4);
    }
    Scene bright{.reflection = [](int) { return 3.0; }};
    EXPECT_GT(stripe_light(bright.seen(1, random), 255).saturated_share(), 0.95);
    Scene half{.reflection = [](int line) { return line < 150 ? 0.8 : 0.2; }};
    std::vector<std::uint8_t> only(300, 0);
    for (int line = 160; line < 300; ++line) only[static_cast<std::size_t>(line)] = 1;
    const StripeLight dark = stripe_light(half.seen(1, random), 255, only);
    EXPECT_EQ(dark.lines, 140);
    EXPECT_LT(dark.bright, 0.3);
}

TEST(LightSearch, SettlesInFiveFramesFromAThousandTimesTooMuchOrTooLittle) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> exponent(-3, 3), reflect(0.02, 5);
    int worst = 0, fit = 0, total = 0;
    constexpr int kTrials = 200;
    for (int trial = 0; trial < kTrials; ++trial) {
        const double r = reflect(random), slope = std::uniform_real_distribution<double>(0, 0.8)(random);
        const Scene scene{.reflection = [=](int line) { return r * (1 - slope * line / 300.0); },
                          .ambient = 0.004 * r,
                          .lines = 120,
                          .depth = trial % 2 ? 8 : 12,
                          .spread_px = trial % 3 ? 1.3 : 2.6};
        LightSearch search(std::pow(10, exponent(random)) / r, 1e-5, 1e6);
        int frames = 0;
        for (;;) {
            double surrounding = 0;
            const auto peaks = scene.seen(search.next(), random, &surrounding);
            ++frames;
            if (search.seen(stripe_light(peaks, scene.full_scale()), surrounding) || frames > 20) break;
        }
        worst = std::max(worst, frames);
        total += frames;
        fit += search.verdict() == LightVerdict::fit;
        // What it chose is right by the scene itself: the brightest line between 0.4 of full scale and the cut.
        const double top = 0.01 + search.light() * (r + scene.ambient);
        EXPECT_GT(top, 0.4) << trial;
        EXPECT_LT(top, 1.02) << trial;
    }
    EXPECT_EQ(fit, kTrials);
    EXPECT_LE(worst, 5);
    EXPECT_LT(total, 3.6 * kTrials);
}

TEST(LightSearch, SaysWhatTheLimitsDoNotAllow) {
    std::mt19937 random(5);
    const Scene scene{.reflection = [](int) { return 1.0; }, .lines = 120};
    const auto end = [&](double start, double lowest, double highest) {
        LightSearch search(start, lowest, highest);
        double surrounding = 0;
        for (int k = 0; k < 10; ++k) {
            const auto peaks = scene.seen(search.next(), random, &surrounding);
            if (search.seen(stripe_light(peaks, 255), surrounding)) break;
        }
        return search;
    };
    EXPECT_EQ(end(0.01, 0.001, 0.1).verdict(), LightVerdict::too_dark);
    EXPECT_DOUBLE_EQ(end(0.01, 0.001, 0.1).light(), 0.1);
    EXPECT_EQ(end(8, 4, 40).verdict(), LightVerdict::too_bright);
    EXPECT_DOUBLE_EQ(end(8, 4, 40).light(), 4);
    const Scene nothing{.reflection = [](int) { return 0.0; }, .lines = 120};
    LightSearch search(1, 0.01, 100);
    double surrounding = 0;
    int frames = 0;
    while (!search.seen(stripe_light(nothing.seen(search.next(), random, &surrounding), 255), surrounding) &&
           frames < 20)
        ++frames;
    EXPECT_EQ(search.verdict(), LightVerdict::no_stripe);
    EXPECT_LT(frames, 6);
}

TEST(LightSearch, AFloodedImageIsTooBrightAndNotEmpty) {
    std::mt19937 random(6);
    // Ambient light alone reaches full scale at the light it starts with.
    const Scene scene{.reflection = [](int) { return 1.0; }, .ambient = 0.05, .lines = 120};
    double surrounding = 0;
    const auto peaks = scene.seen(200, random, &surrounding);
    EXPECT_EQ(judge_light(stripe_light(peaks, 255), surrounding), LightVerdict::too_bright);
    LightSearch search(200, 1e-3, 1e4);
    int frames = 1;
    while (!search.seen(stripe_light(scene.seen(search.next(), random, &surrounding), 255), surrounding) &&
           frames < 20)
        ++frames;
    EXPECT_EQ(search.verdict(), LightVerdict::fit);
    EXPECT_LE(frames, 5);
}

TEST(MergedExposures, AContourHalfBlackHalfShiningIsSeenWholeAndAsWellAsEachHalfByItself) {
    std::mt19937 random(21);
    // Black paint 80 times darker than the shining half, in seeds and orders of our own.
    const Scene scene{.reflection = [](int line) { return line < 150 ? 0.7 : 0.7 / 80; }};
    for (int trial = 0; trial < 10; ++trial) {
        std::vector<StripePeaks> all{scene.seen(1, random), scene.seen(70, random)};
        std::vector<double> light{1, 70};
        if (trial % 2) {
            std::swap(all[0], all[1]);
            std::swap(light[0], light[1]);
        }
        StripePeaks merged;
        ASSERT_TRUE(merge_exposures(all, light, 255, merged));
        const Quality whole = quality(scene, merged), dim = quality(scene, all[trial % 2]),
                      glaring = quality(scene, all[1 - trial % 2]);
        EXPECT_GE(whole.good, 298);
        EXPECT_LT(whole.rms_px, 0.06);
        EXPECT_LT(dim.good, 290);  // the dark half is at the threshold
        EXPECT_LT(dim.good + 5, whole.good);
        EXPECT_GT(glaring.rms_px, whole.rms_px);
        // The stripe's brightness goes on: the two halves stand as the paint does.
        std::vector<double> a, b;
        for (int line = 0; line < 300; ++line)
            (line < 150 ? a : b).push_back(merged.intensity[static_cast<std::size_t>(merged.index(line, 0))]);
        std::nth_element(a.begin(), a.begin() + 75, a.end());
        std::nth_element(b.begin(), b.begin() + 75, b.end());
        EXPECT_NEAR(a[75] / b[75], 80, 40);
    }
}

TEST(MergedExposures, OneOfSeveralIsItselfAndTheOrderDoesNotMatter) {
    std::mt19937 random(22);
    const Scene scene{.reflection = [](int line) { return 0.1 + 0.9 * line / 300.0; }};
    const StripePeaks a = scene.seen(0.9, random), b = scene.seen(5, random);
    StripePeaks one, ab, ba;
    ASSERT_TRUE(merge_exposures({&a, 1}, std::vector{0.9}, 255, one));
    EXPECT_EQ(one.position_px, a.position_px);
    EXPECT_EQ(one.intensity, a.intensity);
    ASSERT_TRUE(merge_exposures(std::vector{a, b}, std::vector{0.9, 5.0}, 255, ab));
    ASSERT_TRUE(merge_exposures(std::vector{b, a}, std::vector{5.0, 0.9}, 255, ba));
    EXPECT_EQ(ab.count, ba.count);
    for (int line = 0; line < ab.lines; ++line)
        EXPECT_EQ(ab.position_px[static_cast<std::size_t>(ab.index(line, 0))],
                  ba.position_px[static_cast<std::size_t>(ba.index(line, 0))]);
}

TEST(MergedExposures, WhatDoesNotBelongTogetherIsRefused) {
    std::mt19937 random(23);
    const Scene scene{.reflection = [](int) { return 0.5; }, .lines = 60},
        other{.reflection = scene.reflection, .lines = 61};
    const StripePeaks a = scene.seen(1, random), b = other.seen(1, random);
    StripePeaks merged;
    EXPECT_FALSE(merge_exposures({}, {}, 255, merged));
    EXPECT_FALSE(merge_exposures(std::vector{a, b}, std::vector{1.0, 2.0}, 255, merged));
    EXPECT_FALSE(merge_exposures(std::vector{a, a}, std::vector{1.0}, 255, merged));
    for (const double bad : {0.0, -1.0, std::nan("")})
        EXPECT_FALSE(merge_exposures(std::vector{a, a}, std::vector{1.0, bad}, 255, merged)) << bad;
}

TEST(UnservedLines, AreThoseThatAnotherExposureShows) {
    std::mt19937 random(24);
    const Scene scene{.reflection = [](int line) { return line < 200 ? 0.7 : 0.7 / 60; }};
    const std::vector<StripePeaks> all{scene.seen(1, random), scene.seen(50, random)};
    const auto flags = unserved_lines(all[0], 255, all);
    EXPECT_LE(std::count(flags.begin(), flags.begin() + 200, 1), 4);
    EXPECT_GE(std::count(flags.begin() + 200, flags.end(), 1), 96);
}

}  // namespace
}  // namespace seamwright
