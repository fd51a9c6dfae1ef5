// Laws and known answers of the drift chart. The points come from a generator of its own: no code of the chart's.

#include "core/statistics/drift_chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "core/acceptance/stability.h"

namespace seamwright {
namespace {

constexpr double kSigma = 0.03;

// Rows of two directions; `shift(i)` mm is added to both in their shares.
std::vector<std::vector<double>> rows_of(int n, std::uint64_t seed, const std::function<double(int)>& shift) {
    std::mt19937_64 rng(seed);
    std::normal_distribution<double> noise(0, kSigma);
    std::vector<std::vector<double>> rows;
    for (int i = 0; i < n; ++i) rows.push_back({noise(rng) + shift(i), noise(rng) - 0.4 * shift(i)});
    return rows;
}

std::vector<DriftLearning> learning(const std::vector<std::vector<double>>& rows) {
    std::vector<DriftLearning> points;
    for (const auto& row : rows) points.push_back({row, 20.0 * static_cast<double>(points.size()), -1});
    return points;
}

// Learnt from the first rows, then point after point. Calls `see` with the index of each and what was said.
void watch_rows(const std::vector<std::vector<double>>& rows, int learnt_from,
                const std::function<bool(int, const DriftJudgement&)>& see, double limit_mm = 0.1) {
    const std::vector<std::vector<double>> first(rows.begin(), rows.begin() + learnt_from);
    const auto chart = learn_drift(learning(first));
    ASSERT_TRUE(chart) << chart.error().sentence();
    std::vector<DriftChannel> channels;
    for (const double sigma : chart->sigma_mm) channels.push_back({sigma, kSigma});
    std::vector<std::vector<double>> residuals;
    for (int i = 0; i < static_cast<int>(rows.size()); ++i) {
        residuals.push_back(rows[static_cast<std::size_t>(i)]);
        for (std::size_t d = 0; d < 2; ++d)
            residuals.back()[d] -=
                chart->mean_mm[d] + cold_share(20.0 * i, -1, chart->time_constant_s) * chart->warm_up_mm[d];
        if (i < learnt_from) continue;
        const std::size_t from = residuals.size() > 100 ? residuals.size() - 100 : 0;
        const auto said = judge_drift(std::span(residuals).subspan(from), channels,
                                      {.limit_mm = limit_mm, .degrees = chart->degrees});
        ASSERT_TRUE(said) << said.error().sentence();
        if (!see(i - learnt_from, *said)) return;
    }
}

TEST(DriftChart, ABumpIsSeenAtItsFirstPoint) {
    int at_once = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed)
        watch_rows(rows_of(80, seed, [](int i) { return i < 60 ? 0 : 0.36; }), 30,
                   [&](int i, const DriftJudgement& said) {
                       if (i < 30) return true;
                       at_once += said.verdict == DriftVerdict::step && said.jump && said.direction == 0 &&
                                  std::abs(said.size_mm - 0.36) < 0.2;
                       return false;
                   });
    EXPECT_GE(at_once, 196) << "12 sigma";
}

TEST(DriftChart, ASmallStepIsToldFromADrift) {
    int step = 0, drift = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed)
        watch_rows(rows_of(120, 1000 + seed, [](int i) { return i < 60 ? 0 : 7 * kSigma; }), 30,
                   [&](int i, const DriftJudgement& said) {
                       step += said.change == DriftChange::step;
                       drift += said.change == DriftChange::drift;
                       return i < 89 && said.change != DriftChange::step && said.change != DriftChange::drift;
                   });
    EXPECT_GE(step, 190) << "7 sigma, told within 60 points";
    EXPECT_LE(drift, 4);
}

TEST(DriftChart, ADriftIsNamedWithin20PointsAndIsNoStep) {
    for (const double slope : {0.33, 0.5, 1.0}) {  // sigma a point
        int named = 0, step = 0;
        for (std::uint64_t seed = 0; seed < 200; ++seed)
            watch_rows(rows_of(90, 2000 + seed, [&](int i) { return std::max(0, i - 49) * slope * kSigma; }),
                       30, [&](int i, const DriftJudgement& said) {
                           if (said.change == DriftChange::step) ++step;
                           if (said.change == DriftChange::drift && i < 40) ++named;
                           return i < 39 && said.change != DriftChange::step &&
                                  said.change != DriftChange::drift;
                       });
        EXPECT_GE(named, 190) << slope;
        EXPECT_LE(step, 3) << slope;
    }
}

// Up within 8 points, 7 points there, back within 13: whatever it was, once it is back nothing was knocked.
TEST(DriftChart, WhatHasComeBackIsNoStep) {
    int step = 0;
    const auto shift = [](int i) {
        if (i < 60) return 0.0;
        if (i < 68) return 12 * kSigma * (i - 59) / 8.0;
        return i < 75 ? 12 * kSigma : std::max(0.0, 12 * kSigma * (1 - (i - 74) / 13.0));
    };
    for (std::uint64_t seed = 0; seed < 200; ++seed)
        watch_rows(rows_of(140, 4000 + seed, shift), 30, [&](int i, const DriftJudgement& said) {
            const bool wrong = i + 30 >= 84 && said.change == DriftChange::step;
            step += wrong;
            return !wrong;
        });
    EXPECT_LE(step, 2) << "of 200, from a third of the way that is left on";
}

