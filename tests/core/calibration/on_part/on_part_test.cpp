#include "core/calibration/on_part/on_part.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "tests/core/calibration/on_part/part_cell.h"
#include "tests/core/calibration/sphere/sphere_simulation.h"

namespace seamwright {
namespace {

using part_cell::Cell;
using part_cell::Curve;
using part_cell::Motion;
using part_cell::Noise;
using testing::HasSubstr;

double turn_deg(const Pose& a, const Pose& b) {
    return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() / Cell::kDeg;
}
double working_mm(const OnPartResult& r, const Pose& truth) {
    const Eigen::Vector3d m(r.working_point_mm.x(), 0, r.working_point_mm.y());
    return (truth * m - r.flange_from_sensor * m).norm();
}

class ExactEdge : public testing::TestWithParam<int> {
  protected:
    static std::vector<Curve> curves(const Cell& cell) {
        switch (GetParam()) {
            case 0:
                return {cell.straight()};
            case 1:
                return {cell.straight(), cell.straight(55, 15)};
            case 2:
                return {cell.round(100)};
            case 3:
                return {cell.round(1000)};
            default:
                return {cell.wavy(1)};
        }
    }
};

// From nothing but points and poses: no start, any mounting.
TEST_P(ExactEdge, WithoutNoiseTheTruthIsFound) {
    for (const unsigned seed : {1U, 2U, 3U}) {
        Cell cell(seed);
        const double latency = cell.uniform(0, 0.02);
        const auto r = calibrate_on_part(cell.passes(curves(cell), 12, 20, {}, {}, latency));
        ASSERT_TRUE(r) << r.error().sentence();
        ASSERT_EQ(r->status, OnPartStatus::ok) << r->report.judgement.reason.english();
        EXPECT_EQ(r->report.judgement.verdict, Verdict::good) << r->report.judgement.reason.english();
        EXPECT_LT(working_mm(*r, cell.mounting()), 0.002);
        EXPECT_LT(turn_deg(r->flange_from_sensor, cell.mounting()), 0.01);
        EXPECT_NEAR(r->latency_s, latency, 2e-5);
        EXPECT_LT(3 * r->working_sigma_mm, 0.03);
        EXPECT_GT(r->report.hold_out.folds, 8);
    }
}
INSTANTIATE_TEST_SUITE_P(Edges, ExactEdge, testing::Range(0, 5));

const Noise kUsual{0.03, 0.03, 0.01, 0, 0};

TEST(OnPart, AnotherBaseFrameChangesNothing) {
    Cell cell(7);
    auto passes = cell.passes({cell.round(300)}, 10, 15, {}, kUsual, 0.006);
    const auto before = calibrate_on_part(passes);
    const Pose moved = Eigen::Translation3d(300, -200, 100) * cell.rotation();
    for (auto& pass : passes)
        for (auto& p : pass.profiles) p.base_from_flange = moved * p.base_from_flange;
    const auto after = calibrate_on_part(passes);
    ASSERT_TRUE(before && after);
    ASSERT_EQ(before->status, OnPartStatus::ok);
    ASSERT_EQ(after->status, OnPartStatus::ok);
    EXPECT_LT(working_mm(*after, before->flange_from_sensor), 2e-3);
    EXPECT_LT(turn_deg(after->flange_from_sensor, before->flange_from_sensor), 5e-3);
    EXPECT_NEAR(after->working_sigma_mm, before->working_sigma_mm, 0.03 * before->working_sigma_mm);
}

TEST(OnPart, AShiftOfAllTimesChangesNothingAndOneOfThePosesIsLatency) {
    Cell cell(8);
    const auto passes = cell.passes({cell.straight()}, 12, 20, {}, kUsual, 0.003);
    auto later = passes;
    for (auto& pass : later)
        for (auto& p : pass.profiles) p.time_s += 4711;
    const auto a = calibrate_on_part(passes), b = calibrate_on_part(later);
    ASSERT_TRUE(a && b);
    EXPECT_NEAR(a->latency_s, b->latency_s, 1e-6);
    EXPECT_NEAR(a->latency_s, 0.003, 4 * a->latency_sigma_s);
    // Points that come one profile later than their poses say are an interval older.
    auto shifted = passes;
    for (auto& pass : shifted) {
        for (std::size_t k = pass.profiles.size(); k-- > 1;)
            pass.profiles[k].point_mm = pass.profiles[k - 1].point_mm;
        pass.profiles.erase(pass.profiles.begin());
    }
    const auto c = calibrate_on_part(shifted);
    ASSERT_TRUE(c);
    const double interval = passes[0].profiles[1].time_s - passes[0].profiles[0].time_s;
    EXPECT_NEAR(c->latency_s - a->latency_s, interval, 4 * a->latency_sigma_s);
}

TEST(OnPart, AFixedLatencyIsTakenAndAWrongOneCosts) {
    Cell cell(9);
    const auto passes = cell.passes({cell.straight()}, 12, 20, {}, kUsual, 0.012);
    OnPartOptions options;
    options.latency_s = 0.012;
    const auto right = calibrate_on_part(passes, options);
    ASSERT_TRUE(right);
    ASSERT_EQ(right->status, OnPartStatus::ok);
    EXPECT_EQ(right->latency_s, 0.012);
    EXPECT_EQ(right->latency_sigma_s, 0);
    EXPECT_EQ(right->report.parameters.size(), 6U);
    EXPECT_LT(working_mm(*right, cell.mounting()), 4 * right->working_sigma_mm);
}

// One straight edge, one attitude: neither the shift nor which of two mirror images it is.
TEST(OnPart, OneAttitudeIsRefusedWithThePassThatWouldHelp) {
    for (const unsigned seed : {11U, 12U, 13U}) {
        Cell cell(seed);
        Motion stiff;
        stiff.turn_deg = 0;
        const auto r = calibrate_on_part(cell.passes({cell.straight()}, 10, 0, stiff, kUsual, 0.004));
        ASSERT_TRUE(r) << r.error().sentence();
        EXPECT_EQ(r->status, OnPartStatus::undetermined);
        EXPECT_EQ(r->report.judgement.verdict, Verdict::undetermined);
        ASSERT_FALSE(r->open.empty());
        ASSERT_FALSE(r->advice.empty());
        EXPECT_THAT(r->advice.front().english(), HasSubstr("pass"));
        EXPECT_TRUE(r->report.parameters.empty());
    }
}

// All attitudes about the edge itself: the shift along it stays open, and is called so.
TEST(OnPart, AttitudesAboutTheTravelLeaveTheShiftAlongItOpen) {
    Cell cell(14);
    Motion stiff;
    stiff.turn_deg = 0;
    std::vector<EdgePass> passes;
    for (int i = 0; i < 12; ++i)
        passes.push_back(cell.pass("P" + std::to_string(i), "e1", cell.straight(), {0, 5.0 * i - 27, 0},
                                   {i % 3 - 1.0, i % 2 * 3.0}, i % 2 ? -1 : 1, stiff, kUsual, 0));
    const auto r = calibrate_on_part(passes);
    ASSERT_TRUE(r);
    EXPECT_EQ(r->status, OnPartStatus::undetermined) << r->report.judgement.reason.english();
    ASSERT_FALSE(r->open.empty());
    std::string all;
    for (const Text& t : r->open) all += t.english() + "\n";
    EXPECT_THAT(all, HasSubstr("travel"));
}

TEST(OnPart, AWrongPassAndWrongProfilesAreNamedAndLeftOut) {
    for (const double off_mm : {0.8, 6.0}) {
        Cell cell(21);
        auto passes = cell.passes({cell.round(500)}, 14, 20, {}, kUsual, 0.008);
        for (auto& p : passes[4].profiles)
            p.base_from_flange.translation() += Eigen::Vector3d(off_mm, -off_mm, off_mm);
        passes[7].profiles[20].point_mm.y() += 1.5;
        passes[8].profiles[5].point_mm.x() -= 40;
        const auto r = calibrate_on_part(passes);
        ASSERT_TRUE(r);
        ASSERT_EQ(r->status, OnPartStatus::ok) << r->report.judgement.reason.english();
        EXPECT_FALSE(r->report.poses[4].used) << off_mm;
        EXPECT_FALSE(r->report.poses[4].note.empty());
        EXPECT_GE(r->left_out_profiles[7], 1);
        EXPECT_GE(r->left_out_profiles[8], 1);
        EXPECT_LT(working_mm(*r, cell.mounting()), 4 * r->working_sigma_mm);
        EXPECT_EQ(r->report.judgement.verdict, Verdict::usable);
    }
}

Matrix6 old_covariance(double mm, double deg) {
    Vector6 sigma;
    sigma << mm, mm, mm, deg * Cell::kDeg, deg * Cell::kDeg, deg * Cell::kDeg;
    return sigma.cwiseAbs2().asDiagonal();
}

// The old place within its sigma: nothing moved, and few passes do. Bumped: said, and never mixed into the answer.
TEST(OnPart, AfterABumpItSaysWhetherTheSensorMoved) {
    Cell cell(31);
    const auto passes = cell.passes({cell.straight()}, 12, 20, {}, kUsual, 0.005);
    OnPartOptions options;
    options.prior = MountingPrior{cell.mounting(), old_covariance(0.03, 0.02)};
    const auto still = calibrate_on_part(passes, options);
    ASSERT_TRUE(still) << still.error().sentence();
    ASSERT_TRUE(still->bump);
    EXPECT_FALSE(still->bump->moved) << still->bump->chi_squared;
    EXPECT_LT(still->working_sigma_mm, 0.05);
    options.prior->flange_from_sensor =
        cell.mounting() * Eigen::Translation3d(0.6, -0.4, 0.5) *
        Eigen::AngleAxisd(0.8 * Cell::kDeg, Eigen::Vector3d(1, 2, -1).normalized());
    const auto moved = calibrate_on_part(passes, options);
    ASSERT_TRUE(moved);
    ASSERT_TRUE(moved->bump);
    EXPECT_TRUE(moved->bump->moved);
    ASSERT_EQ(moved->status, OnPartStatus::ok) << moved->report.judgement.reason.english();
    EXPECT_LT(working_mm(*moved, cell.mounting()), 4 * moved->working_sigma_mm);
    EXPECT_NEAR(moved->bump->turn_deg, 0.8, 0.3);
    // A blow that nobody would call small, against a prior that is sure of itself.
    options.prior->flange_from_sensor =
        cell.mounting() * Eigen::Translation3d(7, -5, 6) *
        Eigen::AngleAxisd(6 * Cell::kDeg, Eigen::Vector3d(1, 2, -1).normalized());
    const auto struck = calibrate_on_part(passes, options);
    ASSERT_TRUE(struck && struck->bump);
    EXPECT_TRUE(struck->bump->moved);
    ASSERT_EQ(struck->status, OnPartStatus::ok) << struck->report.judgement.reason.english();
    EXPECT_LT(working_mm(*struck, cell.mounting()), 4 * struck->working_sigma_mm);
    // Passes under one attitude cannot tell, moved or not: neither is the old place handed on.
    for (const double blow_mm : {0.0, 3.0}) {
        options.prior->flange_from_sensor = cell.mounting() * Eigen::Translation3d(blow_mm, -blow_mm, 0);
        Motion stiff;
        stiff.turn_deg = 0;
        const auto few = cell.passes({cell.straight()}, 4, 0, stiff, kUsual, 0.005);
        const auto checked = calibrate_on_part(few, options);
        ASSERT_TRUE(checked && checked->bump);
        EXPECT_FALSE(checked->bump->moved);
        EXPECT_LT(checked->bump->directions, 3);
        EXPECT_EQ(checked->status, OnPartStatus::undetermined);
        EXPECT_THAT(checked->report.judgement.reason.english(), HasSubstr("cannot tell"));
        EXPECT_FALSE(checked->advice.empty());
    }
}

// Two ways to the same mounting, each with its own sigma: chi squared of six, the 99.9 % point.
TEST(OnPart, TheSphereInTheSameCellAgrees) {
    for (unsigned seed = 51; seed < 56; ++seed) {
        Cell cell(seed);
        const auto part =
            calibrate_on_part(cell.passes({cell.straight(), cell.round(200, 50)}, 12, 20, {}, kUsual, 0.01));
        ASSERT_TRUE(part);
        ASSERT_EQ(part->status, OnPartStatus::ok);
        simulation::Random random(seed);
        simulation::SphereCell sphere = simulation::any_cell(random);
        sphere.flange_from_sensor = cell.mounting();
        sphere.step_mm = 0.3;
        TcpSphereOptions options;
        options.radius_mm = sphere.radius;
        const auto ball = calibrate_tcp_sphere(simulation::sphere_observations(sphere, 9, random), options);
        ASSERT_TRUE(ball);
        ASSERT_EQ(ball->status, TcpSphereStatus::ok);
        const Vector6 d = difference(part->flange_from_sensor, ball->flange_from_sensor);
        EXPECT_LT(d.dot((part->covariance + ball->covariance).inverse() * d), 22.5) << seed;
    }
}

TEST(OnPart, WhatIsNoInputIsRefusedInOneSentence) {
    Cell cell(41);
    const auto good = cell.passes({cell.straight()}, 6, 20, {}, kUsual, 0);
    const auto refused = [](const std::vector<EdgePass>& passes, const OnPartOptions& options = {}) {
        const auto r = calibrate_on_part(passes, options);
        return r ? std::string() : r.error().sentence();
    };
    EXPECT_EQ(refused(good), "");
    EXPECT_FALSE(refused({}).empty());
    auto bad = good;
    bad[1].id = bad[0].id;
    EXPECT_THAT(refused(bad), HasSubstr("twice"));
    bad = good, bad[2].profiles[3].time_s = bad[2].profiles[2].time_s;
    EXPECT_THAT(refused(bad), HasSubstr("time of profile 3"));
    bad = good, bad[2].profiles[3].point_mm.x() = std::nan("");
    EXPECT_THAT(refused(bad), HasSubstr("profile 3"));
    bad = good, bad[2].profiles[3].base_from_flange.linear() *= 1.1;
    EXPECT_FALSE(refused(bad).empty());
    bad = good, bad[2].profiles[3].covariance_mm2 << 1, 2, 2, 1;
    EXPECT_THAT(refused(bad), HasSubstr("covariance"));
    bad = good, bad[0].edge.clear();
    EXPECT_THAT(refused(bad), HasSubstr("edge"));
    bad = good, bad[0].profiles.clear();
    EXPECT_FALSE(refused(bad).empty());
    bad = good;
    for (auto& pass : bad)
        for (auto& p : pass.profiles) p.base_from_flange.translation() *= 1e-3;
    EXPECT_THAT(refused(bad), HasSubstr("metres"));
    OnPartOptions options;
    options.exclude = {"P77"};
    EXPECT_THAT(refused(good, options), HasSubstr("P77"));
    options = {}, options.latency_s = std::nan("");
    EXPECT_FALSE(refused(good, options).empty());
    options = {}, options.prior = MountingPrior{cell.mounting(), Matrix6::Zero()};
    EXPECT_THAT(refused(good, options), HasSubstr("covariance"));
    options = {}, options.robot = RobotRepeatability{-1, 0.1};
    EXPECT_FALSE(refused(good, options).empty());
}

// Never a throw, never "ok": noise for data, equal poses, all but nothing, everything excluded.
TEST(OnPart, DataThatHoldNothingAreNoAnswer) {
    Cell cell(42);
    auto random = cell.passes({cell.straight()}, 8, 20, {}, kUsual, 0);
    for (auto& pass : random)
        for (auto& p : pass.profiles) p.point_mm = {cell.uniform(-30, 30), cell.uniform(-30, 30)};
    auto equal = cell.passes({cell.straight()}, 4, 20, {}, kUsual, 0);
    for (auto& pass : equal)
        for (auto& p : pass.profiles)
            p = {p.time_s, equal[0].profiles[0].base_from_flange, {1, 2}, p.covariance_mm2};
    auto few = cell.passes({cell.straight()}, 1, 20, {}, kUsual, 0);
    few[0].profiles.resize(3);
    auto single = cell.passes({cell.straight()}, 1, 20, {}, kUsual, 0);
    for (const auto& passes : {random, equal, few, single}) {
        const auto r = calibrate_on_part(passes);
        ASSERT_TRUE(r) << r.error().sentence();
        EXPECT_FALSE(serves(r->report.judgement.verdict)) << r->report.judgement.reason.english();
        EXPECT_FALSE(r->report.judgement.reason.empty());
    }
    OnPartOptions options;
    for (const auto& pass : random) options.exclude.push_back(pass.id);
    const auto none = calibrate_on_part(random, options);
    ASSERT_TRUE(none);
    EXPECT_EQ(none->status, OnPartStatus::undetermined);
}

// A pass that alone follows its edge and is excluded has no residual, and nothing breaks.
TEST(OnPart, AnExcludedPassIsJudgedByTheOthers) {
    Cell cell(43);
    auto passes = cell.passes({cell.straight()}, 12, 20, {}, kUsual, 0.002);
    passes[3].edge = "another";
    OnPartOptions options;
    options.exclude = {"P2", "P4"};
    const auto r = calibrate_on_part(passes, options);
    ASSERT_TRUE(r);
    ASSERT_EQ(r->status, OnPartStatus::ok);
    EXPECT_TRUE(r->report.poses[1].excluded);
    EXPECT_FALSE(r->report.poses[1].used);
    EXPECT_LT(r->report.poses[1].rms_mm, 0.5);
    EXPECT_TRUE(std::isnan(r->report.poses[3].rms_mm));
}

// Profiles of straight passes along straight edges, each pass with one attitude and no turn within it.
std::vector<EdgePass> rigid_passes(unsigned seed, int count, int edges, const Pose& mounting,
                                   double latency_s) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 0.03);
    std::uniform_real_distribution<double> u(-1, 1);
    const std::array<Pose, 2> edge = {
        make_pose(rotation_exp({-0.14, 0.09, 0.26}), {900, 150, 250}),
        make_pose(rotation_exp({0.21, -0.1, 1.75}), {980, 60, 230})};  // along X
    constexpr double kSpeed_mm_s = 60;
    std::vector<EdgePass> list;
    for (int i = 0; i < count; ++i) {
        const Pose& at = edge[static_cast<std::size_t>(i % edges)];
        const Eigen::Vector3d lean = 25 * Cell::kDeg * Eigen::Vector3d(u(random), u(random), u(random));
        const Eigen::Matrix3d sensor = at.linear() * rotation_exp({0, 0, 1.5707963}) * rotation_exp(lean);
        const Eigen::Vector3d off(10 * u(random), 0, 10 * u(random)), along = at.linear().col(0);
        const Eigen::Vector3d travel = (i % 2 ? -kSpeed_mm_s : kSpeed_mm_s) * along;
        const auto seen_from = [&](double t) {
            return make_pose(sensor, at.translation() + travel * t - sensor * off);
        };
        EdgePass pass{"P" + std::to_string(i + 1), "e" + std::to_string(i % edges + 1), {}};
        for (int k = 0; k < 25; ++k) {
            const double t = 0.02 * (k - 12);
            const Pose before = seen_from(t - latency_s);
            const Eigen::Vector3d across = before.linear().col(1);
            const double s = across.dot(before.translation() - at.translation()) / across.dot(along);
            const Eigen::Vector3d p = before.inverse() * (at.translation() + s * along);
            EdgeProfile profile;
            profile.time_s = 10.0 * i + t;
            profile.base_from_flange = seen_from(t) * mounting.inverse();
            profile.point_mm = {p.x() + noise(random), p.z() + noise(random)};
            pass.profiles.push_back(profile);
        }
        list.push_back(pass);
    }
    return list;
}
const Pose kRigidMounting = make_pose(rotation_exp({0.06, -0.2, 0.38}), {35, -12, 140});

