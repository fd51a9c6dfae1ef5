// The laws of the ramp: limits, no step of speed beyond the acceleration, exact ends, zero after withdrawal.

#include "devices/cyclic/ramp.h"

#include <gtest/gtest.h>

#include <random>

namespace seamwright {
namespace {

Pose random_displacement(std::mt19937& random, double mm, double deg) {
    std::uniform_real_distribution<double> u(-1, 1);
    return make_pose(rotation_exp(Eigen::Vector3d(u(random), u(random), u(random)) * rad_from_deg(deg)),
                     Eigen::Vector3d(u(random), u(random), u(random)) * mm);
}

TEST(CorrectionRamp, KeepsItsLimitsAndEndsExactlyWhateverIsAsked) {
    std::mt19937 random(7);
    const RampLimits limits{20, 2, 100, 10};
    for (int trial = 0; trial < 60; ++trial) {
        const double cycle_s = trial % 2 ? 0.004 : 0.012;
        CorrectionRamp ramp(limits, cycle_s);
        const Eigen::Vector3d p(300.0 + trial, -200, 50);
        Eigen::Vector3d last = Eigen::Vector3d::Zero(), last_step = last, turn = last, turn_step = last;
        Pose target = Pose::Identity();
        const int changes = static_cast<int>(random() % 3) + 1;
        for (int change = 0; change <= changes; ++change) {
            target =
                change == changes ? random_displacement(random, 3, 0.5) : random_displacement(random, 5, 1);
            ramp.set_target(target);
            // In the middle, at the end, or at once.
            const int cycles = change == changes ? 100000 : static_cast<int>(random() % 250);
            for (int i = 0; i < cycles && !(i > 0 && ramp.arrived()); ++i) {
                const CyclicCorrection c = ramp.step(p);
                const Eigen::Vector3d step = c.offset_mm - last, turned = c.turn_rad - turn;
                ASSERT_LE(step.norm(), limits.speed_mm_s * cycle_s * (1 + 1e-9) + 1e-12);
                ASSERT_LE((step - last_step).norm(),
                          limits.acceleration_mm_s2 * cycle_s * cycle_s * (1 + 1e-6) + 1e-11);
                ASSERT_LE(deg_from_rad(turned.norm()), limits.speed_deg_s * cycle_s * (1 + 1e-9) + 1e-12);
                ASSERT_LE(deg_from_rad((turned - turn_step).norm()),
                          limits.acceleration_deg_s2 * cycle_s * cycle_s * (1 + 1e-6) + 1e-11);
                last = c.offset_mm;
                last_step = step;
                turn = c.turn_rad;
                turn_step = turned;
            }
        }
        ASSERT_TRUE(ramp.arrived());
        const CyclicCorrection end = ramp.at(p);
        EXPECT_LT((end.offset_mm - (target * p - p)).norm(), 1e-9);
        EXPECT_LT((end.turn_rad - rotation_log(target.linear())).norm(), 1e-12);
        ramp.set_target(Pose::Identity());
        for (int i = 0; i < 100000 && !ramp.zero(); ++i) ramp.step(p);
        ASSERT_TRUE(ramp.zero());
        EXPECT_EQ(ramp.at(p).offset_mm, Eigen::Vector3d::Zero());
        EXPECT_EQ(ramp.at(p).turn_rad, Eigen::Vector3d::Zero());
    }
}

TEST(CorrectionRamp, TakesAsLongAsTheTrapezoidOfItsLimits) {
    CorrectionRamp ramp({20, 2, 100, 10}, 0.004);
    ramp.set_target(make_pose(Eigen::Matrix3d::Identity(), {10, 0, 0}));
    int cycles = 0;
    do {
        ramp.step({0, 0, 0});
        ++cycles;
    } while (!ramp.arrived());
    // 10 mm at 20 mm/s with 0.2 s for each end: 0.5 s + 0.2 s.
    EXPECT_NEAR(cycles * 0.004, 0.7, 0.02);
}

TEST(CorrectionRamp, OnAMovingPathItEndsOnTheDisplacedPath) {
    CorrectionRamp ramp({20, 2, 100, 10}, 0.004);
    const Pose b = make_pose(rotation_exp({0.01, -0.02, 0.015}), {2, -1, 3});
    ramp.set_target(b);
    for (int i = 0; i < 20000; ++i) {
        const Eigen::Vector3d p(200 * std::sin(i * 1e-3), 150, 100 * std::cos(i * 1e-3));
        const Eigen::Vector3d offset = ramp.step(p).offset_mm;
        if (ramp.arrived()) {
            ASSERT_LT((p + offset - b * p).norm(), 1e-9);
        }
    }
    EXPECT_TRUE(ramp.arrived());
}

// Steered: a target that moves, jumps and goes away again, on a displacement that is in force.
TEST(CorrectionRamp, FollowsWhatSteersItWithinItsLimitsAndLeadsItBackFirst) {
    std::mt19937 random(17);
    std::uniform_real_distribution<double> u(-1, 1);
    const RampLimits limits{20, 2, 100, 10};
    constexpr double kCycle = 0.004;
    const Eigen::Vector3d p(300, -200, 50);
    CorrectionRamp ramp(limits, kCycle);
    const Pose b = make_pose(Eigen::Matrix3d::Identity(), {2, -1, 1});
    ramp.set_target(b);
    while (!ramp.arrived()) ramp.step(p);
    Eigen::Vector3d last = ramp.at(p).offset_mm, last_step = Eigen::Vector3d::Zero();
    const auto step = [&] {
        const Eigen::Vector3d now = ramp.step(p).offset_mm;
        EXPECT_LE((now - last).norm(), limits.speed_mm_s * kCycle * (1 + 1e-9));
        // Speed and its change, which ends at the exact target with a millionth of a millimetre.
        EXPECT_LE((now - last - last_step).norm(), limits.acceleration_mm_s2 * kCycle * kCycle + 2e-6);
        last_step = now - last;
        last = now;
    };
    // A wave is followed without lag once it has been caught up with.
    double worst = 0;
    for (int i = 0; i < 3000; ++i) {
        const double t = i * kCycle;
        const Eigen::Vector3d wave(1.5 * std::sin(2 * t), 0, 0), rate(3 * std::cos(2 * t), 0, 0);
        ramp.steer(wave, rate);
        step();
        if (t > 2) worst = std::max(worst, (ramp.steered_mm() - wave).norm());
    }
    EXPECT_LT(worst, 0.02);
    for (int jump = 0; jump < 40; ++jump) {
        ramp.steer({2 * u(random), 2 * u(random), 2 * u(random)}, Eigen::Vector3d::Zero());
        const int cycles = static_cast<int>(random() % 200);
        for (int i = 0; i < cycles; ++i) step();
    }
    const Eigen::Vector3d displaced = b * p - p;
    EXPECT_GT(ramp.steered_mm().norm(), 0.1);
    ramp.set_target(Pose::Identity());
    int cycles = 0;
    for (; !ramp.zero() && cycles < 5000; ++cycles) {
        const bool steered = !ramp.steered_mm().isZero(0);
        step();
        // One after the other, so that their speeds never add.
        if (steered && !ramp.steered_mm().isZero(0)) {
            EXPECT_LT((last - ramp.steered_mm() - displaced).norm(), 1e-9);
        }
    }
    EXPECT_LT(cycles, 5000);
    EXPECT_TRUE(last.isZero(0));
}

}  // namespace
}  // namespace seamwright
