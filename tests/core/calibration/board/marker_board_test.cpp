// Boards with markers, drawn here square by square: which corner is which, how exactly, and what is found by itself.

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "core/calibration/board/board.h"

namespace seamwright {
namespace {

constexpr int kFlat = 80;  // px a pitch of the board as drawn

struct Drawn {
    BoardSpec spec;
    cv::Mat flat;
    double rim = kFlat;  // white around it
};

cv::Mat marker(int dictionary, int id, int size, int border) {
    cv::Mat out;
    cv::aruco::drawMarker(cv::makePtr<cv::aruco::Dictionary>(*cv::aruco::getPredefinedDictionary(dictionary)),
                          id, size, out, border);
    return out;
}

// Light squares with markers in the order of reading; the first square is dark, `legacy`: light.
Drawn charuco(int columns, int rows, int dictionary, double share, bool legacy = false) {
    Drawn d;
    d.spec.pattern = BoardPattern::charuco;
    d.spec.columns = columns, d.spec.rows = rows, d.spec.pitch_mm = 20;
    d.flat = cv::Mat((rows + 2) * kFlat, (columns + 2) * kFlat, CV_8U, cv::Scalar(225));
    int id = 0;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            cv::Mat square = d.flat(cv::Rect((c + 1) * kFlat, (r + 1) * kFlat, kFlat, kFlat));
            if ((r + c) % 2 == (legacy ? 1 : 0)) {
                square.setTo(25);
                continue;
            }
            const int size = static_cast<int>(std::lround(share * kFlat)), in = (kFlat - size) / 2;
            cv::Mat m = marker(dictionary, id++, size, 1);
            m.convertTo(m, CV_8U, 200.0 / 255, 25);
            m.copyTo(square(cv::Rect(in, in, size, size)));
        }
    return d;
}

// Tags numbered from the lower left on, a small dark square at every corner between them.
Drawn aprilgrid(int columns, int rows, double share) {
    Drawn d;
    d.spec.pattern = BoardPattern::aprilgrid;
    d.spec.columns = columns, d.spec.rows = rows, d.spec.pitch_mm = 30;
    const int tag = static_cast<int>(std::lround(share * kFlat)), gap = kFlat - tag;
    d.spec.marker_mm = 30.0 * tag / kFlat;
    d.flat = cv::Mat((rows + 2) * kFlat, (columns + 2) * kFlat, CV_8U, cv::Scalar(225));
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            cv::Mat m = marker(cv::aruco::DICT_APRILTAG_36h11, (rows - 1 - r) * columns + c, tag, 2);
            m.convertTo(m, CV_8U, 200.0 / 255, 25);
            m.copyTo(d.flat(cv::Rect((c + 1) * kFlat, (r + 1) * kFlat, tag, tag)));
        }
    for (int r = 0; r <= rows; ++r)
        for (int c = 0; c <= columns; ++c)
            d.flat(cv::Rect((c + 1) * kFlat - gap, (r + 1) * kFlat - gap, gap, gap)).setTo(25);
    return d;
}

// Where a point of the board (pitches from its first corner as printed) is in the flat drawing.
cv::Point2d flat_of(const Drawn& d, const Eigen::Vector3d& mm) {
    const double first = d.spec.pattern == BoardPattern::charuco ? 2 * kFlat : kFlat;
    return {first + mm.x() / d.spec.pitch_mm * kFlat - 0.5, first + mm.y() / d.spec.pitch_mm * kFlat - 0.5};
}

struct Scene {
    cv::Mat image, truth;  // truth: flat -> image
};

