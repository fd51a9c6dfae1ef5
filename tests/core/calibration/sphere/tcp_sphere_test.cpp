#include "core/calibration/sphere/tcp_sphere.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/calibration/sphere/sphere_simulation.h"

namespace seamwright {
namespace {

using namespace simulation;
using ::testing::HasSubstr;

double error_at_work(const TcpSphereResult& result, const SphereCell& cell) {
    return (result.flange_from_sensor * result.working_point_mm -
            cell.flange_from_sensor * result.working_point_mm)
        .norm();
}

TcpSphereResult solve(const std::vector<SphereObservation>& observations, const TcpSphereOptions& options) {
    auto result = calibrate_tcp_sphere(observations, options);
    EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().sentence());
    return result ? *result : TcpSphereResult{};
}

TEST(TcpSphere, FindsAnyMountingWithoutAGuess) {
    for (unsigned seed = 0; seed < 25; ++seed) {
        Random random(seed);
        SphereCell cell = any_cell(random);
        if (seed % 2) cell.working_point = {0, 0, -220};
        const auto observations = sphere_observations(cell, 9, random);
        TcpSphereOptions options;
        options.radius_mm = cell.radius;
        const auto result = solve(observations, options);
        ASSERT_EQ(result.status, TcpSphereStatus::ok) << seed;
        EXPECT_LT(error_at_work(result, cell), 0.06) << seed;
        EXPECT_LE(3 * result.working_sigma_mm, 0.1) << seed;
        EXPECT_LT((result.centre_base_mm - cell.centre_base).norm(), 0.06) << seed;
        EXPECT_EQ(result.report.judgement.verdict, Verdict::good) << result.report.judgement.reason;
        EXPECT_EQ(result.mirrored, MirroredAxis::none);
        EXPECT_EQ(result.report.hold_out.folds, 9);
        EXPECT_LT(result.report.hold_out.rms_mm, 0.08);
    }
}

TEST(TcpSphere, NoiseFreeDataGiveTheTruthToRounding) {
    Random random(3);
    SphereCell cell = any_cell(random);
    cell.noise_mm = 0;
    TcpSphereOptions options;
    options.radius_mm = cell.radius;
    const auto result = solve(sphere_observations(cell, 9, random), options);
    EXPECT_LT(distance_mm(result.flange_from_sensor, cell.flange_from_sensor), 1e-7);
    EXPECT_LT(angle_rad(result.flange_from_sensor, cell.flange_from_sensor), 1e-9);
}

TEST(TcpSphere, EverySectionOfRobustnessAtOnce) {
    // Stray points, a post and a table in every profile; one profile shows another ball, one only the table;
    // one robot pose is a millimetre and a half wrong.
    int solved = 0;
    for (unsigned seed = 100; seed < 110; ++seed) {
        Random random(seed);
        SphereCell cell = any_cell(random);
        cell.outliers = 0.08;
        auto observations = sphere_observations(cell, 12, random);
        SphereCell other = cell;
        other.radius = 6;
        observations[2].profile = sphere_profile(other, {9, 1, -7}, random);
        SphereCell nothing = cell;
        nothing.radius = 1;
        observations[5].profile = sphere_profile(nothing, {0, 2, 0}, random);
        observations[8].base_from_flange.translation() += Eigen::Vector3d(1.0, -0.8, 0.9);
        TcpSphereOptions options;
        options.radius_mm = cell.radius;
        const auto result = solve(observations, options);
        if (result.status != TcpSphereStatus::ok) continue;
        ++solved;
        EXPECT_LT(error_at_work(result, cell), 0.12) << seed;
        for (const size_t wrong : {2u, 5u, 8u})
            EXPECT_FALSE(result.report.poses[wrong].used) << seed << " " << wrong;
        EXPECT_FALSE(result.report.poses[8].note.empty());
        EXPECT_GT(result.report.poses[8].rms_mm, 0.2);
    }
    EXPECT_EQ(solved, 10);
}

TEST(TcpSphere, ExcludedPosesTakeNoPartAndStillHaveAResidual) {
    Random random(11);
    const SphereCell cell = any_cell(random);
    auto observations = sphere_observations(cell, 10, random);
    TcpSphereOptions options;
    options.radius_mm = cell.radius;
    options.exclude = {"P3", "P7"};
    const auto with = solve(observations, options);
    auto fewer = observations;
    fewer.erase(fewer.begin() + 6);
    fewer.erase(fewer.begin() + 2);
    options.exclude.clear();
    const auto without = solve(fewer, options);
    EXPECT_LT(distance_mm(with.flange_from_sensor, without.flange_from_sensor), 1e-6);
    EXPECT_FALSE(with.report.poses[2].used);
    EXPECT_TRUE(std::isfinite(with.report.poses[2].rms_mm));
    EXPECT_LT(with.report.poses[2].rms_mm, 0.1);
}

TEST(TcpSphere, NamesDegeneratePoseSetsAndTheirCure) {
    Random random(5);
    SphereCell cell = any_cell(random);
    TcpSphereOptions options;
    options.radius_mm = cell.radius;
    const auto expect_undetermined = [&](const std::vector<SphereObservation>& observations,
                                         const char* word) {
        const auto result = solve(observations, options);
        EXPECT_EQ(result.status, TcpSphereStatus::undetermined);
        EXPECT_EQ(result.report.judgement.verdict, Verdict::undetermined);
        EXPECT_THAT(result.report.judgement.reason, HasSubstr(word));
        EXPECT_FALSE(result.report.judgement.cure.empty());
        EXPECT_FALSE(result.proposals.empty());
        EXPECT_TRUE(result.report.parameters.empty());
        EXPECT_TRUE(result.flange_from_sensor.isApprox(Pose::Identity()));
        return result;
    };
    cell.tilt_deg = cell.turn_deg = 0;
    expect_undetermined(sphere_observations(cell, 9, random), "one orientation");
    // About one axis of the flange only: turn the sensor about an axis fixed in the flange.
    cell.turn_deg = 60;
    cell.flange_from_sensor = make_pose(rotation_exp({0, 0, 0.4}), {40, -20, 130});  // sensor Z is flange Z
    expect_undetermined(sphere_observations(cell, 9, random), "about the flange's Z axis only");
    cell.turn_deg = 90;
    cell.tilt_deg = 30;
    cell.shift_x = cell.shift_y = cell.shift_z = 0;
    expect_undetermined(sphere_observations(cell, 9, random), "same place");
}

TEST(TcpSphere, ProposedPosesMakeAnUndeterminedSetDetermined) {
    Random random(6);
    SphereCell cell = any_cell(random);
    cell.flange_from_sensor = make_pose(rotation_exp({0, 0, 0.4}), {40, -20, 130});
    cell.tilt_deg = 0;
    TcpSphereOptions options;
    options.radius_mm = cell.radius;
    auto observations = sphere_observations(cell, 9, random);
    const auto before = solve(observations, options);
    ASSERT_EQ(before.status, TcpSphereStatus::undetermined);
    ASSERT_GE(before.proposals.size(), 2u);
    int added = 0;
    for (const auto& proposal : before.proposals) {
        SphereObservation more;
        more.id = "new" + std::to_string(++added);
        // The orientation as proposed; the sphere jogged into the view, as its place is what is not known
        // yet.
        const Eigen::Matrix3d turn = (proposal.base_from_flange * cell.flange_from_sensor).linear();
        const Eigen::Vector3d place(3, 2, -4);
        more.base_from_flange = pose_for_view(cell, turn, place);
        more.profile = sphere_profile(cell, place, random);
        observations.push_back(more);
    }
    const auto after = solve(observations, options);
    ASSERT_EQ(after.status, TcpSphereStatus::ok) << after.report.judgement.reason;
    EXPECT_LT(error_at_work(after, cell), 4 * after.working_sigma_mm + 0.01);
}

TEST(TcpSphere, FreeRadiusWhereTheCutsDetermineIt) {
    Random random(21);
    SphereCell cell = any_cell(random);
    cell.shift_y = 0.8;
    const auto result = solve(sphere_observations(cell, 14, random), {});
    ASSERT_EQ(result.status, TcpSphereStatus::ok) << result.report.judgement.reason;
    EXPECT_GT(result.radius_sigma_mm, 0);
    EXPECT_NEAR(result.radius_mm, cell.radius, 4 * result.radius_sigma_mm);
    EXPECT_LT(error_at_work(result, cell), 0.3);
}

TEST(TcpSphere, AWrongRadiusIsNotPresentedAsGood) {
    Random random(22);
    const SphereCell cell = any_cell(random);
    const auto observations = sphere_observations(cell, 12, random);
    TcpSphereOptions options;
    options.radius_mm = 2 * cell.radius;
    const auto result = solve(observations, options);
    EXPECT_NE(result.report.judgement.verdict, Verdict::good);
    EXPECT_NE(result.report.judgement.verdict, Verdict::usable) << result.report.judgement.reason;
}

TEST(TcpSphere, MirroredAxes) {
    Random random(31);
    const SphereCell cell = any_cell(random);
    auto observations = sphere_observations(cell, 10, random);
    TcpSphereOptions options;
    options.radius_mm = cell.radius;
    auto mirrored_z = observations;
    for (auto& o : mirrored_z)
        for (auto& z : o.profile.z_mm) z = -z;
    const auto result_z = solve(mirrored_z, options);
    EXPECT_EQ(result_z.mirrored, MirroredAxis::z);
    EXPECT_THAT(result_z.notices.front(), HasSubstr("mirrored"));
    // The frame is the one turned half about X, and every point still lands where it is.
    const Pose half_x(Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX()));
    EXPECT_LT(angle_rad(result_z.flange_from_sensor, cell.flange_from_sensor * half_x), 1e-2);

