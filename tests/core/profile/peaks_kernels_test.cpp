// The processor's wide kernels measure what the plain ones measure.

#include <gtest/gtest.h>

#include "core/profile/stripe/peaks_detail.h"
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
        for (const auto& size :
             std::vector<std::pair<int, int>>{{257, 131}, {64, 64}, {33, 200}, {700, 45}}) {
            const int width = size.first, height = size.second;
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

}  // namespace
}  // namespace seamwright
