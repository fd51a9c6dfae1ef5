// How near the peaks lie to the truth that was drawn.

#include <gtest/gtest.h>

#include "tests/core/profile/peaks_found.h"

namespace seamwright {
namespace {

using testing::found_in;
using testing::Frame;
using testing::gaussian_stripe;
using testing::kMethods;
using testing::name_of;
using testing::Noise;
using testing::render;

struct Accuracy {
    int lines = 0, found = 0, false_peaks = 0;
    double bias = 0, rms = 0, worst = 0;
};

Accuracy accuracy(const StripePeaks& peaks, const std::vector<double>& truth) {
    Accuracy a;
    for (int line = 0; line < peaks.lines; ++line) {
        ++a.lines;
        if (!peaks.count[line]) continue;
        const double error = peaks.position_px[peaks.index(line, 0)] - truth[line];
        if (std::abs(error) > 2) {
            ++a.false_peaks;
            continue;
        }
        ++a.found;
        a.bias += error;
        a.rms += error * error;
        a.worst = std::max(a.worst, std::abs(error));
    }
    a.bias /= std::max(1, a.found);
    a.rms = std::sqrt(a.rms / std::max(1, a.found));
    return a;
}

// Centres that pass through every phase of the pixel grid.
std::vector<double> centres(int lines, double middle, std::mt19937& random) {
    std::uniform_real_distribution<double> shift(-2, 2);
    std::vector<double> result(static_cast<std::size_t>(lines));
    for (double& c : result) c = middle + shift(random);
    return result;
}

TEST(Peaks, WithoutNoiseEveryMethodIsUnbiasedAtEveryPhase) {
    std::mt19937 random(1);
    for (const int depth : {8, 10, 12, 16}) {
        for (const double spread : {0.8, 1.2, 2.0, 4.0}) {
            Frame frame(401, 101, depth);
            const double full = frame.image().full_scale();
            std::vector<double> truth(401);
            for (int i = 0; i < 401; ++i) truth[i] = 50 + i / 400.0;
            render(
                frame, ScanLines::columns,
                [&](int line, double at) {
                    return 0.05 * full + gaussian_stripe(at, truth[line], spread, 0.8 * full);
                },
                {}, random);
            for (const PeakMethod method : kMethods) {
                PeakOptions options;
                options.method = method;
                const Accuracy a = accuracy(found_in(frame, options), truth);
                EXPECT_EQ(a.found, 401) << name_of(method) << depth << spread;
                EXPECT_LT(a.worst, 0.01) << name_of(method) << " " << depth << " bit, spread " << spread;
            }
        }
    }
}

TEST(Peaks, NoiseStaysNearTheCramerRaoBound) {
    std::mt19937 random(2);
    const Noise noise{1.5, 25};
    for (const double spread : {1.0, 1.5, 2.5, 4.0}) {
        Frame frame(2000, 128);
        const auto truth = centres(2000, 64, random);
        render(
            frame, ScanLines::columns,
            [&](int line, double at) { return 15 + gaussian_stripe(at, truth[line], spread, 150); }, noise,
            random);
        const double bound = testing::centre_bound(spread, 150, 15, noise, 0.25);
        for (const PeakMethod method : kMethods) {
            PeakOptions options;
            options.method = method;
            const Accuracy a = accuracy(found_in(frame, options), truth);
            const double efficiency = bound * bound / (a.rms * a.rms);
            EXPECT_EQ(a.found, 2000);
            EXPECT_EQ(a.false_peaks, 0);
            EXPECT_LT(std::abs(a.bias), 0.003);
            const double least = method == PeakMethod::centre_of_gravity ? 0.85
                                 : method == PeakMethod::gaussian        ? 0.7
                                                                         : 0.6;
            EXPECT_GT(efficiency, least) << name_of(method) << " " << spread << ": " << a.rms << " px";
        }
    }
}

TEST(Peaks, SaturatedPlateausAreUnbiased) {
    std::mt19937 random(3);
    for (const double spread : {4.0, 8.0, 12.0}) {
        Frame frame(1000, 300);
        const auto truth = centres(1000, 150, random);
        const Noise noise{1.5, 25};
        render(
            frame, ScanLines::columns,
            [&](int line, double at) { return 12 + gaussian_stripe(at, truth[line], spread, 2000); }, noise,
            random);
        for (const PeakMethod method : kMethods) {
            PeakOptions options;
            options.method = method;
            const StripePeaks peaks = found_in(frame, options);
            const Accuracy a = accuracy(peaks, truth);
            EXPECT_EQ(a.found, 1000) << spread;
            EXPECT_LT(std::abs(a.bias), 0.01);
            const double bound = testing::centre_bound(spread, 2000, 12, noise, 0.25, 255);
            EXPECT_LT(a.rms, (method == PeakMethod::gaussian ? 1.4 : 2.6) * bound) << name_of(method);
            const double width = 2 * spread * std::sqrt(2 * std::log(2000 / (0.5 * 243)));
            EXPECT_NEAR(peaks.width_px[peaks.index(500, 0)], width, 1.0);
            EXPECT_TRUE(peaks.flags[peaks.index(500, 0)] & StripePeaks::kSaturated);
            EXPECT_FALSE(peaks.flags[peaks.index(500, 0)] & StripePeaks::kTruncated);
        }
    }
}

TEST(Peaks, UnevenBackgroundDoesNotPullTheStripe) {
    std::mt19937 random(4);
    for (const double slope : {-0.3, 0.1, 0.3}) {
        Frame frame(1000, 256);
        const auto truth = centres(1000, 128, random);
        render(
            frame, ScanLines::columns,
            [&](int line, double at) {
                const double vignette = 20 * std::cos(line / 1000.0 * 3) + 40 * std::sin(at / 256 * 3);
                return 40 + vignette + slope * (at - 128) + gaussian_stripe(at, truth[line], 2.5, 90);
            },
            Noise{1.5, 25}, random);
        for (const PeakMethod method : kMethods) {
            PeakOptions options;
            options.method = method;
            const Accuracy a = accuracy(found_in(frame, options), truth);
            EXPECT_EQ(a.found, 1000);
            EXPECT_LT(std::abs(a.bias), 0.02);
        }
    }
}

TEST(Peaks, WidthAndIntensityAreKept) {
    std::mt19937 random(5);
    for (const double spread : {1.5, 3.0, 6.0}) {
        Frame frame(200, 128, 12);
        render(
            frame, ScanLines::columns,
            [&](int, double at) { return 200 + gaussian_stripe(at, 60, spread, 3000); }, Noise{4, 10},
            random);
        const StripePeaks peaks = found_in(frame);
        double width = 0, intensity = 0;
        for (int line = 0; line < 200; ++line) {
            ASSERT_GE(peaks.count[line], 1);
            width += peaks.width_px[peaks.index(line, 0)] / 200;
            intensity += peaks.intensity[peaks.index(line, 0)] / 200;
        }
        EXPECT_NEAR(width, 2.3548 * spread, 0.05 * 2.3548 * spread);
        EXPECT_NEAR(intensity, 3200, 40);
    }
}

TEST(Peaks, WeakStripeOfFiveSigmaIsFound) {
    std::mt19937 random(12);
    Frame frame(1000, 400);
    const auto truth = centres(1000, 200, random);
    render(
        frame, ScanLines::columns,
        [&](int line, double at) { return 20 + gaussian_stripe(at, truth[line], 2.5, 15); }, Noise{3, 0},
        random);
    const Accuracy a = accuracy(found_in(frame), truth);
    EXPECT_GE(a.found, 700);
    EXPECT_LE(a.false_peaks, 20);
}

}  // namespace
}  // namespace seamwright
