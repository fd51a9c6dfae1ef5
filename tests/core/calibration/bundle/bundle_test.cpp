#include "core/calibration/bundle/bundle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/calibration/bundle/camera_ring.h"

namespace seamwright {
namespace {

using camera_ring::body;
using camera_ring::Ring;
using testing::HasSubstr;

struct Seen {
    std::vector<PlacedCamera> cameras;
    std::vector<BundleSight> sights;
    Pose truth = Pose::Identity();
};

// Cameras about the body, each seeing its share of the features: with `share` 1 all of them.
Seen scene(Ring& ring, int cameras, int features, int share, double noise_px, double place_mm = 0,
           double place_rad = 0) {
    Seen s;
    s.truth = ring.anywhere(400);
    const auto points = body(features);
    for (int c = 0; c < cameras; ++c) {
        const Eigen::Vector3d from = ring.direction();
        PlacedCamera camera =
            ring.looking_at("C" + std::to_string(c), s.truth.translation(), ring.within(900, 1400), from);
        camera.world_from_camera.covariance.diagonal().head<3>().setConstant(place_mm * place_mm);
        camera.world_from_camera.covariance.diagonal().tail<3>().setConstant(place_rad * place_rad);
        const Pose really = ring.truly(camera.world_from_camera);
        for (int i = 0; i < features; ++i) {
            if (i % share != c % share) continue;
            const auto k = static_cast<std::size_t>(i);
            s.sights.push_back({"F" + std::to_string(i), static_cast<std::size_t>(c), points[k],
                                Ring::pixel(camera, really, s.truth * points[k]) +
                                    Eigen::Vector2d(ring.normal(noise_px), ring.normal(noise_px)),
                                1});
        }
        s.cameras.push_back(camera);
    }
    return s;
}

struct Layout {
    int cameras, features, share;
};
class ExactBundle : public testing::TestWithParam<Layout> {};

// From nothing but pixels: no start, the object anywhere.
TEST_P(ExactBundle, IsFoundWithoutAStart) {
    for (unsigned seed = 1; seed <= 12; ++seed) {
        Ring ring(seed);
        const Seen s = scene(ring, GetParam().cameras, GetParam().features, GetParam().share, 0);
        const auto r = locate_object(s.cameras, s.sights, {});
        ASSERT_TRUE(r) << r.error().sentence();
        ASSERT_TRUE(r->determined) << seed << ": " << r->report.judgement.reason.english();
        EXPECT_LT(distance_mm(r->world_from_object, s.truth), 1e-4) << seed;
        EXPECT_LT(angle_rad(r->world_from_object, s.truth), 1e-6) << seed;
    }
}
// One camera that sees all; two; the thesis's four cameras with two features each, and six with one.
INSTANTIATE_TEST_SUITE_P(Layouts, ExactBundle,
                         testing::Values(Layout{1, 8, 1}, Layout{2, 6, 1}, Layout{4, 8, 4}, Layout{6, 6, 6}));

// Per degree of freedom, with the cameras' places in it and few numbers to tell the noise from.
TEST(Bundle, StatesWhatItErrsBy) {
    int inside = 0, numbers = 0;
    for (unsigned seed = 1; seed <= 150; ++seed) {
        Ring ring(seed);
        const double place = seed % 2 == 0 ? 0.2 : 0;
        const Seen s = scene(ring, 2 + static_cast<int>(seed % 3), 4 + static_cast<int>(seed % 5), 1, 0.2,
                             place, place * 1e-3);
        const auto r = locate_object(s.cameras, s.sights, {});
        ASSERT_TRUE(r && r->determined) << seed;
        const Vector6 off = difference(s.truth, r->world_from_object);
        for (int i = 0; i < 6; ++i) inside += std::abs(off(i)) < 1.96 * std::sqrt(r->covariance(i, i));
        numbers += 6;
    }
    EXPECT_GT(inside, 0.91 * numbers);
    EXPECT_LT(inside, 0.985 * numbers) << "a sigma that is too large is no truth either";
}

TEST(Bundle, AWrongFeatureIsNamedAndLeftOut) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
        Ring ring(seed);
        Seen s = scene(ring, 3, 6, 1, 0.1);
        s.sights[7].pixel = {640, 500};  // F1 in C1
        const auto r = locate_object(s.cameras, s.sights, {});
        ASSERT_TRUE(r && r->determined);
        EXPECT_TRUE(r->sights[7].wrong);
        EXPECT_THAT(r->report.poses[1].note.english(), HasSubstr("F1"));
        EXPECT_LT(distance_mm(r->world_from_object, s.truth), 0.6);
        EXPECT_EQ(
            std::count_if(r->sights.begin(), r->sights.end(), [](const auto& one) { return one.wrong; }), 1);
    }
}

TEST(Bundle, NamesTheUnitThatFits) {
    Ring ring(6);
    const Seen s = scene(ring, 3, 6, 1, 0.1);
    const auto cure = [&](double object, double cameras) {
        auto placed = s.cameras;
        auto seen = s.sights;
        for (auto& c : placed) c.world_from_camera.pose.translation() *= cameras;
        for (auto& one : seen) one.object_mm *= object;
        const auto r = locate_object(placed, seen, {});
        if (!r) return r.error().sentence();
        EXPECT_FALSE(serves(r->report.judgement.verdict));
        return r->report.judgement.cure.english();
    };
    EXPECT_TRUE(serves(locate_object(s.cameras, s.sights, {})->report.judgement.verdict));
    EXPECT_THAT(cure(1e-3, 1), HasSubstr("object are metres"));
    EXPECT_THAT(cure(1 / 25.4, 1), HasSubstr("object are inches"));
    EXPECT_THAT(cure(1, 1e-3), HasSubstr("cameras are metres"));
    EXPECT_THAT(cure(1, 1 / 25.4), HasSubstr("cameras are inches"));
    EXPECT_THAT(cure(1e-3, 1e-3), HasSubstr("metres"));
}

