// Grids of circles through a camera of our own, sampled ray by ray: which circle is which and where its middle is.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

#include "core/calibration/board/board.h"

namespace seamwright {
namespace {

struct GridPicture {
    cv::Mat image;
    Eigen::Matrix3d pixel_from_grid;  // of (x mm, y mm, 1)
};

struct GridScene {
    BoardSpec spec;
    double radius_mm = 3;
    bool mark = true;  // the first circle is larger
    int width = 1280, height = 1024;
    double tilt = 0, turn = 0, filled = 0.55;  // of the width
};

GridPicture photograph_grid(const GridScene& s, std::uint64_t seed) {
    const double f = 1.5 * s.width, across = (s.spec.columns - 1) * s.spec.pitch_mm;
    const double distance = f * across / (s.filled * s.width);
    Eigen::Matrix3d k;
    k << f, 0, 0.5 * s.width, 0, f, 0.5 * s.height, 0, 0, 1;
    const Eigen::Matrix3d r = (Eigen::AngleAxisd(s.tilt, Eigen::Vector3d(0.6, 0.8, 0).normalized()) *
                               Eigen::AngleAxisd(s.turn, Eigen::Vector3d::UnitZ()))
                                  .toRotationMatrix();
    const Eigen::Vector3d middle(0.5 * across, 0.5 * (s.spec.rows - 1) * s.spec.pitch_mm, 0);
    const Eigen::Vector3d t = Eigen::Vector3d(0, 0, distance) - r * middle;
    Eigen::Matrix3d place;
    place << r.col(0), r.col(1), t;
    GridPicture picture;
    picture.pixel_from_grid = k * place;
    const Eigen::Matrix3d back = picture.pixel_from_grid.inverse();
    const int kFine = s.width > 2000 ? 2 : 3;  // rays a pixel, squared
    picture.image = cv::Mat(s.height, s.width, CV_8U);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> noise(0, 2);
    cv::Mat exact(s.height, s.width, CV_32F);
    for (int v = 0; v < s.height; ++v)
        for (int u = 0; u < s.width; ++u) {
            double sum = 0;
            for (int a = 0; a < kFine; ++a)
                for (int b = 0; b < kFine; ++b) {
                    const Eigen::Vector2d g =
                        (back * Eigen::Vector3d(u + (a + 0.5) / kFine - 0.5, v + (b + 0.5) / kFine - 0.5, 1))
                            .hnormalized();
                    const double c =
                        std::clamp(std::round(g.x() / s.spec.pitch_mm), 0.0, s.spec.columns - 1.0);
                    const double w = std::clamp(std::round(g.y() / s.spec.pitch_mm), 0.0, s.spec.rows - 1.0);
                    const double radius = s.radius_mm * (s.mark && c == 0 && w == 0 ? 1.4 : 1);
                    const bool inside =
                        std::hypot(g.x() - c * s.spec.pitch_mm, g.y() - w * s.spec.pitch_mm) < radius;
                    sum += inside ? 30 : 215;
                }
            exact.at<float>(v, u) = static_cast<float>(sum / (kFine * kFine));
        }
    cv::GaussianBlur(exact, exact, {}, 0.8);
    for (int v = 0; v < s.height; ++v)
        for (int u = 0; u < s.width; ++u)
            picture.image.at<std::uint8_t>(v, u) =
                cv::saturate_cast<std::uint8_t>(exact.at<float>(v, u) + noise(random));
    return picture;
}

// rms of a coordinate in px; -1: not found. Every index must be the right one.
double rms_of_grid(const GridScene& s, std::uint64_t seed) {
    const GridPicture picture = photograph_grid(s, seed);
    StripeImage image;
    image.pixels = reinterpret_cast<const std::byte*>(picture.image.data);
    image.width = s.width, image.height = s.height, image.row_bytes = picture.image.step, image.bit_depth = 8;
    const auto found = find_board(image, s.spec).board;
    if (!found) return -1;
    EXPECT_EQ(found->symmetry, 1);
    double squares = 0;
    for (std::size_t i = 0; i < found->pixel.size(); ++i) {
        const Eigen::Vector3d& p = found->object_mm[i];
        const Eigen::Vector2d there =
            (picture.pixel_from_grid * Eigen::Vector3d(p.x(), p.y(), 1)).hnormalized();
        EXPECT_LT((found->pixel[i] - there).norm(), 1) << "circle " << found->index[i];
        squares += (found->pixel[i] - there).squaredNorm();
    }
    return std::sqrt(squares / (2.0 * static_cast<double>(found->pixel.size())));
}

GridScene grid(int columns, int rows) {
    GridScene s;
    s.spec.pattern = BoardPattern::circles;
    s.spec.columns = columns, s.spec.rows = rows, s.spec.pitch_mm = 10;
    return s;
}

// Steep views of large circles: their middles are those of the circles, not of the ellipses, which lie 0.1 px and more
// beside them.
TEST(CircleGrid, MiddlesAreThoseOfTheCircles) {
    std::uint64_t seed = 1;
    for (const double tilt : {0.0, 0.4, 0.8}) {
        GridScene s = grid(7, 6);
        s.tilt = tilt, s.turn = 0.3;
        const double rms = rms_of_grid(s, ++seed);
        EXPECT_GE(rms, 0) << "not found at " << tilt;
        EXPECT_LT(rms, 0.03) << "tilt " << tilt;
    }
}

TEST(CircleGrid, InALargePictureAsInASmallOne) {
    GridScene s = grid(9, 7);
    s.width = 4000, s.height = 3000;
    s.tilt = 0.5, s.turn = -0.2;
    s.filled = 0.6;
    const double rms = rms_of_grid(s, 7);
    EXPECT_GE(rms, 0) << "not found";
    EXPECT_LT(rms, 0.05);
}

TEST(CircleGrid, AnotherSizeIsNotTaken) {
    GridScene s = grid(7, 6);
    s.tilt = 0.3;
    const GridPicture picture = photograph_grid(s, 3);
    StripeImage image;
    image.pixels = reinterpret_cast<const std::byte*>(picture.image.data);
    image.width = s.width, image.height = s.height, image.row_bytes = picture.image.step, image.bit_depth = 8;
    BoardSpec larger = s.spec;
    larger.columns = 9;
    EXPECT_FALSE(find_board(image, larger).board);
}

}  // namespace
}  // namespace seamwright
