#include "core/profile/stripe/peaks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/allocations.h"
#include "tests/core/profile/peaks_found.h"

namespace seamwright {
namespace {

using testing::found_in;
using testing::Frame;
using testing::gaussian_stripe;
using ::testing::HasSubstr;
using testing::kMethods;
using testing::name_of;
using testing::Noise;
using testing::render;

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
