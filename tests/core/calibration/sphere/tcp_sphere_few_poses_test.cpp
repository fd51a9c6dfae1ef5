// What few poses of a robot that errs can tell: the sigma holds the truth, a verdict that serves does, and no pose is
// thrown out by others that are too few to know.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "tests/core/calibration/sphere/sphere_simulation.h"

namespace seamwright {
namespace {

using namespace simulation;

constexpr double kEllipse95 = 12.592;  // chi squared of six

struct Count {
    int trials = 0, outside = 0, serving = 0, serving_outside = 0, far = 0, thrown_out = 0;
};

Count count(int poses, double robot_mm, bool radius_free, int trials, unsigned seed) {
    Count n;
    for (int trial = 0; trial < trials; ++trial) {
        Random random(seed + static_cast<unsigned>(trial));
        SphereCell cell = any_cell(random);
        cell.robot_mm = robot_mm;
        cell.robot_deg = 0.1 * robot_mm;
        TcpSphereOptions options;
        if (!radius_free) options.radius_mm = cell.radius;
        const auto result = calibrate_tcp_sphere(sphere_observations(cell, poses, random), options);
        EXPECT_TRUE(result.has_value());
        if (!result || result->status != TcpSphereStatus::ok) continue;
        ++n.trials;
        const Vector6 d = difference(result->flange_from_sensor, cell.flange_from_sensor);
        const double off = d.dot(result->covariance.ldlt().solve(d));
        n.outside += off > kEllipse95 ? 1 : 0;
        n.far += off > 25 * 6 ? 1 : 0;
        const bool serving = serves(result->report.judgement.verdict);
        n.serving += serving ? 1 : 0;
        n.serving_outside += serving && off > kEllipse95 ? 1 : 0;
        for (const PoseResidual& p : result->report.poses) n.thrown_out += p.used ? 0 : 1;
    }
    return n;
}

TEST(TcpSphereFewPoses, TheSigmaHoldsTheTruthAndWhatServesDoes) {
    for (const bool radius_free : {false, true})
        for (const double robot_mm : {0.05, 0.1})
            for (const int poses : {6, 7, 8, 9}) {
                const Count n =
                    count(poses, robot_mm, radius_free, 40, 7000 + 100u * static_cast<unsigned>(poses));
                const auto which = testing::Message() << poses << " poses, " << robot_mm << " mm"
                                                      << (radius_free ? ", radius free" : "");
                EXPECT_GE(n.trials, 30) << which;
                EXPECT_LE(n.outside, 6) << which;  // two expected
                EXPECT_LE(n.serving_outside, 5) << which;
                EXPECT_EQ(n.far, 0) << which;
            }
}

// Six or seven: four or five of them fit some sphere whichever are taken.
TEST(TcpSphereFewPoses, AHandfulConvictsNoPose) {
    for (const int poses : {6, 7}) {
        const Count n = count(poses, 0.1, false, 60, 9000);
        EXPECT_EQ(n.thrown_out, 0) << poses;
        EXPECT_LE(n.serving, 2) << poses;
    }
}

TEST(TcpSphereFewPoses, EnoughPosesServe) {
    const Count n = count(14, 0.05, false, 40, 11000);
    EXPECT_EQ(n.trials, 40);
    EXPECT_GE(n.serving, 36);
    EXPECT_LE(n.outside, 6);
}

// An exact robot: the profiles' own noise, of hundreds of points, is all that errs.
TEST(TcpSphereFewPoses, SixPosesOfAnExactRobotServe) {
    const Count n = count(6, 0, false, 40, 13000);
    EXPECT_GE(n.serving, 30);
    EXPECT_LE(n.serving_outside, 6);
}

TEST(TcpSphereFewPoses, AStatedRobotLetsFewPosesServeTruly) {
    int serving = 0, outside = 0;
    for (unsigned trial = 0; trial < 60; ++trial) {
        Random random(15000 + trial);
        SphereCell cell = any_cell(random);
        cell.robot_mm = 0.03;
        cell.robot_deg = 0.003;
        TcpSphereOptions options;
        options.radius_mm = cell.radius;
        options.robot = {cell.robot_mm, rad_from_deg(cell.robot_deg)};
        const auto result = calibrate_tcp_sphere(sphere_observations(cell, 7, random), options);
        ASSERT_TRUE(result.has_value());
        if (!serves(result->report.judgement.verdict)) continue;
        const Vector6 d = difference(result->flange_from_sensor, cell.flange_from_sensor);
        ++serving;
        outside += d.dot(result->covariance.ldlt().solve(d)) > kEllipse95 ? 1 : 0;
    }
    EXPECT_GE(serving, 30);
    EXPECT_LE(outside, 8);
}

}  // namespace
}  // namespace seamwright
