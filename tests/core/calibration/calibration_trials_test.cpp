// A thousand simulated calibrations each: no bias, stated intervals that hold, and the accuracy that is
// promised.

#include <gtest/gtest.h>

#include <tuple>

#include "tests/core/calibration/pose/hand_eye_simulation.h"
#include "tests/core/calibration/sphere/sphere_simulation.h"

namespace seamwright {
namespace {

using namespace simulation;

struct Tally {
    std::vector<int> inside;
    std::vector<double> sum, variance;
    int trials = 0;
    explicit Tally(size_t n) : inside(n), sum(n), variance(n) {}
    void add(size_t k, double error, double sigma) {
        inside[k] += std::abs(error) < 1.96 * sigma ? 1 : 0;
        sum[k] += error;
        variance[k] += sigma * sigma;
    }
    void check() const {
        for (size_t k = 0; k < inside.size(); ++k) {
            const double share = static_cast<double>(inside[k]) / trials;
            EXPECT_GE(share, 0.93) << "parameter " << k;
            EXPECT_LE(share, 0.97) << "parameter " << k;
            // The mean error of unbiased estimates is within four of its own standard deviations.
            EXPECT_LT(std::abs(sum[k]), 4 * std::sqrt(variance[k])) << "parameter " << k;
        }
    }
};

TEST(CalibrationTrials, TcpSphereNinePoses) {
    Tally tally(9);
    int good = 0;
    double largest = 0;
    for (unsigned trial = 0; trial < 1000; ++trial) {
        Random random(90000 + trial);
        SphereCell cell = any_cell(random);  // any mounting, hence any start
        cell.step_mm = 0.3;
        cell.working_point = {0, 0, -150};
        TcpSphereOptions options;
        options.radius_mm = cell.radius;
        const auto result = calibrate_tcp_sphere(sphere_observations(cell, 9, random), options);
        ASSERT_TRUE(result.has_value());
        ASSERT_EQ(result->status, TcpSphereStatus::ok) << trial << " " << result->report.judgement.reason;
        ++tally.trials;
        const Vector6 d = difference(result->flange_from_sensor, cell.flange_from_sensor);
        for (int k = 0; k < 6; ++k)
            tally.add(static_cast<size_t>(k), d[k], std::sqrt(result->covariance(k, k)));
        for (int k = 0; k < 3; ++k)
            tally.add(6 + static_cast<size_t>(k), result->centre_base_mm[k] - cell.centre_base[k],
                      std::sqrt(result->centre_covariance(k, k)));
        good += 3 * result->working_sigma_mm <= 0.1 ? 1 : 0;
        largest = std::max(largest, (result->flange_from_sensor * result->working_point_mm -
                                     cell.flange_from_sensor * result->working_point_mm)
                                        .norm());
    }
    tally.check();
    EXPECT_GE(good, 970);  // poses are drawn at random: a few sets are weak, and say so
    EXPECT_LT(largest, 0.2);
}

// Robot errors far over the sensor's noise, radius known and solved for: the stated intervals hold against
// the truth, and two halves of one data set agree within what they state.
class TcpSphereWithRobotErrors : public testing::TestWithParam<std::tuple<double, bool>> {};

TEST_P(TcpSphereWithRobotErrors, StatesWhatTheHalvesShow) {
    const auto [robot_mm, radius_free] = GetParam();
    constexpr int kTrials = 90;
    std::vector<int> inside(10), agree(10);
    int halves = 0;
    for (unsigned trial = 0; trial < kTrials; ++trial) {
        Random random(50000 + trial);
        SphereCell cell = any_cell(random);
        cell.step_mm = 0.3;
        cell.working_point = {0, 0, -150};
        cell.robot_mm = robot_mm;
        const auto all = sphere_observations(cell, 24, random);
        TcpSphereOptions options;
        if (!radius_free) options.radius_mm = cell.radius;
        std::vector<TcpSphereResult> found;
        for (int half = 0; half < 2; ++half) {
            std::vector<SphereObservation> part(all.begin() + 12 * half, all.begin() + 12 * (half + 1));
            auto result = calibrate_tcp_sphere(part, options);
            ASSERT_TRUE(result.has_value());
            if (result->status == TcpSphereStatus::ok) found.push_back(std::move(*result));
        }
        if (found.size() < 2) continue;
        ++halves;
        const auto deviations = [&](const Pose& pose, const Eigen::Vector3d& centre, double radius) {
            Eigen::Matrix<double, 10, 1> d;
            d << difference(found[0].flange_from_sensor, pose), found[0].centre_base_mm - centre,
                found[0].radius_mm - radius;
            return d;
        };
        const auto sigmas = [](const TcpSphereResult& r) {
            Eigen::Matrix<double, 10, 1> s;
            s << r.covariance.diagonal().cwiseSqrt(), r.centre_covariance.diagonal().cwiseSqrt(),
                r.radius_sigma_mm;
            return s;
        };
        const auto from_truth = deviations(cell.flange_from_sensor, cell.centre_base, cell.radius);
        const auto from_other =
            deviations(found[1].flange_from_sensor, found[1].centre_base_mm, found[1].radius_mm);
        const auto s0 = sigmas(found[0]), s1 = sigmas(found[1]);
        for (Eigen::Index k = 0; k < 10; ++k) {
            inside[static_cast<size_t>(k)] += std::abs(from_truth[k]) < 1.96 * s0[k] ? 1 : 0;
            agree[static_cast<size_t>(k)] +=
                std::abs(from_other[k]) < 1.96 * std::hypot(s0[k], s1[k]) ? 1 : 0;
        }
    }
    EXPECT_GT(halves, kTrials * 2 / 3);
    const double band = 3.5 * std::sqrt(0.95 * 0.05 / halves);  // of a count at 95 %; forty are looked at
    for (size_t k = 0; k < (radius_free ? 10u : 9u); ++k) {
        EXPECT_NEAR(static_cast<double>(inside[k]) / halves, 0.95, band) << "truth, parameter " << k;
        EXPECT_NEAR(static_cast<double>(agree[k]) / halves, 0.95, band) << "halves, parameter " << k;
    }
}

INSTANTIATE_TEST_SUITE_P(CalibrationTrials, TcpSphereWithRobotErrors,
                         testing::Combine(testing::Values(0.05, 0.2), testing::Bool()));

TEST(CalibrationTrials, HandEyeTwelvePairs) {
    Tally tally(12);
    for (unsigned trial = 0; trial < 1000; ++trial) {
        Random random(70000 + trial);
        const HandEyeCell cell = any_hand_eye_cell(random);
        const auto result = calibrate_hand_eye(cell.mount, hand_eye_pairs(cell, 12, random));
        ASSERT_TRUE(result.has_value());
        ASSERT_EQ(result->status, HandEyeStatus::ok);
        ++tally.trials;
        const Vector6 dx = difference(result->x, cell.x), dy = difference(result->y, cell.y);
        for (int k = 0; k < 6; ++k) {
            tally.add(static_cast<size_t>(k), dx[k], std::sqrt(result->covariance_x(k, k)));
            tally.add(6 + static_cast<size_t>(k), dy[k], std::sqrt(result->covariance_y(k, k)));
        }
    }
    tally.check();
}

}  // namespace
}  // namespace seamwright
