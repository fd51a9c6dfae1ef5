#include "core/calibration/camera/bundle.h"

#include <gtest/gtest.h>

#include "tests/core/calibration/camera/camera_scene.h"

namespace seamwright {
namespace {

std::vector<PlacedCamera> two_cameras() {
    const auto camera = test::camera_640();
    return {{camera, Pose::Identity()}, {camera, make_pose(rotation_exp({0, 0.3, 0}), {-120, 5, 20})}};
}

TEST(Triangulate, MeetsInThePoint) {
    const auto cameras = two_cameras();
    const Eigen::Vector3d truth(30, -20, 400);
    const auto pixel = [&](std::size_t i) {
        return cameras[i].camera.project(cameras[i].camera_from_world * truth);
    };
    const auto p = triangulate(cameras[0], pixel(0), cameras[1], pixel(1));
    ASSERT_TRUE(p);
    EXPECT_LT((p->world_mm - truth).norm(), 1e-6);
    EXPECT_LT(p->gap_mm, 1e-6);
    EXPECT_FALSE(triangulate(cameras[0], pixel(0), cameras[0], pixel(0)));
}

TEST(BundleObject, TwoCamerasFixAnObjectAndWeightsCount) {
    const auto cameras = two_cameras();
    const Pose truth = make_pose(rotation_exp({0.1, 0.2, -0.3}), {10, 5, 420});
    std::vector<BundleSight> sights;
    for (int k = 0; k < 2; ++k)
        for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(60, 0, 0),
                                         Eigen::Vector3d(0, 50, 0), Eigen::Vector3d(40, 40, 15)})
            sights.push_back({k, p,
                              cameras[static_cast<std::size_t>(k)].camera.project(
                                  cameras[static_cast<std::size_t>(k)].camera_from_world * (truth * p)),
                              1});
    const Pose start = retract(truth, (Vector6() << 20, -10, 15, 0.1, -0.1, 0.2).finished());
    auto r = bundle_object(cameras, sights, start);
    ASSERT_TRUE(r);
    EXPECT_TRUE(r->determined);
    EXPECT_LT(distance_mm(r->world_from_object, truth), 1e-6);
    sights[3].pixel.x() += 50;
    sights[3].weight = 0;
    r = bundle_object(cameras, sights, start);
    ASSERT_TRUE(r);
    EXPECT_LT(distance_mm(r->world_from_object, truth), 1e-6);
    for (auto& s : sights) s.object_mm = {s.object_mm.x(), 0, 0};
    r = bundle_object(cameras, sights, start);
    ASSERT_TRUE(r);
    EXPECT_FALSE(r->determined);
    sights[0].camera = 7;
    EXPECT_FALSE(bundle_object(cameras, sights, start));
}

}  // namespace
}  // namespace seamwright
