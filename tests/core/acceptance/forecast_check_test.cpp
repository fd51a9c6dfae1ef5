// Predicted against measured, by closed forms.

#include "core/acceptance/forecast_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace seamwright {
namespace {

// Chi-square of two degrees of freedom is exponential: P(x) = 1 - exp(-x / 2).
TEST(ForecastCheck, ScatterOfTwoDegreesInClosedForm) {
    for (const double ratio : {0.05, 0.3, 0.8, 1.0, 1.5, 1.9, 2.5}) {
        const double below = 1 - std::exp(-ratio * ratio);
        const ForecastCheck check = check_scatter(0.02, 0.02 * ratio, 2);
        EXPECT_NEAR(check.p, 2 * std::min(below, 1 - below), 1e-12) << ratio;
        EXPECT_EQ(check.agreement == Agreement::agrees, check.p >= 0.05) << ratio;
        EXPECT_EQ(check.agreement == Agreement::beyond_99, check.p < 0.01) << ratio;
    }
    // 49 degrees, the table's 2.5 % and 97.5 % points of chi-square: 31.555 and 70.222.
    for (const auto& [point, inside] :
         {std::pair{31.50, false}, {31.60, true}, {70.20, true}, {70.25, false}})
        EXPECT_EQ(check_scatter(1, std::sqrt(point / 49), 49).agreement == Agreement::agrees, inside)
            << point;
}

TEST(ForecastCheck, BiasByTheNormalTable) {
    EXPECT_NEAR(check_bias(0.01, 0.0196).p, 0.05, 1e-4);
    EXPECT_EQ(check_bias(0.01, -0.0195).agreement, Agreement::agrees);
    EXPECT_EQ(check_bias(0.01, -0.0197).agreement, Agreement::beyond_95);
    EXPECT_EQ(check_bias(0.01, 0.0258).agreement, Agreement::beyond_99);
}

// A true prediction is called wrong in 5 % and 1 % of the studies.
TEST(ForecastCheck, CallsATruePredictionWrongAsOftenAsItSays) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    int beyond_95 = 0, beyond_99 = 0;
    constexpr int kTrials = 4000, kValues = 10;
    for (int trial = 0; trial < kTrials; ++trial) {
        double sum = 0, squares = 0;
        for (int i = 0; i < kValues; ++i) {
            const double v = normal(random);
            sum += v;
            squares += v * v;
        }
        const double s = std::sqrt((squares - sum * sum / kValues) / (kValues - 1));
        const Agreement agreement = check_scatter(1, s, kValues - 1).agreement;
        beyond_95 += agreement != Agreement::agrees;
        beyond_99 += agreement == Agreement::beyond_99;
    }
    EXPECT_NEAR(beyond_95, 0.05 * kTrials, 4 * std::sqrt(0.05 * 0.95 * kTrials));
    EXPECT_NEAR(beyond_99, 0.01 * kTrials, 4 * std::sqrt(0.01 * 0.99 * kTrials));
}

}  // namespace
}  // namespace seamwright
