#include "core/correction/travel.h"

#include <gtest/gtest.h>

#include "tests/core/correction/doors.h"

namespace seamwright {
namespace {

using namespace testing_doors;

// A point of the spot's contour at the travel y, sensor frame as taught.
Eigen::Vector3d on_contour(const SpotObservation& s, double y) {
    const Eigen::Vector3d powers(y, y * y, y * y * y);
    Eigen::Vector3d p = s.reference_mm + y * Eigen::Vector3d::UnitY();
    if (s.curve) {
        p.x() += s.curve->x_coefficients.dot(powers);
        p.z() += s.curve->z_coefficients.dot(powers);
    }
    return p;
}

// Where the displaced contour pierces the sensor's plane at `travel` along its Y: regula falsi over y.
Eigen::Vector3d pierced(const SpotObservation& s, const Pose& d, double travel) {
    const Pose& w = s.workobject_from_sensor;
    const auto seen = [&](double y) -> Eigen::Vector3d {
        return w.inverse() * (d * (w * on_contour(s, y))) - Eigen::Vector3d(0, travel, 0);
    };
    double low = -60, high = 60;
    for (int i = 0; i < 200; ++i) {
        const double middle = 0.5 * (low + high);
        (seen(middle).y() < 0 ? low : high) = middle;
    }
    return seen(low);
}

TEST(Travel, CovarianceIsTheSlopeOfTheDisplacedContour) {
    Rng rng(1);
    for (int i = 0; i < 200; ++i) {
        SpotObservation s = door(rng, 4, {900, -400, 250})[0];
        if (i % 2 == 0) {
            s.curve.emplace();
            s.curve->x_coefficients = {uniform(rng, -0.05, 0.05), uniform(rng, -2e-3, 2e-3), 1e-6};
            s.curve->z_coefficients = {uniform(rng, -0.05, 0.05), uniform(rng, -2e-3, 2e-3), -1e-6};
            s.curve->valid_from_mm = -60, s.curve->valid_to_mm = 60;
        }
        const Pose d = random_displacement(rng, 10, 3, {900, -400, 250});
        s.measured_mm = pierced(s, d, 0);
        const double h = 1e-3;
        const Eigen::Vector3d slope = (pierced(s, d, h) - pierced(s, d, -h)) / (2 * h);
        const Eigen::Vector3d direction = contour_direction(s, {d});
        EXPECT_NEAR(direction.x(), slope.x(), 1e-6);
        EXPECT_NEAR(direction.z(), slope.z(), 1e-6);
        EXPECT_EQ(direction.y(), 1);
        const Eigen::Matrix2d c = travel_covariance(s, {d}, 2);
        EXPECT_NEAR(c(0, 0), 4 * slope.x() * slope.x(), 1e-6);
        EXPECT_NEAR(c(0, 1), 4 * slope.x() * slope.z(), 1e-6);
        EXPECT_NEAR(c(1, 1), 4 * slope.z() * slope.z(), 1e-6);
    }
}

TEST(Travel, WhatADisplacedSpotMeasures) {
    Rng rng(3);
    for (int i = 0; i < 200; ++i) {
        SpotObservation s = door(rng, 4, {900, -400, 250})[0];
        if (i % 2 == 0) {
            s.curve.emplace();
            s.curve->x_coefficients = {uniform(rng, -0.05, 0.05), uniform(rng, -2e-3, 2e-3), 1e-6};
            s.curve->z_coefficients = {uniform(rng, -0.05, 0.05), uniform(rng, -2e-3, 2e-3), -1e-6};
            s.curve->valid_from_mm = -60, s.curve->valid_to_mm = 60;
        }
        const Pose d = random_displacement(rng, 10, 3, {900, -400, 250});
        EXPECT_LT((displaced_measure(s, {d}) - pierced(s, d, 0)).norm(), 1e-9);
    }
    SpotObservation lying = door(rng, 4)[0];
    const Pose& w = lying.workobject_from_sensor;
    const Pose turned = w * make_pose(rotation_exp({0, 0, kPi / 2}), Eigen::Vector3d::Zero()) * w.inverse();
    EXPECT_EQ(displaced_measure(lying, {turned}), lying.reference_mm) << "along the laser line";
}

TEST(Travel, FrozenContourGainsNothing) {
    Rng rng(2);
    const SpotObservation s = door(rng, 4)[0];
    EXPECT_LT(travel_covariance(s, {}, 3).norm(), 1e-24);
}

// A sensor that does not stand along its edge, and no pass that told: once the part slides, the edges' course is in the residuals.
// What is answered with "ok" says so in its sigma, and nothing that is as it should be says anything.
TEST(UnseenCourse, IsInTheSigmaOfWhatIsAnswered) {
    constexpr double kNoise_mm = 0.1;
    for (const double off_deg : {0.0, 3.0}) {
        Rng rng(91);
        int answered = 0, told = 0, trials = 0;
        double squares = 0, told_squares = 0;
        while (trials < 600) {
            std::vector<SpotObservation> spots = door(rng, 8);
            const Pose truth = random_displacement(rng, 15, 2, Eigen::Vector3d::Zero());
            ++trials;
            for (SpotObservation& s : spots) {
                // The edge runs along the sensor's Y turned about its Z and X, through the reference.
                const double about_z = rad_from_deg(uniform(rng, -off_deg, off_deg));
                const double about_x = rad_from_deg(uniform(rng, -off_deg, off_deg));
                const Eigen::Vector3d along(-std::tan(about_z), 1, std::tan(about_x));
                const Pose m = s.workobject_from_sensor.inverse() * truth * s.workobject_from_sensor;
                const Eigen::Vector3d p = m * s.reference_mm, d = m.linear() * along;
                s.measured_mm = p - d * (p.y() / d.y());
                s.sigma_mm = kNoise_mm;
            }
            add_noise(spots, rng, kNoise_mm);
            const auto r = solve_region(spots, {});
            ASSERT_TRUE(r);
            if (r->status != CorrectionStatus::ok || !r->consistent) continue;
            const Pose& d = r->displacement.workobject_from_movedworkobject;
            Vector6 error;
            error << truth.translation() - d.translation(),
                rotation_log(truth.linear() * d.linear().transpose());
            const double square = error.dot(r->covariance.ldlt().solve(error)) / 6;
            ++answered;
            squares += square;
            if (std::string(r->message.english()).find("which sigma takes in") == std::string::npos) continue;
            ++told;
            told_squares += square;
        }
        if (off_deg == 0) {
            EXPECT_GE(answered, 590);
            EXPECT_LE(told, 15);  // 1 % of 600, and a half
            EXPECT_NEAR(squares / answered, 1, 0.1);
        } else {
            EXPECT_GE(told, 60);
            EXPECT_LT(told_squares / told, 3);
        }
    }
}

}  // namespace
}  // namespace seamwright
