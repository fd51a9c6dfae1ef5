// What holds a contour whose slopes leave a direction open: the ends of its sheets, and nothing else.

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace seamwright::scenes
