#include "core/calibration/sphere/drift_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/calibration/sphere/sphere_simulation.h"

namespace seamwright {
namespace {

using namespace simulation;
using ::testing::HasSubstr;

// Views of each sphere through a sensor that has moved by `change` on its flange.
std::vector<DriftMeasurement> measure(const SphereCell& cell, const Pose& change, int spheres, Random& random,
                                      int views = 2) {
    std::vector<DriftMeasurement> list;
    for (int k = 0; k < spheres; ++k) {
        SphereCell now = cell;
        now.centre_base += Eigen::Vector3d(k == 1 ? 90 : 0, k == 2 ? 80 : 0, 15 * k);
        now.flange_from_sensor = change * cell.flange_from_sensor;
        for (const auto& observation : sphere_observations(now, views, random)) {
            auto m =
                drift_measurement(observation, cell.radius, cell.flange_from_sensor, now.centre_base, 0.01);
            EXPECT_TRUE(m.has_value());
            if (!m) continue;
            m->id = "sphere" + std::to_string(k) + observation.id;
            list.push_back(*m);
        }
    }
    return list;
}

TEST(DriftCheck, HoldsWhenNothingHasChanged) {
    int holds = 0;
    for (unsigned seed = 0; seed < 50; ++seed) {
        Random random(seed);
        SphereCell cell = any_cell(random);
        const auto result = check_drift(measure(cell, Pose::Identity(), 3, random, 4));
        ASSERT_TRUE(result.has_value());
        holds += result->status == DriftStatus::holds ? 1 : 0;
        EXPECT_NE(result->status, DriftStatus::drifted) << seed << " " << result->report.judgement.reason;
    }
    EXPECT_GE(holds, 45);
}

TEST(DriftCheck, SeesAShiftAndATurnWithTheirSize) {
    int smaller = 0;
    for (unsigned seed = 0; seed < 20; ++seed) {
        Random random(seed + 60);
        SphereCell cell = any_cell(random);
        // A knock: turned by 0.4 degrees about the sensor's own place and shifted by 0.6 mm.
        const Eigen::Matrix3d turn = rotation_exp(rad_from_deg(0.4) * Eigen::Vector3d(0.6, -0.64, 0.48));
        const Eigen::Vector3d pivot = cell.flange_from_sensor.translation();
        const Pose change = make_pose(turn, pivot + Eigen::Vector3d(0.4, -0.2, 0.4) - turn * pivot);
        const auto result = check_drift(measure(cell, change, 3, random));
        ASSERT_TRUE(result.has_value());
        EXPECT_EQ(result->status, DriftStatus::drifted) << seed;
        EXPECT_EQ(result->report.judgement.verdict, Verdict::poor);
        EXPECT_GT(result->chi_squared, result->chi_squared_limit);
        EXPECT_NEAR(result->change_mm, 0.6, 0.3) << seed;
        smaller += result->rms_after_mm < 0.7 * result->rms_before_mm;
        if (result->not_determined.empty()) {
            EXPECT_NEAR(result->change_deg, 0.4, 4 * result->sigma_deg) << seed;
        }
    }
    EXPECT_GE(smaller, 15);  // across the laser plane a view says little, and the mean counts all axes alike
}

TEST(DriftCheck, ExactMeasurementsGiveTheExactChange) {
    const Pose change = make_pose(rotation_exp({0.01, -0.02, 0.03}), {1.5, -2, 0.7});
    std::vector<DriftMeasurement> list;
    const Eigen::Vector3d places[] = {{0, 0, 200}, {40, 0, 210}, {0, 35, 190}, {-20, 10, 220}};
    for (int i = 0; i < 4; ++i) {
        DriftMeasurement m;
        m.id = std::to_string(i);
        m.base_from_flange = make_pose(rotation_exp({0.1 * i, 0.2, -0.1 * i}), {900 + 10.0 * i, 100, 500});
        m.measured_flange_mm = places[i];
        m.known_base_mm = m.base_from_flange * (change * places[i]);
        list.push_back(m);
    }
    const auto result = check_drift(list);
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(result->status, DriftStatus::drifted);
    EXPECT_LT(distance_mm(result->change, change), 1e-7);
    EXPECT_LT(angle_rad(result->change, change), 1e-9);
    EXPECT_LT(result->rms_after_mm, 1e-7);
    EXPECT_TRUE(result->not_determined.empty());
}

TEST(DriftCheck, OnePlaceCannotSeeATurnAndSaysSo) {
    std::vector<DriftMeasurement> list(1);
    list[0].id = "a";
    list[0].base_from_flange = make_pose(Eigen::Matrix3d::Identity(), {900, 100, 500});
    list[0].measured_flange_mm = {0, 0, 200};
    list[0].known_base_mm = {900, 100, 700};
    list[0].covariance = 1e-4 * Eigen::Matrix3d::Identity();
    const auto result = check_drift(list);
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(result->status, DriftStatus::undetermined) << "a turn about that place would not show";
    EXPECT_EQ(result->not_determined.size(), 3u);
    EXPECT_THAT(result->report.judgement.reason, HasSubstr("turn about"));
    list[0].covariance = Eigen::Matrix3d::Identity();
    EXPECT_EQ(check_drift(list)->status, DriftStatus::undetermined);
}

// Whatever the turn, "holds" may not be said beyond the limits: over sizes about the limit and measurements
// from fine to rough.
TEST(DriftCheck, HoldsIsSaidOfNothingThatIsBeyondTheLimits) {
    const DriftLimits limits{0.1, 0.2};
    int drifted = 0, undetermined = 0;
    for (unsigned seed = 0; seed < 120; ++seed) {
        Random random(seed + 400);
        SphereCell cell = any_cell(random);
        cell.noise_mm = 0.01 * (1 + seed % 8);
        const double angle_deg = limits.rotation_deg * (1.5 + 0.5 * (seed % 4));
        Eigen::Vector3d axis(normal(random, 1), normal(random, 1), normal(random, 1));
        const Eigen::Matrix3d turn = rotation_exp(rad_from_deg(angle_deg) * axis.normalized());
        const Eigen::Vector3d pivot = cell.flange_from_sensor * cell.working_point;
        const auto result =
            check_drift(measure(cell, make_pose(turn, pivot - turn * pivot), 3, random), limits);
        ASSERT_TRUE(result.has_value());
        EXPECT_NE(result->status, DriftStatus::holds)
            << seed << ": " << angle_deg << " degrees, " << result->report.judgement.reason;
        drifted += result->status == DriftStatus::drifted ? 1 : 0;
        undetermined += result->status == DriftStatus::undetermined ? 1 : 0;
    }
    EXPECT_GT(drifted, 20);
    EXPECT_GT(undetermined, 5);
}

TEST(DriftCheck, AMovedTargetIsNoDriftOfTheSensor) {
    Random random(9);
    SphereCell cell = any_cell(random);
    auto list = measure(cell, Pose::Identity(), 3, random);
    list[0].known_base_mm += Eigen::Vector3d(3, 0, 0);
    list[1].known_base_mm -= Eigen::Vector3d(3, 2, 0);
    const auto result = check_drift(list);
    ASSERT_TRUE(result.has_value());
    EXPECT_THAT(result->report.judgement.reason, HasSubstr("no rigid change"));
    EXPECT_EQ(result->report.judgement.verdict, Verdict::poor);
}

TEST(DriftCheck, RefusesBadInput) {
    EXPECT_FALSE(check_drift({}).has_value());
    DriftMeasurement m;
    m.id = "a";
    m.base_from_flange.translation() = Eigen::Vector3d(500, 0, 0);
    EXPECT_FALSE(check_drift({m, m}).has_value());
    m.covariance(0, 0) = -1;
    EXPECT_FALSE(check_drift({m}).has_value());
    m.covariance.setIdentity();
    m.known_base_mm.x() = std::nan("");
    EXPECT_FALSE(check_drift({m}).has_value());
    m.known_base_mm.setZero();
    m.base_from_flange.translation() *= 1e-3;
    EXPECT_THAT(check_drift({m}).error().sentence(), HasSubstr("metres"));
    SphereObservation empty;
    empty.id = "e";
    empty.base_from_flange.translation() = Eigen::Vector3d(500, 0, 0);
    EXPECT_FALSE(drift_measurement(empty, 10, Pose::Identity(), Eigen::Vector3d::Zero(), 0.01).has_value());
}

// Of a calibration by the same robot on the same sphere, nothing moved since: what the stored numbers err is no drift.
// Neither is a robot that is less exact than was stated.
struct Told {
    int drifted = 0, as_if_exact = 0, unstated = 0, moved = 0;
};

Told tell_drift(double robot_mm, int trials) {
    Told told;
    for (unsigned seed = 0; seed < static_cast<unsigned>(trials); ++seed) {
        Random random(seed + 3000);
        SphereCell cell = any_cell(random);
        cell.robot_mm = robot_mm;
        cell.robot_deg = 0.1 * robot_mm;
        TcpSphereOptions options;
        options.radius_mm = cell.radius;
        options.robot = {cell.robot_mm, rad_from_deg(cell.robot_deg)};
        const auto stored = calibrate_tcp_sphere(sphere_observations(cell, 12, random), options);
        EXPECT_TRUE(stored.has_value() && stored->status == TcpSphereStatus::ok);
        if (!stored || stored->status != TcpSphereStatus::ok) continue;
        StoredCovariance covariance = StoredCovariance::Zero();
        Eigen::Matrix<double, 9, 1> unit = Eigen::Matrix<double, 9, 1>::Ones();
        unit.segment<3>(3).setConstant(rad_from_deg(1));
        covariance.topLeftCorner<9, 9>() = unit.asDiagonal() * stored->report.covariance * unit.asDiagonal();
        for (const double moved_mm : {0.0, 1.5}) {
            SphereCell now = cell;
            now.flange_from_sensor.translation() += moved_mm * Eigen::Vector3d(0.6, -0.64, 0.48);
            std::vector<DriftMeasurement> list, bare;
            for (const auto& observation : sphere_observations(now, 12, random)) {
                auto m = drift_measurement(observation, cell.radius, stored->flange_from_sensor,
                                           stored->centre_base_mm, 0.01);
                if (!m) continue;
                bare.push_back(*m);
                const Eigen::Matrix3d lever = skew(m->measured_flange_mm);
                m->covariance += robot_mm * robot_mm * Eigen::Matrix3d::Identity() +
                                 std::pow(rad_from_deg(cell.robot_deg), 2) * lever * lever.transpose();
                list.push_back(*m);
            }
            const auto drifted = [](const Expected<DriftResult>& r) {
                return r && r->status == DriftStatus::drifted ? 1 : 0;
            };
            if (moved_mm > 0) {
                told.moved += drifted(check_drift(list, {}, covariance));
                continue;
            }
            told.drifted += drifted(check_drift(list, {}, covariance));
            told.as_if_exact += drifted(check_drift(list));
            told.unstated += drifted(check_drift(bare, {}, covariance));
        }
    }
    return told;
}

TEST(DriftCheck, WhatTheStoredCalibrationErrsIsNoDrift) {
    for (const double robot_mm : {0.03, 0.05, 0.1}) {
        const Told told = tell_drift(robot_mm, 40);
        EXPECT_LE(told.drifted, 2) << robot_mm;
        EXPECT_LE(told.unstated, 2) << robot_mm;
        EXPECT_GE(told.as_if_exact, told.drifted) << robot_mm;
        EXPECT_GE(told.moved, 36) << robot_mm;
    }
}

TEST(DriftCheck, RefusesACovarianceThatIsNone) {
    DriftMeasurement m;
    m.id = "a";
    m.base_from_flange.translation() = Eigen::Vector3d(500, 0, 0);
    StoredCovariance none = StoredCovariance::Identity();
    none(2, 2) = -1;
    EXPECT_FALSE(check_drift({m}, {}, none).has_value());
    none = StoredCovariance::Identity();
    none(0, 1) = 0.5;
    EXPECT_FALSE(check_drift({m}, {}, none).has_value());
}

}  // namespace
}  // namespace seamwright
