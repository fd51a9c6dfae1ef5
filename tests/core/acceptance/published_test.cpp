// Published worked examples to their printed digits, and closed forms computed here from first principles where
// none is published.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/acceptance/correlation.h"
#include "core/acceptance/linearity.h"
#include "core/acceptance/process_uncertainty.h"
#include "core/acceptance/type1.h"
#include "core/acceptance/type3.h"

namespace seamwright {
namespace {

std::vector<StudyValue> nested(const std::vector<std::vector<std::vector<double>>>& parts) {
    std::vector<StudyValue> out;
    for (std::size_t p = 0; p < parts.size(); ++p)
        for (std::size_t h = 0; h < parts[p].size(); ++h)
            for (std::size_t n = 0; n < parts[p][h].size(); ++n)
                out.push_back(
                    {std::to_string(p), std::to_string(h), static_cast<long>(n + 1), parts[p][h][n], {}, {}});
    return out;
}

// AIAG MSA 4th edition, bias study: 15 measurements of a part of reference 6.00.
TEST(Published, AiagBias) {
    const std::vector<double> values{5.8, 5.7, 5.9, 5.9, 6.0, 6.1, 6.0, 6.1,
                                     6.4, 6.3, 6.0, 6.1, 6.2, 5.6, 6.0};
    const auto r = type1_study(values, 6.0, {5.0});
    ASSERT_TRUE(r);
    EXPECT_NEAR(r->mean_mm, 6.0067, 5e-5);
    EXPECT_NEAR(r->s_mm, 0.2120, 5e-5);
    EXPECT_NEAR(r->bias_mm, 0.0067, 5e-5);
    EXPECT_NEAR(r->s_mm / std::sqrt(15.0), 0.0547, 5e-5);
    EXPECT_NEAR(r->t, 0.1218, 5e-5);
    EXPECT_NEAR(r->bias_limits.low, -0.1107, 5e-5);
    EXPECT_NEAR(r->bias_limits.high, 0.1241, 5e-5);
    EXPECT_EQ(r->verdict, AcceptanceVerdict::too_little_data);
}

// Cg and Cgk of a sample that has mean 10.01 and s = 0.1 exactly; chi-square quantiles of 49 degrees from tables:
// 31.5549 and 70.2224.
TEST(Published, CgOfAKnownSample) {
    std::vector<double> values;
    const double a = 0.1 * std::sqrt(49.0 / 50.0);
    for (int i = 0; i < 25; ++i) values.insert(values.end(), {10.01 - a, 10.01 + a});
    const auto r = type1_study(values, 10.0, {6.0});
    ASSERT_TRUE(r);
    EXPECT_NEAR(r->s_mm, 0.1, 1e-12);
    EXPECT_NEAR(r->cg, 0.2 * 6 / (6 * 0.1), 1e-9);
    EXPECT_NEAR(r->cgk, (0.1 * 6 - 0.01) / (3 * 0.1), 1e-9);
    EXPECT_NEAR(r->s_limits.low, 0.1 * std::sqrt(49 / 70.2224), 1e-6);
    EXPECT_NEAR(r->s_limits.high, 0.1 * std::sqrt(49 / 31.5549), 1e-6);
    EXPECT_NEAR(r->cg_limits.low, 2 * std::sqrt(31.5549 / 49), 1e-5);
    EXPECT_NEAR(r->cg_limits.high, 2 * std::sqrt(70.2224 / 49), 1e-5);
    // Bissell (1990): Cgk -+ 1.96 sqrt(1 / 9n + Cgk^2 / 2(n - 1)), first order
    const double by = 1.96 * std::sqrt(1 / 450.0 + r->cgk * r->cgk / 98);
    EXPECT_NEAR(r->cgk_limits.low, r->cgk - by, 0.02);
    EXPECT_NEAR(r->cgk_limits.high, r->cgk + by, 0.02);
    EXPECT_EQ(r->verdict, AcceptanceVerdict::ok);
    // The variant of other companies: 0.15 and 4 s.
    const auto other = type1_study(values, 10.0, {6.0, 0.15, 4});
    ASSERT_TRUE(other);
    EXPECT_NEAR(other->cg, 0.15 * 6 / (4 * 0.1), 1e-9);
    EXPECT_NEAR(other->cgk, (0.075 * 6 - 0.01) / (2 * 0.1), 1e-9);
}

// AIAG MSA 4th edition, linearity study: 5 parts, 12 trials each.
TEST(Published, AiagLinearity) {
    const std::vector<std::pair<double, std::vector<double>>> data{
        {2, {2.7, 2.5, 2.4, 2.5, 2.7, 2.3, 2.5, 2.5, 2.4, 2.4, 2.6, 2.4}},
        {4, {5.1, 3.9, 4.2, 5.0, 3.8, 3.9, 3.9, 3.9, 3.9, 4.0, 4.1, 3.8}},
        {6, {5.8, 5.7, 5.9, 5.9, 6.0, 6.1, 6.0, 6.1, 6.4, 6.3, 6.0, 6.1}},
        {8, {7.6, 7.7, 7.8, 7.7, 7.8, 7.8, 7.8, 7.7, 7.8, 7.5, 7.6, 7.7}},
        {10, {9.1, 9.3, 9.5, 9.3, 9.4, 9.5, 9.5, 9.5, 9.6, 9.2, 9.3, 9.4}}};
    std::vector<StudyValue> values;
    for (const auto& [reference, of] : data)
        for (std::size_t i = 0; i < of.size(); ++i)
            values.push_back({std::to_string(reference), "1", static_cast<long>(i), of[i], reference, {}});
    const auto r = linearity_study(values);
    ASSERT_TRUE(r);
    EXPECT_NEAR(r->line.slope, -0.131667, 5e-7);
    EXPECT_NEAR(r->line.intercept, 0.736667, 5e-7);
    EXPECT_NEAR(r->line.s, 0.23954, 5e-6);
    EXPECT_NEAR(r->line.r2, 0.714, 5e-4);
    EXPECT_NEAR(r->line.t_slope, -12.043, 5e-4);
    EXPECT_NEAR(r->line.t_intercept, 10.158, 5e-4);
    const std::vector<double> biases{0.491667, 0.125, 0.025, -0.29167, -0.61667};
    ASSERT_EQ(r->levels.size(), biases.size());
    for (std::size_t i = 0; i < biases.size(); ++i) EXPECT_NEAR(r->levels[i].bias_mm, biases[i], 5e-6);
    EXPECT_FALSE(r->zero_inside);
    EXPECT_EQ(r->verdict, AcceptanceVerdict::not_ok);
}

// Montgomery, Design and Analysis of Experiments: four looms, four pieces of fabric each. Random effects; the
// share of the looms' variance lies in [0.385, 0.982].
TEST(Published, MontgomeryLooms) {
    const auto values =
        nested({{{98, 97, 99, 96}}, {{91, 90, 93, 92}}, {{96, 95, 97, 95}}, {{95, 96, 99, 98}}});
    const auto r = type3_study(values, {10.0});
    ASSERT_TRUE(r);
    ASSERT_EQ(r->anova.size(), 3u);
    EXPECT_NEAR(r->anova[0].ss, 89.19, 5e-3);
    EXPECT_NEAR(r->anova[0].ms, 29.73, 5e-3);
    EXPECT_NEAR(r->anova[1].ss, 22.75, 5e-3);
    EXPECT_NEAR(r->anova[1].ms, 1.90, 5e-3);
    EXPECT_EQ(r->anova[1].df, 12);
    EXPECT_NEAR(r->anova[2].ss, 111.94, 5e-3);
    EXPECT_NEAR(r->pv_mm * r->pv_mm, 6.96, 5e-3);
    // share of the parts = 1 - (GRR / TV)^2
    EXPECT_NEAR(1 - std::pow(r->total_limits.high / 100, 2), 0.385, 1e-3);
    EXPECT_NEAR(1 - std::pow(r->total_limits.low / 100, 2), 0.982, 1e-3);
    EXPECT_EQ(r->verdict, AcceptanceVerdict::too_little_data);  // four parts
}

// Box, Hunter and Hunter, Statistics for Experimenters: pigment paste, 15 batches, 2 samples each, 2 tests each:
// variances 7.1 (batches), 28.5 (samples), 0.92 (tests).
TEST(Published, PigmentPaste) {
    const auto values = nested({{{40, 39}, {30, 30}},
                                {{26, 28}, {25, 26}},
                                {{29, 28}, {14, 15}},
                                {{30, 31}, {24, 24}},
                                {{19, 20}, {17, 17}},
                                {{33, 32}, {26, 24}},
                                {{23, 24}, {32, 33}},
                                {{34, 34}, {29, 29}},
                                {{27, 27}, {31, 31}},
                                {{13, 16}, {27, 24}},
                                {{25, 23}, {25, 27}},
                                {{29, 29}, {31, 32}},
                                {{19, 20}, {29, 30}},
                                {{23, 24}, {25, 25}},
                                {{39, 37}, {26, 28}}});
    const auto r = type3_study(values, {150.0});
    ASSERT_TRUE(r);
    ASSERT_EQ(r->anova.size(), 4u);
    EXPECT_NEAR(r->anova[0].ms, 86.495, 5e-4);
    EXPECT_NEAR(r->anova[1].ms, 57.983, 5e-4);
    EXPECT_NEAR(r->anova[2].ms, 0.917, 5e-4);
    EXPECT_EQ(r->anova[0].df, 14);
    EXPECT_EQ(r->anova[1].df, 15);
    EXPECT_EQ(r->anova[2].df, 30);
    EXPECT_NEAR(r->ev_mm * r->ev_mm, 0.92, 5e-3);
    EXPECT_NEAR(r->rehang_mm * r->rehang_mm, 28.5, 0.05);
    EXPECT_NEAR(r->pv_mm * r->pv_mm, 7.1, 0.05);
    EXPECT_EQ(r->ndc, 0);
    EXPECT_NEAR(r->grr_percent_tolerance, 100 * 6 * 5.426 / 150, 0.01);
    EXPECT_EQ(r->verdict, AcceptanceVerdict::conditional);
}

TEST(Type3, NegativeComponentsAreZeroAndSaid) {
    // Parts that agree better than their repeats let expect.
    const auto r = type3_study(nested({{{0, 2}}, {{1, 1.2}}, {{2, 0.5}}, {{0.1, 1.3}}, {{1.7, 0.8}}}), {100});
    ASSERT_TRUE(r);
    EXPECT_TRUE(r->pv_negative);
    EXPECT_EQ(r->pv_mm, 0);
    EXPECT_EQ(r->ndc, 0);
    EXPECT_DOUBLE_EQ(r->grr_percent_total, 100);
    EXPECT_EQ(r->pv_limits.low, 0);
    EXPECT_GT(r->pv_limits.high, 0);
    const auto hung =
        type3_study(nested({{{0, 2}, {2, 0.1}}, {{10, 12}, {12, 10}}, {{20, 22}, {22.1, 20}}}), {100});
    ASSERT_TRUE(hung);
    EXPECT_TRUE(hung->rehang_negative);
    EXPECT_EQ(hung->rehang_mm, 0);
    EXPECT_FALSE(hung->pv_negative);
}

TEST(Type3, OneRunARehangIsRepeat) {
    const auto a = type3_study(nested({{{0}, {2}}, {{10}, {12}}, {{20}, {22.5}}}), {100});
    const auto b = type3_study(nested({{{0, 2}}, {{10, 12}}, {{20, 22.5}}}), {100});
    ASSERT_TRUE(a && b);
    EXPECT_TRUE(a->rehang_in_repeat);
    EXPECT_DOUBLE_EQ(a->ev_mm, b->ev_mm);
    EXPECT_DOUBLE_EQ(a->pv_mm, b->pv_mm);
}

// By hand after VDA 5: T = 1, u_CAL = 0.002, 25 values of bias 0.01 and s = 0.02, production EV 0.03.
TEST(ProcessUncertainty, ByHand) {
    std::vector<StudyValue> references;
    const double a = 0.02 * std::sqrt(24.0 / 24.0);
    for (int i = 0; i < 24; ++i) references.push_back({"M", "1", i, 5.01 + (i % 2 ? a : -a), 5.0, {}});
    references.push_back({"M", "1", 24, 5.01, 5.0, {}});  // s^2 = 24 a^2 / 24
    ProcessSettings settings;
    settings.lower_mm = 4.5;
    settings.upper_mm = 5.5;
    settings.reference_u_mm = 0.002;
    settings.resolution_mm = 0.001;
    const auto r = process_uncertainty(references, {}, settings);
    ASSERT_TRUE(r);
    const double ms = std::sqrt(0.002 * 0.002 + 0.01 * 0.01 / 3 + 0.02 * 0.02);
    EXPECT_NEAR(r->u_ms_mm, ms, 1e-12);
    EXPECT_NEAR(r->u_mp_mm, ms, 1e-12);
    EXPECT_NEAR(r->q_ms_percent, 400 * ms, 1e-9);
    EXPECT_NEAR(r->conformity_zone.low, 4.5 + 2 * ms, 1e-12);
    EXPECT_NEAR(r->conformity_zone.high, 5.5 - 2 * ms, 1e-12);
    EXPECT_LT(r->u_ms_limits.low, ms);
    EXPECT_GT(r->u_ms_limits.high, ms);
    EXPECT_EQ(r->verdict, AcceptanceVerdict::ok);

    Type3 production;
    production.ev_mm = 0.03;
    production.rehang_mm = 0.04;
    production.runs = 2;
    production.anova = {{"part", 9, 9, 1}, {"rehang", 10, 0.041, 0.0041}, {"repeat", 20, 0.018, 0.0009}};
    const auto with = process_uncertainty(references, production, settings);
    ASSERT_TRUE(with);
    EXPECT_NEAR(with->u_ms_mm, ms, 1e-12);
    EXPECT_NEAR(with->u_mp_mm, std::sqrt(0.002 * 0.002 + 0.01 * 0.01 / 3 + 0.03 * 0.03 + 0.04 * 0.04), 1e-12);
    // A coarse resolution takes the repeatability's place.
    settings.resolution_mm = 0.2;
    const auto coarse = process_uncertainty(references, {}, settings);
    ASSERT_TRUE(coarse);
    EXPECT_NEAR(coarse->u_ms_mm, std::sqrt(0.002 * 0.002 + 0.01 * 0.01 / 3 + 0.2 * 0.2 / 12), 1e-12);
    EXPECT_EQ(coarse->verdict, AcceptanceVerdict::not_ok);
}

TEST(Correlation, PairsByHand) {
    // value = 0.1 + 1.02 reference -+ 0.01, repeats of a part are one pair
    std::vector<StudyValue> values;
    std::vector<double> d;
    for (int i = 0; i < 12; ++i) {
        const double reference = i - 5.5, value = 0.1 + 1.02 * reference + (i % 2 ? 0.01 : -0.01);
        d.push_back(value - reference);
        for (const double e : {-0.003, 0.003})
            values.push_back({std::to_string(i), "1", e < 0 ? 1 : 2, value + e, reference, {}});
    }
    values.push_back({"no reference", "1", 1, 99, {}, {}});
    const auto r = correlation_study(values);
    ASSERT_TRUE(r);
    ASSERT_EQ(r->pairs.size(), 12u);
    const double mean = std::accumulate(d.begin(), d.end(), 0.0) / 12;
    double s = 0;
    for (double v : d) s += (v - mean) * (v - mean);
    s = std::sqrt(s / 11);
    EXPECT_NEAR(r->offset_mm, mean, 1e-12);
    EXPECT_NEAR(r->offset_limits.high - mean, 2.200985 * s / std::sqrt(12.0), 1e-7);  // t of 11 degrees
    EXPECT_NEAR(r->line.slope, 1.02, 0.002);
    EXPECT_FALSE(r->line.slope_limits.contains(1));
    EXPECT_EQ(r->verdict, AcceptanceVerdict::not_ok);
}

}  // namespace
}  // namespace seamwright
