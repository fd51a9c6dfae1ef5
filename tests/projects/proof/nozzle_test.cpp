// A calibrated nozzle in a project: kept in the file, at the bead in budget, forecast and gate, stale after a collision;
// and without one every number is what it was.

#include "projects/measure/nozzle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

#include "devices/capture/capture.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/calibrate/session/answer.h"
#include "projects/file/project_file.h"
#include "projects/file/project_json.h"
#include "projects/proof/budget.h"
#include "projects/proof/budget/budget_json.h"
#include "projects/proof/budget/budget_page.h"
#include "projects/proof/checklist.h"
#include "projects/proof/forecast.h"
#include "projects/station/check.h"
#include "tests/projects/fake_cell.h"

namespace seamwright {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kBefore = "2026-03-01T08:00:00.000Z";

Project plain() {
    Project p = make_fake_cell(8)->project;
    for (Spot& s : p.spots) s.sigma_mm = 0.02, s.jitter_mm = 1;
    for (Calibration& c : p.calibrations) c.created_utc = kBefore;
    return p;
}

Calibration nozzle(const Project& p, double worst_mm) {
    Calibration c;
    c.id = "nozzle-2";
    c.method = "nozzle";
    c.sensor_id = p.sensors.front().id;
    c.robot_id = p.robots.front().id;
    c.robot_identity = p.robots.front().identity;
    c.created_utc = kBefore;
    c.verdict = Verdict::good;
    NozzleTip tip;
    tip.flange_from_nozzle = make_pose(rotation_exp({0, 0.5, 0}), {4, -1, 231});
    const Eigen::Matrix3d turn = rotation_exp({0.3, -0.2, 0.9});
    tip.covariance_mm2 =
        turn * Eigen::Vector3d(1e-4, 4e-4, worst_mm * worst_mm).asDiagonal() * turn.transpose();
    tip.degrees = 6;
    c.nozzle = tip;
    return c;
}
Project with_nozzle(double worst_mm) {
    Project p = plain();
    p.calibrations.push_back(nozzle(p, worst_mm));
    return p;
}

RegionBudget budget_of(const Project& p, BudgetOptions options = {}) {
    const auto budget = region_budget(p, p.regions.front(), options);
    EXPECT_TRUE(budget) << budget.error().sentence();
    return budget ? *budget : RegionBudget{};
}

TEST(NozzleInTheProject, TheBudgetHasARowAtTheBeadAndNowhereElse) {
    const RegionBudget before = budget_of(plain()), after = budget_of(with_nozzle(0.08));
    ASSERT_EQ(before.measurands.size(), after.measurands.size());
    for (std::size_t i = 0; i < after.measurands.size(); ++i) {
        const MeasurandBudget &a = after.measurands[i], &b = before.measurands[i];
        if (a.quantity > Quantity::binormal) {
            EXPECT_EQ(a.u, b.u);
            EXPECT_EQ(a.rows.size(), b.rows.size());
            continue;
        }
        EXPECT_NEAR(a.u, std::hypot(b.u, 0.08), 1e-12);
        EXPECT_EQ(a.u_random, b.u_random);
        ASSERT_EQ(a.rows.size(), b.rows.size() + 1);
        const auto row = std::find_if(a.rows.begin(), a.rows.end(),
                                      [](const BudgetRow& r) { return r.source == ErrorSource::nozzle; });
        ASSERT_NE(row, a.rows.end());
        EXPECT_EQ(row->owner, "R1");
        EXPECT_NEAR(row->u, 0.08, 1e-9);
        EXPECT_NEAR(row->sensitivity, 1, 1e-9);
        EXPECT_NEAR(row->degrees, 6, 1e-9);
        EXPECT_TRUE(row->type_a);
        EXPECT_LT(a.degrees, 1e3);
        double share = 0;
        for (const BudgetRow& r : a.rows) share += r.share;
        EXPECT_NEAR(share, 1, 1e-12);
    }
    const std::vector<RegionBudget> all{after};
    EXPECT_THAT(budget_page(all, {}).text(), HasSubstr("nozzle R1"));
    EXPECT_THAT(budget_json(after).dump(), HasSubstr("\"source\":\"nozzle\""));
}

BudgetOptions drawn(std::size_t block, std::size_t most, std::uint64_t seed) {
    BudgetOptions options;
    options.monte_carlo = true;
    options.drawing.block = block;
    options.drawing.most = most;
    options.seed = seed;
    return options;
}

TEST(NozzleInTheProject, WithoutOneTheNumbersStayBitForBit) {
    Project p = plain();
    const auto json = budget_json(budget_of(p, drawn(1000, 2000, 3))).dump();
    const auto forecast = forecast_region(p, p.regions.front());
    // One that is poor, of another robot, or a sensor's is none.
    p.calibrations.push_back(nozzle(p, 0.08));
    p.calibrations.back().verdict = Verdict::poor;
    p.calibrations.push_back(nozzle(p, 0.08));
    p.calibrations.back().robot_id = "R9";
    EXPECT_EQ(budget_json(budget_of(p, drawn(1000, 2000, 3))).dump(), json);
    EXPECT_EQ(forecast_region(p, p.regions.front())->sigma_mm, forecast->sigma_mm);
}

TEST(NozzleInTheProject, MonteCarloDrawsItToo) {
    Project p = with_nozzle(0.08);
    p.calibrations.back().nozzle->degrees = std::numeric_limits<double>::infinity();
    const RegionBudget b = budget_of(p, drawn(10000, 60000, 5));
    for (const MeasurandBudget& m : b.measurands) {
        ASSERT_TRUE(m.drawn);
        EXPECT_NEAR(m.drawn->u, m.u, 0.03 * m.u) << to_string(m.quantity);
        EXPECT_TRUE(m.agrees) << to_string(m.quantity);
    }
}

TEST(NozzleInTheProject, TheForecastSumsItAsTheGateDoes) {
    const Project before = plain(), after = with_nozzle(0.08);
    const auto a = forecast_region(before, before.regions.front()),
               b = forecast_region(after, after.regions.front());
    ASSERT_TRUE(a && b);
    EXPECT_NEAR(b->sigma_mm, std::hypot(a->sigma_mm, 0.08), 1e-12);
    EXPECT_EQ(b->sigma_deg, a->sigma_deg);
}

TEST(NozzleInTheProject, TheNewestThatServesIsInUse) {
    Project p = with_nozzle(0.08);
    p.calibrations.push_back(nozzle(p, 0.02));
    p.calibrations.back().id = "nozzle-3";
    p.calibrations.push_back(nozzle(p, 0.01));
    p.calibrations.back().id = "nozzle-4";
    p.calibrations.back().verdict = Verdict::poor;
    ASSERT_NE(nozzle_of(p, "R1"), nullptr);
    EXPECT_EQ(nozzle_of(p, "R1")->id, "nozzle-3");
    EXPECT_NEAR(nozzle_sigma_mm(p, p.regions.front()), 0.02, 1e-9);
    EXPECT_EQ(nozzle_of(p, "R2"), nullptr);
}

TEST(NozzleInTheProject, IsKeptInTheFileAndOldFilesHoldNone) {
    Project p = with_nozzle(0.08);
    p.calibrations.back().nozzle->off_programmed_mm = 0.75;
    p.robots.front().collisions = {"2026-01-01T00:00:00Z", "2026-02-01T00:00:00Z"};
    const auto path = std::filesystem::temp_directory_path() /
                      ("seamwright_nozzle_" + std::to_string(::getpid()) + ".seam");
    std::filesystem::remove(path);
    {
        auto file = ProjectFile::create(path, p);
        ASSERT_TRUE(file) << file.error().sentence();
    }
    const auto back = ProjectFile::open(path, FileAccess::read_only)->load();
    std::filesystem::remove(path);
    ASSERT_TRUE(back) << back.error().sentence();
    ASSERT_TRUE(back->calibrations.back().nozzle);
    const NozzleTip &a = *back->calibrations.back().nozzle, &b = *p.calibrations.back().nozzle;
    EXPECT_EQ(a.covariance_mm2, b.covariance_mm2);
    EXPECT_EQ(a.flange_from_nozzle.matrix(), b.flange_from_nozzle.matrix());
    EXPECT_EQ(a.degrees, 6);
    EXPECT_EQ(a.off_programmed_mm, 0.75);
    EXPECT_EQ(back->robots.front().collisions, p.robots.front().collisions);
    // What has neither is written as before this was known.
    EXPECT_FALSE(to_json_document(plain().calibrations.front()).contains("nozzle"));
    EXPECT_FALSE(to_json_document(plain().robots.front()).contains("collisions"));
}

TEST(Collision, WhatIsOlderIsStaleUntilItIsMadeAgain) {
    Project p = with_nozzle(0.05);
    EXPECT_TRUE(nozzle_trouble(p, "R1").empty());
    ASSERT_TRUE(mark_collision(p, "R1", "2026-03-05T00:00:00Z"));
    EXPECT_THAT(nozzle_trouble(p, "R1").english(), HasSubstr("older than the collision of 2026-03-05"));
    Facts facts;
    facts.now_utc = "2026-03-06T00:00:00.000Z";
    const auto item = [&] {
        for (const CheckItem& i : checklist(p, facts))
            if (i.step == CheckStep::calibrations) return i;
        return CheckItem{};
    };
    EXPECT_EQ(item().status, CheckStatus::stale);
    EXPECT_THAT(item().why.english(), HasSubstr("older than the collision"));
    EXPECT_THAT(budget_of(p).remarks, testing::Not(IsEmpty()));
    for (Calibration& c : p.calibrations)
        if (!c.nozzle) c.created_utc = "2026-03-05T12:00:00.000Z";
    EXPECT_THAT(item().why.english(), HasSubstr("nozzle"));
    p.calibrations.back().created_utc = "2026-03-05T12:00:00.000Z";
    EXPECT_TRUE(nozzle_trouble(p, "R1").empty());
    EXPECT_NE(item().why.english().find("older"), 0U);
    ASSERT_TRUE(take_collision_back(p, "R1"));
    EXPECT_TRUE(p.robots.front().collisions.empty());
}

TEST(Collision, IsRefusedInOneSentence) {
    Project p = plain();
    EXPECT_THAT(mark_collision(p, "R9", "").error().sentence(), HasSubstr("R9"));
    EXPECT_THAT(mark_collision(p, "R1", "yesterday").error().sentence(), HasSubstr("no date"));
    EXPECT_THAT(mark_collision(p, "R1", "2926-03-05T00:00:00Z").error().sentence(), HasSubstr("future"));
    EXPECT_THAT(take_collision_back(p, "R1").error().sentence(), HasSubstr("no collision"));
    ASSERT_TRUE(mark_collision(p, "R1", "2026-03-05T00:00:00Z"));
    EXPECT_THAT(mark_collision(p, "R1", "2026-03-04T00:00:00Z").error().sentence(), HasSubstr("later"));
    EXPECT_TRUE(before_collision("no date", "2026-03-05T00:00:00Z"));
    EXPECT_TRUE(before_collision(kBefore, "no date"));
    EXPECT_FALSE(before_collision("no date", ""));
}

TEST(NozzleInTheProject, AnswersBecomeRecordsThatHoldTheTip) {
    const CalibrationMethod& method = *find_method("nozzle");
    const auto data = method.example();
    const auto solution = solve_calibration(method, data, {});
    ASSERT_TRUE(solution) << solution.error().sentence();
    const auto c = calibration_of_solution(method, data, {}, *solution, nullptr);
    ASSERT_TRUE(c);
    ASSERT_TRUE(c->nozzle);
    EXPECT_NEAR(nozzle_sigma_mm(*c), solution->document["sigma"]["worst_mm"].get<double>(), 1e-9);
    EXPECT_NEAR(c->nozzle->degrees, solution->document["degrees"].get<double>(), 1e-9);
}

TEST(NozzleInTheProject, TheCheckFindsACovarianceThatIsNone) {
    Project p = with_nozzle(0.05);
    const auto before = check(p).size();
    p.calibrations.back().nozzle->covariance_mm2(0, 0) = -1;
    p.robots.front().collisions = {"soon"};
    EXPECT_EQ(check(p).size(), before + 2);
}

}  // namespace
}  // namespace seamwright
