// Capability, EWMA and trend: known answers and laws.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/statistics/capability.h"
#include "core/statistics/ewma.h"
#include "core/statistics/trend.h"

namespace seamwright {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

std::vector<double> normal_values(unsigned seed, int n, double mean = 0, double s = 1) {
    std::mt19937 rng(seed);
    std::normal_distribution<double> draw(mean, s);
    std::vector<double> out;
    for (int i = 0; i < n; ++i) out.push_back(draw(rng));
    return out;
}

// Mean 3, s sqrt(2.5); limits 0 and 10: Pp = 10 / (6 s), Ppk = 3 / (3 s).
TEST(Capability, IndicesByHand) {
    const double values[] = {1, 5, 2, 4, 3};
    const auto r = summarise_process(values, {0.0, 10.0});
    ASSERT_TRUE(r);
    const double s = std::sqrt(2.5);
    EXPECT_EQ(r->n, 5);
    EXPECT_DOUBLE_EQ(r->mean, 3);
    EXPECT_DOUBLE_EQ(r->median, 3);
    EXPECT_NEAR(r->s, s, 1e-15);
    EXPECT_NEAR(r->sigma_within, (4 + 3 + 2 + 1) / 4.0 / 1.128, 1e-15);
    EXPECT_NEAR(r->total.spread->value, 10 / (6 * s), 1e-14);
    EXPECT_NEAR(r->total.worst_side->value, 3 / (3 * s), 1e-14);
    // s is uncertain by chi-square of 4: 0.4844 and 11.1433 are its 2.5 % and 97.5 % quantiles.
    EXPECT_NEAR(r->total.spread->limits.low, 10 / (6 * s) * std::sqrt(0.484419 / 4), 1e-5);
    EXPECT_NEAR(r->total.spread->limits.high, 10 / (6 * s) * std::sqrt(11.143287 / 4), 1e-5);
    EXPECT_EQ(r->beyond, 0);
    EXPECT_FALSE(r->normal_p);
}

// Montgomery, Introduction to Statistical Quality Control, example 8.4 and 8.5: n = 20, Cpk 1.33: 0.88 to 1.78 by
// Bissell's formula.
TEST(Capability, BissellsLimitsAsPublished) {
    const int n = 20;
    std::vector<double> values;
    for (int i = 0; i < n; ++i) values.push_back(i % 2 ? 1.0 : -1.0);
    const double s = std::sqrt(n / (n - 1.0));
    const auto r = summarise_process(values, {std::nullopt, 1.33 * 3 * s});
    ASSERT_TRUE(r);
    EXPECT_FALSE(r->total.spread);
    EXPECT_NEAR(r->total.worst_side->value, 1.33, 1e-12);
    EXPECT_NEAR(r->total.worst_side->limits.low, 0.88, 0.01);
    EXPECT_NEAR(r->total.worst_side->limits.high, 1.78, 0.01);
}

TEST(Capability, ShiftsAndScalesAsItMust) {
    const auto values = normal_values(1, 200);
    std::vector<double> other;
    for (const double v : values) other.push_back(7 + 3 * v);
    const auto a = summarise_process(values, {-4.0, 5.0});
    const auto b = summarise_process(other, {7 - 12.0, 7 + 15.0});
    ASSERT_TRUE(a && b);
    EXPECT_NEAR(a->total.worst_side->value, b->total.worst_side->value, 1e-12);
    EXPECT_NEAR(a->within.spread->limits.low, b->within.spread->limits.low, 1e-12);
    EXPECT_NEAR(a->correlation, b->correlation, 1e-12);
    EXPECT_NEAR(*a->normal_p, *b->normal_p, 1e-9);
}

TEST(Capability, WhatIsNotNormalIsSaid) {
    EXPECT_FALSE(summarise_process(normal_values(2, 2000), {})->not_normal());
    std::vector<double> skew;
    for (const double v : normal_values(3, 2000)) skew.push_back(std::exp(v / 2));
    const auto r = summarise_process(skew, {0.0, 10.0});
    EXPECT_TRUE(r->not_normal());
    // Of a lognormal the quantiles are known: exp(3 / 2) and exp(-3 / 2) about exp(0).
    ASSERT_TRUE(r->by_quantiles);
    EXPECT_NEAR(r->by_quantiles->worst_side->value, 1 / (1 - std::exp(-1.5)), 0.1);
}

// Lag-1 correlation 0.8: 1000 values hold of the mean what 111 independent ones do.
TEST(Capability, LimitsWidenWhereNeighboursAreAlike) {
    std::mt19937 rng(4);
    std::normal_distribution<double> draw;
    std::vector<double> values;
    double x = 0;
    for (int i = 0; i < 1000; ++i) values.push_back(x = 0.8 * x + 0.6 * draw(rng));
    const auto r = summarise_process(values, {-5.0, 5.0});
    EXPECT_TRUE(r->correlated);
    const double half = (r->mean_limits.high - r->mean_limits.low) / 2;
    EXPECT_NEAR(half / (1.96 * r->s / std::sqrt(1000.0)), 3, 0.5);
    EXPECT_GT(r->within.worst_side->value, 1.5 * r->total.worst_side->value);
}

TEST(Capability, HostileInputIsRefused) {
    EXPECT_FALSE(summarise_process({}, {}));
    for (const double bad : {kNan, kInfinite})
        EXPECT_FALSE(summarise_process(std::vector<double>{1, bad, 2}, {}));
    const double values[] = {1, 2, 3};
    EXPECT_FALSE(summarise_process(values, {kNan, 1.0}));
    EXPECT_FALSE(summarise_process(values, {1.0, 1.0}));
    EXPECT_FALSE(summarise_process(values, {2.0, 1.0}));
    // No scatter: no index, and no infinite one.
    const auto same = summarise_process(std::vector<double>(100, 0.25), {0.0, 1.0});
    ASSERT_TRUE(same);
    EXPECT_FALSE(same->total.spread || same->total.worst_side || same->normal_p);
    const auto one = summarise_process(std::vector<double>{4}, {0.0, 1.0});
    ASSERT_TRUE(one);
    EXPECT_EQ(one->beyond, 1);
    EXPECT_FALSE(one->total.worst_side);
}

TEST(Ewma, ByHand) {
    const double values[] = {1, 2, -1};
    const auto r = ewma_chart(values, 0, 1, {0.5, 3});
    ASSERT_TRUE(r);
    EXPECT_THAT(r->z, testing::ElementsAre(0.5, 1.25, 0.125));
    EXPECT_NEAR(r->half_width[0], 3 * 0.5, 1e-14);  // of one value: lambda sigma
    EXPECT_NEAR(r->half_width[2], 3 * std::sqrt(1 / 3.0 * (1 - 1 / 64.0)), 1e-14);
    EXPECT_TRUE(r->beyond.empty());
    EXPECT_FALSE(ewma_chart(values, 0, 0));
    EXPECT_FALSE(ewma_chart(values, 0, 1, {0, 3}));
    EXPECT_FALSE(ewma_chart(values, 0, 1, {0.2, kNan}));
    EXPECT_FALSE(ewma_chart(std::vector<double>{kNan}, 0, 1));
}

TEST(Trend, LineAndCrossingByHand) {
    std::vector<double> days, values;
    for (int i = 0; i <= 20; ++i) {
        days.push_back(100 + i);
        values.push_back(0.1 * i + (i % 2 ? 0.01 : -0.01));
    }
    auto t = trend_of(days, values, {-5.0, 3.0});
    ASSERT_TRUE(t && *t);
    EXPECT_NEAR((*t)->slope_per_day, 0.1, 1e-3);
    EXPECT_TRUE((*t)->significant);
    ASSERT_TRUE((*t)->crossing);
    EXPECT_TRUE((*t)->crossing->upper);
    EXPECT_NEAR((*t)->crossing->days, 10, 0.1);
    EXPECT_LE((*t)->crossing->earliest_days, (*t)->crossing->days);
    EXPECT_GE(*(*t)->crossing->latest_days, (*t)->crossing->days);
    // Further ahead than three times what was seen, nothing is told.
    t = trend_of(days, values, {-5.0, 9.0});
    EXPECT_TRUE((*t)->significant);
    EXPECT_FALSE((*t)->crossing);
    // Falling, and beyond already.
    for (double& v : values) v = -v;
    t = trend_of(days, values, {-1.0, 3.0});
    EXPECT_FALSE((*t)->crossing->upper);
    EXPECT_NEAR((*t)->crossing->days, -10, 0.1);
    EXPECT_LE((*t)->crossing->earliest_days, (*t)->crossing->days);
    EXPECT_GE(*(*t)->crossing->latest_days, (*t)->crossing->days);
}

TEST(Trend, NoTrendOfFewNoneOfOneInstantNoneOfChance) {
    const std::vector<double> days(20, 1), values(20, 1);
    EXPECT_FALSE(*trend_of(days, values, {}));
    EXPECT_FALSE(*trend_of(std::vector<double>{1, 2, 3}, std::vector<double>{1, 2, 3}, {}));
    std::vector<double> ascending(20);
    for (std::size_t i = 0; i < 20; ++i) ascending[i] = static_cast<double>(i);
    EXPECT_FALSE((*trend_of(ascending, values, {}))->significant);
    EXPECT_FALSE(trend_of(ascending, std::vector<double>(19, 1), {}));
    std::vector<double> back = ascending;
    back[5] = 2;
    EXPECT_FALSE(trend_of(back, values, {}));
    back[5] = kNan;
    EXPECT_FALSE(trend_of(back, values, {}));
}

}  // namespace
}  // namespace seamwright
