// Do the stated limits hold what they promise? Over many trials with known truth.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/statistics/capability.h"
#include "core/statistics/ewma.h"
#include "core/statistics/trend.h"

namespace seamwright {
namespace {

// Share of 4000 trials in which limits of 95 % hold the truth; 3 sigma of that share is 1.0 %.
template <class Trial>
double coverage(const Trial& trial, int trials = 4000) {
    std::mt19937 rng(21);
    int held = 0;
    for (int i = 0; i < trials; ++i) held += trial(rng);
    return static_cast<double>(held) / trials;
}

std::vector<double> autoregression(std::mt19937& rng, int n, double r, double mean = 0) {
    std::normal_distribution<double> draw;
    std::vector<double> out;
    double x = draw(rng);
    for (int i = 0; i < n; ++i) {
        out.push_back(mean + x);
        x = r * x + std::sqrt(1 - r * r) * draw(rng);
    }
    return out;
}

TEST(StatisticsCoverage, IndicesOfIndependentValues) {
    // mean 0.5, sigma 1, limits +-4: Pp 4/3, Ppk 3.5/3
    for (const int n : {30, 200}) {
        EXPECT_NEAR(coverage([&](std::mt19937& rng) {
                        const auto r = summarise_process(autoregression(rng, n, 0, 0.5), {-4.0, 4.0});
                        return r->total.spread->limits.contains(4.0 / 3);
                    }),
                    0.95, 0.02)
            << n;
        EXPECT_NEAR(coverage([&](std::mt19937& rng) {
                        const auto r = summarise_process(autoregression(rng, n, 0, 0.5), {-4.0, 4.0});
                        return r->total.worst_side->limits.contains(3.5 / 3);
                    }),
                    0.95, 0.02)
            << n;
        EXPECT_NEAR(coverage([&](std::mt19937& rng) {
                        const auto r = summarise_process(autoregression(rng, n, 0, 0.5), {-4.0, 4.0});
                        return r->within.spread->limits.contains(4.0 / 3);
                    }),
                    0.95, 0.025)
            << n;
    }
}

TEST(StatisticsCoverage, IndicesAndMeanOfAlikeNeighbours) {
    const auto limits_hold = [](std::mt19937& rng, bool of_mean) {
        const auto r = summarise_process(autoregression(rng, 400, 0.7, 0.5), {-4.0, 4.0});
        return of_mean ? r->mean_limits.contains(0.5) : r->total.worst_side->limits.contains(3.5 / 3);
    };
    // Without the correlation the mean's limits would hold 59 %.
    EXPECT_NEAR(coverage([&](std::mt19937& rng) { return limits_hold(rng, true); }), 0.95, 0.03);
    EXPECT_NEAR(coverage([&](std::mt19937& rng) { return limits_hold(rng, false); }), 0.95, 0.03);
}

TEST(StatisticsCoverage, SlopeOfATrend) {
    for (const double r : {0.0, 0.6}) {
        EXPECT_NEAR(coverage([&](std::mt19937& rng) {
                        std::vector<double> days, values = autoregression(rng, 200, r);
                        for (std::size_t i = 0; i < values.size(); ++i) {
                            days.push_back(0.1 * static_cast<double>(i));
                            values[i] += 0.02 * days.back();
                        }
                        return (*trend_of(days, values, {}))->slope_limits.contains(0.02);
                    }),
                    0.95, 0.03)
            << r;
    }
}

TEST(StatisticsCoverage, NormalValuesAreSeldomCalledOthers) {
    EXPECT_NEAR(coverage([](std::mt19937& rng) {
                    return summarise_process(autoregression(rng, 100, 0), {})->not_normal();
                }),
                kNormalityLevel, 0.004);
}

// Lucas and Saccucci (1990): 500 values to a false alarm, about 10 to see one sigma.
TEST(StatisticsCoverage, EwmaRunLengths) {
    std::normal_distribution<double> draw;
    for (const auto& [shift, length, tolerance] : {std::tuple{0.0, 500.0, 30.0}, {1.0, 9.8, 0.7}}) {
        double sum = 0;
        for (int trial = 0; trial < 3000; ++trial) {
            for (int n = 16;; n *= 4) {
                std::mt19937 same(static_cast<unsigned>(trial) + 100);
                draw.reset();
                std::vector<double> values;
                for (int i = 0; i < n; ++i) values.push_back(shift + draw(same));
                const auto r = ewma_chart(values, 0, 1);
                if (r->beyond.empty()) continue;
                sum += static_cast<double>(r->beyond.front() + 1);
                break;
            }
        }
        EXPECT_NEAR(sum / 3000, length, tolerance) << shift;
    }
}

}  // namespace
}  // namespace seamwright