// Poses written the wrong way round, and two edges under one name.
TEST(OnPart, PassesThatShareNoEdgeAreRefusedWithTheCause) {
    for (const unsigned seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
        auto inverse = rigid_passes(seed, 10, 2, kRigidMounting, 0.004);
        for (auto& pass : inverse)
            for (auto& p : pass.profiles) p.base_from_flange = p.base_from_flange.inverse();
        auto one_name = rigid_passes(seed, 10, 2, kRigidMounting, 0.004);
        for (auto& pass : one_name) pass.edge = "e1";
        for (const auto& passes : {inverse, one_name}) {
            const auto r = calibrate_on_part(passes);
            ASSERT_TRUE(r) << r.error().sentence();
            EXPECT_FALSE(serves(r->report.judgement.verdict)) << seed;
            EXPECT_THAT(r->report.judgement.reason.english(), HasSubstr("do not lie on one smooth edge"))
                << seed;
            EXPECT_THAT(r->report.judgement.cure.english(), HasSubstr("which way round")) << seed;
        }
    }
}

// A straight edge followed along itself says nothing of the latency, however its noise falls.
TEST(OnPart, ALatencyThatNothingShowsIsNotStated) {
    int ok = 0, known = 0;
    for (unsigned seed = 1; seed <= 8; ++seed) {
        const auto r = calibrate_on_part(rigid_passes(seed, 10, 1, kRigidMounting, 0.004));
        ASSERT_TRUE(r);
        ok += r->status == OnPartStatus::ok;
        if (r->status != OnPartStatus::ok) continue;
        known += r->latency_known;
        if (r->latency_known) {  // hardly, and then it says so
            EXPECT_GT(r->latency_sigma_s, 0.6 * kOnPartOpen_s) << seed;
            EXPECT_LT(std::abs(r->latency_s - 0.004), 2.6 * r->latency_sigma_s) << seed;
        }
        EXPECT_LT(working_mm(*r, kRigidMounting), 4 * r->working_sigma_mm) << seed;
        for (const Text& notice : r->notices)
            EXPECT_THAT(notice.english(), testing::Not(HasSubstr("wrong profiles"))) << seed;
    }
    EXPECT_GT(ok, 0);
    EXPECT_LT(known, ok);
}

