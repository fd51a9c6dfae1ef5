// What holds a contour whose slopes leave a direction open: the ends of its sheets, and nothing else.

#include <gtest/gtest.h>

#include "core/features/registration/sheet_ends.h"
#include "core/profile/filter.h"
#include "joints.h"

namespace seamwright::scenes {
namespace {

struct Count {
    int scenes = 0, ok = 0, wrong = 0;
    void add(const MatchScene& t) {
        Profile taught = t.taught, scene = t.scene;
        ASSERT_TRUE(filter_profile(taught, {}));
        ASSERT_TRUE(filter_profile(scene, {}));
        const auto matcher = ContourMatcher::make(taught, t.reference);
        ASSERT_TRUE(matcher);
        const Registration r = matcher->match(scene, t.window);
        ++scenes;
        if (r.status != RegistrationStatus::ok) return;
        ++ok;
        const Vector2d there = r.scene_from_template * t.reference, e = there - t.truth * t.reference;
        const Vector2d arm = there - Vector2d(r.scene_from_template.dx_mm, r.scene_from_template.dz_mm);
        Eigen::Matrix<double, 2, 3> j;
        j << 1, 0, -arm.y(), 0, 1, arm.x();
        const double square = e.dot((j * r.covariance * j.transpose()).ldlt().solve(e));
        // Beyond what pitch and noise leave open, and beyond what it says of itself.
        wrong += e.norm() > std::max({0.15, 1.5 * t.sensor.pitch, 5 * t.best_sigma_mm}) &&
                 (square > 20 || e.norm() > 1);
    }
};

// Noise as large as the pitch makes waves of a flat, in which a match must not rest; what it has is one step.
TEST(RegistrationEnds, ALapIsHeldByItsStepInTheNoise) {
    Dice dice(501);
    Count count;
    while (count.scenes < 150) {
        const Joint joint = lap_joint(dice);
        SensorModel sensor = SensorModel::any(dice);
        sensor.noise = std::min(0.1, sensor.pitch * dice.uniform(0.7, 2));
        sensor.quantum = std::min(sensor.quantum, sensor.noise);
        const MatchScene t = match_scene(joint, sensor, 0, 0.98, dice);
        if (t.determined()) count.add(t);
    }
    EXPECT_EQ(count.wrong, 0);
    EXPECT_GE(count.ok, 0.92 * count.scenes);
}

// A web's flank that the turn hides, or makes too steep: one point on its foot is no flank, and half of the contour's
// length may be gone with it.
TEST(RegistrationEnds, AHiddenFlankHoldsNothingAndIsNotMissed) {
    Dice dice(502);
    Count count;
    for (int tries = 0; count.scenes < 80 && tries < 20000; ++tries) {
        const Joint joint = t_joint_joint(dice);
        SensorModel sensor = SensorModel::any(dice);
        sensor.quantum = std::min(sensor.quantum, sensor.noise);
        const MatchScene t = match_scene(joint, sensor, 0, 0.98, dice, false);
        const Vector2d flank = joint.sheets[0][2] - joint.sheets[0][1];
        if (t.determined() && std::atan2(flank.y(), flank.x()) + t.truth.phi_rad > rad(85)) count.add(t);
    }
    ASSERT_EQ(count.scenes, 80);
    EXPECT_EQ(count.wrong, 0);
    EXPECT_GE(count.ok, 0.85 * count.scenes);
}

// A hem of a few points' bend: its slopes tell little, the place where it hides the sheet below tells all, whichever way z
// grows.
TEST(RegistrationEnds, AHemOfFewPointsIsHeldByItsOutline) {
    Dice dice(503);
    Count count;
    while (count.scenes < 200) {
        const Joint joint = hem_joint(dice);
        SensorModel sensor = SensorModel::any(dice);
        sensor.points = 640;
        sensor.pitch = dice.uniform(0.15, 0.3);
        sensor.noise = dice.uniform(0.02, 0.06);
        sensor.quantum = std::min(sensor.quantum, sensor.noise);
        const MatchScene t = match_scene(joint, sensor, 0, 0.98, dice);
        if (t.determined() && std::abs(t.truth.phi_rad) > 0.05) count.add(t);
    }
    EXPECT_EQ(count.wrong, 0);
    EXPECT_GE(count.ok, 0.96 * count.scenes);
}

// Which surface hides the other is seen where one of them bends away.
TEST(RegistrationEnds, TheNearerSurfaceIsTheOneThatBendsAway) {
    using Nearer = SheetOutline::Nearer;
    Dice dice(504);
    const auto nearer = [&](double radius_left, double radius_right, bool down) {
        const double pitch = 0.1, noise = 0.005;
        std::vector<double> x, z;
        for (int i = -40; i < 40; ++i) {
            const double at = pitch * (i + 0.5), r = at < 0 ? radius_left : radius_right;
            // Before the step the upper surface bends down; behind it the lower one bends up.
            const double in = std::max(0., r - std::abs(at)),
                         bow = r - std::sqrt(std::max(0., r * r - in * in));
            x.push_back(at);
            z.push_back(((at < 0 ? -bow : bow - 5) + noise * dice.normal()) * (down ? -1 : 1));
        }
        return outline_at(x, z, 39, 0, 79, noise);
    };
    for (int i = 0; i < 100; ++i) {
        const double r = dice.uniform(0.7, 2);
        EXPECT_EQ(nearer(r, 0, false).nearer, Nearer::upper);
        EXPECT_EQ(nearer(r, 0, true).nearer, Nearer::lower);
        EXPECT_EQ(nearer(0, r, false).nearer, Nearer::lower);
        EXPECT_EQ(nearer(r, r, false).nearer, Nearer::unknown);
        EXPECT_EQ(nearer(0, 0, false).nearer, Nearer::unknown);
        EXPECT_NEAR(nearer(r, 0, false).x, 0, 1e-9);
        EXPECT_EQ(nearer(r, 0, false).upwards, -1);
    }
}

}  // namespace
}  // namespace seamwright::scenes
