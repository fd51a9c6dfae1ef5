#include "core/calibration/pose/plate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "tests/core/calibration/sphere/sphere_simulation.h"

namespace seamwright {
namespace {

using namespace simulation;
using ::testing::HasSubstr;

std::vector<PlatePoint> plate_points(const Pose& world_from_plate, int count, double sigma, Random& random,
                                     bool flat = true) {
    std::vector<PlatePoint> points;
    for (int i = 0; i < count; ++i) {
        PlatePoint p;
        p.id = "M" + std::to_string(i + 1);
        p.plate = {uniform(random, -150, 150), uniform(random, -100, 100),
                   flat ? 0 : uniform(random, -50, 50)};
        p.world = world_from_plate * p.plate +
                  Eigen::Vector3d(normal(random, sigma), normal(random, sigma), normal(random, sigma));
        points.push_back(p);
    }
    return points;
}

PlateResult solve(const std::vector<PlatePoint>& points, const PlateOptions& options = {}) {
    auto result = calibrate_plate(points, options);
    EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().sentence());
    return result ? *result : PlateResult{};
}

TEST(Plate, ExactForExactPointsFlatOrNotInAnyPose) {
    for (unsigned seed = 0; seed < 50; ++seed) {
        Random random(seed);
        const Pose truth = make_pose(any_rotation(random), {3000, -1500, 700});
        const auto result =
            solve(plate_points(truth, 3 + static_cast<int>(seed % 5), 0, random, seed % 2 == 0));
        EXPECT_LT(distance_mm(result.world_from_plate, truth), 1e-8) << seed;
        EXPECT_LT(angle_rad(result.world_from_plate, truth), 1e-10) << seed;
        EXPECT_NEAR(result.world_from_plate.linear().determinant(), 1, 1e-12);
    }
}

// The minimum is a minimum: no small rigid change lowers the sum of squares.
TEST(Plate, NoNeighbourFitsBetter) {
    Random random(4);
    const Pose truth = make_pose(any_rotation(random), {900, 100, -300});
    const auto points = plate_points(truth, 6, 0.5, random, false);
    const auto result = solve(points);
    const auto squares = [&](const Pose& pose) {
        double sum = 0;
        for (const auto& p : points) sum += (p.world - pose * p.plate).squaredNorm();
        return sum;
    };
    const double best = squares(result.world_from_plate);
    for (int k = 0; k < 12; ++k) {
        Vector6 step = Vector6::Zero();
        step[k / 2] = (k % 2 ? 1 : -1) * (k < 6 ? 1e-3 : 1e-5);
        EXPECT_GT(squares(retract(result.world_from_plate, step)), best);
    }
}

TEST(Plate, StatedIntervalsHold95PercentAndErrorsHaveNoBias) {
    int inside[6] = {};
    Vector6 mean = Vector6::Zero();
    Matrix6 mean_covariance = Matrix6::Zero();
    const int trials = 2000;
    Random random(77);
    for (int trial = 0; trial < trials; ++trial) {
        const Pose truth = make_pose(any_rotation(random), {1000, 0, 500});
        const auto result = solve(plate_points(truth, 5, 0.05, random));
        const Vector6 d = difference(result.world_from_plate, truth);
        mean += d / trials;
        mean_covariance += result.covariance / trials;
        for (int k = 0; k < 6; ++k)
            inside[k] += std::abs(d[k]) < 1.96 * std::sqrt(result.covariance(k, k)) ? 1 : 0;
    }
    for (int k = 0; k < 6; ++k) {
        EXPECT_NEAR(inside[k] / static_cast<double>(trials), 0.95, 0.02) << k;
        EXPECT_LT(std::abs(mean[k]), 4 * std::sqrt(mean_covariance(k, k) / trials)) << k;
    }
}

TEST(Plate, NamesAWrongPoint) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        Random random(seed + 300);
        const Pose truth = make_pose(any_rotation(random), {1000, 0, 500});
        auto points = plate_points(truth, 7, 0.03, random);
        points[4].world += Eigen::Vector3d(0.8, -0.6, 0.5);
        const auto result = solve(points);
        EXPECT_FALSE(result.report.poses[4].used) << seed;
        EXPECT_THAT(result.notices.at(0), HasSubstr("M5"));
        EXPECT_LT(distance_mm(result.world_from_plate, truth), 0.15) << seed;
        EXPECT_EQ(solve(points, {{"M5"}, {}}).rms_mm, result.rms_mm) << seed;
    }
}

