// Clouds: thinning, outliers, normals, the nearest place of a surface.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/cloud/cloud.h"
#include "core/cloud/coarse.h"
#include "core/cloud/deviation.h"
#include "core/cloud/surface.h"
#include "tests/core/cloud/test_parts.h"

namespace seamwright {
namespace {

using Eigen::Vector3d;
using test_parts::box;

TEST(Cloud, AProfileLandsWhereFlangeAndSensorSay) {
    Profile profile;
    profile.x_mm = {1, 2, 3};
    profile.z_mm = {10, std::numeric_limits<double>::quiet_NaN(), 12};
    const Pose base_from_sensor = make_pose(rotation_exp(Vector3d(0, 0, kPi / 2)), Vector3d(100, 200, 300)) *
                                  make_pose(Eigen::Matrix3d::Identity(), Vector3d(0, 5, 0));
    Cloud cloud;
    append_profile(cloud, profile, base_from_sensor, 0.1);
    ASSERT_EQ(cloud.size(), 2U);  // without the one that returned nothing
    EXPECT_NEAR((cloud.points[0] - Vector3d(95, 201, 310)).norm(), 0, 1e-9);
    EXPECT_NEAR((cloud.points[1] - Vector3d(95, 203, 312)).norm(), 0, 1e-9);
    EXPECT_NEAR((cloud.towards[0] - Eigen::Vector3f::UnitZ()).norm(), 0, 1e-6);
}

TEST(Cloud, OutliersOfAFilteredProfileStayOut) {
    Profile profile;
    profile.x_mm = {1, 2, 3};
    profile.z_mm = {0, 0, 50};
    profile.segment = {0, 0, kOutlier};
    Cloud cloud;
    append_profile(cloud, profile, Pose::Identity());
    EXPECT_EQ(cloud.size(), 2U);
}

TEST(Cloud, ACellHoldsTheMeanAndItsSigma) {
    Cloud cloud;
    for (int i = 0; i < 4; ++i) cloud.points.emplace_back(0.1 * i, 0, 0);
    cloud.points.emplace_back(10, 10, 10);
    cloud.sigma_mm.assign(5, 0.2F);
    const Cloud thin = voxel_grid(cloud, 1);
    ASSERT_EQ(thin.size(), 2U);
    EXPECT_NEAR(thin.points[0].x(), 0.15, 1e-9);
    EXPECT_NEAR(thin.sigma_mm[0], 0.1, 1e-6);
    EXPECT_NEAR(thin.sigma_mm[1], 0.2, 1e-6);
}

TEST(Cloud, ThinningKeepsToItsNumber) {
    std::mt19937_64 random(1);
    const Cloud cloud = test_parts::panel_scan(random, 20000, 0);
    for (const std::size_t most : {100U, 1000U, 5000U}) {
        const Cloud thin = thinned(cloud, most);
        EXPECT_LE(thin.size(), most);
        EXPECT_GT(thin.size(), most / 4);
    }
    EXPECT_EQ(thinned(cloud, 30000).size(), cloud.size());
}

TEST(Cloud, WhatStandsFarFromAllOthersIsAnOutlier) {
    std::mt19937_64 random(2);
    Cloud cloud = test_parts::panel_scan(random, 5000, 0.05);
    const std::size_t good = cloud.size();
    std::uniform_real_distribution<double> far(100, 400);
    for (int i = 0; i < 20; ++i) cloud.points.emplace_back(far(random), far(random), far(random));
    cloud.towards.clear();
    const auto keep = statistical_inliers(cloud);
    std::size_t lost = 0, left = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) (i < good ? lost : left) += (i < good) != (keep[i] != 0);
    EXPECT_LT(lost, good / 50);
    EXPECT_EQ(left, 0U);
}

TEST(Cloud, NormalsArethoseOfTheFormula) {
    std::mt19937_64 random(3);
    Cloud cloud = test_parts::panel_scan(random, 40000, 0.01);
    estimate_normals(cloud, 24);
    std::size_t compared = 0, near = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const Vector3d p = cloud.points[i];
        if (p.x() < 10 || p.x() > 590 || p.y() < 10 || p.y() > 390) continue;
        ++compared;
        near += cloud.normals[i].cast<double>().dot(test_parts::panel_normal(p.x(), p.y())) >
                std::cos(rad_from_deg(4));
    }
    EXPECT_GT(static_cast<double>(near), 0.95 * static_cast<double>(compared));
}

