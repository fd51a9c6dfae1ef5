// How often quiet points alarm: the stated rates, counted. The generator is its own.

#include <gtest/gtest.h>

#include <random>

#include "core/statistics/drift_chart.h"

namespace seamwright {
namespace {

TEST(DriftChartRates, QuietPointsAlarmNoMoreOftenThanStated) {
    std::mt19937_64 rng(77);
    std::normal_distribution<double> noise(0, 0.02);
    constexpr int kLearnings = 100, kPoints = 300;
    int points = 0, steps = 0, starts = 0, rules = 0;
    for (int k = 0; k < kLearnings; ++k) {
        std::vector<DriftLearning> learning;
        std::vector<std::vector<double>> rows;
        for (int i = 0; i < 30; ++i) learning.push_back({{noise(rng), noise(rng)}, 20.0 * i, -1});
        const auto chart = learn_drift(learning);
        ASSERT_TRUE(chart) << chart.error().sentence();
        ASSERT_EQ(chart->time_constant_s, 0);
        const std::vector<DriftChannel> channels{{chart->sigma_mm[0], 0}, {chart->sigma_mm[1], 0}};
        for (const DriftLearning& p : learning)
            rows.push_back({p.values_mm[0] - chart->mean_mm[0], p.values_mm[1] - chart->mean_mm[1]});
        bool before = false;
        for (int i = 0; i < kPoints; ++i) {
            rows.push_back({noise(rng) - chart->mean_mm[0], noise(rng) - chart->mean_mm[1]});
            const auto said =
                judge_drift(std::span(rows).last(std::min<std::size_t>(rows.size(), kDriftWindow)), channels,
                            {.degrees = chart->degrees});
            ASSERT_TRUE(said);
            ++points;
            const bool now = said->change != DriftChange::none;
            steps += said->change == DriftChange::step && !before;
            starts += now && !before;
            before = now;
            for (const DriftRule& rule : said->rules)
                rules += rule.rule == 1 || rule.rule == 2 || rule.rule == 5 || rule.rule == 6;
        }
    }
    RecordProperty("points", points);
    RecordProperty("changes", starts);
    RecordProperty("steps", steps);
    // 30000 points: at 1e-4 three changes are expected, at 1e-5 0.3 steps; beyond these counts at most 1 in 300 times.
    EXPECT_LE(starts, 9);
    EXPECT_LE(steps, 2);
    // Of two directions, a rule each 50 points or so; a wrong mean or sigma of 30 points doubles it.
    EXPECT_GT(rules, points / 100);
    EXPECT_LT(rules, points / 10);
}

}  // namespace
}  // namespace seamwright
