// Laws, known answers and hostile input of the registration. Success rates and statistics over many scenes
// are in registration_long_test.cpp.

#include "core/features/registration/registration.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include "contours.h"
#include "core/features/contour/contour_model.h"

namespace seamwright::test {
namespace {

PlanarMotion inverse(const PlanarMotion& m) {
    PlanarMotion i{0, 0, -m.phi_rad};
    const Eigen::Vector2d d = i * Eigen::Vector2d(m.dx_mm, m.dz_mm);
    return {-d.x(), -d.y(), -m.phi_rad};
}
PlanarMotion product(const PlanarMotion& a, const PlanarMotion& b) {
    const Eigen::Vector2d d = a * Eigen::Vector2d(b.dx_mm, b.dz_mm);
    return {d.x(), d.y(), a.phi_rad + b.phi_rad};
}
Profile moved(Profile p, const PlanarMotion& m) {
    for (std::size_t i = 0; i < p.size(); ++i) {
        const Eigen::Vector2d q = m * Eigen::Vector2d(p.x_mm[i], p.z_mm[i]);
        p.x_mm[i] = q.x();
        p.z_mm[i] = q.y();
    }
    return p;
}
void expect_near(const PlanarMotion& a, const PlanarMotion& b, double mm, double rad) {
    EXPECT_NEAR(a.dx_mm, b.dx_mm, mm);
    EXPECT_NEAR(a.dz_mm, b.dz_mm, mm);
    EXPECT_NEAR(a.phi_rad, b.phi_rad, rad);
}

TEST(Registration, ExactMotionWithoutNoise) {
    const Profile t = sample(hem(-15, 15), 0.05);
    auto matcher = ContourMatcher::make(t, {0, 0});
    ASSERT_TRUE(matcher);
    for (const PlanarMotion& truth :
         {PlanarMotion{0, 0, 0}, PlanarMotion{9, -8, 0.2}, PlanarMotion{-3, 7, -0.25}}) {
        const Registration r = matcher->match(moved(t, truth), {});
        EXPECT_EQ(r.status, RegistrationStatus::ok) << to_string(r.status);
        expect_near(r.scene_from_template, truth, 1e-4, 1e-5);
        EXPECT_GT(r.inlier_share, 0.97);
    }
}

TEST(Registration, MovesWithTheScene) {
    Random random(5);
    Profile t = sample(hem(-15, 15), 0.05), s = sample(hem(-30, 30), 0.06);
    add_noise(t, 0.02, random);
    add_noise(s, 0.02, random);
    auto matcher = ContourMatcher::make(t, {0, 0});
    ASSERT_TRUE(matcher);
    const Registration still = matcher->match(s, {});
    ASSERT_EQ(still.status, RegistrationStatus::ok);
    for (const PlanarMotion& m :
         {PlanarMotion{4, 5, 0}, PlanarMotion{-6, 3, 0.15}, PlanarMotion{1, -7, -0.2}}) {
        const Registration r = matcher->match(moved(s, m), {});
        ASSERT_EQ(r.status, RegistrationStatus::ok);
        // The same minimum, up to the few points that fall on either side of the gate.
        expect_near(r.scene_from_template, product(m, still.scene_from_template), 2e-3, 1e-4);
    }
}

TEST(Registration, TemplateFarFromTheOriginChangesNothing) {
    Random random(6);
    const PlanarMotion far{250, -480, 0};
    Profile t = sample(joggle(-15, 15), 0.05), s = sample(joggle(-30, 30).moved({5, -4, 0.2}), 0.05);
    add_noise(s, 0.02, random);
    auto near_matcher = ContourMatcher::make(t, {0, 0});
    auto far_matcher = ContourMatcher::make(moved(t, far), {250, -480});
    ASSERT_TRUE(near_matcher && far_matcher);
    const Registration a = near_matcher->match(s, {}), b = far_matcher->match(moved(s, far), {});
    ASSERT_EQ(a.status, RegistrationStatus::ok);
    ASSERT_EQ(b.status, RegistrationStatus::ok);
    const PlanarMotion expected = product(product(far, a.scene_from_template), inverse(far));
    expect_near(b.scene_from_template, expected, 1e-6, 1e-9);
    // The covariance of the landmark is the same as well.
    Eigen::Matrix<double, 2, 3> j;
    const Eigen::Vector2d arm = b.scene_from_template * Eigen::Vector2d(250, -480) -
                                Eigen::Vector2d(b.scene_from_template.dx_mm, b.scene_from_template.dz_mm);
    j << 1, 0, -arm.y(), 0, 1, arm.x();
    const Eigen::Matrix2d at_landmark = j * b.covariance * j.transpose();
    EXPECT_LT((at_landmark - a.covariance.topLeftCorner<2, 2>()).norm(), 1e-3 * at_landmark.norm());
}

TEST(Registration, SwappedPairGivesTheInverse) {
    Random random(7);
    const PlanarMotion truth{2, 3, 0.1};
    Profile a = sample(hem(-15, 15), 0.05), b = sample(hem(-15, 15).moved(truth), 0.05, 0.2);
    add_noise(a, 0.01, random);
    add_noise(b, 0.01, random);
    auto forth = ContourMatcher::make(a, {0, 0}), back = ContourMatcher::make(b, {0, 0});
    ASSERT_TRUE(forth && back);
    const Registration f = forth->match(b, {}), g = back->match(a, {});
    ASSERT_EQ(f.status, RegistrationStatus::ok);
    ASSERT_EQ(g.status, RegistrationStatus::ok);
    const PlanarMotion identity = product(g.scene_from_template, f.scene_from_template);
    // Each is within its own noise of the truth.
    const double mm = 4 * std::sqrt(f.covariance.topLeftCorner<2, 2>().trace());
    expect_near(identity, {0, 0, 0}, std::max(mm, 0.005), 2e-3);
}

TEST(Registration, OtherPitchAndShuffledScene) {
    const PlanarMotion truth{-4, 6, -0.15};
    const Profile t = sample(hem(-15, 15), 0.05);
    auto matcher = ContourMatcher::make(t, {0, 0});
    ASSERT_TRUE(matcher);
    for (const double pitch : {0.02, 0.04, 0.1, 0.2}) {
        const Registration r = matcher->match(sample(hem(-30, 30).moved(truth), pitch), {});
        EXPECT_EQ(r.status, RegistrationStatus::ok) << pitch;
        expect_near(r.scene_from_template, truth, 0.02, 1e-3);
    }
    Random random(8);
    Profile s = sample(hem(-30, 30).moved(truth), 0.05), shuffled = s;
    std::vector<std::size_t> order(s.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random);
    for (std::size_t i = 0; i < order.size(); ++i) {
        shuffled.x_mm[i] = s.x_mm[order[i]];
        shuffled.z_mm[i] = s.z_mm[order[i]];
    }
    const Registration a = matcher->match(s, {}), b = matcher->match(shuffled, {});
    EXPECT_EQ(b.status, RegistrationStatus::ok);
    expect_near(a.scene_from_template, b.scene_from_template, 1e-6, 1e-8);
}

TEST(Registration, RefineFollowsSmallMotions) {
    Random random(9);
    const Profile t = sample(hem(-15, 15), 0.05);
    auto matcher = ContourMatcher::make(t, {0, 0});
    ASSERT_TRUE(matcher);
    PlanarMotion truth{0, 0, 0}, tracked{0, 0, 0};
    for (int i = 0; i < 40; ++i) {
        truth = {truth.dx_mm + 0.3, truth.dz_mm - 0.2, truth.phi_rad + 0.004};
        Profile s = sample(hem(-30, 30).moved(truth), 0.05);
        add_noise(s, 0.02, random);
        const Registration r = matcher->refine(s, tracked);
        ASSERT_EQ(r.status, RegistrationStatus::ok) << i;
        tracked = r.scene_from_template;
        expect_near(tracked, truth, 0.04, 1e-3);
    }
}

TEST(Registration, StraightTemplateSlidesAndSaysWhere) {
    Random random(10);
    Shape line, longer;
    line.line_to(-10, -2);
    line.line_to(10, 2);
    longer.line_to(-30, -6);
    longer.line_to(30, 6);
    for (const double noise : {0.0, 0.02}) {
        Profile t = sample(line, 0.05), s = sample(longer.moved({1, 2, 0.05}), 0.05);
        add_noise(t, noise, random);
        add_noise(s, noise, random);
        auto matcher = ContourMatcher::make(t, {0, 0});
        ASSERT_TRUE(matcher);
        const Registration r = matcher->match(s, {});
        ASSERT_EQ(r.status, RegistrationStatus::sliding) << noise << " " << to_string(r.status);
        const double angle = std::atan2(0.2, 1) + 0.05;
        const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
        EXPECT_GT(std::abs(r.sliding_direction.dot(along)), 0.999);
        EXPECT_NEAR(r.scene_from_template.phi_rad, 0.05, 2e-3);
        const Eigen::Vector2d n(-std::sin(angle), std::cos(angle));
        const Eigen::Matrix2d shift = r.covariance.topLeftCorner<2, 2>();
        EXPECT_GT(shift.trace(), 1e3 * n.dot(shift * n));
    }
}

// Six points of the rim say where along the flat it is.
TEST(Registration, ASmallRimIsNotSlidAlongItsFlat) {
    Random random(13);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto rim = [](double left, double radius) {
        Shape s;
        s.line_to(left, 0);
        s.line_to(0, 0);
        s.arc(0, -radius, radius, 90, 15);
        return s;
    };
    int right = 0, wrong = 0;
    for (int i = 0; i < 40; ++i) {
        const double radius = i % 2 ? 1 : 2, side = i % 4 < 2 ? 1 : -1;
        const PlanarMotion truth{side * (5 + 4 * unit(random)), 2 - 4 * unit(random),
                                 0.1 - 0.2 * unit(random)};
        Profile t = sample(rim(-10, radius), 0.1),
                s = sample(rim(-40, radius).moved(truth), 0.1, unit(random));
        add_noise(t, 0.02, random);
        add_noise(s, 0.02, random);
        auto matcher = ContourMatcher::make(t, {0, 0});
        ASSERT_TRUE(matcher);
        const Registration r = matcher->match(s, {});
        if (r.status != RegistrationStatus::ok) continue;
        const bool here = std::hypot(r.scene_from_template.dx_mm - truth.dx_mm,
                                     r.scene_from_template.dz_mm - truth.dz_mm) < 0.15;
        right += here;
        wrong += !here;
    }
    EXPECT_GE(right, 39);
    EXPECT_EQ(wrong, 0);
}

// The rim lies in the dark: its flat alone may slide, and the sigma says so.
TEST(Registration, AFlatWithoutItsRimSlides) {
    Random random(14);
    Shape rim, flat;
    rim.line_to(-10, 0);
    rim.line_to(0, 0);
    rim.arc(0, -1, 1, 90, 15);
    flat.line_to(-40, 1);
    flat.line_to(5, 1);
    for (int i = 0; i < 10; ++i) {
        Profile t = sample(rim, 0.1), s = sample(flat, 0.1);
        add_noise(t, 0.02, random);
        add_noise(s, 0.02, random);
        auto matcher = ContourMatcher::make(t, {0, 0});
        ASSERT_TRUE(matcher);
        const Registration r = matcher->match(s, {});
        ASSERT_EQ(r.status, RegistrationStatus::sliding) << to_string(r.status);
        EXPECT_GT(std::abs(r.sliding_direction.x()), 0.99);
        EXPECT_GT(std::sqrt(r.covariance(0, 0)), 100);
    }
}

// What lies beyond the window is not found in it, half seen, at its rim.
TEST(Registration, WhatLiesBeyondTheWindowIsRefused) {
    Random random(15);
    SearchWindow window, wide;
    window.dx_mm = window.dz_mm = 6;
    window.phi_rad = wide.phi_rad = 0.1;
    wide.dx_mm = wide.dz_mm = 20;
    for (const auto& shape : {&hem, &joggle}) {
        auto matcher = ContourMatcher::make(sample(shape(-15, 15), 0.05), {0, 0});
        ASSERT_TRUE(matcher);
        for (const double dx : {-14.0, -11.0, -9.0, 8.5, 10.0, 13.0}) {
            Profile s = sample(shape(-45, 45).moved({dx, 2, 0.03}), 0.05, 0.3);
            add_noise(s, 0.02, random);
            EXPECT_NE(matcher->match(s, window).status, RegistrationStatus::ok) << dx;
            const Registration r = matcher->match(s, wide);
            ASSERT_EQ(r.status, RegistrationStatus::ok) << dx;
            EXPECT_NEAR(r.scene_from_template.dx_mm, dx, 0.1);
        }
    }
}

TEST(Registration, TwoEqualPlacesAreAmbiguous) {
    Random random(11);
    Shape two;
    two.line_to(-30, 0);
    for (const double at : {-4.0, 4.0}) {
        const Shape b = bead(at - 3.5, at + 3.5, at, 4, 1.5);
        for (std::size_t i = 0; i < b.x.size(); ++i) two.line_to(b.x[i], b.z[i]);
    }
    two.line_to(30, 0);
    Profile s = sample(two, 0.05);
    add_noise(s, 0.02, random);
    auto matcher = ContourMatcher::make(sample(bead(-3.5, 3.5, 0, 4, 1.5), 0.05), {0, 0});
    ASSERT_TRUE(matcher);
    EXPECT_EQ(matcher->match(s, {}).status, RegistrationStatus::ambiguous);
    // With one of them outside of the window it is found.
    SearchWindow window;
    window.dx_mm = 2;
    window.centre_mm = {4, 0};
    const Registration r = matcher->match(s, window);
    EXPECT_EQ(r.status, RegistrationStatus::ok);
    EXPECT_NEAR(r.scene_from_template.dx_mm, 4, 0.03);
}

TEST(Registration, GarbageIsNoMatch) {
    Random random(12);
    auto matcher = ContourMatcher::make(sample(hem(-15, 15), 0.05), {0, 0});
    ASSERT_TRUE(matcher);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int trial = 0; trial < 20; ++trial) {
        Profile scatter;
        for (int i = 0; i < 800; ++i) {
            scatter.x_mm.push_back(-20 + 0.05 * i);
            scatter.z_mm.push_back(10 * unit(random));
        }
        EXPECT_NE(matcher->match(scatter, {}).status, RegistrationStatus::ok);
        // Another shape: straight parts fit, the fold is not there.
        Profile other = sample(bead(-30, 30, 5 * unit(random), 5, 2), 0.05);
        add_noise(other, 0.02, random);
        EXPECT_NE(matcher->match(other, {}).status, RegistrationStatus::ok);
        Shape flat;
        flat.line_to(-30, 0);
        flat.line_to(30, 0);
        Profile plain = sample(flat, 0.05);
        add_noise(plain, 0.02, random);
        EXPECT_NE(matcher->match(plain, {}).status, RegistrationStatus::ok);
    }
}

// A flat, a ramp, a flat. Of the part in the scene the ramp is of another length: the flats lie as taught and place the
// template by themselves, while the ramp, by which a person would place it, stands elsewhere.
Shape joggle(double first_deg, double second_deg, double run, double height, double ramp_scale) {
    const double first = std::tan(rad_from_deg(first_deg)), second = std::tan(rad_from_deg(second_deg));
    Shape s;
    s.line_to(-40, -40 * first);
    s.line_to(0, 0);
    s.line_to(run * ramp_scale, height + run * (ramp_scale - 1) * second);
    s.line_to(40, height + (40 - run) * second);
    return s;
}

Shape piece(const Shape& whole, double from, double to) {
    Shape s;
    for (std::size_t i = 0; i < whole.x.size(); ++i)
        if (whole.x[i] > from && whole.x[i] < to) {
            s.x.push_back(whole.x[i]);
            s.z.push_back(whole.z[i]);
        }
    return s;
}

// Share of the taught contour, put where it was found, that lies more than `far_mm` over or under the scene's.
double share_elsewhere(const Shape& taught, const Shape& scene, const PlanarMotion& found, double far_mm) {
    const Shape put = taught.moved(found);
    std::size_t beside = 0;
    for (std::size_t i = 0; i < put.x.size(); ++i) {
        const auto right = std::lower_bound(scene.x.begin(), scene.x.end(), put.x[i]) - scene.x.begin();
        if (right == 0 || right == static_cast<std::ptrdiff_t>(scene.x.size())) continue;
        if (std::abs(scene.z[static_cast<std::size_t>(right)] - put.z[i]) > far_mm) ++beside;
    }
    return double(beside) / double(put.x.size());
}

TEST(Registration, APartOfAnotherShapeIsNotOk) {
    Random random(606);
    std::uniform_real_distribution<double> unit(-1, 1);
    SearchWindow window;
    window.dx_mm = window.dz_mm = 20;
    window.phi_rad = rad_from_deg(5);
    int right = 0, same_shape = 0, other = 0;
    for (int trial = 0; trial < 240; ++trial) {
        const double first = 5 * unit(random), second = first + 25 * unit(random);
        const double run = 10 + 5 * unit(random), height = 6 * unit(random),
                     flat = run * (0.8 + 0.2 * unit(random));
        const PlanarMotion moved{8 * unit(random), 5 * unit(random), rad_from_deg(3 * unit(random))};
        const double scale = trial % 4 == 0 ? 1 : (trial % 2 ? 0.5 : 1.7) + 0.2 * unit(random);
        const Shape taught = piece(joggle(first, second, run, height, 1), -flat, run + flat);
        const Shape scene = joggle(first, second, run, height, scale).moved(moved);
        Profile contour = sample(taught, 0.1), seen = sample(scene, 0.1, 0.3);
        add_noise(contour, 0.04, random);
        add_noise(seen, 0.04, random);
        const auto matcher = ContourMatcher::make(contour, {0, 0});
        ASSERT_TRUE(matcher);
        const Registration r = matcher->match(seen, window);
        if (scale == 1) {
            ++same_shape;
            right += r.status == RegistrationStatus::ok &&
                     std::abs(r.scene_from_template.dx_mm - moved.dx_mm) < 0.5;
        } else if (r.status == RegistrationStatus::ok) {
            EXPECT_LT(share_elsewhere(taught, scene, r.scene_from_template, 0.5), 0.3) << trial;
        } else {
            ++other;
        }
    }
    EXPECT_GE(right, same_shape * 9 / 10);
    EXPECT_GT(other, 60);
}

TEST(Registration, HostileInput) {
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();
    Profile none, one, few, same, nans, line;
    one.x_mm = one.z_mm = {1};
    few.x_mm = few.z_mm = {1, 2, 3, 4};
    same.x_mm = same.z_mm = std::vector<double>(100, 3.0);
    nans.x_mm = std::vector<double>(100, 1.0);
    nans.z_mm = std::vector<double>(100, nan);
    Profile unequal;
    unequal.x_mm = {1, 2, 3};
    unequal.z_mm = {1};
    for (const Profile* p : {&none, &one, &few, &same, &nans, &unequal})
        EXPECT_FALSE(ContourMatcher::make(*p, {0, 0}));
    EXPECT_FALSE(ContourMatcher::make(sample(hem(-10, 10), 0.05), {nan, 0}));

    auto matcher = ContourMatcher::make(sample(hem(-15, 15), 0.05), {0, 0});
    ASSERT_TRUE(matcher);
    EXPECT_EQ(matcher->match(none, {}).status, RegistrationStatus::no_points);
    EXPECT_EQ(matcher->match(nans, {}).status, RegistrationStatus::no_points);
    EXPECT_NE(matcher->match(same, {}).status, RegistrationStatus::ok);
    EXPECT_EQ(matcher->match(one, {}).status, RegistrationStatus::no_points);
    Profile huge = sample(hem(-30, 30), 0.05), spotted = huge;
    for (double& z : huge.z_mm) z *= 1e12;
    EXPECT_NE(matcher->match(huge, {}).status, RegistrationStatus::ok);
    for (std::size_t i = 0; i < spotted.size(); i += 7) spotted.z_mm[i] = i % 2 ? nan : inf;
    spotted.x_mm[50] = 1e9;
    const Registration r = matcher->match(spotted, {});
    EXPECT_EQ(r.status, RegistrationStatus::ok);
    expect_near(r.scene_from_template, {0, 0, 0}, 0.02, 1e-3);
    SearchWindow nowhere;
    nowhere.dx_mm = nowhere.dz_mm = nowhere.phi_rad = 0;
    EXPECT_EQ(matcher->match(sample(hem(-30, 30), 0.05), nowhere).status, RegistrationStatus::ok);
    SearchWindow bad;
    bad.dx_mm = nan;
    EXPECT_EQ(matcher->match(spotted, bad).status, RegistrationStatus::no_match);
    EXPECT_NE(matcher->refine(spotted, {nan, 0, 0}).status, RegistrationStatus::ok);
}

}  // namespace
}  // namespace seamwright::test
