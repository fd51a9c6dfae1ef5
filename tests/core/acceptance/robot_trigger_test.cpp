// Repeatability of a robot, latency and jitter of a trigger: known answers, laws and refusals.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/acceptance/equipment/robot_study.h"
#include "core/acceptance/equipment/trigger_study.h"
#include "tests/core/acceptance/robot_trigger_data.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

TEST(RobotStudy, RpOfIso9283) {
    // Four points at 1, 1, 2 and 2 mm from their mean: mean(l) = 1.5, s(l) = sqrt(1/3).
    Eigen::MatrixXd p(3, 4);
    p << 11, 9, 10, 10, 5, 5, 7, 3, -1, -1, -1, -1;
    EXPECT_NEAR(repeatability_of_positions(p), 1.5 + 3 * std::sqrt(1.0 / 3), 1e-12);
}

TEST(RobotStudy, RpOfNormalArrivals) {
    // Half normal, Rayleigh, Maxwell.
    const double half = std::sqrt(2 / kPi), rayleigh = std::sqrt(kPi / 2), maxwell = 2 * std::sqrt(2 / kPi);
    const auto rp = [](int k, double mean) { return mean + 3 * std::sqrt(k - mean * mean); };
    EXPECT_NEAR(repeatability_of(Eigen::MatrixXd::Identity(1, 1)), rp(1, half), 1e-9);
    EXPECT_NEAR(repeatability_of(Eigen::MatrixXd::Identity(2, 2)), rp(2, rayleigh), 1e-9);
    EXPECT_NEAR(repeatability_of(Eigen::MatrixXd::Identity(3, 3)), rp(3, maxwell), 1e-9);
    EXPECT_NEAR(repeatability_of(0.0009 * Eigen::MatrixXd::Identity(3, 3)), 0.03 * rp(3, maxwell), 1e-9);
    // All on a line: the half normal again, whatever the space about it.
    const Eigen::Vector3d line(2, -1, 2);
    EXPECT_NEAR(repeatability_of(line * line.transpose() / 9), rp(1, half), 2e-3);
}

TEST(RobotStudy, TheSensorsNoiseIsTakenOff) {
    std::mt19937_64 random(3);
    const Eigen::Matrix3d c = 0.0009 * Eigen::Matrix3d::Identity();
    const SpotReturns spot = simulated_returns("S1", looking(0.3, 0), c, 0.1, 1000, 10, random);
    const auto study = robot_study({&spot, 1});
    ASSERT_TRUE(study) << study.error().sentence();
    const SpotRepeatability& r = study->spots[0];
    EXPECT_EQ(r.returns, 1000);
    EXPECT_EQ(r.profiles, 10000);
    EXPECT_NEAR(r.noise_mm.x(), 0.1, 0.003);
    EXPECT_NEAR(r.arrival_x.sigma_mm, 0.03, 0.004);
    EXPECT_TRUE(r.arrival_z.limits_mm.contains(0.03));
    EXPECT_TRUE(r.rp_limits_mm.contains(0.03 * repeatability_of(Eigen::MatrixXd::Identity(2, 2))));
    EXPECT_GT(r.rp_measured_mm, 1.2 * r.rp_mm) << "the noise of ten profiles is in the formula's value";
}

TEST(RobotStudy, WhatNoSpotSeesIsNamedAndIsotropic) {
    std::mt19937_64 random(4);
    const Eigen::Matrix3d c = Eigen::Vector3d(0.0004, 0.0016, 0.0009).asDiagonal();
    SpotReturns spot = simulated_returns("S1", looking(0, 0), c, 0.01, 2000, 2, random);  // sees base X and Z
    auto study = robot_study({&spot, 1});
    ASSERT_TRUE(study);
    EXPECT_EQ(study->seen, 3);
    ASSERT_EQ(study->unseen.size(), 1u);
    EXPECT_NEAR(std::abs(study->unseen[0].y()), 1, 1e-9);
    EXPECT_NEAR(study->covariance_mm2(0, 0), 0.0004, 0.00004);
    EXPECT_NEAR(study->covariance_mm2(2, 2), 0.0009, 0.00009);
    EXPECT_NEAR(study->covariance_mm2(1, 1), 0.00065, 0.00006) << "the mean of what is seen";
    EXPECT_NEAR(study->covariance_mm2(0, 1), 0, 1e-12);

    spot.z = false;  // X alone
    study = robot_study({&spot, 1});
    ASSERT_TRUE(study);
    EXPECT_EQ(study->seen, 1);
    EXPECT_EQ(study->unseen.size(), 2u);
    EXPECT_EQ(study->spots[0].arrival_z.sigma_mm, 0);
    EXPECT_NEAR(study->covariance_mm2(2, 2), study->covariance_mm2(0, 0), 1e-12);
}

