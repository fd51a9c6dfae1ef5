// The stated sigma of the tip is true: 1000 trials each, the sphere's place drawn anew in each as the sensor errs.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "core/calibration/nozzle/nozzle.h"
#include "tests/core/calibration/nozzle/touch_cell.h"

namespace seamwright {
namespace {

using touches::Cell;

struct NozzleCase {
    const char* name;
    bool sphere;
    int touches;
    double tilt_deg;
    bool stated;
};

class NozzleCoverage : public testing::TestWithParam<NozzleCase> {};

TEST_P(NozzleCoverage, NinetyFivePercentHoldTheTip) {
    const NozzleCase& c = GetParam();
    constexpr int kTrials = 1000;
    Cell cell;
    cell.hand = 0.1;
    cell.robot = 0.03;
    cell.robot_turn = 1e-4;
    cell.tilt_deg = c.tilt_deg;
    cell.reseed(77);
    NozzleOptions options;
    if (c.stated) options.sigma_mm = cell.hand;
    options.robot.sigma_mm = cell.robot;
    options.robot.sigma_rad = cell.robot_turn;
    Eigen::Matrix3d spread;
    spread << 0.0064, 0.002, 0, 0.002, 0.0036, -0.001, 0, -0.001, 0.01;
    const Eigen::Matrix3d root = spread.llt().matrixL();
    std::array<int, 3> inside{};
    double squares = 0;
    int solved = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
        const auto list = c.sphere ? cell.sphere(c.touches) : cell.point(c.touches);
        NozzleTarget target = cell.target(c.sphere);
        target.covariance_mm2 = spread;
        target.place_mm += root * cell.normals();
        if (c.sphere) {
            target.radius_sigma_mm = 0.02;
            *target.radius_mm += 0.02 * cell.normals().x();
        }
        const auto r = calibrate_nozzle(list, target, options);
        ASSERT_TRUE(r) << r.error().sentence();
        if (r->status != NozzleStatus::ok) continue;
        ++solved;
        const Eigen::Vector3d off = r->flange_from_nozzle.translation() - cell.tip;
        for (int i = 0; i < 3; ++i)
            inside[static_cast<std::size_t>(i)] +=
                std::abs(off[i]) < 1.959964 * std::sqrt(r->covariance(i, i));
        squares += off.dot(r->covariance.ldlt().solve(off));
    }
    EXPECT_GT(solved, 0.99 * kTrials);
    for (const int n : inside) {
        EXPECT_GE(n, 0.935 * solved) << c.name;
        EXPECT_LE(n, 0.965 * solved) << c.name;
    }
    RecordProperty("nees", std::to_string(squares / solved));
    std::printf("%s: %d %d %d of %d, nees %.2f\n", c.name, inside[0], inside[1], inside[2], solved,
                squares / solved);
}

INSTANTIATE_TEST_SUITE_P(Cells, NozzleCoverage,
                         testing::Values(NozzleCase{"sphere_turned_stated", true, 10, 25, true},
                                         NozzleCase{"sphere_turned_estimated", true, 12, 25, false},
                                         NozzleCase{"sphere_one_attitude_stated", true, 8, 0, true},
                                         NozzleCase{"sphere_one_attitude_estimated", true, 12, 0, false},
                                         NozzleCase{"point_turned_stated", false, 4, 25, true},
                                         NozzleCase{"point_turned_estimated", false, 6, 25, false}),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace seamwright
