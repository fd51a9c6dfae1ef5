#include "core/calibration/board/board.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/calibration/board/board_checker.h"
#include "core/calibration/board/board_detectors.h"
#include "core/calibration/camera/camera.h"

namespace seamwright {

namespace {

constexpr double kLeastPitch_mm = 0.2;  // a finer board is one given in metres

}  // namespace

Expected<void> validate(const BoardSpec& spec) {
    if (spec.columns < 3 || spec.rows < 3 || spec.columns > 200 || spec.rows > 200)
        return input_error(Text("a board of {}x{} points is not possible", std::to_string(spec.columns),
                                std::to_string(spec.rows)),
                           "board", "give columns x rows between 3 and 200, e.g. 7x6");
    if (!std::isfinite(spec.pitch_mm) || spec.pitch_mm <= 0)
        return input_error("the pitch must be a positive number of millimetres", "pitch_mm", "give e.g. 10");
    if (spec.pitch_mm < kLeastPitch_mm)
        return input_error(Text("a pitch of {} mm looks like metres", std::to_string(spec.pitch_mm)),
                           "pitch_mm", "give the pitch in millimetres (0.01 m = 10 mm)");
    if (spec.pitch_mm > 1000)
        return input_error("a pitch beyond one metre looks like micrometres", "pitch_mm",
                           "give the pitch in millimetres");
    if (spec.pattern == BoardPattern::aprilgrid && spec.marker_mm == 0)
        return input_error("the size of the tags is not given", "marker_mm",
                           "give the edge of a tag in millimetres beside the pitch from tag to tag");
    if ((spec.pattern == BoardPattern::charuco || spec.pattern == BoardPattern::aprilgrid) &&
        spec.marker_mm != 0 && !(spec.marker_mm > 0 && spec.marker_mm < spec.pitch_mm))
        return input_error("the marker must be smaller than its square", "marker_mm",
                           "give e.g. 0.75 of the pitch");
    return {};
}

namespace {

// In OpenCV's order: its numbers are the places.
constexpr const char* kDictionaries[] = {
    "4x4_50",        "4x4_100",        "4x4_250",       "4x4_1000", "5x5_50",         "5x5_100",
    "5x5_250",       "5x5_1000",       "6x6_50",        "6x6_100",  "6x6_250",        "6x6_1000",
    "7x7_50",        "7x7_100",        "7x7_250",       "7x7_1000", "aruco_original", "apriltag_16h5",
    "apriltag_25h9", "apriltag_36h10", "apriltag_36h11"};

}  // namespace

std::string_view name_of(BoardPattern pattern) {
    switch (pattern) {
        case BoardPattern::chessboard:
            return "chessboard";
        case BoardPattern::circles:
            return "circles";
        case BoardPattern::charuco:
            return "charuco";
        case BoardPattern::aprilgrid:
            return "aprilgrid";
    }
    return "chessboard";
}

std::optional<BoardPattern> board_pattern_named(const std::string& name) {
    for (const BoardPattern p :
         {BoardPattern::chessboard, BoardPattern::circles, BoardPattern::charuco, BoardPattern::aprilgrid})
        if (name == name_of(p)) return p;
    return std::nullopt;
}

int board_columns(const BoardSpec& spec) {
    return spec.pattern == BoardPattern::charuco     ? spec.columns - 1
           : spec.pattern == BoardPattern::aprilgrid ? 2 * spec.columns
                                                     : spec.columns;
}

int board_rows(const BoardSpec& spec) {
    return spec.pattern == BoardPattern::charuco     ? spec.rows - 1
           : spec.pattern == BoardPattern::aprilgrid ? 2 * spec.rows
                                                     : spec.rows;
}

Eigen::Vector3d board_point(const BoardSpec& spec, int index) {
    const int column = index % board_columns(spec), row = index / board_columns(spec);
    if (spec.pattern != BoardPattern::aprilgrid) return {column * spec.pitch_mm, row * spec.pitch_mm, 0};
    const auto along = [&](int k) { return k / 2 * spec.pitch_mm + k % 2 * spec.marker_mm; };
    return {along(column), along(row), 0};
}

std::optional<int> dictionary_named(const std::string& name) {
    std::string plain;
    for (const char c : name) plain += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    if (plain.rfind("dict_", 0) == 0) plain.erase(0, 5);
    const auto at = std::find(std::begin(kDictionaries), std::end(kDictionaries), plain);
    if (at == std::end(kDictionaries)) return std::nullopt;
    return static_cast<int>(at - std::begin(kDictionaries));
}

std::vector<std::string> dictionary_names() {
    return {std::begin(kDictionaries), std::end(kDictionaries)};
}

namespace detail {

// Of the square over its length: a piece that covers less is a stripe.
constexpr double kSaturatedThin = 0.35;
constexpr double kDarkQuantile = 0.005;   // of the grey values: what is darker is stretched to black
constexpr double kLightQuantile = 0.985;  // of the grey values: what is lighter is stretched to white
constexpr int kLeastStretch = 4;          // grey values that are stretched, however flat the picture
constexpr double kNearSaturation = 235;   // of 255
// Longer side of the pictures that are searched, one after the other.
constexpr std::array kSides_px{1600.0, 3200.0};
constexpr float kLeastKept = 1e-3F;  // of the pixels around: guards the mean where all are the stripe's

std::vector<cv::Mat> reduced(const cv::Mat& grey) {
    const double longest = std::max(grey.cols, grey.rows);
    std::vector<cv::Mat> pictures;
    for (const double side : kSides_px) {
        if (!pictures.empty() && pictures.back().cols == grey.cols) break;
        if (longest <= side) {
            pictures.push_back(grey);
        } else {
            pictures.emplace_back();
            cv::resize(grey, pictures.back(), {}, side / longest, side / longest, cv::INTER_AREA);
        }
    }
    return pictures;
}

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
    cv::threshold(grey, bright, kNearSaturation, 255, cv::THRESH_BINARY);
    const int count = cv::connectedComponentsWithStats(bright, labels, stats, centres, 8);
    cv::Mat mask = cv::Mat::zeros(grey.size(), CV_8U);
    const int least = std::max(grey.cols, grey.rows) / 12;
    for (int i = 1; i < count; ++i) {
        const int w = stats.at<int>(i, cv::CC_STAT_WIDTH), h = stats.at<int>(i, cv::CC_STAT_HEIGHT);
        const int area = stats.at<int>(i, cv::CC_STAT_AREA);
        // Long and thin: its area is a small part of the square over its length.
        const int length = std::max(w, h);
        if (length >= least && area < kSaturatedThin * length * length) mask.setTo(255, labels == i);
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
    cv::Mat fill = sum / cv::max(total, kLeastKept), fill8, out = grey.clone();
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
    const double low = quantile(kDarkQuantile),
                 high = std::max<double>(quantile(kLightQuantile), low + kLeastStretch);
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
        const int type = image.bytes_per_pixel() == 1 ? CV_8UC1 : CV_16UC1;
        const cv::Mat full(image.height, image.width, type, const_cast<std::byte*>(image.pixels),
                           image.row_bytes);
        found.board = spec.pattern == BoardPattern::circles ? detail::find_circles(grey, spec)
                                                            : detail::find_marker_board(full, grey, spec);
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
    const double m = spec.pattern == BoardPattern::aprilgrid ? 0 : spec.pitch_mm;
    const Eigen::Vector3d last = board_point(spec, board_columns(spec) * board_rows(spec) - 1);
    const double w = last.x(), t = last.y();
    std::vector<Eigen::Vector2d> out;
    for (const auto& corner : {Eigen::Vector2d(-m, -m), Eigen::Vector2d(w + m, -m),
                               Eigen::Vector2d(w + m, t + m), Eigen::Vector2d(-m, t + m)})
        out.push_back((*h * corner.homogeneous()).hnormalized());
    return out;
}

}  // namespace seamwright