TEST(RobotStudy, SpotsOfSeveralOrientationsSeeAll) {
    std::mt19937_64 random(5);
    Eigen::Matrix3d c = Eigen::Vector3d(0.0004, 0.0016, 0.0009).asDiagonal();
    c(0, 1) = c(1, 0) = 0.0005;
    c(0, 2) = c(2, 0) = -0.0003;
    std::vector<SpotReturns> spots;
    for (const auto& [a, b] : {std::pair{0.0, 0.0}, {1.1, 0.2}, {2.2, -0.3}, {0.5, 1.2}})
        spots.push_back(simulated_returns("S", looking(a, b), c, 0.01, 4000, 2, random));
    const auto study = robot_study(spots);
    ASSERT_TRUE(study);
    EXPECT_EQ(study->seen, 6);
    EXPECT_TRUE(study->unseen.empty());
    EXPECT_LT((study->covariance_mm2 - c).norm(), 0.05 * c.norm()) << study->covariance_mm2;
    EXPECT_TRUE(study->rp_limits_mm.contains(repeatability_of(c)));
    // Millimetres in tenths: ten times everything.
    for (SpotReturns& spot : spots)
        for (auto& profiles : spot.returns)
            for (auto& p : profiles) p *= 10;
    const auto larger = robot_study(spots);
    ASSERT_TRUE(larger);
    EXPECT_NEAR(larger->rp_mm, 10 * study->rp_mm, 1e-9);
    EXPECT_NEAR(larger->rp_limits_mm.high, 10 * study->rp_limits_mm.high, 1e-9);
}

TEST(RobotStudy, ARobotBetterThanTheSensorIsBoundedAbove) {
    std::mt19937_64 random(6);
    const SpotReturns spot =
        simulated_returns("S1", looking(0, 0), Eigen::Matrix3d::Zero(), 0.05, 30, 5, random);
    const auto study = robot_study({&spot, 1});
    ASSERT_TRUE(study);
    EXPECT_EQ(study->spots[0].arrival_x.limits_mm.low, 0);
    EXPECT_LT(study->spots[0].arrival_x.limits_mm.high, 0.03);
    EXPECT_GE(study->covariance_mm2.diagonal().minCoeff(), 0);
}

TEST(RobotStudy, Refuses) {
    std::mt19937_64 random(7);
    const SpotReturns good =
        simulated_returns("S1", looking(0, 0), Eigen::Matrix3d::Identity(), 0.1, 10, 3, random);
    const auto refused = [&](const char* part, const auto& spoil) {
        SpotReturns spot = good;
        spoil(spot);
        const auto study = robot_study({&spot, 1});
        ASSERT_FALSE(study) << part;
        EXPECT_THAT(study.error().sentence(), HasSubstr(part));
        EXPECT_EQ(study.error().kind, ErrorKind::input);
    };
    refused("4 returns", [](SpotReturns& s) { s.returns.resize(4); });
    refused("no profile", [](SpotReturns& s) { s.returns[2].clear(); });
    refused("one profile a return", [](SpotReturns& s) {
        for (auto& r : s.returns) r.resize(1);
    });
    refused("not finite", [](SpotReturns& s) { s.returns[1][0].x() = std::nan(""); });
    refused("does not see", [](SpotReturns& s) { s.x = s.z = false; });
    refused("does not see", [](SpotReturns& s) { s.sees(0, 0) = INFINITY; });
    refused("all returns are equal", [](SpotReturns& s) {
        for (auto& r : s.returns) r.assign(2, {1, 2});
    });
    EXPECT_FALSE(robot_study({}));
}

std::vector<TravelPoint> contour(double dx, double dz, double noise, double bend = 0) {
    std::mt19937_64 random(8);
    std::normal_distribution<double> normal;
    std::vector<TravelPoint> points;
    for (double y = -20; y <= 20; y += 2)
        points.push_back(
            {y, 3 + dx * y + bend * y * y + noise * normal(random), -1 + dz * y + noise * normal(random)});
    return points;
}

TEST(TravelSight, AContourThatStandsStillIsSeenOnlyAcross) {
    const auto along = travel_sight(contour(0, 0, 0.02), 0, true, true);
    ASSERT_TRUE(along);
    EXPECT_FALSE(along->sees());
    const auto across = travel_sight(contour(0, 0, 0.02), 45, true, true);
    ASSERT_TRUE(across);
    EXPECT_TRUE(across->sees());
    EXPECT_NEAR(across->slope.x(), -std::sqrt(0.5), 0.002);
    const auto blind = travel_sight(contour(0, 0, 0.02), 45, false, true);
    ASSERT_TRUE(blind);
    EXPECT_FALSE(blind->sees()) << "z alone tells nothing of a travel along x";
}

