#include "core/calibration/nozzle/nozzle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/core/calibration/nozzle/touch_cell.h"

namespace seamwright {
namespace {

using testing::HasSubstr;
using touches::Cell;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

NozzleResult solved(const std::vector<NozzleTouch>& list, const NozzleTarget& target,
                    const NozzleOptions& options = {}) {
    auto result = calibrate_nozzle(list, target, options);
    EXPECT_TRUE(result) << result.error().sentence();
    return result ? *std::move(result) : NozzleResult{};
}
std::string refused(const std::vector<NozzleTouch>& list, const NozzleTarget& target,
                    const NozzleOptions& options = {}) {
    const auto result = calibrate_nozzle(list, target, options);
    return result ? std::string() : result.error().sentence();
}

TEST(Nozzle, ExactTouchesGiveTheTip) {
    for (const double tilt : {0.0, 25.0})
        for (const bool sphere : {true, false}) {
            Cell cell;
            cell.tilt_deg = tilt;
            auto list = sphere ? cell.sphere(8) : cell.point(6);
            if (!sphere && tilt == 0) list.resize(1);  // the others are the same pose
            NozzleOptions options;
            options.sigma_mm = 0.1;
            const auto r = solved(list, cell.target(sphere), options);
            ASSERT_EQ(r.status, NozzleStatus::ok) << tilt << sphere << r.report.judgement.reason;
            EXPECT_LT((r.flange_from_nozzle.translation() - cell.tip).norm(), 1e-6);
            EXPECT_LT(r.rms_mm, 1e-6);
        }
}

TEST(Nozzle, ABallAtTheTipIsFurtherFromTheCentre) {
    Cell cell;
    cell.radius = 27;
    const auto list = cell.sphere(8);
    auto target = cell.target();
    target.radius_mm = 25;
    NozzleOptions options;
    options.sigma_mm = 0.1;
    options.tip_radius_mm = 2;
    EXPECT_LT((solved(list, target, options).flange_from_nozzle.translation() - cell.tip).norm(), 1e-6);
}

// One touch of a point, the flange never turned: the covariance is the touch's, the robot's and the place's.
TEST(Nozzle, TheCovarianceOfOneTouchIsTheSumOfItsErrors) {
    Cell cell;
    const auto list = cell.point(1);
    auto target = cell.target(false);
    target.covariance_mm2.diagonal() = Eigen::Vector3d(0.01, 0.04, 0.09);
    NozzleOptions options;
    options.sigma_mm = 0.1;
    options.robot.sigma_mm = 0.2;
    options.robot.sigma_rad = 1e-3;
    const auto r = solved(list, target, options);
    ASSERT_EQ(r.status, NozzleStatus::ok);
    const Eigen::Matrix3d at = list[0].base_from_flange.linear();
    const Eigen::Vector3d arm = at * cell.tip;
    const Eigen::Matrix3d turn =
        1e-6 * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
    const Eigen::Matrix3d random = (0.01 + 0.04) * Eigen::Matrix3d::Identity() + turn;
    EXPECT_TRUE(r.covariance_random.isApprox(at.transpose() * random * at, 1e-6));
    EXPECT_TRUE(r.covariance_systematic.isApprox(at.transpose() * target.covariance_mm2 * at, 1e-6));
}

// The whole cell moved: the tip on the flange and its covariance stay.
TEST(Nozzle, AMovedBaseChangesNothing) {
    Cell cell;
    cell.hand = 0.1;
    auto list = cell.sphere(9);
    auto target = cell.target();
    target.covariance_mm2 << 0.004, 0.001, 0, 0.001, 0.003, 0, 0, 0, 0.01;
    const auto before = solved(list, target);
    const Pose moved = make_pose(rotation_exp({0.7, -1.1, 2.0}), {-300, 1200, 80});
    for (NozzleTouch& t : list) t.base_from_flange = moved * t.base_from_flange;
    target.place_mm = moved * target.place_mm;
    target.covariance_mm2 = moved.linear() * target.covariance_mm2 * moved.linear().transpose();
    const auto after = solved(list, target);
    EXPECT_LT((after.flange_from_nozzle.translation() - before.flange_from_nozzle.translation()).norm(),
              1e-5);
    EXPECT_TRUE(after.covariance.isApprox(before.covariance, 1e-4));
    EXPECT_EQ(after.report.judgement.verdict, before.report.judgement.verdict);
}

// One orientation: the centre's error goes into the tip whole. Turned, the touches tell the centre themselves.
TEST(Nozzle, TurningTheFlangeTellsTheCentreAndTheTipApart) {
    auto sigma_with = [](double tilt) {
        Cell cell;
        cell.tilt_deg = tilt;
        cell.hand = 0.05;
        auto target = cell.target();
        target.covariance_mm2 = 0.25 * Eigen::Matrix3d::Identity();
        NozzleOptions options;
        options.sigma_mm = 0.05;
        const auto r = solved(cell.sphere(16), target, options);
        EXPECT_EQ(r.status, NozzleStatus::ok);
        EXPECT_EQ(r.notices.empty(), tilt > 0);
        return r.worst_sigma_mm;
    };
    EXPECT_GE(sigma_with(0), 0.5);
    EXPECT_LT(sigma_with(45), 0.25);
}

TEST(Nozzle, WhatIsNotDeterminedIsNamedWithTheNextTouch) {
    Cell cell;
    cell.tilt_deg = 0;
    NozzleOptions options;
    options.sigma_mm = 0.05;
    auto four = std::vector{cell.on_sphere("A", {1, 0, 0}), cell.on_sphere("B", {-1, 0, 0}),
                            cell.on_sphere("C", {0, 1, 0})};
    const auto mirrored = solved({cell.on_sphere("A", {1, 0, 0.5}), cell.on_sphere("B", {-1, 0, 0.5}),
                                  cell.on_sphere("C", {0, 1, 0.5})},
                                 cell.target(), options);
    EXPECT_EQ(mirrored.status, NozzleStatus::undetermined);
    EXPECT_THAT(mirrored.report.judgement.reason.english(), HasSubstr("which of two places"));
    EXPECT_THAT(mirrored.report.judgement.cure.english(), HasSubstr("from above"));
    EXPECT_TRUE(mirrored.report.parameters.empty());

    const auto flat = solved(four, cell.target(), options);
    EXPECT_EQ(flat.status, NozzleStatus::undetermined);
    EXPECT_THAT(flat.report.judgement.cure.english(), HasSubstr("from above"));

    four.resize(2);
    const auto line = solved(four, cell.target(), options);
    EXPECT_EQ(line.status, NozzleStatus::undetermined);
    EXPECT_FALSE(line.open.empty());
    ASSERT_FALSE(line.advice.empty());

    const auto unsure = solved(cell.point(1), cell.target(false));
    EXPECT_EQ(unsure.status, NozzleStatus::undetermined);
    EXPECT_THAT(unsure.report.judgement.reason.english(), HasSubstr("how surely"));
}

// The touch that is advised closes what is open.
TEST(Nozzle, TheAdvisedTouchDeterminesTheTip) {
    Cell cell;
    cell.tilt_deg = 0;
    NozzleOptions options;
    options.sigma_mm = 0.05;
    auto list = std::vector{cell.on_sphere("A", {1, 0, 0.5}), cell.on_sphere("B", {-1, 0, 0.5}),
                            cell.on_sphere("C", {0, 1, 0.5})};
    ASSERT_EQ(solved(list, cell.target(), options).status, NozzleStatus::undetermined);
    list.push_back(cell.on_sphere("D", {0, 0, 1}));
    const auto r = solved(list, cell.target(), options);
    EXPECT_EQ(r.status, NozzleStatus::ok) << r.report.judgement.reason;
    EXPECT_LT((r.flange_from_nozzle.translation() - cell.tip).norm(), 1e-6);
}

TEST(Nozzle, ASlippedTouchIsNamedAndLeftOut) {
    for (const bool stated : {true, false}) {
        Cell cell;
        cell.hand = 0.05;
        auto list = cell.sphere(12);
        list[4].base_from_flange.translation() +=
            1.5 * (list[4].base_from_flange * cell.tip - cell.centre).normalized();
        NozzleOptions options;
        if (stated) options.sigma_mm = 0.05;
        const auto r = solved(list, cell.target(), options);
        ASSERT_EQ(r.status, NozzleStatus::ok);
        for (std::size_t i = 0; i < list.size(); ++i)
            EXPECT_EQ(r.report.poses[i].used, i != 4) << i << stated;
        EXPECT_THAT(r.report.poses[4].note.english(), HasSubstr("slipped"));
        EXPECT_LT((r.flange_from_nozzle.translation() - cell.tip).norm(), 4 * r.worst_sigma_mm);
    }
}

// Five touches of a sphere, one unknown to spare: some touch slipped, and none can be told from the others.
TEST(Nozzle, WhereNothingTellsWhichTouchSlippedNoneIsTaken) {
    Cell cell;
    cell.tilt_deg = 0;
    cell.hand = 0.01;
    std::vector<NozzleTouch> list{cell.on_sphere("A", {1, 0, 0.3}), cell.on_sphere("B", {-1, 0, 0.3}),
                                  cell.on_sphere("C", {0, 1, 0.3}), cell.on_sphere("D", {0.1, 0.1, 1})};
    list[1].base_from_flange.translation().x() -= 3;
    NozzleOptions options;
    options.sigma_mm = 0.02;
    const auto r = solved(list, cell.target(), options);
    EXPECT_FALSE(serves(r.report.judgement.verdict)) << r.report.judgement.reason;
    for (const PoseResidual& p : r.report.poses) EXPECT_TRUE(p.used);
}

TEST(Nozzle, ADeviationFromTheProgrammedToolIsToldFromChance) {
    Cell cell;
    cell.hand = 0.05;
    const auto list = cell.sphere(10);
    NozzleOptions options;
    options.programmed = make_pose(rotation_exp({0.2, 0.1, 0}), cell.tip);
    const auto same = solved(list, cell.target(), options);
    ASSERT_TRUE(same.deviation);
    EXPECT_FALSE(same.deviation->beyond_chance);
    EXPECT_TRUE(same.flange_from_nozzle.linear().isApprox(options.programmed->linear()));
    options.programmed->translation() += Eigen::Vector3d(0, 1, 0);
    const auto bent = solved(list, cell.target(), options);
    ASSERT_TRUE(bent.deviation);
    EXPECT_TRUE(bent.deviation->beyond_chance);
    EXPECT_NEAR(bent.deviation->mm.y(), -1, 0.2);
    EXPECT_FALSE(solved(list, cell.target()).deviation);
}

TEST(Nozzle, TouchesThatScatterMoreThanStatedArePoor) {
    Cell cell;
    cell.hand = 0.5;
    NozzleOptions options;
    options.sigma_mm = 0.05;
    const auto r = solved(cell.sphere(12), cell.target(), options);
    EXPECT_EQ(r.report.judgement.verdict, Verdict::poor) << r.report.judgement.reason;
}

TEST(Nozzle, TheSamePoseTwiceIsOneTouch) {
    Cell cell;
    cell.hand = 0.05;
    auto list = cell.sphere(8);
    list.push_back(list[3]);
    list.back().id = "again";
    const auto r = solved(list, cell.target());
    EXPECT_FALSE(r.report.poses.back().used);
    EXPECT_THAT(r.report.poses.back().note.english(), HasSubstr("same pose as 'T4'"));
}

TEST(Nozzle, HostileValuesAreRefusedInOneSentence) {
    Cell cell;
    const auto good = cell.sphere(6);
    const auto target = cell.target();
    EXPECT_THAT(refused({}, target), HasSubstr("no touch"));
    auto bad = good;
    bad[2].base_from_flange.translation().y() = kNan;
    EXPECT_THAT(refused(bad, target), HasSubstr("T3"));
    bad = good;
    bad[2].base_from_flange.linear() *= 1.1;
    EXPECT_THAT(refused(bad, target), HasSubstr("T3"));
    bad = good;
    bad[2].base_from_flange.translation().x() = 1e9;
    EXPECT_THAT(refused(bad, target), HasSubstr("100 m"));
    bad = good;
    bad[2].id = "T1";
    EXPECT_THAT(refused(bad, target), HasSubstr("twice"));
    bad = good;
    for (NozzleTouch& t : bad) t.base_from_flange.translation() *= 0.001;
    EXPECT_THAT(refused(bad, target), HasSubstr("metres"));
    auto wrong = target;
    wrong.place_mm.z() = kNan;
    EXPECT_FALSE(refused(good, wrong).empty());
    for (const double radius : {0.0, -1.0, kNan, 1e9}) {
        wrong = target;
        wrong.radius_mm = radius;
        EXPECT_THAT(refused(good, wrong), HasSubstr("radius"));
    }
    wrong = target;
    wrong.covariance_mm2(0, 1) = 1;
    EXPECT_THAT(refused(good, wrong), HasSubstr("covariance"));
    wrong.covariance_mm2 = -Eigen::Matrix3d::Identity();
    EXPECT_THAT(refused(good, wrong), HasSubstr("covariance"));
    for (const double sigma : {0.0, -0.1, kNan, 100.0}) {
        NozzleOptions options;
        options.sigma_mm = sigma;
        EXPECT_THAT(refused(good, target, options), HasSubstr("sigma"));
    }
    NozzleOptions options;
    options.robot.sigma_mm = -1;
    EXPECT_THAT(refused(good, target, options), HasSubstr("repeatability"));
    options = {};
    options.exclude = {"T9"};
    EXPECT_THAT(refused(good, target, options), HasSubstr("T9"));
    options.exclude = {"T1", "T2", "T3", "T4", "T5", "T6"};
    EXPECT_THAT(refused(good, target, options), HasSubstr("excluded"));
    options = {};
    options.tip_radius_mm = 1;
    EXPECT_THAT(refused(cell.point(4), cell.target(false), options), HasSubstr("ball"));
}

}  // namespace
}  // namespace seamwright