// A machine that warms up: fast at first, then at rest. From its beginning to its end no step is seen.
TEST(DriftChart, AWarmUpThatNobodyLearntIsADriftToItsEnd) {
    int named = 0, step = 0;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        bool was_named = false;
        watch_rows(rows_of(200, 3000 + seed,
                           [](int i) { return i < 50 ? 0 : 0.4 * (1 - std::exp(-(i - 49) / 12.0)); }),
                   30, [&](int i, const DriftJudgement& said) {
                       was_named = was_named || (i < 40 && said.change == DriftChange::drift);
                       step += said.verdict == DriftVerdict::step;
                       return said.verdict != DriftVerdict::step;
                   });
        named += was_named;
    }
    EXPECT_GE(named, 97);
    EXPECT_LE(step, 2) << "of 100 warm-ups of 13 sigma with a time constant of 12 points";
}

TEST(DriftChart, BeyondItsLimitItSaysRecalibrate) {
    DriftVerdict last = DriftVerdict::fine;
    watch_rows(rows_of(90, 4, [](int i) { return std::max(0, i - 49) * 0.01; }), 30,
               [&](int, const DriftJudgement& said) {
                   last = said.verdict;
                   return true;
               });
    EXPECT_EQ(last, DriftVerdict::recalibrate) << "0.4 mm away, limit 0.1";
}

TEST(DriftChart, TheWarmUpIsLearntAndTakenOff) {
    const double tau = 400;
    const auto cold = [&](int i) { return 0.3 * std::exp(-20.0 * i / tau); };
    const auto chart = learn_drift(learning(rows_of(120, 5, cold)));
    ASSERT_TRUE(chart) << chart.error().sentence();
    EXPECT_NEAR(chart->warm_up_mm[0], 0.3, 0.05);
    EXPECT_NEAR(chart->warm_up_mm[1], -0.12, 0.05);
    EXPECT_NEAR(chart->time_constant_s, tau, 120);
    EXPECT_NEAR(chart->sigma_mm[0], kSigma, 0.01);
    EXPECT_NEAR(chart->mean_mm[0], 0, 0.02);
    // After a pause as long as the time constant 63 % of it are there again.
    EXPECT_NEAR(cold_share(0, tau, tau), 1 - std::exp(-1), 1e-12);
    EXPECT_EQ(cold_share(0, -1, tau), 1);
    EXPECT_EQ(cold_share(0, 0, tau), 0);
    EXPECT_EQ(cold_share(100, -1, 0), 0);

    const auto unfinished = learn_drift(learning(rows_of(30, 6, cold)));
    ASSERT_FALSE(unfinished) << "it still moves";
    const auto quiet = learn_drift(learning(rows_of(60, 7, [](int) { return 0; })));
    ASSERT_TRUE(quiet);
    EXPECT_EQ(quiet->time_constant_s, 0) << "no curve where there is none";
}

TEST(DriftChart, AStepAmongThePointsIsNotLearnt) {
    const auto knocked = learn_drift(learning(rows_of(60, 8, [](int i) { return i < 30 ? 0.0 : 0.4; })));
    EXPECT_FALSE(knocked);
}

TEST(DriftChart, NelsonsRulesAreThoseOfTheStudy) {
    std::vector<std::vector<double>> rows(12, {0, 0});
    for (std::size_t i = 3; i < 12; ++i) rows[i][1] = 0.5 * kSigma;  // nine on one side
    const std::vector<DriftChannel> channels(2, {kSigma, kSigma});
    const auto said = judge_drift(rows, channels);
    ASSERT_TRUE(said);
    bool second = false;
    for (const DriftRule& rule : said->rules) second = second || (rule.direction == 1 && rule.rule == 2);
    EXPECT_TRUE(second);
    EXPECT_EQ(said->verdict, DriftVerdict::watch);
}

TEST(DriftChart, HostileInputIsRefused) {
    const std::vector<DriftChannel> channels(1, {kSigma, kSigma});
    const auto refused = [&](std::vector<std::vector<double>> rows, std::vector<DriftChannel> c,
                             DriftChartOptions o = {}) { return !judge_drift(rows, c, o).has_value(); };
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                     inf = std::numeric_limits<double>::infinity();
    EXPECT_TRUE(refused({}, channels));
    EXPECT_TRUE(refused({{0}}, {}));
    EXPECT_TRUE(refused({{0, 1}}, channels));
    EXPECT_TRUE(refused({{nan}}, channels));
    EXPECT_TRUE(refused({{inf}}, channels));
    EXPECT_TRUE(refused({{0}}, {{0, 0}}));
    EXPECT_TRUE(refused({{0}}, {{nan, 0}}));
    EXPECT_TRUE(refused({{0}}, channels, {.limit_mm = 0}));
    EXPECT_TRUE(refused({{0}}, channels, {.degrees = nan}));
    EXPECT_TRUE(refused({{0}}, channels, {.step_chance = 0}));
    EXPECT_FALSE(refused({{0}}, channels)) << "one point";
    EXPECT_FALSE(refused({{1e9}}, channels));
    EXPECT_FALSE(learn_drift({}));
    EXPECT_FALSE(learn_drift(learning(rows_of(19, 1, [](int) { return 0; }))));
    auto points = learning(rows_of(30, 1, [](int) { return 0; }));
    points[3].values_mm.pop_back();
    EXPECT_FALSE(learn_drift(points));
    points = learning(rows_of(30, 1, [](int) { return 0; }));
    points[3].running_s = nan;
    EXPECT_FALSE(learn_drift(points));
    const auto still = learn_drift(learning(std::vector<std::vector<double>>(30, {1.0, 2.0})));
    ASSERT_TRUE(still) << still.error().sentence();
    EXPECT_NEAR(still->sigma_mm[0], 1e-3, 2e-4);
}

}  // namespace
}  // namespace seamwright