TEST(Plate, DegenerateAndWrongData) {
    Random random(5);
    const Pose truth = make_pose(any_rotation(random), {1000, 0, 500});
    auto points = plate_points(truth, 5, 0.02, random);
    for (auto& p : points) {
        p.plate.y() = 0.3 * p.plate.x();
        p.world = truth * p.plate;
    }
    const auto line = solve(points);
    EXPECT_EQ(line.status, PlateStatus::undetermined);
    EXPECT_EQ(line.report.judgement.verdict, Verdict::undetermined);
    EXPECT_THAT(line.report.judgement.reason, HasSubstr("one line"));

    points = plate_points(truth, 6, 0.02, random);
    for (auto& p : points) p.world = p.world * 1.01;
    const auto stretched = solve(points);
    EXPECT_EQ(stretched.report.judgement.verdict, Verdict::poor);
    EXPECT_NEAR(stretched.scale, 1.01, 1e-3);

    points = plate_points(truth, 6, 0.02, random, false);
    for (auto& p : points) p.plate.z() = -p.plate.z();
    const auto mirrored = solve(points);
    EXPECT_TRUE(mirrored.mirrored);
    EXPECT_EQ(mirrored.report.judgement.verdict, Verdict::poor);
    EXPECT_NEAR(mirrored.world_from_plate.linear().determinant(), 1, 1e-12);
}

TEST(Plate, RefusesBadInput) {
    Random random(6);
    const Pose truth = make_pose(any_rotation(random), {1000, 0, 500});
    const auto good = plate_points(truth, 5, 0.02, random);
    const auto expect_error = [&](const std::vector<PlatePoint>& points, const char* word,
                                  const PlateOptions& o = {}) {
        const auto result = calibrate_plate(points, o);
        ASSERT_FALSE(result.has_value()) << word;
        EXPECT_THAT(result.error().sentence(), HasSubstr(word));
    };
    expect_error({}, "too few");
    expect_error({good.begin(), good.begin() + 2}, "too few");
    expect_error(good, "too few", {{"M1", "M2", "M3"}, {}});
    expect_error(good, "nobody", {{"nobody"}, {}});
    auto bad = good;
    bad[1].plate = bad[0].plate;
    expect_error(bad, "same point");
    bad = good;
    bad[1].world.y() = std::nan("");
    expect_error(bad, "finite");
    bad = good;
    for (auto& p : bad) p.world *= 1e-3;
    expect_error(bad, "metres");
    bad = good;
    for (auto& p : bad) p.plate *= 1e-3;
    expect_error(bad, "metres");
    bad = good;
    bad[1].id = "M1";
    expect_error(bad, "twice");
}

// Stated ten times too small, or nothing at all: the residuals say otherwise, and what is told of the plate holds the truth.
TEST(Plate, AStatedSigmaThatThePointsContradictIsNotBelieved) {
    for (const double stated : {0.005, 1e-9}) {
        int inside = 0;
        for (unsigned seed = 0; seed < 40; ++seed) {
            Random random(seed + 800);
            const Pose truth = make_pose(any_rotation(random), {900, -100, 300});
            PlateOptions options;
            options.sigma_mm = stated;
            const auto result = calibrate_plate(plate_points(truth, 8, 0.05, random), options);
            ASSERT_TRUE(result.has_value());
            EXPECT_FALSE(serves(result->report.judgement.verdict)) << result->report.judgement.reason;
            EXPECT_THAT(result->report.judgement.reason, HasSubstr("more than their sigma"));
            const Vector6 d = difference(result->world_from_plate, truth);
            inside += d.dot(result->covariance.ldlt().solve(d)) < 12.592 ? 1 : 0;
        }
        EXPECT_GE(inside, 33) << stated;
    }
    int contradicted = 0;
    for (unsigned seed = 0; seed < 200; ++seed) {
        Random random(seed + 2000);
        PlateOptions options;
        options.sigma_mm = 0.05;
        const auto result = calibrate_plate(plate_points(Pose::Identity(), 8, 0.05, random), options);
        contradicted += result && result->contradicted ? 1 : 0;
    }
    EXPECT_LE(contradicted, 2);
}

}  // namespace
}  // namespace seamwright
