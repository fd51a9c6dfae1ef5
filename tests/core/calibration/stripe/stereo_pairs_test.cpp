// The left and right camera of OpenCV's example: 13 pairs of images of one chessboard.

#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/calibration/board/board.h"
#include "core/calibration/camera/camera.h"

namespace seamwright {
namespace {

const std::filesystem::path kExamples = "/usr/share/doc/opencv-doc/examples/data";

CameraData seen(const char* side) {
    CameraData data{640, 480, {}};
    BoardSpec spec;
    spec.columns = 9, spec.rows = 6, spec.pitch_mm = 25;
    for (int i = 1; i <= 14; ++i) {
        const std::string name = std::string(side) + (i < 10 ? "0" : "") + std::to_string(i) + ".jpg";
        if (!std::filesystem::exists(kExamples / name)) continue;  // there is no tenth pair
        const cv::Mat image = cv::imread((kExamples / name).string(), cv::IMREAD_GRAYSCALE);
        StripeImage view;
        view.pixels = reinterpret_cast<const std::byte*>(image.data);
        view.width = image.cols, view.height = image.rows, view.row_bytes = image.step;
        const auto board = find_board(view, spec).board;
        if (!board) {
            ADD_FAILURE() << "no board found in " << name;
            continue;
        }
        data.views.push_back({std::to_string(i), board->object_mm, board->pixel});
    }
    return data;
}

// The same points in the other library.
double focal_by_opencv(const CameraData& data) {
    std::vector<std::vector<cv::Point3f>> object;
    std::vector<std::vector<cv::Point2f>> image;
    for (const auto& v : data.views) {
        object.emplace_back();
        image.emplace_back();
        for (std::size_t i = 0; i < v.pixel.size(); ++i) {
            object.back().emplace_back(v.object_mm[i].x(), v.object_mm[i].y(), v.object_mm[i].z());
            image.back().emplace_back(v.pixel[i].x(), v.pixel[i].y());
        }
    }
    cv::Mat k, d;
    std::vector<cv::Mat> r, t;
    cv::calibrateCamera(object, image, {data.width, data.height}, k, d, r, t);
    return k.at<double>(0, 0);
}

TEST(StereoPairs, BaselineIsTheSameInEveryView) {
    if (!std::filesystem::exists(kExamples / "left01.jpg")) GTEST_SKIP() << "skipped: no opencv-doc";
    const CameraData left_data = seen("left"), right_data = seen("right");
    const auto left = calibrate_camera(left_data, {}), right = calibrate_camera(right_data, {});
    ASSERT_TRUE(left) << left.error().sentence();
    ASSERT_TRUE(right) << right.error().sentence();
    // Published in the same package, left_intrinsics.yml. (intrinsics.yml holds one focal length for both.)
    EXPECT_NEAR(left->camera.fx, 535.916, 0.005 * 535.916);
    EXPECT_NEAR(0.5 * (left->camera.fx + right->camera.fx), 534.803, 0.005 * 534.803);
    EXPECT_NEAR(left->camera.fx, focal_by_opencv(left_data), 0.005 * 535);
    EXPECT_NEAR(right->camera.fx, focal_by_opencv(right_data), 0.005 * 535);
    EXPECT_LT(left->rms_px, 0.42);
    EXPECT_LT(right->rms_px, 0.42);
    ASSERT_EQ(left->camera_from_target.size(), 13u);
    ASSERT_EQ(right->camera_from_target.size(), 13u);
    std::vector<Pose> right_from_left;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < 13; ++i) {
        right_from_left.push_back(right->camera_from_target[i] * left->camera_from_target[i].inverse());
        mean += right_from_left.back().translation() / 13;
    }
    double spread = 0, angle = 0;
    for (const auto& p : right_from_left) {
        spread += (p.translation() - mean).squaredNorm() / 13;
        angle = std::max(angle, angle_rad(p, right_from_left[0]));
    }
    RecordProperty("baseline_mm", std::to_string(mean.norm()));
    RecordProperty("spread_mm", std::to_string(std::sqrt(spread)));
    RecordProperty("angle_deg", std::to_string(deg_from_rad(angle)));
    // The cameras stand side by side.
    EXPECT_GT(std::abs(mean.x()), 0.98 * mean.norm());
    EXPECT_LT(std::sqrt(spread), 1.5);
    EXPECT_LT(deg_from_rad(angle), 0.5);
}

}  // namespace
}  // namespace seamwright
