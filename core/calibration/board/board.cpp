#include "core/calibration/board/board.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/calibration/board/board_checker.h"
#include "core/calibration/board/board_detectors.h"
#include "core/calibration/camera/camera.h"

namespace seamwright {

Expected<void> validate(const BoardSpec& spec) {
    if (spec.columns < 3 || spec.rows < 3 || spec.columns > 200 || spec.rows > 200)
        return input_error(Text("a board of {}x{} points is not possible", std::to_string(spec.columns),
                                std::to_string(spec.rows)),
                           "board", "give columns x rows between 3 and 200, e.g. 7x6");
    if (!std::isfinite(spec.pitch_mm) || spec.pitch_mm <= 0)
        return input_error("the pitch must be a positive number of millimetres", "pitch_mm", "give e.g. 10");
    if (spec.pitch_mm < 0.2)
        return input_error(Text("a pitch of {} mm looks like metres", std::to_string(spec.pitch_mm)),
                           "pitch_mm", "give the pitch in millimetres (0.01 m = 10 mm)");
    if (spec.pitch_mm > 1000)
        return input_error("a pitch beyond one metre looks like micrometres", "pitch_mm",
                           "give the pitch in millimetres");
    if (spec.pattern == BoardPattern::charuco && spec.marker_mm != 0 &&
        !(spec.marker_mm > 0 && spec.marker_mm < spec.pitch_mm))
        return input_error("the marker must be smaller than its square", "marker_mm",
                           "give e.g. 0.75 of the pitch");
    return {};
}

namespace detail {

cv::Mat grey_of(const StripeImage& image) {
    cv::Mat out;
    if (image.empty()) return out;
    auto* data = const_cast<std::byte*>(image.pixels);
    if (image.bytes_per_pixel() == 1)
        cv::Mat(image.height, image.width, CV_8UC1, data, image.row_bytes).copyTo(out);
    else
        cv::Mat(image.height, image.width, CV_16UC1, data, image.row_bytes)
            .convertTo(out, CV_8U, 255.0 / image.full_scale());
    return out;
}

cv::Mat stripe_mask(const cv::Mat& grey) {
    // The stripe is the long connected piece near saturation. Glints are short and stay as they are.
    cv::Mat bright, labels, stats, centres;
    cv::threshold(grey, bright, 235, 255, cv::THRESH_BINARY);
    const int count = cv::connectedComponentsWithStats(bright, labels, stats, centres, 8);
    cv::Mat mask = cv::Mat::zeros(grey.size(), CV_8U);
    const int least = std::max(grey.cols, grey.rows) / 12;
    for (int i = 1; i < count; ++i) {
        const int w = stats.at<int>(i, cv::CC_STAT_WIDTH), h = stats.at<int>(i, cv::CC_STAT_HEIGHT);
        const int area = stats.at<int>(i, cv::CC_STAT_AREA);
        // Long and thin: its area is a small part of the square over its length.
        const int length = std::max(w, h);
        if (length >= least && area < 0.35 * length * length) mask.setTo(255, labels == i);
    }
    return mask;
}

cv::Mat without_stripe(const cv::Mat& grey, const cv::Mat& stripe) {
    if (cv::countNonZero(stripe) == 0) return grey.clone();
    cv::Mat wide;
    cv::dilate(stripe, wide, cv::getStructuringElement(cv::MORPH_ELLIPSE, {15, 15}));
    // Fill with the blurred surroundings (normalised convolution), so that no new edge arises.
    cv::Mat value, weight;
    grey.convertTo(value, CV_32F);
    cv::Mat keep = (wide == 0);
    keep.convertTo(weight, CV_32F, 1.0 / 255);
    value = value.mul(weight);
    cv::Mat sum, total;
    cv::boxFilter(value, sum, CV_32F, {81, 81});
    cv::boxFilter(weight, total, CV_32F, {81, 81});
    cv::Mat fill = sum / cv::max(total, 1e-3f), fill8, out = grey.clone();
    fill.convertTo(fill8, CV_8U);
    fill8.copyTo(out, wide);
    return out;
}

cv::Mat stretched(const cv::Mat& grey, const cv::Mat& ignore, double gamma) {
    std::array<int, 256> histogram{};
    int total = 0;
    for (int y = 0; y < grey.rows; ++y)
        for (int x = 0; x < grey.cols; ++x)
            if (ignore.empty() || !ignore.at<std::uint8_t>(y, x)) {
                ++histogram[grey.at<std::uint8_t>(y, x)];
                ++total;
            }
    const auto quantile = [&](double q) {
        int sum = 0;
        for (int i = 0; i < 256; ++i)
            if ((sum += histogram[static_cast<std::size_t>(i)]) > q * total) return i;
        return 255;
    };
    const double low = quantile(0.005), high = std::max<double>(quantile(0.985), low + 4);
    cv::Mat table(1, 256, CV_8U), out;
    for (int i = 0; i < 256; ++i)
        table.at<std::uint8_t>(i) = cv::saturate_cast<std::uint8_t>(
            255 * std::pow(std::clamp((i - low) / (high - low), 0.0, 1.0), gamma));
    cv::LUT(grey, table, out);
    return out;
}

}  // namespace detail

BoardSearch find_board(const StripeImage& image, const BoardSpec& spec) {
    BoardSearch found;
    if (image.empty() || image.width < 32 || image.height < 32 || !validate(spec)) return found;
    try {
        if (spec.pattern == BoardPattern::chessboard) {
            const int type = image.bytes_per_pixel() == 1 ? CV_8UC1 : CV_16UC1;
            auto* data = const_cast<std::byte*>(image.pixels);
            return detail::find_checker(cv::Mat(image.height, image.width, type, data, image.row_bytes),
                                        image.full_scale(), spec);
        }
        const cv::Mat grey = detail::grey_of(image);
        found.board = spec.pattern == BoardPattern::circles ? detail::find_circles(grey, spec)
                                                            : detail::find_charuco(grey, spec);
    } catch (const cv::Exception&) {
        // OpenCV refuses some degenerate images by exception: there is no board in them.
    }
    return found;
}

Text why_missed(const BoardSpec& spec, const BoardMiss& miss) {
    if (miss.counted)
        return Text("a board of {} x {} inner corners is seen, {} x {} was asked for", miss.counted->columns,
                    miss.counted->rows, spec.columns, spec.rows);
    if (miss.several) return Text("more than one board of {} x {} corners is seen", spec.columns, spec.rows);
    return Text("no complete board of {} x {} corners is seen", spec.columns, spec.rows);
}

Text cure_of(const BoardMiss& miss) {
    if (miss.counted) return "count the corners where four squares meet, not the squares";
    if (miss.several) return "leave one of them in the picture";
    return "bring the whole board into the picture, more light, less gloss, and check its counts";
}

FoundBoard turned(const FoundBoard& board, const BoardSpec& spec, int quarter_turns) {
    FoundBoard out = board;
    const int turns = ((quarter_turns % 4) + 4) % 4;
    for (std::size_t i = 0; i < board.index.size(); ++i) {
        int c = board.index[i] % spec.columns, r = board.index[i] / spec.columns;
        if (spec.columns == spec.rows) {
            for (int t = 0; t < turns; ++t) {
                const int old = c;
                c = spec.rows - 1 - r;
                r = old;
            }
        } else if (turns >= 2) {
            c = spec.columns - 1 - c;
            r = spec.rows - 1 - r;
        }
        out.index[i] = r * spec.columns + c;
        out.object_mm[i] = {c * spec.pitch_mm, r * spec.pitch_mm, 0};
    }
    return out;
}

std::vector<Eigen::Vector2d> outline(const FoundBoard& board, const BoardSpec& spec) {
    std::vector<Eigen::Vector2d> flat;
    for (const auto& p : board.object_mm) flat.push_back(p.head<2>());
    const auto h = homography_dlt(flat, board.pixel);
    if (!h) return {};
    const double m = spec.pattern == BoardPattern::charuco ? 0 : spec.pitch_mm;
    const double w = (spec.columns - 1) * spec.pitch_mm, t = (spec.rows - 1) * spec.pitch_mm;
    std::vector<Eigen::Vector2d> out;
    for (const auto& corner : {Eigen::Vector2d(-m, -m), Eigen::Vector2d(w + m, -m),
                               Eigen::Vector2d(w + m, t + m), Eigen::Vector2d(-m, t + m)})
        out.push_back((*h * corner.homogeneous()).hnormalized());
    return out;
}

}  // namespace seamwright
