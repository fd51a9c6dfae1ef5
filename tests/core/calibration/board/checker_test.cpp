// The product's own search for a checkerboard, on rendered pictures with known corners.

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "core/calibration/board/board_checker.h"
#include "tests/core/calibration/board/board_scene.h"

namespace seamwright {
namespace {

using test::BoardPicture;
using test::BoardScene;

cv::Mat view_of(BoardPicture& picture) {
    return {picture.height, picture.width, CV_8U, picture.pixels.data()};
}

BoardSpec spec_of(int columns, int rows) {
    BoardSpec spec;
    spec.columns = columns, spec.rows = rows, spec.pitch_mm = 10;
    return spec;
}

BoardSearch search(BoardPicture& picture, int columns, int rows) {
    return detail::find_checker(view_of(picture), 255, spec_of(columns, rows));
}

BoardScene small_scene(unsigned seed, double tilt_deg) {
    BoardScene s;
    s.width = 640, s.height = 512, s.focal = 760, s.seed = seed;
    std::mt19937 random(seed);
    return test::posed(s, tilt_deg, 30, random);
}

TEST(Checkerboard, EveryCornerOfAPlainBoard) {
    const BoardScene s = small_scene(1, 30);
    BoardPicture picture = test::render(s);
    const auto found = search(picture, 7, 6);
    ASSERT_TRUE(found.board);
    EXPECT_EQ(found.board->index.size(), 42u);
    EXPECT_EQ(found.board->symmetry, 1);
    const auto errors = test::errors_of(*found.board, s, picture);
    ASSERT_TRUE(errors);
    EXPECT_LT(errors->rms, 0.03);
}

TEST(Checkerboard, CornersAreNoLessExactThanCornerSubPix) {
    double ours = 0, theirs = 0;
    std::size_t count = 0;
    for (const unsigned seed : {2u, 3u, 4u}) {
        BoardScene s = small_scene(seed, 35);
        s.noise = 2, s.blur_px = 1;
        if (seed == 4) s.focal = 480, s.k1 = -0.2, s.at.z() *= 0.6, s.at.head<2>() *= 0.8;
        BoardPicture picture = test::render(s);
        const auto found = search(picture, 7, 6);
        ASSERT_TRUE(found.board) << seed;
        const auto errors = test::errors_of(*found.board, s, picture);
        ASSERT_TRUE(errors) << seed;
        // The same corners by OpenCV, from the truth as its start and with the window that the squares let.
        cv::Mat soft;
        cv::GaussianBlur(view_of(picture), soft, {}, 0.8);
        for (std::size_t i = 0; i < found.board->index.size(); ++i) {
            const int k = found.board->index[i];
            const Eigen::Vector2d truth = picture.corners[static_cast<std::size_t>(k)];
            const double step = std::min((test::seen_at(s, k % 7 + 1, k / 7) - truth).norm(),
                                         (test::seen_at(s, k % 7, k / 7 + 1) - truth).norm());
            const int half = std::clamp(static_cast<int>(0.4 * step), 2, 11);
            std::vector<cv::Point2f> one{{static_cast<float>(truth.x()), static_cast<float>(truth.y())}};
            cv::cornerSubPix(soft, one, {half, half}, {-1, -1},
                             {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-4});
            theirs += (Eigen::Vector2d(one[0].x, one[0].y) - truth).squaredNorm();
            ours += errors->px[i] * errors->px[i];
            ++count;
        }
    }
    RecordProperty("ours_rms_px", std::to_string(std::sqrt(ours / static_cast<double>(count))));
    RecordProperty("cornerSubPix_rms_px", std::to_string(std::sqrt(theirs / static_cast<double>(count))));
    std::printf("rms of the corners: ours %.4f px, cornerSubPix %.4f px\n",
                std::sqrt(ours / static_cast<double>(count)), std::sqrt(theirs / static_cast<double>(count)));
    EXPECT_LE(ours, theirs);
}

TEST(Checkerboard, CornersUnderAStripeAreLeftOut) {
    // Along the second row.
    BoardScene s = small_scene(5, 20);
    const Eigen::Vector2d a = test::seen_at(s, 0, 1), b = test::seen_at(s, 6, 1);
    s.stripe_px = 8, s.stripe_halo = 6, s.stripe_through = a;
    s.stripe_deg = std::atan2(b.y() - a.y(), b.x() - a.x()) * 180 / M_PI;
    BoardPicture picture = test::render(s);
    const auto found = search(picture, 7, 6);
    ASSERT_TRUE(found.board);
    EXPECT_GE(found.board->index.size(), 30u);
    const auto errors = test::errors_of(*found.board, s, picture);
    ASSERT_TRUE(errors);
    EXPECT_LT(errors->worst, 0.2);
}

TEST(Checkerboard, AnotherSizeIsCountedAndNeverRead) {
    const BoardScene s = small_scene(6, 25);
    BoardPicture picture = test::render(s);
    for (const auto& [columns, rows] :
         {std::pair{8, 7}, {6, 5}, {7, 7}, {6, 6}, {9, 6}, {8, 6}, {7, 5}, {5, 4}, {11, 8}}) {
        const auto found = search(picture, columns, rows);
        EXPECT_FALSE(found.board) << columns << "x" << rows;
        ASSERT_TRUE(found.miss.counted) << columns << "x" << rows;
        EXPECT_EQ(found.miss.counted->columns, 7);
        EXPECT_EQ(found.miss.counted->rows, 6);
    }
}

TEST(Checkerboard, NothingIsFoundWhereThereIsNone) {
    BoardScene s = small_scene(7, 0);
    s.board = false;
    s.stripe_px = 6;
    BoardPicture picture = test::render(s);
    for (const auto& [columns, rows] : {std::pair{3, 3}, {4, 3}, {7, 6}}) {
        const auto found = search(picture, columns, rows);
        EXPECT_FALSE(found.board);
        EXPECT_FALSE(found.miss.counted);
    }
}

TEST(Checkerboard, TurnsThatLookAlikeAreSaid) {
    struct Case {
        int columns, rows, symmetry;
    };
    for (const Case& c : {Case{7, 6, 1}, Case{8, 6, 2}, Case{5, 5, 2}, Case{6, 6, 4}}) {
        BoardScene s = small_scene(8, 20);
        s.columns = c.columns, s.rows = c.rows;
        BoardPicture picture = test::render(s);
        const auto found = search(picture, c.columns, c.rows);
        ASSERT_TRUE(found.board) << c.columns << "x" << c.rows;
        EXPECT_EQ(found.board->symmetry, c.symmetry);
        EXPECT_TRUE(test::errors_of(*found.board, s, picture)) << c.columns << "x" << c.rows;
    }
}

TEST(Checkerboard, ASideThatIsHiddenIsNoBoard) {
    // The last column under a sheet: 6 x 6 would fit as well.
    BoardScene s = small_scene(1, 0);
    s.turn = Eigen::Matrix3d::Identity();
    s.at.head<2>().setZero();
    const Eigen::Vector2d at = test::seen_at(s, 7.45, 2.5);
    const double pitch = test::seen_at(s, 1, 0).x() - test::seen_at(s, 0, 0).x();
    s.covers.push_back({at.x(), at.y(), 1.7 * pitch, 6 * pitch, 8, 150});
    BoardPicture picture = test::render(s);
    for (const auto& [columns, rows] : {std::pair{7, 6}, {6, 6}, {8, 6}, {8, 7}}) {
        const auto found = search(picture, columns, rows);
        EXPECT_FALSE(found.board) << columns << "x" << rows;
        EXPECT_FALSE(found.miss.counted) << columns << "x" << rows;
    }
}

TEST(Checkerboard, ThePicturesRimMayCutTheLastSquares) {
    BoardScene s = small_scene(1, 0);
    s.turn = Eigen::Matrix3d::Identity();
    const double pitch = test::seen_at(s, 1, 0).x() - test::seen_at(s, 0, 0).x();
    s.at.y() = 0;
    s.at.x() += (s.width - 1 - 0.4 * pitch - test::seen_at(s, 6, 0).x()) / pitch;
    BoardPicture picture = test::render(s);
    const auto found = search(picture, 7, 6);
    ASSERT_TRUE(found.board);
    EXPECT_EQ(found.board->index.size(), 42u);
    EXPECT_TRUE(test::errors_of(*found.board, s, picture));
    for (const auto& [columns, rows] : {std::pair{6, 6}, {8, 6}, {8, 7}, {7, 5}})
        EXPECT_FALSE(search(picture, columns, rows).board) << columns << "x" << rows;
}

TEST(Checkerboard, OfTwoBoardsNeitherIsTaken) {
    BoardPicture left = test::render(small_scene(1, 20)), right = test::render(small_scene(2, 30));
    cv::Mat both;
    cv::hconcat(view_of(left), view_of(right), both);
    const auto found = detail::find_checker(both, 255, spec_of(7, 6));
    EXPECT_FALSE(found.board);
    EXPECT_TRUE(found.miss.several);
    // Of another size beside it is no rival.
    BoardScene other = small_scene(2, 30);
    other.columns = 9;
    right = test::render(other);
    cv::hconcat(view_of(left), view_of(right), both);
    EXPECT_TRUE(detail::find_checker(both, 255, spec_of(7, 6)).board);
    EXPECT_TRUE(detail::find_checker(both, 255, spec_of(9, 6)).board);
}

TEST(Checkerboard, TheSentenceNamesBothSizes) {
    BoardPicture picture = test::render(small_scene(6, 25));
    const BoardSpec spec = spec_of(8, 7);
    const auto found = find_board(picture.image(), spec);
    ASSERT_FALSE(found.board);
    EXPECT_EQ(why_missed(spec, found.miss).english(),
              "a board of 7 x 6 inner corners is seen, 8 x 7 was asked for");
}

TEST(Checkerboard, SixteenBitsAreReadAsTheyAre) {
    BoardPicture picture = test::render(small_scene(1, 30));
    cv::Mat deep;
    view_of(picture).convertTo(deep, CV_16U, 4);
    StripeImage image{reinterpret_cast<const std::byte*>(deep.data), deep.cols, deep.rows, deep.step, 10};
    const auto found = find_board(image, spec_of(7, 6));
    ASSERT_TRUE(found.board);
    EXPECT_EQ(found.board->index.size(), 42u);
}

}  // namespace
}  // namespace seamwright