Scene photograph(const Drawn& d, double tilt, double turn, double scale, std::uint64_t seed) {
    constexpr int kFine = 4;
    const cv::Size size(1280, 1024);
    const double w = d.flat.cols, h = d.flat.rows;
    const std::vector<cv::Point2f> from{{0, 0}, {float(w), 0}, {float(w), float(h)}, {0, float(h)}};
    std::vector<cv::Point2f> to;
    for (const auto& p : from) {
        const double x = (p.x - w / 2) * scale, y = (p.y - h / 2) * scale;
        const double u = x * std::cos(turn) - y * std::sin(turn), v = x * std::sin(turn) + y * std::cos(turn);
        const double depth = 1 + v * std::sin(tilt) / 1500;
        to.emplace_back(float(640 + u / depth), float(512 + v * std::cos(tilt) / depth));
    }
    Scene s;
    s.truth = cv::getPerspectiveTransform(from, to);
    const cv::Mat finer =
        (cv::Mat_<double>(3, 3) << kFine, 0, 0.5 * (kFine - 1), 0, kFine, 0.5 * (kFine - 1), 0, 0, 1);
    cv::Mat fine;
    cv::warpPerspective(d.flat, fine, finer * s.truth, size * kFine, cv::INTER_LINEAR, cv::BORDER_CONSTANT,
                        cv::Scalar(120));
    cv::resize(fine, s.image, size, 0, 0, cv::INTER_AREA);
    cv::GaussianBlur(s.image, s.image, {}, 0.8);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> noise(0, 2);
    for (auto it = s.image.begin<std::uint8_t>(); it != s.image.end<std::uint8_t>(); ++it)
        *it = cv::saturate_cast<std::uint8_t>(*it + noise(random));
    return s;
}

StripeImage view(const cv::Mat& m) {
    StripeImage image;
    image.pixels = reinterpret_cast<const std::byte*>(m.data);
    image.width = m.cols;
    image.height = m.rows;
    image.row_bytes = m.step;
    image.bit_depth = 8;
    return image;
}

// rms of the corners against where they were drawn; every index must be the right one.
double rms_px(const Drawn& d, const Scene& s, const FoundBoard& board) {
    double squares = 0;
    for (std::size_t i = 0; i < board.pixel.size(); ++i) {
        EXPECT_LT((board.object_mm[i] - board_point(d.spec, board.index[i])).norm(), 1e-9);
        const cv::Point2d flat = flat_of(d, board.object_mm[i]);
        const cv::Mat p = s.truth * (cv::Mat_<double>(3, 1) << flat.x, flat.y, 1);
        const Eigen::Vector2d there(p.at<double>(0) / p.at<double>(2), p.at<double>(1) / p.at<double>(2));
        EXPECT_LT((board.pixel[i] - there).norm(), 0.5) << "corner " << board.index[i];
        squares += (board.pixel[i] - there).squaredNorm();
    }
    return std::sqrt(squares / (2.0 * static_cast<double>(board.pixel.size())));
}

struct Case {
    const char* name;
    Drawn drawn;
};

TEST(MarkerBoard, EveryFamilyAndLayoutIsFoundByItself) {
    const Case cases[] = {{"4x4", charuco(8, 7, cv::aruco::DICT_4X4_50, 0.75)},
                          {"5x5", charuco(9, 7, cv::aruco::DICT_5X5_100, 0.7)},
                          {"6x6, even rows", charuco(7, 6, cv::aruco::DICT_6X6_250, 0.8)},
                          {"5x5, even rows, legacy", charuco(7, 8, cv::aruco::DICT_5X5_50, 0.75, true)},
                          {"original", charuco(7, 5, cv::aruco::DICT_ARUCO_ORIGINAL, 0.75)},
                          {"aprilgrid", aprilgrid(6, 6, 10.0 / 13)}};
    std::uint64_t seed = 1;
    for (const Case& c : cases) {
        for (const double tilt : {0.0, 0.6, -0.7}) {
            const double turn = 0.3 * static_cast<double>(seed % 5) - 0.5;
            const Scene s = photograph(c.drawn, tilt, turn, 1.0, ++seed);
            const auto found = find_board(view(s.image), c.drawn.spec);
            ASSERT_TRUE(found.board) << c.name << " tilt " << tilt;
            const auto all = static_cast<std::size_t>(board_columns(c.drawn.spec) * board_rows(c.drawn.spec));
            // The squares between tags are a quarter of a pitch: some corners of a leaning grid are too small to measure.
            const auto least = c.drawn.spec.pattern == BoardPattern::aprilgrid ? all * 3 / 4 : all * 9 / 10;
            EXPECT_GE(found.board->pixel.size(), least) << c.name;
            EXPECT_EQ(found.board->symmetry, 1);
            EXPECT_LT(rms_px(c.drawn, s, *found.board), 0.06) << c.name << " tilt " << tilt;
        }
    }
}

