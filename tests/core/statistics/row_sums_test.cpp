// Sums of a row say what its values say, wherever it is cut.

#include "core/statistics/row_sums.h"

#include <gtest/gtest.h>

#include <random>

#include "core/statistics/capability.h"
#include "core/statistics/trend.h"

namespace seamwright {
namespace {

struct Row {
    std::vector<double> days, values;
};

// Of a first order autoregression about a line.
Row row_of(int n, double alike, double slope, double middle, unsigned seed) {
    std::mt19937 rng(seed);
    std::normal_distribution<double> draw;
    Row row;
    double noise = draw(rng);
    for (int i = 0; i < n; ++i) {
        row.days.push_back(i / 1440.0);
        noise = alike * noise + std::sqrt(1 - alike * alike) * draw(rng);
        row.values.push_back(middle + slope * i / 1440.0 + 0.2 * noise);
    }
    return row;
}

void expect_near(const Interval& a, const Interval& b, double by) {
    EXPECT_NEAR(a.low, b.low, by);
    EXPECT_NEAR(a.high, b.high, by);
}

void expect_same(const RowSums& a, const RowSums& b) {
    EXPECT_LT((a.own - b.own).norm(), 1e-9 * (1 + a.own.norm()));
    EXPECT_LT((a.pairs - b.pairs).norm(), 1e-9 * (1 + a.pairs.norm()));
    EXPECT_NEAR(a.ranges, b.ranges, 1e-9 * (1 + a.ranges));
    EXPECT_EQ(a.lowest, b.lowest);
    EXPECT_EQ(a.highest, b.highest);
    EXPECT_EQ(a.first, b.first);
    EXPECT_EQ(a.last, b.last);
}

TEST(RowSums, SummaryAndTrendAreThoseOfTheValues) {
    unsigned seed = 1;
    for (const double alike : {0.0, 0.6, -0.4})
        for (const double slope : {0.0, 0.5})
            for (const double middle : {0.0, 3.5, -120.0})
                for (const int n : {1, 2, 3, 9, 400}) {
                    const Row row = row_of(n, alike, slope, middle, ++seed);
                    const RowSums sums = row_sums(row.days, row.values);
                    for (const ProcessLimits& limits :
                         {ProcessLimits{}, ProcessLimits{middle - 1, middle + 1},
                          ProcessLimits{{}, middle + 1}}) {
                        const auto wanted = summarise_process(row.values, limits);
                        const auto found = summarise_sums(sums, limits);
                        ASSERT_TRUE(wanted && found);
                        EXPECT_EQ(found->n, wanted->n);
                        EXPECT_NEAR(found->mean, wanted->mean, 1e-11);
                        EXPECT_NEAR(found->s, wanted->s, 1e-8);
                        EXPECT_EQ(found->lowest, wanted->lowest);
                        EXPECT_EQ(found->highest, wanted->highest);
                        EXPECT_NEAR(found->sigma_within, wanted->sigma_within, 1e-9);
                        EXPECT_NEAR(found->correlation, wanted->correlation, 1e-7);
                        EXPECT_EQ(found->correlated, wanted->correlated);
                        if (n > 1) expect_near(found->mean_limits, wanted->mean_limits, 1e-6);
                        ASSERT_EQ(found->total.spread.has_value(), wanted->total.spread.has_value());
                        ASSERT_EQ(found->within.worst_side.has_value(),
                                  wanted->within.worst_side.has_value());
                        if (wanted->total.spread) {
                            EXPECT_NEAR(found->total.spread->value / wanted->total.spread->value, 1, 1e-6);
                        }
                        if (wanted->within.worst_side && n > 3) {
                            EXPECT_NEAR(found->within.worst_side->value, wanted->within.worst_side->value,
                                        1e-6);
                            expect_near(found->within.worst_side->limits, wanted->within.worst_side->limits,
                                        1e-5);
                        }
                        const auto line = trend_of(row.days, row.values, limits);
                        const auto by_sums = trend_of(sums, limits);
                        ASSERT_TRUE(line);
                        ASSERT_EQ(by_sums.has_value(), line->has_value());
                        if (!by_sums) continue;
                        EXPECT_NEAR(by_sums->slope_per_day, (*line)->slope_per_day, 1e-5);
                        EXPECT_NEAR(by_sums->level, (*line)->level, 1e-5);
                        EXPECT_NEAR(by_sums->span_days, (*line)->span_days, 1e-12);
                        EXPECT_NEAR(by_sums->residual_s, (*line)->residual_s, 1e-6);
                        EXPECT_NEAR(by_sums->correlation, (*line)->correlation, 1e-4);
                        EXPECT_EQ(by_sums->significant, (*line)->significant);
                        EXPECT_EQ(by_sums->crossing.has_value(), (*line)->crossing.has_value());
                        if (by_sums->crossing) {
                            EXPECT_NEAR(by_sums->crossing->days, (*line)->crossing->days, 1e-4);
                        }
                    }
                }
}

TEST(RowSums, ACutRowGoesOnAsIfItWereWhole) {
    const Row row = row_of(100, 0.5, 0.2, 1, 7);
    const RowSums whole = row_sums(row.days, row.values);
    const std::span days(row.days), values(row.values);
    for (const std::size_t cut : {0U, 1U, 37U, 99U, 100U}) {
        RowSums sums = row_sums(days.first(cut), values.first(cut));
        sums.go_on(row_sums(days.subspan(cut), values.subspan(cut)));
        expect_same(sums, whole);
    }
    // In three, put together from the end.
    RowSums tail = row_sums(days.subspan(20, 30), values.subspan(20, 30));
    tail.go_on(row_sums(days.subspan(50), values.subspan(50)));
    RowSums sums = row_sums(days.first(20), values.first(20));
    sums.go_on(tail);
    expect_same(sums, whole);
}

// Another station lies a millimetre off: that is scatter of all, and none from part to part.
TEST(RowSums, JoinedRowsHaveNoNeighboursInCommon) {
    const Row a = row_of(300, 0, 0, 0, 3), b = row_of(300, 0, 0, 1, 4);
    RowSums both = row_sums(a.days, a.values);
    both.join(row_sums(b.days, b.values));
    EXPECT_EQ(both.values(), 600);
    EXPECT_EQ(both.neighbours(), 598);
    const auto summary = summarise_sums(both, {-3, 4});
    ASSERT_TRUE(summary);
    EXPECT_NEAR(summary->sigma_within, 0.2, 0.02);
    EXPECT_NEAR(summary->s, std::sqrt(0.25 + 0.04), 0.02);
    EXPECT_NEAR(summary->mean, 0.5, 0.02);
}

TEST(RowSums, AnotherOriginOfTimeIsTheSameRow) {
    const Row row = row_of(200, 0.4, 0.5, 2, 9);
    Row later = row;
    for (double& day : later.days) day += 3;
    expect_same(row_sums(row.days, row.values).later_by(3), row_sums(later.days, later.values));
    EXPECT_EQ(RowSums{}.later_by(3).values(), 0);
}

TEST(RowSums, ValuesWithoutScatterHaveNone) {
    const std::vector<double> days{1, 2, 3, 4}, same(4, 0.1);
    const auto summary = summarise_sums(row_sums(days, same), {-1, 1});
    ASSERT_TRUE(summary);
    EXPECT_EQ(summary->s, 0);
    EXPECT_EQ(summary->sigma_within, 0);
    EXPECT_FALSE(summary->total.spread);
}

TEST(RowSums, RefusesWhatIsNoRow) {
    EXPECT_FALSE(summarise_sums({}, {}));
    const std::vector<double> days{1, 2}, wrong{0, std::nan("")};
    EXPECT_FALSE(summarise_sums(row_sums(days, wrong), {}));
    const std::vector<double> fine{0, 1};
    EXPECT_FALSE(summarise_sums(row_sums(days, fine), {1, -1}));
}

}  // namespace
}  // namespace seamwright
