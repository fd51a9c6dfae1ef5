// Control charts: the tables' constants, each of Nelson's rules alone, subgroups.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/acceptance/stability.h"

namespace seamwright {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::pair<std::size_t, int>> fired(const std::vector<double>& z) {
    std::vector<std::pair<std::size_t, int>> out;
    for (const StabilityAlarm& a : nelson_rules(z, 0, 1)) out.emplace_back(a.subgroup, a.rule);
    return out;
}

// ISO 7870-2 and any table of control charts.
TEST(Stability, ConstantsOfTheTables) {
    EXPECT_NEAR(c4(2), 0.7979, 5e-5);
    EXPECT_NEAR(c4(5), 0.9400, 5e-5);
    EXPECT_NEAR(c4(10), 0.9727, 5e-5);
    EXPECT_NEAR(c4(25), 0.9896, 5e-5);
    // A3, B3, B4 of n = 5 and n = 10: 1.427, 0, 2.089; 0.975, 0.284, 1.716
    for (const auto& [n, a3, b3, b4] : {std::tuple{5, 1.427, 0.0, 2.089}, {10, 0.975, 0.284, 1.716}}) {
        std::vector<Subgroup> groups;
        for (int g = 0; g < 20; ++g) {
            Subgroup group{g, {}};
            for (int i = 0; i < n; ++i) group.values_mm.push_back(7 + (i - (n - 1) / 2.0) + 0.1 * (g % 2));
            groups.push_back(group);
        }
        const auto r = stability_study(groups);
        ASSERT_TRUE(r);
        EXPECT_NEAR((r->mean_chart.high - r->centre_mm) / r->mean_s_mm, a3, 5e-4);
        EXPECT_NEAR(r->s_chart.low / r->mean_s_mm, b3, 5e-4);
        EXPECT_NEAR(r->s_chart.high / r->mean_s_mm, b4, 5e-4);
    }
}

TEST(Stability, EachRuleAlone) {
    EXPECT_THAT(fired({0.5, -0.5, 3.1, -0.4}), ElementsAre(std::pair(2u, 1)));
    EXPECT_THAT(fired({0.5, -0.5, -3.1}), ElementsAre(std::pair(2u, 1)));
    EXPECT_THAT(fired({0.5, -0.4, 3.0}), IsEmpty());  // at the limit is within
    EXPECT_THAT(fired({-1, .2, .5, .1, .6, .3, .8, .2, .1, .4}), ElementsAre(std::pair(9u, 2)));
    EXPECT_THAT(fired({-.5, .3, -1.2, -.8, -.4, .1, .5, .9}), ElementsAre(std::pair(7u, 3)));
    EXPECT_THAT(fired({1.2, .8, .4, -.1, -.5, -.9}), ElementsAre(std::pair(5u, 3)));
    // fourteen points, alternating
    EXPECT_THAT(fired({.2, 1.2, -.3, .6, -1.4, .1, -.2, 1.3, -.1, .4, -1.3, .6, -.5, 1.1}),
                ElementsAre(std::pair(13u, 4)));
    EXPECT_THAT(fired({.2, 2.1, -.3, 2.2}), ElementsAre(std::pair(3u, 5)));
    EXPECT_THAT(fired({.2, 2.1, -.3, -2.2}), IsEmpty());  // on different sides
    EXPECT_THAT(fired({-1.1, -1.3, .2, -1.4, -1.2}), ElementsAre(std::pair(4u, 6)));
    std::vector<double> near;
    for (int i = 0; i < 15; ++i) near.push_back(std::sin(2.5 * i) * 0.9);
    near[3] = near[2] + 0.01;  // not alternating
    EXPECT_THAT(fired(near), ElementsAre(std::pair(14u, 7)));
    EXPECT_THAT(fired({1.1, -1.2, -1.3, 1.4, 1.1, -1.5, -1.2, 1.3}), ElementsAre(std::pair(7u, 8)));
}

// What the header says of false alarms: charts of 25 means that stand still.
TEST(Stability, FalseAlarms) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    const int charts = 4000;
    int first = 0, any = 0;
    for (int chart = 0; chart < charts; ++chart) {
        std::vector<double> z(25);
        for (double& v : z) v = normal(random);
        const auto alarms = nelson_rules(z, 0, 1);
        any += !alarms.empty();
        first +=
            std::any_of(alarms.begin(), alarms.end(), [](const StabilityAlarm& a) { return a.rule == 1; });
    }
    EXPECT_NEAR(first / static_cast<double>(charts), 0.065, 0.012);
    EXPECT_NEAR(any / static_cast<double>(charts), 0.26, 0.05);
}

TEST(Stability, NamesRunAndRule) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal(5, 0.1);
    std::vector<StudyValue> values;
    for (long run = 1; run <= 125; ++run)
        values.push_back({"M", "1", run, normal(random) + (run > 100 && run <= 105 ? 0.3 : 0), {}, {}});
    const auto groups = subgroups_of(values, 5);
    ASSERT_TRUE(groups);
    ASSERT_EQ(groups->groups.size(), 25u);
    EXPECT_EQ(groups->left_out, 0);
    const auto r = stability_study(groups->groups);
    ASSERT_TRUE(r);
    ASSERT_FALSE(r->alarms.empty());
    EXPECT_TRUE(std::any_of(r->alarms.begin(), r->alarms.end(),
                            [](const StabilityAlarm& a) { return a.run == 105 && a.rule == 1; }));
    EXPECT_EQ(r->verdict, AcceptanceVerdict::not_ok);
}

TEST(Stability, RunsOfSeveralValuesAreSubgroups) {
    std::vector<StudyValue> values;
    for (long run = 3; run >= 1; --run)
        for (const char* rehang : {"a", "b"}) values.push_back({"M", rehang, run, 0.1 * run, {}, {}});
    auto groups = subgroups_of(values, 5);
    ASSERT_TRUE(groups);
    ASSERT_EQ(groups->groups.size(), 3u);
    EXPECT_EQ(groups->groups[0].run, 1);
    EXPECT_EQ(groups->groups[0].values_mm.size(), 2u);
    values.pop_back();
    EXPECT_FALSE(subgroups_of(values, 5));
    EXPECT_FALSE(subgroups_of(values, 0));
}

}  // namespace
}  // namespace seamwright
