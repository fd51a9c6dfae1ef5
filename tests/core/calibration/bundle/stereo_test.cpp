#include "core/calibration/bundle/stereo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/calibration/bundle/camera_ring.h"

namespace seamwright {
namespace {

using camera_ring::Ring;
using testing::HasSubstr;

struct Pair {
    PlacedCamera first, second;
    std::vector<StereoSight> sights;
    std::vector<Eigen::Vector3d> truth;
};

Pair scene(Ring& ring, int points, double noise_px, double place_mm = 0, double place_rad = 0) {
    Pair p;
    p.first = ring.looking_at("left", {0, 0, 0}, 800, {-0.35, 0.1, 1});
    p.second = ring.looking_at("right", {0, 0, 0}, 800, {0.4, -0.05, 1});
    for (PlacedCamera* c : {&p.first, &p.second}) {
        c->world_from_camera.covariance.diagonal().head<3>().setConstant(place_mm * place_mm);
        c->world_from_camera.covariance.diagonal().tail<3>().setConstant(place_rad * place_rad);
    }
    const Pose left = ring.truly(p.first.world_from_camera), right = ring.truly(p.second.world_from_camera);
    for (int i = 0; i < points; ++i) {
        const Eigen::Vector3d at(ring.within(-200, 200), ring.within(-150, 150), ring.within(-80, 80));
        p.truth.push_back(at);
        const auto noise = [&] { return Eigen::Vector2d(ring.normal(noise_px), ring.normal(noise_px)); };
        p.sights.push_back({"P" + std::to_string(i), Ring::pixel(p.first, left, at) + noise(),
                            Ring::pixel(p.second, right, at) + noise(), std::nullopt});
    }
    return p;
}

TEST(Stereo, MeetsInThePoint) {
    Ring ring(1);
    const Pair p = scene(ring, 20, 0);
    const auto r = intersect(p.first, p.second, p.sights, {});
    ASSERT_TRUE(r) << r.error().sentence();
    for (std::size_t i = 0; i < p.truth.size(); ++i) {
        EXPECT_LT((r->points[i].world_mm - p.truth[i]).norm(), 1e-5);
        EXPECT_LT(r->points[i].gap_mm, 1e-5);
    }
    EXPECT_EQ(r->report.judgement.verdict, Verdict::usable) << "nothing confirms the scale";
    EXPECT_FALSE(meet_rays(p.first, {600, 500}, p.first, {600, 500})) << "one ray is parallel to itself";
}

// Two rays along the axes that pass each other at a known distance: the middle of it.
TEST(Stereo, TheMiddleOfTheCommonPerpendicular) {
    PlacedCamera a, b;
    a.id = "a", b.id = "b";
    for (PlacedCamera* c : {&a, &b}) {
        c->camera.fx = c->camera.fy = 1000, c->camera.cx = 500, c->camera.cy = 400;
        c->camera.width = 1000, c->camera.height = 800;
    }
    a.world_from_camera.pose.translation() = Eigen::Vector3d(0, 0, -300);  // along z through the origin
    b.world_from_camera.pose =                                             // along x, two above
        make_pose(Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitY()).toRotationMatrix(), {-400, 2, 0});
    const auto met = meet_rays(a, {500, 400}, b, {500, 400});
    ASSERT_TRUE(met);
    EXPECT_LT((met->world_mm - Eigen::Vector3d(0, 1, 0)).norm(), 1e-9);
    EXPECT_NEAR(std::abs(met->gap_mm), 2, 1e-9);
    EXPECT_NEAR(met->angle_rad, kPi / 2, 1e-12);
    b.world_from_camera.pose.translation().x() = 400;  // looks away from the crossing
    EXPECT_FALSE(meet_rays(a, {500, 400}, b, {500, 400}));
}

TEST(Stereo, StatesWhatItErrsBy) {
    int inside = 0, numbers = 0;
    for (unsigned seed = 1; seed <= 200; ++seed) {
        Ring ring(seed);
        const double place = seed % 2 == 0 ? 0.1 : 0;
        const Pair p = scene(ring, 3 + static_cast<int>(seed % 10), 0.15, place, place * 2e-3);
        const auto r = intersect(p.first, p.second, p.sights, {});
        ASSERT_TRUE(r) << r.error().sentence();
        for (std::size_t i = 0; i < p.truth.size(); ++i)
            for (int k = 0; k < 3; ++k, ++numbers)
                inside += std::abs(r->points[i].world_mm(k) - p.truth[i](k)) <
                          1.96 * std::sqrt(r->points[i].covariance(k, k));
    }
    EXPECT_GT(inside, 0.93 * numbers);
    EXPECT_LT(inside, 0.985 * numbers);
}

TEST(Stereo, KnownPointsConfirmOrContradict) {
    Ring ring(6);
    Pair p = scene(ring, 15, 0.03);
    for (const std::size_t i : {2, 7, 11}) p.sights[i].known_mm = p.truth[i];
    auto r = intersect(p.first, p.second, p.sights, {});
    ASSERT_TRUE(r);
    EXPECT_EQ(r->report.judgement.verdict, Verdict::good) << r->report.judgement.reason.english();
    EXPECT_EQ(r->report.hold_out.folds, 3);
    // Along the base line: the rays still meet, the scale is wrong.
    const Eigen::Vector3d base =
        p.second.world_from_camera.pose.translation() - p.first.world_from_camera.pose.translation();
    p.second.world_from_camera.pose.translation() += 0.02 * base;
    r = intersect(p.first, p.second, p.sights, {});
    ASSERT_TRUE(r);
    EXPECT_EQ(r->report.judgement.verdict, Verdict::poor);
    EXPECT_THAT(r->report.judgement.reason.english(), HasSubstr("known to be"));
}

TEST(Stereo, ACameraThatWasTurnedIsNoticedWithoutKnownPoints) {
    Ring ring(7);
    Pair p = scene(ring, 20, 0.1);
    Pose& right = p.second.world_from_camera.pose;
    right.linear() = Eigen::AngleAxisd(0.002, Eigen::Vector3d::UnitX()).toRotationMatrix() * right.linear();
    const auto r = intersect(p.first, p.second, p.sights, {});
    ASSERT_TRUE(r);
    EXPECT_EQ(r->report.judgement.verdict, Verdict::poor);
    EXPECT_THAT(r->report.judgement.reason.english(), HasSubstr("stood elsewhere"));
}

TEST(Stereo, TwoPointsTakenForOneAreNamed) {
    Ring ring(9);
    Pair p = scene(ring, 12, 0.1);
    std::swap(p.sights[3].second_px, p.sights[8].second_px);
    const auto r = intersect(p.first, p.second, p.sights, {});
    ASSERT_TRUE(r);
    EXPECT_TRUE(r->report.poses[3].contradicts || r->report.poses[8].contradicts);
    EXPECT_LT(r->sigma_px, 0.3);
}

TEST(Stereo, RefusesWhatIsNone) {
    Ring ring(2);
    const Pair p = scene(ring, 3, 0);
    EXPECT_FALSE(intersect(p.first, p.second, {}, {}));
    EXPECT_FALSE(intersect(p.first, p.first, p.sights, {}));
    auto outside = p.sights;
    outside[1].first_px.x() = -20;
    const auto r = intersect(p.first, p.second, outside, {});
    ASSERT_FALSE(r);
    EXPECT_THAT(r.error().sentence(), HasSubstr("'left'"));
    EXPECT_FALSE(intersect(p.first, p.second, p.sights, {{"nobody"}, {}}));
}

}  // namespace
}  // namespace seamwright
