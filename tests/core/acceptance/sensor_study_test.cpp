// A sensor against artefacts whose indices are known by symmetry.

#include "core/acceptance/equipment/sensor_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

namespace seamwright {
namespace {

using testing::HasSubstr;

// Rings of 12 points at five heights, alike above and below: a deviation that is the same at opposite points leaves
// the least-squares sphere where it is.
std::vector<Eigen::Vector3d> sphere(const Eigen::Vector3d& centre, double radius, double wave = 0) {
    std::vector<Eigen::Vector3d> points;
    for (const double height : {-0.8, -0.4, 0.0, 0.4, 0.8})
        for (int i = 0; i < 12; ++i) {
            const double turn = i * M_PI / 6, across = std::sqrt(1 - height * height);
            const Eigen::Vector3d n(across * std::cos(turn), across * std::sin(turn), height);
            points.push_back(centre + (radius + (i % 2 ? wave : -wave)) * n);
        }
    return points;
}

std::vector<Eigen::Vector3d> chessboard(const Eigen::Isometry3d& at, double step, double wave) {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 10; ++i)
        for (int k = 0; k < 10; ++k)
            points.push_back(at * Eigen::Vector3d(step * i, step * k, (i + k) % 2 ? wave : -wave));
    return points;
}

TEST(SensorStudy, IndicesByConstruction) {
    SensorStudyData data;
    data.spheres = {{"K1", sphere({100, -50, 300}, 15.002, 0.005), 30.0, 0.0005, 0.0004},
                    {"K2", sphere({100, 50.03, 300}, 14.99), 30.0, 0.0005, 0.0004}};
    data.distances = {{"K1", "K2", 100.0, 0.001}};
    Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
    at.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
    at.pretranslate(Eigen::Vector3d(500, 0, -20));
    data.planes = {{"P", chessboard(at, 10, 0.006), 0.001}};
    data.limits = {0.02, 0.01, 0.05, 0.0125};
    const auto study = sensor_study(data);
    ASSERT_TRUE(study) << study.error().sentence();
    EXPECT_NEAR(study->spheres[0].form.value_mm, 0.01, 1e-9);
    EXPECT_NEAR(study->spheres[0].size->value_mm, 0.004, 1e-6);
    EXPECT_NEAR(study->spheres[0].size->U_mm, 0.001, 1e-12);
    EXPECT_EQ(study->spheres[0].size->verdict, AcceptanceVerdict::ok);
    EXPECT_NEAR(study->spheres[1].form.value_mm, 0, 1e-9);
    EXPECT_NEAR(study->spheres[1].size->value_mm, -0.02, 1e-9);
    EXPECT_EQ(study->spheres[1].size->verdict, AcceptanceVerdict::not_ok);
    EXPECT_NEAR(study->distances[0].error.value_mm, 0.03, 1e-6);
    EXPECT_NEAR(study->planes[0].flatness.value_mm, 0.012, 1e-9);
    EXPECT_EQ(study->planes[0].flatness.verdict, AcceptanceVerdict::conditional)
        << "0.012 -+ 0.001 about 0.0125";
    EXPECT_EQ(study->verdict, AcceptanceVerdict::not_ok);
    data.limits = {};
    EXPECT_EQ(sensor_study(data)->verdict, AcceptanceVerdict::too_little_data) << "nothing is judged";
}

// Three of a thousand are left out, the fourth is not.
TEST(SensorStudy, LeavesOutWhatTheGuidelineAllows) {
    SensorStudyData data;
    data.planes = {{"P", {}, 0}};
    for (int i = 0; i < 40; ++i)
        for (int k = 0; k < 25; ++k) data.planes[0].points_mm.push_back({1.0 * i, 1.0 * k, 0});
    for (const int i : {210, 390, 640}) data.planes[0].points_mm[static_cast<std::size_t>(i)].z() = 0.5;
    const auto three = sensor_study(data);
    ASSERT_TRUE(three);
    EXPECT_EQ(three->planes[0].left_out, 3);
    EXPECT_LT(three->planes[0].flatness.value_mm, 0.01);
    data.planes[0].points_mm[500].z() = 0.5;
    EXPECT_GT(sensor_study(data)->planes[0].flatness.value_mm, 0.45);
}

TEST(SensorStudy, RefusesWhatTellsNothing) {
    const auto refused = [](const SensorStudyData& data, const char* part) {
        const auto study = sensor_study(data);
        ASSERT_FALSE(study);
        EXPECT_THAT(study.error().sentence(), HasSubstr(part));
        EXPECT_EQ(study.error().kind, ErrorKind::input);
    };
    SensorStudyData good;
    good.spheres = {{"K1", sphere({0, 0, 0}, 15), 30.0}};
    ASSERT_TRUE(sensor_study(good));
    refused({}, "no sphere");
    SensorStudyData bad = good;
    bad.spheres[0].points_mm.resize(10);
    refused(bad, "10 points");
    bad = good;
    bad.spheres[0].points_mm[3].x() = std::nan("");
    refused(bad, "not finite");
    bad = good;
    bad.spheres.push_back(bad.spheres[0]);
    refused(bad, "two artefacts");
    bad = good;
    bad.spheres[0].diameter_mm = -30;
    refused(bad, "certificate");
    bad = good;
    bad.limits.form_mm = std::numeric_limits<double>::infinity();
    refused(bad, "permitted error");
    bad = good;
    bad.distances = {{"K1", "K7", 100, 0}};
    refused(bad, "between two spheres");
    // One cut, a cap of 5 degrees, one point many times.
    bad = good;
    bad.spheres[0].points_mm.clear();
    for (int i = 0; i < 60; ++i)
        bad.spheres[0].points_mm.push_back({12 * std::cos(0.1 * i), 3, 12 * std::sin(0.1 * i)});
    refused(bad, "too little of it");
    for (int i = 0; i < 60; ++i) {
        const double tilt = 0.087 * (i % 6) / 6, turn = i;
        bad.spheres[0].points_mm[static_cast<std::size_t>(i)] =
            15 *
            Eigen::Vector3d(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt));
    }
    refused(bad, "too little of it");
    bad.spheres[0].points_mm.assign(60, {1, 2, 3});
    refused(bad, "too little of it");
    SensorStudyData plane;
    plane.planes = {{"P", {}, 0}};
    for (int i = 0; i < 60; ++i) plane.planes[0].points_mm.push_back({1.0 * i, 0, 0.001 * (i % 3)});
    refused(plane, "line");
}

}  // namespace
}  // namespace seamwright