TEST(MarkerBoard, HalfOfItHiddenTheRestIsStillKnown) {
    const Drawn d = charuco(9, 7, cv::aruco::DICT_4X4_100, 0.75);
    Scene s = photograph(d, 0.3, 0.2, 1.0, 7);
    s.image(cv::Rect(0, 0, 640, 1024)).setTo(90);
    const auto found = find_board(view(s.image), d.spec);
    ASSERT_TRUE(found.board);
    EXPECT_GE(found.board->pixel.size(), 12u);
    EXPECT_LT(rms_px(d, s, *found.board), 0.06);
}

TEST(MarkerBoard, WhatWasSaidIsHeldTo) {
    Drawn d = charuco(8, 6, cv::aruco::DICT_5X5_100, 0.75);
    const Scene s = photograph(d, 0.2, 0.1, 1.0, 9);
    d.spec.dictionary = *dictionary_named("DICT_5X5_250");
    EXPECT_TRUE(find_board(view(s.image), d.spec).board) << "its first markers are the same";
    d.spec.dictionary = *dictionary_named("4x4_50");
    EXPECT_FALSE(find_board(view(s.image), d.spec).board);
    d.spec.dictionary = -1;
    d.spec.legacy = true;
    EXPECT_FALSE(find_board(view(s.image), d.spec).board) << "it is not the old layout";
    d.spec.legacy = false;
    EXPECT_TRUE(find_board(view(s.image), d.spec).board);
}

// Markers of another board: its numbers lie elsewhere.
TEST(MarkerBoard, AnotherBoardIsNotTaken) {
    const Drawn d = charuco(8, 6, cv::aruco::DICT_4X4_50, 0.75);
    const Scene s = photograph(d, 0.2, 0.1, 1.0, 11);
    BoardSpec other = d.spec;
    other.columns = 6, other.rows = 8;
    const auto found = find_board(view(s.image), other);
    EXPECT_FALSE(found.board) << found.board->pixel.size();
    cv::Mat empty(1024, 1280, CV_8U, cv::Scalar(128));
    EXPECT_FALSE(find_board(view(empty), d.spec).board);
    cv::Mat mirrored;
    cv::flip(s.image, mirrored, 1);
    EXPECT_FALSE(find_board(view(mirrored), d.spec).board);
}

TEST(MarkerBoard, NamesAreOpenCVs) {
    EXPECT_EQ(dictionary_named("4x4_50"), cv::aruco::DICT_4X4_50);
    EXPECT_EQ(dictionary_named("DICT_7X7_1000"), cv::aruco::DICT_7X7_1000);
    EXPECT_EQ(dictionary_named("apriltag_36h11"), cv::aruco::DICT_APRILTAG_36h11);
    EXPECT_EQ(dictionary_named("aruco_original"), cv::aruco::DICT_ARUCO_ORIGINAL);
    EXPECT_FALSE(dictionary_named("8x8_50"));
    EXPECT_FALSE(dictionary_named(""));
    BoardSpec tags;
    tags.pattern = BoardPattern::aprilgrid;
    tags.columns = tags.rows = 6;
    tags.pitch_mm = 30;
    EXPECT_FALSE(validate(tags)) << "without the tags' size";
}

}  // namespace
}  // namespace seamwright
