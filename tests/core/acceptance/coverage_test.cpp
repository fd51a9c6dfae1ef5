// The 95 % limits of every index hold its true value in 95 % of simulated studies.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <random>

#include "core/acceptance/correlation.h"
#include "core/acceptance/linearity.h"
#include "core/acceptance/process_uncertainty.h"
#include "core/acceptance/stability.h"
#include "core/acceptance/type1.h"
#include "core/acceptance/type3.h"

namespace seamwright {
namespace {

class Held {
  public:
    void add(const std::string& index, const Interval& limits, double truth) {
        ++trials_[index];
        held_[index] += limits.contains(truth);
    }
    void expect(double low = 0.93, double high = 0.97) {
        for (const auto& [index, n] : trials_) {
            const double share = static_cast<double>(held_[index]) / n;
            std::printf("  %-28s %.4f of %d\n", index.c_str(), share, n);
            EXPECT_GE(share, low) << index;
            EXPECT_LE(share, high) << index;
        }
    }

  private:
    std::map<std::string, int> trials_, held_;
};

TEST(Coverage, Type1) {
    Held held;
    std::mt19937 random(11);
    for (const int n : {10, 25, 50})
        for (const double bias : {0.0, 0.02, 0.1, -0.3}) {
            std::normal_distribution<double> normal(10 + bias, 0.05);
            const double cg = 0.2 * 2 / (6 * 0.05), cgk = (0.2 - std::abs(bias)) / (3 * 0.05);
            const std::string name = " n " + std::to_string(n) + " bias " + std::to_string(bias).substr(0, 5);
            for (int trial = 0; trial < 1500; ++trial) {
                std::vector<double> values(static_cast<std::size_t>(n));
                for (double& v : values) v = normal(random);
                const auto r = type1_study(values, 10, {2});
                ASSERT_TRUE(r);
                held.add("s" + name, r->s_limits, 0.05);
                held.add("bias" + name, r->bias_limits, bias);
                held.add("Cg" + name, r->cg_limits, cg);
                held.add("Cgk" + name, r->cgk_limits, cgk);
            }
        }
    held.expect();
}

struct Components {
    int k, h, r;
    double part, rehang, repeat;
};

TEST(Coverage, Type3) {
    Held held;
    std::mt19937 random(12);
    std::normal_distribution<double> normal;
    for (const Components& c : {Components{25, 1, 2, 0.5, 0, 0.1},
                                {10, 1, 3, 0.3, 0, 0.2},
                                {5, 1, 5, 1, 0, 0.05},
                                {10, 2, 2, 0.5, 0.15, 0.1},
                                {25, 2, 2, 0.3, 0.1, 0.1},
                                {6, 3, 2, 1, 0.2, 0.05}}) {
        const std::string name =
            " k" + std::to_string(c.k) + " h" + std::to_string(c.h) + " r" + std::to_string(c.r);
        const double grr = std::hypot(c.repeat, c.rehang), total = 100 * grr / std::hypot(grr, c.part);
        for (int trial = 0; trial < 1000; ++trial) {
            std::vector<StudyValue> values;
            for (int p = 0; p < c.k; ++p) {
                const double part = c.part * normal(random);
                for (int h = 0; h < c.h; ++h) {
                    const double hung = part + c.rehang * normal(random);
                    for (int n = 0; n < c.r; ++n)
                        values.push_back({std::to_string(p),
                                          std::to_string(h),
                                          n,
                                          hung + c.repeat * normal(random),
                                          {},
                                          {}});
                }
            }
            const auto r = type3_study(values, {4});
            ASSERT_TRUE(r);
            held.add("EV" + name, r->ev_limits, c.repeat);
            held.add("GRR" + name, r->grr_limits, grr);
            held.add("%T" + name, r->tolerance_limits, 600 * grr / 4);
            held.add("PV" + name, r->pv_limits, c.part);
            held.add("%total" + name, r->total_limits, total);
            if (c.h > 1) held.add("rehang" + name, r->rehang_limits, c.rehang);
        }
    }
    held.expect();
}

TEST(Coverage, LinearityCorrelationStability) {
    Held held;
    std::mt19937 random(13);
    std::normal_distribution<double> normal;
    for (int trial = 0; trial < 3000; ++trial) {
        std::vector<StudyValue> values, pairs;
        for (int level = 0; level < 5; ++level)
            for (int i = 0; i < 10; ++i) {
                const double x = 5.0 * level - 10;
                values.push_back(
                    {std::to_string(level), "1", i, x + 0.01 + 0.002 * x + 0.03 * normal(random), x, {}});
            }
        const auto linear = linearity_study(values);
        ASSERT_TRUE(linear);
        held.add("slope", linear->line.slope_limits, 0.002);
        held.add("intercept", linear->line.intercept_limits, 0.01);
        held.add("band", linear->line.band(10), 0.03);
        for (int i = 0; i < 15; ++i) {
            const double x = normal(random);
            pairs.push_back({std::to_string(i), "1", 1, x + 0.02 + 0.05 * normal(random), x, {}});
        }
        const auto correlation = correlation_study(pairs);
        ASSERT_TRUE(correlation);
        held.add("offset", correlation->offset_limits, 0.02);
        held.add("correlation slope", correlation->line.slope_limits, 1);
        std::vector<Subgroup> groups;
        for (int g = 0; g < 20; ++g) {
            groups.push_back({g, {}});
            for (int i = 0; i < 5; ++i) groups.back().values_mm.push_back(3 + 0.1 * normal(random));
        }
        const auto stable = stability_study(groups);
        ASSERT_TRUE(stable);
        held.add("centre", stable->centre_limits, 3);
    }
    held.expect();
}

TEST(Coverage, ProcessUncertainty) {
    Held held;
    std::mt19937 random(14);
    std::normal_distribution<double> normal;
    for (const double bias : {0.0, 0.01, 0.05, 0.15})
        for (int trial = 0; trial < 1000; ++trial) {
            std::vector<StudyValue> references, parts;
            for (int i = 0; i < 25; ++i)
                references.push_back({"M", "1", i, bias + 0.05 * normal(random), 0.0, {}});
            for (int p = 0; p < 10; ++p) {
                const double part = normal(random);
                for (int h = 0; h < 2; ++h) {
                    const double hung = part + 0.1 * normal(random);
                    for (int n = 0; n < 2; ++n)
                        parts.push_back(
                            {std::to_string(p), std::to_string(h), n, hung + 0.08 * normal(random), {}, {}});
                }
            }
            ProcessSettings settings;
            settings.lower_mm = -2;
            settings.upper_mm = 2;
            settings.reference_u_mm = 0.01;
            const auto type3 = type3_study(parts, {4});
            ASSERT_TRUE(type3);
            const auto r = process_uncertainty(references, *type3, settings);
            ASSERT_TRUE(r);
            const double common = 0.01 * 0.01 + bias * bias / 3, ms = std::sqrt(common + 0.05 * 0.05),
                         mp = std::sqrt(common + 0.08 * 0.08 + 0.1 * 0.1);
            const std::string name = " bias " + std::to_string(bias).substr(0, 4);
            held.add("u_MS" + name, r->u_ms_limits, ms);
            held.add("Q_MS" + name, r->q_ms_limits, 100 * ms);
            held.add("u_MP" + name, r->u_mp_limits, mp);
            held.add("zone" + name, r->conformity_low_limits, -2 + 2 * mp);
        }
    held.expect();
}

}  // namespace
}  // namespace seamwright
