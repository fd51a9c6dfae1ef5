// Which corner of a chessboard is the first, however the camera is turned about it.

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/calibration/board/board.h"

namespace seamwright {
namespace {

constexpr int kSquarePx = 40;

// Squares of kSquarePx, the first one dark, a white rim of one and a half; inner corners columns x rows.
cv::Mat printed(int columns, int rows) {
    const int rim = kSquarePx * 3 / 2;
    cv::Mat image((rows + 1) * kSquarePx + 2 * rim, (columns + 1) * kSquarePx + 2 * rim, CV_8U,
                  cv::Scalar(230));
    for (int r = 0; r <= rows; ++r)
        for (int c = 0; c <= columns; ++c)
            if ((r + c) % 2 == 0)
                image(cv::Rect(rim + c * kSquarePx, rim + r * kSquarePx, kSquarePx, kSquarePx)).setTo(25);
    cv::GaussianBlur(image, image, {5, 5}, 1.2);
    return image;
}

cv::Mat turned_image(const cv::Mat& image, int quarter_turns) {
    cv::Mat out = image;
    for (int t = 0; t < quarter_turns; ++t) {
        cv::Mat next;
        cv::rotate(out, next, cv::ROTATE_90_CLOCKWISE);
        out = next;
    }
    return out;
}

// The corner of the upright print, row * columns + column, that each found index stands for.
std::vector<int> corner_of_index(const FoundBoard& board, int columns, int rows, int quarter_turns) {
    const int rim = kSquarePx * 3 / 2, width = (columns + 1) * kSquarePx + 2 * rim,
              height = (rows + 1) * kSquarePx + 2 * rim;
    std::vector<int> corner(board.index.size(), -1);
    for (std::size_t i = 0; i < board.index.size(); ++i) {
        double x = board.pixel[i].x(), y = board.pixel[i].y(), w = quarter_turns % 2 ? height : width,
               h = quarter_turns % 2 ? width : height;
        for (int t = 0; t < quarter_turns; ++t) {  // back, anticlockwise
            const double old = x;
            x = y, y = w - 1 - old;
            std::swap(w, h);
        }
        const int c = int(std::lround((x + 0.5 - rim) / kSquarePx)) - 1,
                  r = int(std::lround((y + 0.5 - rim) / kSquarePx)) - 1;
        corner[std::size_t(board.index[i])] = r * columns + c;
    }
    return corner;
}

TEST(BoardOrder, OnlyTurnsThatLookAlikeAreLeftOpen) {
    struct Case {
        int columns, rows, symmetry;
    };
    // A quarter turn of n x n corners changes the colours when n is odd; a half turn where both counts are of one
    // parity does not.
    for (const Case c : {Case{7, 6, 1}, Case{7, 5, 2}, Case{5, 5, 2}, Case{7, 7, 2}, Case{6, 6, 4}}) {
        const cv::Mat print = printed(c.columns, c.rows);
        std::vector<int> first;
        for (int turns = 0; turns < 4; ++turns) {
            const cv::Mat image = turned_image(print, turns);
            StripeImage seen;
            seen.pixels = reinterpret_cast<const std::byte*>(image.data);
            seen.width = image.cols, seen.height = image.rows;
            seen.row_bytes = static_cast<std::size_t>(image.step);
            const BoardSpec spec{.columns = c.columns, .rows = c.rows, .pitch_mm = 10};
            const auto board = find_board(seen, spec).board;
            ASSERT_TRUE(board) << c.columns << " x " << c.rows << " turned " << turns;
            EXPECT_EQ(board->symmetry, c.symmetry) << c.columns << " x " << c.rows;
            // One of the readings that are left open is that of the upright print.
            bool same = false;
            for (int t = 0; t < 4; t += 4 / c.symmetry) {
                const auto corner = corner_of_index(turned(*board, spec, t), c.columns, c.rows, turns);
                if (first.empty()) first = corner;
                same = same || corner == first;
            }
            EXPECT_TRUE(same) << c.columns << " x " << c.rows << " turned " << turns;
        }
    }
}

}  // namespace
}  // namespace seamwright