// (2.24): v = 0 turns a feature off, a small one lets it count for little.
TEST(Bundle, WeightsCount) {
    Ring ring(5);
    Seen s = scene(ring, 2, 6, 1, 0);
    s.sights[3].pixel += Eigen::Vector2d(8, -5);
    s.sights[3].weight = 0;
    auto r = locate_object(s.cameras, s.sights, {});
    ASSERT_TRUE(r && r->determined);
    EXPECT_LT(distance_mm(r->world_from_object, s.truth), 1e-4);
    s.sights[3].weight = 1e-6;
    r = locate_object(s.cameras, s.sights, {});
    ASSERT_TRUE(r && r->determined);
    EXPECT_LT(distance_mm(r->world_from_object, s.truth), 1e-2);
}

TEST(Bundle, ACameraThatStandsElsewhereIsNamed) {
    Ring ring(8);
    Seen s = scene(ring, 4, 8, 1, 0.1);
    s.cameras[2].world_from_camera.pose.translation() += Eigen::Vector3d(6, -5, 4);
    const auto r = locate_object(s.cameras, s.sights, {});
    ASSERT_TRUE(r && r->determined);
    EXPECT_EQ(r->report.judgement.verdict, Verdict::poor);
    EXPECT_THAT(r->report.judgement.reason.english(), HasSubstr("'C2'"));
    const auto without = locate_object(s.cameras, s.sights, {{"C2"}, {}, {}});
    ASSERT_TRUE(without && without->determined);
    EXPECT_TRUE(serves(without->report.judgement.verdict));
}

TEST(Bundle, WhatIsNotDeterminedIsSaid) {
    Ring ring(3);
    Seen s = scene(ring, 3, 6, 1, 0.1);
    std::vector<BundleSight> two;
    for (const BundleSight& one : s.sights)
        if (one.feature == "F0" || one.feature == "F1") two.push_back(one);
    auto r = locate_object(s.cameras, two, {});
    ASSERT_TRUE(r);
    EXPECT_FALSE(r->determined);
    EXPECT_THAT(r->report.judgement.reason.english(), HasSubstr("three features"));
    // On one line of the object.
    for (std::size_t i = 0; i < s.sights.size(); ++i) {
        s.sights[i].object_mm = {30.0 * static_cast<double>(i % 6), 0, 0};
        s.sights[i].pixel =
            Ring::pixel(s.cameras[s.sights[i].camera], s.cameras[s.sights[i].camera].world_from_camera.pose,
                        s.truth * s.sights[i].object_mm);
    }
    r = locate_object(s.cameras, s.sights, {});
    ASSERT_TRUE(r);
    EXPECT_FALSE(r->determined);
    EXPECT_EQ(r->report.judgement.verdict, Verdict::undetermined);
}

// Three features in one camera: up to four places explain them, and a start decides.
TEST(Bundle, TwoPlacesAreNotOne) {
    Ring ring(4);
    Seen s = scene(ring, 1, 3, 1, 0);
    const auto open = locate_object(s.cameras, s.sights, {});
    ASSERT_TRUE(open);
    if (!open->determined) {
        EXPECT_THAT(open->report.judgement.reason.english(), HasSubstr("two places"));
    }
    const auto r = locate_object(s.cameras, s.sights, {{}, {}, s.truth});
    ASSERT_TRUE(r && r->determined);
    EXPECT_LT(distance_mm(r->world_from_object, s.truth), 1e-3);
    EXPECT_NE(r->report.judgement.verdict, Verdict::good) << "nothing is left to check with";
}

TEST(Bundle, RefusesWhatIsNone) {
    Ring ring(2);
    const Seen s = scene(ring, 2, 4, 1, 0);
    const auto refused = [&](const Seen& bad, const BundleOptions& options = {}) {
        const auto r = locate_object(bad.cameras, bad.sights, options);
        return r ? std::string("taken") : r.error().sentence();
    };
    Seen bad = s;
    bad.sights[0].camera = 7;
    EXPECT_THAT(refused(bad), HasSubstr("no camera 7"));
    bad = s;
    bad.sights[0].weight = -1;
    EXPECT_THAT(refused(bad), HasSubstr("weight"));
    bad = s;
    bad.sights[0].pixel.x() = 4000;
    EXPECT_THAT(refused(bad), HasSubstr("outside the image of camera 'C0'"));
    bad = s;
    bad.sights[0].object_mm.x() += 1;
    EXPECT_THAT(refused(bad), HasSubstr("two places of the object"));
    bad = s;
    bad.cameras[1].camera.fx = 0;
    EXPECT_THAT(refused(bad), HasSubstr("focal length"));
    EXPECT_THAT(refused(s, {{"nobody"}, {}, {}}), HasSubstr("nobody"));
    EXPECT_THAT(refused(s, {{}, -1.0, {}}), HasSubstr("sigma_px"));
}

}  // namespace
}  // namespace seamwright