// The latency of passes along one straight edge is idle. Held or free, with the robot stated or not, a blow of millimetres
// shows, and a place that is as good as its covariance says stands.
TEST(OnPart, AlongOneStraightEdgeABlowIsNeverPassedOver) {
    const RobotRepeatability stated{0.01, 0.003 * Cell::kDeg};
    int still_moved = 0, still = 0;
    for (unsigned seed = 1; seed <= 4; ++seed)
        for (const bool robot : {false, true}) {
            const auto passes = rigid_passes(seed, 8, 1, kRigidMounting, 0.008);
            std::mt19937 random(seed + 100);
            std::normal_distribution<double> n(0, 1);
            Vector6 off;
            for (int i = 0; i < 6; ++i) off(i) = n(random) * (i < 3 ? 0.1 : 0.05 * Cell::kDeg);
            Vector6 blow;
            for (int i = 0; i < 6; ++i) blow(i) = n(random) * (i < 3 ? 1.5 : 0.5 * Cell::kDeg);
            OnPartOptions options;
            if (robot) options.robot = stated;
            options.prior = MountingPrior{retract(kRigidMounting, off), old_covariance(0.1, 0.05)};
            const auto honest = calibrate_on_part(passes, options);
            ASSERT_TRUE(honest && honest->bump) << seed;
            still_moved += honest->bump->moved, ++still;
            if (honest->status == OnPartStatus::ok) {
                EXPECT_LT(working_mm(*honest, kRigidMounting), 4 * honest->working_sigma_mm) << seed;
            }
            options.prior->flange_from_sensor = retract(kRigidMounting, off + blow);
            const auto struck = calibrate_on_part(passes, options);
            ASSERT_TRUE(struck && struck->bump) << seed;
            EXPECT_TRUE(struck->bump->moved) << seed << " chi squared " << struck->bump->chi_squared;
            if (struck->status == OnPartStatus::ok) {
                EXPECT_LT(working_mm(*struck, kRigidMounting), 4 * struck->working_sigma_mm) << seed;
            }
        }
    EXPECT_LE(still_moved, 1) << "of " << still;
}

}  // namespace
}  // namespace seamwright
