#include "core/profile/sensor_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <random>

#include "tests/allocations.h"

namespace seamwright {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

CameraModel camera(double k1, double k2, double p1, double p2, double k3) {
    return {1400, 1390, 635, 508, k1, k2, p1, p2, k3, 1280, 1024};
}

// No lens, a mild one, strong barrel, strong pincushion, and a moustache.
std::vector<CameraModel> cameras() {
    return {camera(0, 0, 0, 0, 0), camera(-0.12, 0.03, 4e-4, -3e-4, 0),
            camera(-0.42, 0.25, 1e-3, 8e-4, -0.06), camera(0.35, 0.1, -6e-4, 5e-4, 0.02),
            camera(-0.3, 0.5, 0, 0, -0.1)};
}

// Laser plane 30 degrees to the optical axis, 400 mm away.
SensorModel sensor(const CameraModel& camera) {
    SensorModel model;
    model.camera = camera;
    const Eigen::Matrix3d rotation = (Eigen::AngleAxisd(rad_from_deg(120), Eigen::Vector3d::UnitX()) *
                                      Eigen::AngleAxisd(rad_from_deg(2), Eigen::Vector3d::UnitY()))
                                         .toRotationMatrix();
    model.camera_from_laser = make_pose(rotation, {3, -8, 400});
    return model;
}

TEST(CameraModel, AgreesWithOpenCV) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> x(-0.45, 0.45), y(-0.36, 0.36), depth(100, 900);
    for (const CameraModel& c : cameras()) {
        const cv::Matx33d matrix(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
        const cv::Vec<double, 5> lens(c.k1, c.k2, c.p1, c.p2, c.k3);
        for (int i = 0; i < 500; ++i) {
            const double z = depth(random);
            const Eigen::Vector3d point(x(random) * z, y(random) * z, z);
            std::vector<cv::Point2d> projected, undistorted;
            cv::projectPoints(std::vector<cv::Point3d>{{point.x(), point.y(), point.z()}}, cv::Vec3d(),
                              cv::Vec3d(), matrix, lens, projected);
            const Eigen::Vector2d pixel = c.project(point);
            ASSERT_NEAR(pixel.x(), projected[0].x, 1e-9);
            ASSERT_NEAR(pixel.y(), projected[0].y, 1e-9);
            cv::undistortPoints(
                projected, undistorted, matrix, lens, cv::noArray(), cv::noArray(),
                cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 500, 1e-14));
            const Eigen::Vector2d ray = c.undistort(pixel);
            EXPECT_NEAR(ray.x(), undistorted[0].x, 1e-9);
            EXPECT_NEAR(ray.y(), undistorted[0].y, 1e-9);
            EXPECT_NEAR(ray.x(), point.x() / z, 1e-10);
            EXPECT_NEAR(ray.y(), point.y() / z, 1e-10);
        }
    }
}