TEST(Surface, TheNearestPlaceOfABoxIsThatOfTheFormula) {
    const Vector3d size(20, 12, 8);
    const Surface surface(box(size));
    EXPECT_NEAR(surface.area_mm2(), 2 * (20 * 12 + 12 * 8 + 8 * 20), 1e-9);
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> any(-20, 20);
    for (int i = 0; i < 2000; ++i) {
        const Vector3d p(any(random), any(random), any(random));
        const Vector3d outside = (p.cwiseAbs() - size / 2).cwiseMax(0);
        const double inside = (size / 2 - p.cwiseAbs()).minCoeff();
        const double wanted = inside > 0 ? -inside : outside.norm();
        const auto near = surface.nearest(p, 1000);
        ASSERT_TRUE(near);
        EXPECT_NEAR(near->signed_mm, wanted, 1e-9);
        EXPECT_FALSE(near->at_border);
    }
}

TEST(Surface, BeyondItsReachThereIsNothingAndTheFarSideDoesNotFace) {
    const Surface surface(box({20, 12, 8}));
    EXPECT_FALSE(surface.nearest({0, 0, 10}, 5));
    const Vector3d down = -Vector3d::UnitZ();
    const auto near = surface.nearest({0, 0, 5}, 50, &down);
    ASSERT_TRUE(near);
    EXPECT_NEAR(near->point.z(), -4, 1e-12);
}

TEST(Surface, ASheetEndsAtItsBorder) {
    TriangleMesh sheet;
    test_parts::quad(sheet, {0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0});
    const Surface surface(sheet);
    EXPECT_TRUE(surface.nearest({-1, 5, 0.1}, 10)->at_border);
    EXPECT_TRUE(surface.nearest({-1, -1, 0.1}, 10)->at_border);
    EXPECT_FALSE(surface.nearest({5, 5, 0.1}, 10)->at_border);
}

TEST(Surface, ARoundDrawnByFacetsHasTheNormalsOfTheRound) {
    const Surface surface(test_parts::cylinder(50, 200, 32));
    for (int k = 0; k < 100; ++k) {
        const double a = 0.0628 * k;
        const Vector3d out(std::cos(a), std::sin(a), 0);
        EXPECT_GT(surface.nearest(50.0 * out + 100 * Vector3d::UnitZ(), 10)->normal.dot(out), 0.9995);
    }
}

TEST(Surface, SamplesLieOnItAndAreSpreadByArea) {
    const Surface surface(box({20, 12, 8}));
    const Cloud samples = surface.sampled(5000, 1);
    EXPECT_NEAR(static_cast<double>(samples.size()), 5000, 2);
    std::size_t top = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        EXPECT_NEAR(surface.nearest(samples.points[i], 1)->distance_mm, 0, 1e-9);
        top += samples.normals[i].z() > 0.9F;
    }
    EXPECT_NEAR(static_cast<double>(top) / 5000, 20 * 12 / surface.area_mm2(), 0.01);
}

TEST(Pairs, ThreeExactPairsGiveThePose) {
    std::mt19937_64 random(5);
    const Pose truth = test_parts::random_pose(random, 3, 500);
    const std::vector<Vector3d> from{{0, 0, 0}, {100, 0, 0}, {0, 80, 10}};
    std::vector<Vector3d> to;
    for (const auto& p : from) to.push_back(truth * p);
    const auto pose = pose_of_pairs(from, to);
    ASSERT_TRUE(pose);
    EXPECT_LT(difference(*pose, truth).norm(), 1e-9);
    EXPECT_FALSE(pose_of_pairs({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}));
    EXPECT_FALSE(pose_of_pairs({{0, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, {1, 0, 0}}));
}

TEST(Deviation, ADentIsFoundWhereItIsWithItsDepth) {
    std::mt19937_64 random(6);
    const Vector3d dent(250, 200, test_parts::panel_height(250, 200));
    Cloud cloud = test_parts::panel_scan(random, 60000, 0.02, 1, [&](const Vector3d& p) -> Vector3d {
        const double d = (p - dent).head<2>().norm() / 30;
        return Vector3d(0, 0, d < 1 ? -1.2 * (1 - d * d) : 0);
    });
    const Surface surface(test_parts::panel());
    const DeviationMap map = deviation_map(cloud, surface, Pose::Identity(), {});
    EXPECT_LT((map.worst_part_mm - dent).head<2>().norm(), 20);
    EXPECT_NEAR(map.worst_mm, -1.2, 0.25);
    EXPECT_GT(map.share_seen, 0.9);
    std::size_t total = 0;
    for (const auto& bin : map.histogram) total += bin.count;
    EXPECT_EQ(total, map.counted);
}

}  // namespace
}  // namespace seamwright
