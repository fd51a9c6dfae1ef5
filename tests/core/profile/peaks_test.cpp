#include "core/profile/stripe/peaks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/profile/stripe/peaks_detail.h"
#include "tests/allocations.h"
#include "tests/core/profile/stripe_frames.h"

namespace seamwright {
namespace {

using testing::Frame;
using testing::gaussian_stripe;
using ::testing::HasSubstr;
using testing::Noise;
using testing::render;

constexpr PeakMethod kMethods[] = {PeakMethod::centre_of_gravity, PeakMethod::gaussian, PeakMethod::steger};
const char* name_of(PeakMethod method) {
    return method == PeakMethod::centre_of_gravity ? "centre of gravity"
           : method == PeakMethod::gaussian        ? "gaussian"
                                                   : "steger";
}

StripePeaks found_in(const Frame& frame, const PeakOptions& options = {}) {
    StripePeaks peaks;
    const auto ok = find_peaks(frame.image(), options, peaks);
    EXPECT_TRUE(ok) << (ok ? "" : ok.error().sentence());
    return peaks;
}

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

TEST(Peaks, DoubleReflectionsAreHandedOverStrongestFirst) {
    std::mt19937 random(6);
    Frame frame(600, 300);
    render(
        frame, ScanLines::columns,
        [&](int line, double at) {
            return 10 + gaussian_stripe(at, 200 + 0.05 * line, 2, line % 2 ? 180 : 0) +
                   gaussian_stripe(at, 120 + 0.05 * line, 2, 90) + gaussian_stripe(at, 80, 2, 45);
        },
        Noise{1.5, 25}, random);
    const StripePeaks peaks = found_in(frame);
    for (int line = 0; line < 600; ++line) {
        std::vector<double> expected{120 + 0.05 * line, 80};
        if (line % 2) expected.insert(expected.begin(), 200 + 0.05 * line);
        ASSERT_EQ(peaks.count[line], expected.size()) << line;
        for (std::size_t k = 0; k < expected.size(); ++k)
            EXPECT_NEAR(peaks.position_px[peaks.index(line, int(k))], expected[k], 0.5);
    }
}

TEST(Peaks, TwoMaximaAreTwoPeaksWhenTheValleyIsBelowHalf) {
    std::mt19937 random(7);
    for (const bool parted : {false, true}) {
        Frame frame(64, 128);
        const double apart = parted ? 8 : 4;  // valley 2 exp(-apart^2/(8 * 2^2)): 0.27 or above 1
        render(
            frame, ScanLines::columns,
            [&](int, double at) {
                return 10 + gaussian_stripe(at, 60, 2, 150) + gaussian_stripe(at, 60 + apart, 2, 150);
            },
            {}, random);
        const StripePeaks peaks = found_in(frame);
        for (int line = 0; line < 64; ++line) EXPECT_EQ(peaks.count[line], parted ? 2 : 1);
        if (!parted) {
            EXPECT_NEAR(peaks.position_px[0], 62, 0.02);
        }
    }
}

TEST(Peaks, StrengthIsTheStripeNotAHotPixel) {
    std::mt19937 random(8);
    Frame frame(300, 200);
    render(
        frame, ScanLines::columns, [&](int, double at) { return 10 + gaussian_stripe(at, 90, 2.5, 70); },
        Noise{1.5, 25}, random);
    for (int x = 0; x < 300; x += 3) frame.set(x, 20 + x % 50, 255);
    const StripePeaks peaks = found_in(frame);
    for (int line = 0; line < 300; ++line) {
        ASSERT_GE(peaks.count[line], 1);
        EXPECT_NEAR(peaks.position_px[peaks.index(line, 0)], 90, 1) << line;
    }
}

// A stripe of a few pixels across a chessboard in bright light, and over its squares.
TEST(Peaks, ABrightChessboardDoesNotRuinIt) {
    std::mt19937 random(9);
    Frame frame(800, 600);
    std::vector<double> truth(800);
    for (int x = 0; x < 800; ++x) truth[x] = 250 + 0.1 * x;
    render(
        frame, ScanLines::columns,
        [&](int line, double at) {
            const bool board = line > 100 && line < 700 && at > 60 && at < 540;
            const bool white = (line / 60 + int(at) / 60) % 2 == 0;
            return (board ? (white ? 120 : 25) : 60) + gaussian_stripe(at, truth[line], 2.0, 130);
        },
        Noise{1.5, 25}, random);
    for (const PeakMethod method : kMethods) {
        PeakOptions options;
        options.method = method;
        const StripePeaks peaks = found_in(frame, options);
        double sum = 0, squares = 0;
        int far = 0, lost = 0, off = 0;
        for (int x = 0; x < 800; ++x) {
            const double error = peaks.count[x] ? peaks.position_px[peaks.index(x, 0)] - truth[x] : 1e9;
            // Within 3 standard deviations of an edge between squares the light itself is no symmetric
            // stripe.
            const double edge = std::abs(std::remainder(truth[x] + 0.5, 60.0));
            const bool on_board = x > 100 && x < 700;
            if (on_board && edge < 4.5) continue;
            if (std::abs(error) > 3) ++lost;
            if (on_board && edge < 7) continue;
            ++far;
            if (std::abs(error) > 0.3) {
                ++off;
                continue;
            }
            sum += error;
            squares += error * error;
        }
        EXPECT_LE(lost, 4) << name_of(method);
        EXPECT_GT(far, 600);
        EXPECT_LE(off, 4) << name_of(method);
        EXPECT_LT(std::abs(sum / far), 0.02) << name_of(method);
        EXPECT_LT(std::sqrt(squares / far), 0.08) << name_of(method);
    }
}

TEST(Peaks, DarkColumnsHaveNone) {
    std::mt19937 random(10);
    Frame frame(900, 400);
    render(
        frame, ScanLines::columns,
        [&](int line, double at) { return 10 + gaussian_stripe(at, 200, 2.5, line / 100 % 2 ? 0 : 120); },
        Noise{2, 20}, random);
    const StripePeaks peaks = found_in(frame);
    int dark = 0, bright = 0;
    for (int line = 0; line < 900; ++line) (line / 100 % 2 ? dark : bright) += peaks.count[line] > 0;
    EXPECT_EQ(bright, 500);
    EXPECT_LE(dark, 1);
}

TEST(Peaks, NoiseAloneHasHardlyAnyPeaks) {
    std::mt19937 random(11);
    for (const double level : {3.0, 30.0, 200.0}) {
        for (const double read : {0.4, 3.0, 12.0}) {
            Frame frame(1024, 768);
            render(
                frame, ScanLines::columns, [&](int, double) { return level; }, Noise{read, 20}, random);
            const StripePeaks peaks = found_in(frame);
            const int lines = static_cast<int>(
                std::count_if(peaks.count.begin(), peaks.count.end(), [](int n) { return n > 0; }));
            EXPECT_LE(lines, 5) << level << " " << read;
        }
    }
    Frame uniform(512, 512);
    for (int y = 0; y < 512; ++y)
        for (int x = 0; x < 512; ++x) uniform.set(x, y, static_cast<int>(random() % 256));
    const StripePeaks peaks = found_in(uniform);
    EXPECT_LE(std::count_if(peaks.count.begin(), peaks.count.end(), [](int n) { return n > 0; }), 5);
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

TEST(Peaks, FixedThresholdIsAboveBackground) {
    std::mt19937 random(13);
    Frame frame(100, 200);
    render(
        frame, ScanLines::columns,
        [&](int line, double at) { return 50 + gaussian_stripe(at, 100, 2.5, line < 50 ? 60 : 100); }, {},
        random);
    PeakOptions options;
    options.threshold = 80;
    const StripePeaks peaks = found_in(frame, options);
    for (int line = 0; line < 100; ++line) EXPECT_EQ(peaks.count[line] > 0, line >= 50);
}

TEST(Peaks, WidthLimitsAreKept) {
    std::mt19937 random(14);
    Frame frame(60, 400);
    render(
        frame, ScanLines::columns,
        [&](int, double at) {
            return 10 + gaussian_stripe(at, 100, 2, 150) + gaussian_stripe(at, 250, 8, 150);
        },
        {}, random);
    PeakOptions options;
    options.max_width_px = 10;
    StripePeaks peaks = found_in(frame, options);
    ASSERT_EQ(peaks.count[30], 1);
    EXPECT_NEAR(peaks.position_px[peaks.index(30, 0)], 100, 0.05);
    options.max_width_px = 80;
    options.min_width_px = 10;
    peaks = found_in(frame, options);
    ASSERT_EQ(peaks.count[30], 1);
    EXPECT_NEAR(peaks.position_px[peaks.index(30, 0)], 250, 0.05);
}

TEST(Peaks, AStripeThatLeavesTheImageIsMarked) {
    std::mt19937 random(15);
    Frame frame(100, 100);
    render(
        frame, ScanLines::columns,
        [&](int line, double at) { return 10 + gaussian_stripe(at, 50 - line, 3, 150); }, {}, random);
    const StripePeaks peaks = found_in(frame);
    for (int line = 0; line < 45; ++line) {
        ASSERT_EQ(peaks.count[line], 1);
        EXPECT_FALSE(peaks.flags[peaks.index(line, 0)] & StripePeaks::kTruncated);
    }
    for (int line = 48; line < 53; ++line) {
        ASSERT_EQ(peaks.count[line], 1);
        EXPECT_TRUE(peaks.flags[peaks.index(line, 0)] & StripePeaks::kTruncated);
    }
    for (int line = 70; line < 100; ++line) EXPECT_EQ(peaks.count[line], 0);
}

bool same(const StripePeaks& a, const StripePeaks& b) {
    if (a.lines != b.lines || a.count != b.count) return false;
    for (int line = 0; line < a.lines; ++line) {
        for (int k = 0; k < a.count[line]; ++k) {
            const int i = a.index(line, k), j = b.index(line, k);
            if (a.position_px[i] != b.position_px[j] || a.intensity[i] != b.intensity[j] ||
                a.width_px[i] != b.width_px[j] || a.flags[i] != b.flags[j])
                return false;
        }
    }
    return true;
}

TEST(Peaks, KernelsAgreeBitForBitAndRowsAreColumnsTransposed) {
    std::mt19937 random(16);
    for (const int depth : {8, 12, 16}) {
        for (const auto& [width, height] :
             std::vector<std::pair<int, int>>{{257, 131}, {64, 64}, {33, 200}, {700, 45}}) {
            Frame columns(width, height, depth, 5), rows(height, width, depth, 3);
            const double full = columns.image().full_scale();
            const auto light = [&](int line, double at) {
                return 0.1 * full + gaussian_stripe(at, 0.4 * height + 5.0 * line / width, 2, 0.7 * full) +
                       gaussian_stripe(at, 0.85 * height, 1.5, height > 60 ? 0.3 * full : 0);
            };
            render(columns, ScanLines::columns, light, Noise{0.02 * full, 0}, random);
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) rows.set(y, x, columns.get(x, y));
            for (const PeakMethod method : kMethods) {
                PeakOptions options;
                options.method = method;
                options.threshold = 0.05 * full;  // noise makes many runs
                for (const auto* frame : {&columns, &rows}) {
                    StripePeaks fast, portable;
                    options.scan = frame == &columns ? ScanLines::columns : ScanLines::rows;
                    ASSERT_TRUE(detail::find_peaks(frame->image(), options, fast, detail::Kernel::best));
                    ASSERT_TRUE(
                        detail::find_peaks(frame->image(), options, portable, detail::Kernel::portable));
                    EXPECT_TRUE(same(fast, portable)) << depth << " " << width << "x" << height;
                }
            }
            // The tiles of the two are sampled differently; a fixed threshold on an even background finds the
            // same.
            std::mt19937 again(17);
            Frame even(width, height, depth), turned(height, width, depth, 7);
            render(even, ScanLines::columns, light, {}, again);
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) turned.set(y, x, even.get(x, y));
            PeakOptions options;
            options.threshold = 0.05 * full;
            const StripePeaks a = found_in(even, options);
            options.scan = ScanLines::rows;
            const StripePeaks b = found_in(turned, options);
            ASSERT_EQ(a.lines, b.lines);
            for (int line = 0; line < a.lines; ++line) {
                ASSERT_GE(a.count[line], 1);
                ASSERT_GE(b.count[line], 1);
                EXPECT_NEAR(a.position_px[a.index(line, 0)], b.position_px[b.index(line, 0)], 1e-3);
            }
        }
    }
}

// What the lanes of eight measure is what the one-at-a-time measurement in double precision gives, on
// stripes, reflections beside them, uneven light, grains, plateaus, noise alone, near the border and far from
// it.
TEST(Peaks, LobesMeasuredInGroupsAreThoseMeasuredOneByOne) {
    std::mt19937 random(21);
    int compared = 0, apart = 0;
    for (const int depth : {8, 12}) {
        for (const double height : {0.06, 0.3, 0.7, 1.5}) {
            for (const double spread : {0.7, 1.5, 2.5, 3.6, 6.0}) {
                Frame frame(300, 240, depth);
                const double full = frame.image().full_scale();
                render(
                    frame, ScanLines::columns,
                    [&](int line, double at) {
                        const double light =
                            0.1 + 0.05 * std::sin(0.02 * line) + (line > 200 ? 2e-4 * at : 0.0);
                        const double step = line > 150 && line < 170 && at > 118 ? 0.1 : 0.0;
                        return full * (light + step) +
                               gaussian_stripe(at, 12 + 0.7 * line, spread, height * full) +
                               gaussian_stripe(at, 120, spread, 0.4 * height * full) +
                               gaussian_stripe(at, 120 + 0.1 * line, 1.5 * spread, 0.3 * height * full);
                    },
                    Noise{0.006 * full, 0}, random);
                for (const PeakMethod method : kMethods) {
                    for (const double threshold : {0.0, 0.03}) {
                        if (method != PeakMethod::centre_of_gravity && threshold > 0) continue;
                        PeakOptions options;
                        options.method = method;
                        options.threshold = threshold * full;
                        options.per_line = 8;
                        options.max_width_px = height > 0.5 ? 8 : 80;
                        StripePeaks group, careful;
                        ASSERT_TRUE(detail::find_peaks(frame.image(), options, group, detail::Kernel::best));
                        ASSERT_TRUE(
                            detail::find_peaks(frame.image(), options, careful, detail::Kernel::careful));
                        for (int line = 0; line < group.lines; ++line) {
                            ASSERT_EQ(group.count[line], careful.count[line]) << line;
                            for (int k = 0; k < group.count[line]; ++k) {
                                const int i = group.index(line, k);
                                ++compared;
                                const double moved = std::abs(group.position_px[i] - careful.position_px[i]);
                                const double widened = std::abs(group.width_px[i] - careful.width_px[i]);
                                EXPECT_LT(moved, 0.2) << name_of(method) << " line " << line;
                                EXPECT_LT(widened, 1.0) << name_of(method) << " line " << line;
                                apart += moved > 1e-3 || widened > 1e-3;
                                EXPECT_EQ(group.intensity[i], careful.intensity[i]);
                                EXPECT_EQ(group.flags[i], careful.flags[i]);
                            }
                        }
                    }
                }
            }
        }
    }
    EXPECT_GT(compared, 30000);
    // Levels are fractions of whole grey values: a pixel may stand exactly at half height, a step of the
    // background exactly at its limit; there rounding decides.
    EXPECT_LT(apart, compared / 1000);
}

TEST(Peaks, OddTinyBlackWhiteAndRandomImagesAreSurvived) {
    std::mt19937 random(18);
    for (const int depth : {8, 10, 16}) {
        for (const int width : {1, 2, 3, 31, 32, 33, 65}) {
            for (const int height : {1, 2, 3, 31, 33, 100}) {
                for (const int kind : {0, 1, 2, 3}) {
                    Frame frame(width, height, depth, width % 2);
                    const int full = frame.image().full_scale();
                    for (int y = 0; y < height; ++y)
                        for (int x = 0; x < width; ++x)
                            frame.set(x, y,
                                      kind == 0   ? 0
                                      : kind == 1 ? full
                                      : kind == 2 ? static_cast<int>(random() % (full + 1u))
                                                  : (random() % 20 == 0 ? full : 0));
                    for (const PeakMethod method : kMethods) {
                        for (const ScanLines scan : {ScanLines::columns, ScanLines::rows}) {
                            for (const double threshold : {0.0, 1.0}) {
                                PeakOptions options{scan, method};
                                options.threshold = threshold;
                                const StripePeaks peaks = found_in(frame, options);
                                const int length = scan == ScanLines::columns ? height : width;
                                for (int line = 0; line < peaks.lines; ++line) {
                                    if (kind < 2) {
                                        EXPECT_EQ(peaks.count[line], 0);
                                    }
                                    for (int k = 0; k < peaks.count[line]; ++k) {
                                        const int i = peaks.index(line, k);
                                        ASSERT_GE(peaks.position_px[i], -0.5f);
                                        ASSERT_LE(peaks.position_px[i], length - 0.5f);
                                        ASSERT_LE(peaks.intensity[i], full);
                                        ASSERT_GE(peaks.width_px[i], 1.f);
                                    }
                                }
                            }
                        }
                    }
                    EXPECT_TRUE(guess_scan_lines(frame.image()));
                }
            }
        }
    }
}

TEST(Peaks, RefusesWhatItCannotRead) {
    Frame frame(32, 32);
    StripePeaks peaks;
    const auto refused = [&](const StripeImage& image, const PeakOptions& options, const char* word) {
        const auto ok = find_peaks(image, options, peaks);
        ASSERT_FALSE(ok) << word;
        EXPECT_EQ(ok.error().kind, ErrorKind::input);
        EXPECT_THAT(ok.error().sentence(), HasSubstr(word));
    };
    StripeImage image;
    refused(image, {}, "empty");
    image = frame.image();
    image.height = -3;
    refused(image, {}, "empty");
    image = frame.image();
    image.bit_depth = 14;
    refused(image, {}, "14");
    image = frame.image();
    image.row_bytes = 31;
    refused(image, {}, "31");
    image.bit_depth = 12;
    image.width = 8;
    refused(image, {}, "odd");
    PeakOptions options;
    options.per_line = 0;
    refused(frame.image(), options, "per_line");
    options = {};
    options.threshold = std::nan("");
    refused(frame.image(), options, "threshold");
    options.threshold = 256;
    refused(frame.image(), options, "threshold");
    options = {};
    options.max_width_px = 0.5;
    refused(frame.image(), options, "width");
    options = {};
    options.steger_sigma_px = INFINITY;
    refused(frame.image(), options, "steger");
}

TEST(Peaks, AllocateNothingAfterTheFirstFrameOfASize) {
    std::mt19937 random(19);
    Frame quiet(400, 300), busy(400, 300);
    render(
        quiet, ScanLines::columns, [](int, double at) { return 10 + gaussian_stripe(at, 90, 2, 150); },
        Noise{1, 0}, random);
    render(
        busy, ScanLines::columns, [](int line, double at) { return 60 + 50 * std::sin(at) * std::cos(line); },
        Noise{20, 0}, random);
    StripePeaks peaks;
    for (const ScanLines scan : {ScanLines::columns, ScanLines::rows}) {
        for (const PeakMethod method : kMethods) {
            PeakOptions options{scan, method};
            ASSERT_TRUE(find_peaks(quiet.image(), options, peaks));
            options.threshold = 5;  // thousands of runs
            const long before = allocations_so_far();
            const bool ok = find_peaks(busy.image(), options, peaks).has_value();
            EXPECT_EQ(allocations_so_far() - before, 0);
            EXPECT_TRUE(ok);
        }
    }
}

TEST(Peaks, ScanDirectionIsThatOfTheStripe) {
    std::mt19937 random(20);
    for (const ScanLines scan : {ScanLines::columns, ScanLines::rows}) {
        for (const double slope : {0.0, 0.3, -0.7}) {
            Frame frame(500, 400);
            render(
                frame, scan,
                [&](int line, double at) {
                    const bool board = line > 40 && line < 180 && at > 20 && at < 120;
                    return (board && (line / 20 + int(at) / 20) % 2 ? 90 : 30) +
                           gaussian_stripe(at, 200 + slope * (line - 200), 3, 600);
                },
                Noise{1.5, 25}, random);
            const auto guess = guess_scan_lines(frame.image());
            ASSERT_TRUE(guess);
            EXPECT_EQ(*guess, scan) << slope;
        }
    }
}

}  // namespace
}  // namespace seamwright