    auto mirrored_x = observations;
    for (auto& o : mirrored_x)
        for (auto& x : o.profile.x_mm) x = -x;
    const auto result_x = solve(mirrored_x, options);
    EXPECT_EQ(result_x.mirrored, MirroredAxis::x);
    options.nominal_flange_from_sensor =
        cell.flange_from_sensor * make_pose(rotation_exp({0.1, 0.05, -0.1}), {5, 3, -9});
    EXPECT_EQ(solve(mirrored_x, options).mirrored, MirroredAxis::x);
    EXPECT_EQ(solve(mirrored_z, options).mirrored, MirroredAxis::z);
    EXPECT_EQ(solve(observations, options).mirrored, MirroredAxis::none);
}

TEST(TcpSphere, RefusesBadInputInOneSentence) {
    Random random(41);
    const SphereCell cell = any_cell(random);
    const auto good = sphere_observations(cell, 8, random);
    TcpSphereOptions options;
    options.radius_mm = cell.radius;
    const auto expect_error = [&](const std::vector<SphereObservation>& observations,
                                  const TcpSphereOptions& o, const char* word) {
        const auto result = calibrate_tcp_sphere(observations, o);
        ASSERT_FALSE(result.has_value()) << word;
        EXPECT_EQ(result.error().kind, ErrorKind::input);
        EXPECT_THAT(result.error().sentence(), HasSubstr(word));
    };
    expect_error({}, options, "too few");
    expect_error({good.begin(), good.begin() + 5}, options, "5 poses are too few");
    auto same = good;
    for (auto& o : same) o.base_from_flange = good[0].base_from_flange;
    expect_error(same, options, "only 1 of the 8 poses differ");
    auto metres = good;
    for (auto& o : metres) o.base_from_flange.translation() *= 1e-3;
    expect_error(metres, options, "metres");
    auto metre_points = good;
    for (auto& o : metre_points) {
        for (auto& x : o.profile.x_mm) x *= 1e-3;
        for (auto& z : o.profile.z_mm) z *= 1e-3;
    }
    expect_error(metre_points, options, "metres");
    auto sheared = good;
    sheared[3].base_from_flange.matrix()(0, 1) += 0.02;
    expect_error(sheared, options, "P4");
    auto nan = good;
    nan[2].base_from_flange.translation().x() = std::nan("");
    expect_error(nan, options, "P3");
    auto twice = good;
    twice[1].id = "P1";
    expect_error(twice, options, "twice");
    auto uneven = good;
    uneven[1].profile.z_mm.pop_back();
    expect_error(uneven, options, "different numbers");
    TcpSphereOptions bad = options;
    bad.radius_mm = -1;
    expect_error(good, bad, "positive");
    bad.radius_mm = 0.0127;
    expect_error(good, bad, "metres");
    bad = options;
    bad.exclude = {"nobody"};
    expect_error(good, bad, "nobody");
    auto empty = good;
    for (auto& o : empty) o.profile.clear();
    expect_error(empty, options, "point");
}

TEST(TcpSphere, ProfilesWithoutASphereAreUndetermined) {
    Random random(51);
    SphereCell cell = any_cell(random);
    auto observations = sphere_observations(cell, 9, random);
    for (auto& o : observations) {
        for (size_t i = 0; i < o.profile.size(); ++i)
            o.profile.z_mm[i] = 0.1 * o.profile.x_mm[i] + normal(random, 0.03);
    }
    TcpSphereOptions options;
    options.radius_mm = cell.radius;
    const auto result = solve(observations, options);
    EXPECT_EQ(result.status, TcpSphereStatus::not_converged);
    EXPECT_EQ(result.report.judgement.verdict, Verdict::undetermined);
    // Noise alone, and absurd numbers, must come back too.
    for (auto& o : observations)
        for (size_t i = 0; i < o.profile.size(); ++i) {
            o.profile.x_mm[i] = uniform(random, -1e12, 1e12);
            o.profile.z_mm[i] =
                i % 7 == 0 ? std::numeric_limits<double>::infinity() : uniform(random, -1e12, 1e12);
        }
    const auto absurd = solve(observations, options);
    EXPECT_EQ(absurd.report.judgement.verdict, Verdict::undetermined);
}

}  // namespace
}  // namespace seamwright
