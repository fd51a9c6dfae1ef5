// A radius of the sphere that is given wrong by one percent is named, not blamed on the robot.

#include <gtest/gtest.h>

#include "tests/core/calibration/sphere/sphere_simulation.h"

namespace seamwright {
namespace {

using simulation::Random;
using simulation::SphereCell;

bool names_radius(const TcpSphereResult& r) {
    return r.report.judgement.reason.english().find("fit a radius of") != std::string::npos;
}

TEST(TcpSphereRadius, OnePercentWrongIsNamedAndARightOneIsNot) {
    for (const int count : {6, 12})
        for (const double wrong : {1.0, 1.01}) {
            int named = 0, serving = 0;
            constexpr int kTrials = 60;
            for (unsigned trial = 0; trial < kTrials; ++trial) {
                Random random(700 + trial);
                SphereCell cell = simulation::any_cell(random);
                cell.radius = 25;
                cell.robot_mm = 0.05;
                cell.robot_deg = 0.005;
                TcpSphereOptions options;
                options.radius_mm = wrong * cell.radius;
                options.robot = {cell.robot_mm, rad_from_deg(cell.robot_deg)};
                options.thorough = trial % 4 == 0;
                const auto r =
                    calibrate_tcp_sphere(simulation::sphere_observations(cell, count, random), options);
                ASSERT_TRUE(r) << r.error().sentence();
                named += names_radius(*r);
                serving += serves(r->report.judgement.verdict);
            }
            std::printf("n %d radius x %.2f: named %d, serving %d of %d\n", count, wrong, named, serving,
                        kTrials);
            if (wrong == 1.0) {
                EXPECT_EQ(named, 0);
            } else {
                EXPECT_EQ(serving, 0);
                EXPECT_GE(named, kTrials * 8 / 10);
            }
        }
}

}  // namespace
}  // namespace seamwright