TEST(CameraModel, WhatHasNoRayOrNoPixelIsNaN) {
    const CameraModel barrel = camera(-0.42, 0, 0, 0, 0);  // folds back at r = sqrt(1/(3 * 0.42)) = 0.891
    EXPECT_TRUE(barrel.project({0.88, 0, 1}).allFinite());
    EXPECT_FALSE(barrel.project({0.90, 0, 1}).allFinite());
    EXPECT_FALSE(barrel.project({5, 0, 1}).allFinite());
    EXPECT_FALSE(barrel.project({0, 0, -1}).allFinite());
    EXPECT_FALSE(barrel.project({0, 0, 0}).allFinite());
    EXPECT_FALSE(barrel.project({kNaN, 0, 1}).allFinite());
    const double edge = 0.8909 * (1 - 0.42 * 0.8909 * 0.8909);  // the largest distorted radius
    EXPECT_TRUE(barrel.undistort({635 + 1400 * (edge - 1e-4), 508}).allFinite());
    EXPECT_FALSE(barrel.undistort({635 + 1400 * (edge + 1e-3), 508}).allFinite());
    EXPECT_FALSE(barrel.undistort({1e7, -1e7}).allFinite());
    for (const double bad :
         {kNaN, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
        EXPECT_FALSE(barrel.undistort({bad, 3}).allFinite());
        EXPECT_FALSE(barrel.undistort({3, bad}).allFinite());
    }
}

TEST(SensorModel, LaserAndPixelAreInverseOverTheFieldOfView) {
    for (const CameraModel& c : cameras()) {
        const SensorModel model = sensor(c);
        int placed = 0;
        for (double v = 0; v < 1024; v += 31.7) {
            for (double u = 0; u < 1280; u += 41.3) {
                const auto xz = model.to_laser({u, v});
                if (!xz) continue;
                ++placed;
                const auto pixel = model.to_pixel(*xz);
                ASSERT_TRUE(pixel);
                EXPECT_NEAR(pixel->x(), u, 1e-8);
                EXPECT_NEAR(pixel->y(), v, 1e-8);
                // On the ray and on the plane, by the frames themselves.
                const Eigen::Vector3d point = model.camera_from_laser * Eigen::Vector3d(xz->x(), 0, xz->y());
                const Eigen::Vector2d again = c.project(point);
                EXPECT_NEAR((again - Eigen::Vector2d(u, v)).norm(), 0, 1e-8);
            }
        }
        EXPECT_GT(placed, 900);
    }
}

TEST(SensorModel, RaysThatMissTheLaserPlaneGiveNothing) {
    SensorModel model;
    model.camera = camera(0, 0, 0, 0, 0);
    // The plane holds the optical axis direction: x to the right, z along the axis, 50 mm below it.
    model.camera_from_laser = make_pose(Eigen::Matrix3d::Identity(), {0, 50, 0});
    EXPECT_FALSE(model.to_laser({635, 508}));  // parallel
    EXPECT_FALSE(model.to_laser({635, 400}));  // backwards
    ASSERT_TRUE(model.to_laser({635, 608}));
    EXPECT_NEAR(model.to_laser({635, 608})->y(), 50 * 1390 / 100.0, 1e-9);
    EXPECT_FALSE(model.to_laser({kNaN, 600}));
    EXPECT_FALSE(model.to_pixel({0, -10}));  // behind the camera
    EXPECT_FALSE(model.to_pixel({kNaN, 10}));
}

TEST(LookupTable, AgreesWithTheModelAndKeepsItsHoles) {
    SensorModel model = sensor(camera(-0.12, 0.03, 4e-4, -3e-4, 0));
    LookupTable table = tabulate(model, 8);
    EXPECT_EQ(table.columns, 161);
    EXPECT_EQ(table.rows, 129);
    SensorModel tabled = model;
    tabled.table = table;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> u(0, 1279), v(0, 1023);
    for (int i = 0; i < 2000; ++i) {
        const Eigen::Vector2d pixel(u(random), v(random));
        const auto exact = model.to_laser(pixel), near = tabled.to_laser(pixel);
        ASSERT_TRUE(exact && near);
        // Bilinear error: an eighth of the second derivative over the step.
        EXPECT_LT((*exact - *near).norm(), 0.02);
    }
    // Nodes are exact, the last ones too.
    for (const int j : {0, 60, 128}) {
        for (const int i : {0, 77, 160}) {
            const auto at = table.at({8.0 * i, 8.0 * j});
            ASSERT_TRUE(at);
            EXPECT_DOUBLE_EQ(at->x(), table.x_mm[static_cast<std::size_t>(j * 161 + i)]);
            EXPECT_DOUBLE_EQ(at->y(), table.z_mm[static_cast<std::size_t>(j * 161 + i)]);
        }
    }
    // A hole in one node takes its four cells.
    table.z_mm[20 * 161 + 30] = kNaN;
    for (const double du : {-7.0, 0.0, 7.0})
        for (const double dv : {-7.0, 0.0, 7.0}) EXPECT_FALSE(table.at({240 + du, 160 + dv}));
    EXPECT_TRUE(table.at({240 + 8.01, 160}));
    EXPECT_TRUE(table.at({240, 160 - 8.01}));
    for (const double bad : {-0.01, 1280.01, kNaN, 1e300}) EXPECT_FALSE(table.at({bad, 100})) << bad;
    EXPECT_FALSE(table.at({100, 1024.01}));
    LookupTable broken = table;
    broken.z_mm.resize(5);
    EXPECT_FALSE(broken.at({100, 100}));
    EXPECT_FALSE(LookupTable{}.at({0, 0}));
    broken = table;
    broken.step_u = 0;
    EXPECT_FALSE(broken.at({100, 100}));
}

StripePeaks peaks_on(ScanLines scan, int lines, int per_line) {
    StripePeaks peaks;
    peaks.scan = scan;
    peaks.lines = lines;
    peaks.per_line = per_line;
    const auto slots = static_cast<std::size_t>(lines * per_line);
    peaks.count.assign(static_cast<std::size_t>(lines), static_cast<std::uint8_t>(per_line));
    peaks.flags.assign(slots, 0);
    for (std::size_t i = 0; i < slots; ++i) {
        peaks.position_px.push_back(100.0f + static_cast<float>(i % 700));
        peaks.intensity.push_back(static_cast<float>(i % 255));
        peaks.width_px.push_back(5);
    }
    return peaks;
}

TEST(ToMillimetres, PlacesEveryCandidateOfColumnsAndRowsWithoutAllocating) {
    const SensorModel model = sensor(camera(-0.12, 0.03, 4e-4, -3e-4, 0));
    for (const ScanLines scan : {ScanLines::columns, ScanLines::rows}) {
        StripePeaks peaks = peaks_on(scan, 1000, 3);
        peaks.flags[peaks.index(7, 1)] = StripePeaks::kTruncated;
        peaks.position_px[peaks.index(9, 0)] = std::numeric_limits<float>::quiet_NaN();
        peaks.count[11] = 0;
        ProfileCandidates candidates;
        to_millimetres(peaks, model, candidates);
        const long before = allocations_so_far();
        to_millimetres(peaks, model, candidates);
        EXPECT_EQ(allocations_so_far() - before, 0);
        ASSERT_EQ(candidates.lines, 1000);
        ASSERT_EQ(candidates.per_line, 3);
        EXPECT_EQ(candidates.count[7], 2);
        EXPECT_EQ(candidates.count[9], 2);
        EXPECT_EQ(candidates.count[11], 0);
        EXPECT_EQ(candidates.intensity[candidates.index(7, 1)], peaks.intensity[peaks.index(7, 2)]);
        for (const int line : {0, 500, 999}) {
            ASSERT_EQ(candidates.count[line], 3);
            for (int k = 0; k < 3; ++k) {
                const double at = peaks.position_px[peaks.index(line, k)];
                const auto pixel =
                    scan == ScanLines::columns ? Eigen::Vector2d(line, at) : Eigen::Vector2d(at, line);
                const auto xz = model.to_laser(pixel);
                ASSERT_TRUE(xz);
                EXPECT_DOUBLE_EQ(candidates.x_mm[candidates.index(line, k)], xz->x());
                EXPECT_DOUBLE_EQ(candidates.z_mm[candidates.index(line, k)], xz->y());
            }
        }
    }
}

}  // namespace
}  // namespace seamwright
