// Real frames: a saturated laser stripe across a chessboard, with reflections (../shared/data/etna).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/profile/stripe/peaks.h"

namespace seamwright {
namespace {

std::vector<std::string> frames() {
    const char* given = std::getenv("SEAMWRIGHT_DATA");
    const std::filesystem::path data = given ? given : SEAMWRIGHT_SHARED_DATA;
    std::vector<std::string> result;
    for (const char* set : {"root", "calib1", "calib2"}) {
        std::error_code error;
        for (const auto& entry : std::filesystem::directory_iterator(data / "etna" / set, error))
            if (entry.path().extension() == ".png") result.push_back(entry.path().string());
    }
    std::sort(result.begin(), result.end());
    return result;
}

// Where the stripe is, found another way: the largest saturated blob of the picture by area (and every
// further one at least 60 px long), cut row by row. Rows where the blob touches the border of the picture
// have no middle.
struct Visible {
    std::vector<double> middle;  // NaN: not visible on this row
    int rows = 0;
};
Visible visible(const cv::Mat& frame) {
    cv::Mat saturated, labels, stats, centres;
    cv::threshold(frame, saturated, 249, 255, cv::THRESH_BINARY);
    const int count = cv::connectedComponentsWithStats(saturated, labels, stats, centres);
    Visible result;
    result.middle.assign(static_cast<std::size_t>(frame.rows), std::nan(""));
    int stripe = 0;
    for (int i = 1; i < count; ++i)
        if (stripe == 0 || stats.at<int>(i, cv::CC_STAT_AREA) > stats.at<int>(stripe, cv::CC_STAT_AREA))
            stripe = i;
    if (stripe == 0) return result;
    std::vector<bool> belongs(static_cast<std::size_t>(count), false);
    belongs[static_cast<std::size_t>(stripe)] = true;
    for (int i = 1; i < count; ++i)
        if (stats.at<int>(i, cv::CC_STAT_HEIGHT) >= 60 && stats.at<int>(i, cv::CC_STAT_AREA) >= 600)
            belongs[static_cast<std::size_t>(i)] = true;
    for (int y = 0; y < frame.rows; ++y) {
        // The widest piece of a row.
        int best = 0, best_begin = 0;
        for (int x = 0; x < frame.cols;) {
            const int label = labels.at<int>(y, x);
            int end = x;
            while (end < frame.cols && labels.at<int>(y, end) == label) ++end;
            if (label > 0 && belongs[static_cast<std::size_t>(label)] && end - x > best)
                best = end - x, best_begin = x;
            x = end;
        }
        if (best < 4 || best_begin == 0 || best_begin + best == frame.cols) continue;
        result.middle[static_cast<std::size_t>(y)] = best_begin + 0.5 * (best - 1);
        ++result.rows;
    }
    return result;
}

struct Share {
    int visible = 0, strongest = 0, any = 0;
};

Share found(const cv::Mat& frame, const Visible& truth, const PeakOptions& options) {
    const StripeImage image{reinterpret_cast<const std::byte*>(frame.data), frame.cols, frame.rows,
                            frame.step[0], 8};
    StripePeaks peaks;
    EXPECT_TRUE(find_peaks(image, options, peaks));
    Share share;
    for (int y = 0; y < frame.rows; ++y) {
        const double middle = truth.middle[static_cast<std::size_t>(y)];
        if (std::isnan(middle)) continue;
        ++share.visible;
        bool any = false;
        for (int k = 0; k < peaks.count[static_cast<std::size_t>(y)]; ++k) {
            const bool on =
                std::abs(peaks.position_px[static_cast<std::size_t>(peaks.index(y, k))] - middle) <= 2;
            any |= on;
            share.strongest += on && k == 0;
        }
        share.any += any;
    }
    return share;
}

TEST(EtnaFrames, StripeIsFoundOverItsWholeVisibleLength) {
    const auto files = frames();
    if (files.empty()) GTEST_SKIP() << "skipped: no real data";
    EXPECT_EQ(files.size(), 24u);
    for (const std::string& file : files) {
        const cv::Mat frame = cv::imread(file, cv::IMREAD_GRAYSCALE);
        ASSERT_FALSE(frame.empty()) << file;
        const Visible truth = visible(frame);
        ASSERT_GT(truth.rows, 300) << file;
        const StripeImage image{reinterpret_cast<const std::byte*>(frame.data), frame.cols, frame.rows,
                                frame.step[0], 8};
        const auto guess = guess_scan_lines(image);
        ASSERT_TRUE(guess);
        EXPECT_EQ(*guess, ScanLines::rows) << file;
        for (const PeakMethod method :
             {PeakMethod::centre_of_gravity, PeakMethod::gaussian, PeakMethod::steger}) {
            for (const double threshold : {0.0, 40.0, 100.0}) {
                PeakOptions options{ScanLines::rows, method};
                options.threshold = threshold;
                const Share share = found(frame, truth, options);
                EXPECT_GE(share.any, 0.99 * share.visible) << file << " threshold " << threshold;
                EXPECT_GE(share.strongest, 0.98 * share.visible) << file << " threshold " << threshold;
            }
        }
    }
}

}  // namespace
}  // namespace seamwright
