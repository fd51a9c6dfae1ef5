#include "core/calibration/pose/static_chain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "tests/core/calibration/sphere/sphere_simulation.h"

namespace seamwright {
namespace {

using namespace simulation;
using ::testing::HasSubstr;

Matrix6 any_covariance(Random& random, double mm, double rad) {
    Matrix6 a;
    for (int i = 0; i < 6; ++i)
        for (int k = 0; k < 6; ++k) a(i, k) = normal(random, 1);
    Vector6 scale;
    scale << mm, mm, mm, rad, rad, rad;
    return scale.asDiagonal() * (a * a.transpose() / 6 + 0.2 * Matrix6::Identity()) * scale.asDiagonal();
}

Vector6 draw(const Matrix6& covariance, Random& random) {
    Vector6 n;
    for (int k = 0; k < 6; ++k) n[k] = normal(random, 1);
    return covariance.llt().matrixL() * n;
}

StaticSensor any_sensor(const std::string& id, Random& random) {
    StaticSensor s;
    s.id = id;
    s.world_from_plate = {make_pose(any_rotation(random), {2500, 300, 900}),
                          any_covariance(random, 0.02, 5e-5)};
    s.plate_from_camera = {make_pose(any_rotation(random), {60, -30, 320}),
                           any_covariance(random, 0.03, 1e-4)};
    s.camera_from_laser = {make_pose(any_rotation(random), {10, 80, 150}),
                           any_covariance(random, 0.03, 1e-4)};
    s.working_point_mm = {0, 0, -120};
    return s;
}

// Errors drawn from the links' covariances spread as the propagated covariance says: the mean of d^T C^-1 d
// is 6 and every variance agrees (4.10), (4.18).
TEST(StaticChain, ErrorEqualsThePropagatedCovariance) {
    Random random(1);
    for (int chain = 0; chain < 3; ++chain) {
        const StaticSensor sensor = any_sensor("S1", random);
        StaticChainOptions options;
        if (chain == 2)
            options.reference_from_world = UncertainPose{make_pose(any_rotation(random), {100, 2000, 50}),
                                                         any_covariance(random, 0.05, 1e-4)};
        const auto result = calibrate_static({sensor}, options);
        ASSERT_TRUE(result.has_value());
        const auto& nominal = result->sensors[0].world_from_laser;
        const Pose reference =
            options.reference_from_world ? options.reference_from_world->pose : Pose::Identity();
        EXPECT_LT(
            distance_mm(nominal.pose, reference * sensor.world_from_plate.pose *
                                          sensor.plate_from_camera.pose * sensor.camera_from_laser.pose),
            1e-9);
        const int trials = 4000;
        Matrix6 spread = Matrix6::Zero();
        double square = 0;
        for (int trial = 0; trial < trials; ++trial) {
            Pose pose =
                retract(sensor.world_from_plate.pose, draw(sensor.world_from_plate.covariance, random)) *
                retract(sensor.plate_from_camera.pose, draw(sensor.plate_from_camera.covariance, random)) *
                retract(sensor.camera_from_laser.pose, draw(sensor.camera_from_laser.covariance, random));
            if (options.reference_from_world)
                pose = retract(reference, draw(options.reference_from_world->covariance, random)) * pose;
            const Vector6 d = difference(pose, nominal.pose);
            spread += d * d.transpose() / trials;
            square += d.dot(nominal.covariance.ldlt().solve(d)) / trials;
        }
        EXPECT_NEAR(square, 6, 4 * std::sqrt(12.0 / trials));
        for (int k = 0; k < 6; ++k)
            EXPECT_NEAR(spread(k, k) / nominal.covariance(k, k), 1, 4 * std::sqrt(2.0 / trials)) << k;
    }
}

TEST(StaticChain, SeveralSensorsSharesAndVerdicts) {
    Random random(2);
    std::vector<StaticSensor> sensors;
    for (int i = 0; i < 4; ++i) sensors.push_back(any_sensor("S" + std::to_string(i + 1), random));
    for (auto* link :
         {&sensors[0].world_from_plate, &sensors[0].plate_from_camera, &sensors[0].camera_from_laser})
        link->covariance *= 0.01;
    sensors[3].camera_from_laser.covariance *= 400;
    for (auto* link :
         {&sensors[2].world_from_plate, &sensors[2].plate_from_camera, &sensors[2].camera_from_laser})
        link->covariance.setZero();
    const auto result = calibrate_static(sensors, {{}, {"S2"}});
    ASSERT_TRUE(result.has_value());
    ASSERT_EQ(result->sensors.size(), 3u);
    EXPECT_EQ(result->sensors[0].judgement.verdict, Verdict::good) << result->sensors[0].judgement.reason;
    EXPECT_EQ(result->sensors[1].judgement.verdict, Verdict::usable);
    EXPECT_THAT(result->sensors[1].judgement.reason, HasSubstr("unknown"));
    EXPECT_EQ(result->sensors[2].judgement.verdict, Verdict::poor);
    EXPECT_THAT(result->sensors[2].judgement.cure, HasSubstr("laser plane in the camera"));
    EXPECT_EQ(result->judgement.verdict, Verdict::poor);
    for (const auto& s : result->sensors) {
        double sum = 0;
        for (const double share : s.shares) sum += share;
        EXPECT_NEAR(sum, s.id == "S3" ? 0 : 1, 1e-9);
    }
}

TEST(StaticChain, NamesWhatItTakesAsExact) {
    Random random(5);
    StaticSensor sensor = any_sensor("S1", random);
    for (auto link : {&StaticSensor::world_from_plate, &StaticSensor::plate_from_camera,
                      &StaticSensor::camera_from_laser})
        (sensor.*link).covariance *= 0.01;
    EXPECT_EQ(calibrate_static({sensor})->judgement.verdict, Verdict::good);
    sensor.camera_from_laser.covariance.setZero();
    const auto result = calibrate_static({sensor});
    EXPECT_EQ(result->judgement.verdict, Verdict::usable);
    EXPECT_THAT(result->judgement.reason, HasSubstr("taken as exact: the laser plane in the camera"));
}

TEST(StaticChain, RefusesBadInput) {
    Random random(3);
    const StaticSensor good = any_sensor("S1", random);
    const auto expect_error = [](const std::vector<StaticSensor>& sensors, const char* word) {
        const auto result = calibrate_static(sensors);
        ASSERT_FALSE(result.has_value()) << word;
        EXPECT_THAT(result.error().sentence(), HasSubstr(word));
    };
    expect_error({}, "no sensor");
    expect_error({good, good}, "twice");
    auto bad = good;
    bad.camera_from_laser.pose.linear() *= 1.1;
    expect_error({bad}, "camera_from_laser");
    bad = good;
    bad.plate_from_camera.covariance(0, 0) = -1;
    expect_error({bad}, "positive");
    bad = good;
    bad.plate_from_camera.covariance(0, 1) += 1;
    expect_error({bad}, "symmetric");
    bad = good;
    bad.plate_from_camera.pose.translation() *= 1e-3;
    expect_error({bad}, "metres");
    expect_error({bad}, "plate_from_camera");
    bad.camera_field = "camera_from_plate";
    expect_error({bad}, "camera_from_plate");
    for (auto link : {&StaticSensor::world_from_plate, &StaticSensor::camera_from_laser}) {
        bad = good;
        (bad.*link).pose.translation() *= 1e-3;
        expect_error({good,
                      [&] {
                          bad.id = "S2";
                          return bad;
                      }()},
                     "metres");
        expect_error({bad},
                     link == &StaticSensor::world_from_plate ? "world_from_plate" : "camera_from_laser");
    }
    // A world that is the plate, a laser frame that is the camera's.
    bad = good;
    bad.world_from_plate.pose.setIdentity();
    bad.camera_from_laser.pose.setIdentity();
    EXPECT_TRUE(calibrate_static({bad}).has_value());
    EXPECT_FALSE(calibrate_static({good}, {{}, {"S1"}}).has_value());
}

}  // namespace
}  // namespace seamwright