TEST(TravelSight, TheTravelOfAPointOnABentContour) {
    for (const double deg : {0.0, 30.0, -45.0, 90.0}) {
        const auto sight = travel_sight(contour(0.5, -0.2, 0, 0.01), deg, true, true);
        ASSERT_TRUE(sight);
        const double a = deg * kPi / 180;
        for (const double s : {-6.0, -0.5, 0.0, 2.0}) {
            // Where the sensor, s along its way, cuts the contour.
            const double y = s * std::cos(a);
            const Eigen::Vector2d p(3 + 0.5 * y + 0.01 * y * y - s * std::sin(a), -1 - 0.2 * y);
            EXPECT_NEAR(sight->travel_of(p), s, 1e-6) << deg;
        }
    }
}

TEST(TravelSight, Refuses) {
    EXPECT_FALSE(travel_sight(contour(0.5, 0, 0), 91, true, true));
    EXPECT_FALSE(travel_sight(contour(0.5, 0, 0), std::nan(""), true, true));
    EXPECT_FALSE(travel_sight(contour(0.5, 0, 0), 0, false, false));
    EXPECT_FALSE(travel_sight({}, 0, true, true));
}

TEST(TriggerStudy, FindsLatencyJitterAndReversal) {
    std::mt19937_64 random(9);
    const auto passes = simulated_passes({50, 100, 200}, 300, 4, 6, 0.05, 0.02, 2.0, random);
    const auto study = trigger_study(passes, 0);
    ASSERT_TRUE(study) << study.error().sentence();
    EXPECT_EQ(study->moving, 1800);
    EXPECT_EQ(study->standing, 600);
    EXPECT_NEAR(study->latency_ms, 4, 0.3);
    EXPECT_TRUE(study->latency_limits_ms.contains(4));
    EXPECT_NEAR(study->jitter_ms, 6 / std::sqrt(3), 0.1);
    EXPECT_TRUE(study->jitter_limits_ms.contains(6 / std::sqrt(3)));
    EXPECT_TRUE(study->jitter_seen());
    EXPECT_NEAR(study->half_width_mm(100), 0.6, 0.02);
    EXPECT_NEAR(study->reversal_mm, 0.02, 0.01);
    EXPECT_NEAR(study->standing_mm, 0.05, 0.003);
}

TEST(TriggerStudy, AnUncertainSlopeWidensTheLimits) {
    std::mt19937_64 random(10);
    const auto passes = simulated_passes({50, 100, 200}, 10, 20, 5, 0.05, 0, 0, random);
    const auto sure = trigger_study(passes, 0), unsure = trigger_study(passes, 0.05);
    ASSERT_TRUE(sure && unsure);
    EXPECT_EQ(sure->latency_ms, unsure->latency_ms);
    EXPECT_NEAR(unsure->latency_limits_ms.high - sure->latency_limits_ms.high, 0.1 * sure->latency_ms, 1e-9);
    EXPECT_LT(unsure->jitter_limits_ms.low, sure->jitter_limits_ms.low);
}

TEST(TriggerStudy, JitterThatIsNotSeenIsBoundedAbove) {
    std::mt19937_64 random(11);
    const auto study = trigger_study(simulated_passes({50, 100, 200}, 10, 0, 0, 0.1, 0, 0, random), 0);
    ASSERT_TRUE(study);
    EXPECT_FALSE(study->jitter_seen());
    EXPECT_TRUE(study->latency_limits_ms.contains(0));
    EXPECT_GT(study->half_width_mm(100), 0);
    EXPECT_LT(study->half_width_mm(100), 0.2);
}

TEST(TriggerStudy, Refuses) {
    std::mt19937_64 random(12);
    const auto good = simulated_passes({50, 100, 200}, 3, 5, 5, 0.05, 0, 0, random);
    const auto refused = [&](const char* part, const auto& spoil, double share = 0) {
        auto passes = good;
        spoil(passes);
        const auto study = trigger_study(passes, share);
        ASSERT_FALSE(study) << part;
        EXPECT_THAT(study.error().sentence(), HasSubstr(part));
    };
    using Passes = std::vector<TriggerPass>;
    refused("2 speeds",
            [](Passes& p) { std::erase_if(p, [](auto& q) { return std::abs(q.velocity_mm_s) == 50; }); });
    refused("0 passes at 100 mm/s",
            [](Passes& p) { std::erase_if(p, [](auto& q) { return q.velocity_mm_s == -100; }); });
    refused("no pass stopped",
            [](Passes& p) { std::erase_if(p, [](auto& q) { return q.velocity_mm_s == 0; }); });
    refused("not finite", [](Passes& p) { p[0].travel_mm = std::nan(""); });
    refused("its own direction", [](Passes& p) { p[0].backward = !p[0].backward; });
    refused(
        "slope", [](Passes&) {}, std::nan(""));
    EXPECT_FALSE(trigger_study({}, 0));
}

}  // namespace
}  // namespace seamwright
