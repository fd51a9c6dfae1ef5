// The most probable spacing against its density, and the forms in which the tracker takes it.

#include <gtest/gtest.h>

#include <limits>

#include "core/profile/contour_state.h"
#include "core/profile/filter.h"
#include "tests/core/profile/synthetic_profiles.h"

namespace seamwright {
namespace {

using synthetic::Maker;

// The logarithm of the density of (3.7) over u = ln(s / s_0), in long double.
struct Oracle {
    long double s_meas, s_0, mu, sigma, sn;
    int i;
    long double value(long double u) const {
        const long double e = (s_meas - s_0 * expl(u)) / sn, w = u - (mu - sigma * sigma / 2) * i;
        return -e * e / 2 - u - w * w / (2 * sigma * sigma * i);
    }
    long double maximum() const {
        const long double mode = (mu - 1.5L * sigma * sigma) * i;
        long double lo = mode - 30, hi = mode;
        if (s_meas > 0) lo = std::min(mode, logl(s_meas / s_0)), hi = std::max(mode, logl(s_meas / s_0));
        const int n = 3000;
        int best = 0;
        for (int k = 1; k <= n; ++k)
            if (value(lo + (hi - lo) * k / n) > value(lo + (hi - lo) * best / n)) best = k;
        long double a = lo + (hi - lo) * (best - 1) / n - 1e-12L,
                    b = lo + (hi - lo) * (best + 1) / n + 1e-12L;
        for (int k = 0; k < 100; ++k) {
            const long double p = a + (b - a) * 0.382L, q = a + (b - a) * 0.618L;
            (value(p) < value(q) ? a : b) = value(p) < value(q) ? p : q;
        }
        return s_0 * expl((a + b) / 2);
    }
};

TEST(MapSpacing, KnownValueOfTheThesis) {
    // Fig. 3.4: the exact maximum is 0.12846, the approximation alone prints 0.1284.
    const Oracle oracle{0.13L, 0.146L, -0.111L, 0.13L, 0.02L, 1};
    const double exact = double(oracle.maximum());
    EXPECT_NEAR(exact, 0.12846, 5e-6);
    EXPECT_NEAR(map_spacing(0.13, 0.146, -0.111, 0.13, 0.02), exact, 1e-7);
    EXPECT_NEAR(map_spacing_closed_form(0.13, 0.146, -0.111, 0.13, 0.02), 0.1284, 5e-5);
}

TEST(MapSpacing, TheTrackersFormIsCloseToTheMaximum) {
    Maker random(8);
    double worst = 0, worst_calm = 0;
    for (int k = 0; k < 20000; ++k) {
        contour::State s;
        s.drift = random.uniform(-0.1, 0.1);
        s.variance = std::pow(random.uniform(0.05, 0.3), 2);
        const int i = random.whole(1, 3);
        const double rm = random.uniform(-0.5, 3), rho = std::exp(random.uniform(-4, 3)), v = s.variance * i;
        const double ratio = contour::map_ratio(rm, v / (rho * rho), s.drift * i - 1.5 * v, s, i);
        const double exact = map_spacing(rm, 1, s.drift, std::sqrt(s.variance), rho, i);
        const double error = std::abs(ratio / exact - 1);
        worst = std::max(worst, error);
        if (std::abs(exact - 1) < 0.1) worst_calm = std::max(worst_calm, error);
    }
    EXPECT_LT(worst, 0.02);
    EXPECT_LT(worst_calm, 0.01);
}

// Held factors change nothing that matters: the same contour followed with and without them.
TEST(Filter, HeldFactorsFollowAsTheFullUpdateDoes) {
    for (const double noise : {0.005, 0.02, 0.05}) {
        Maker random(9);
        const double step = 0.1, radius = 30;
        contour::Scale scale;
        scale.sx = scale.sz = noise, scale.spacing = step;
        const contour::Model m(scale, {});
        contour::State full = contour::first_point(m, 0, 0), fast = full;
        contour::Held held;
        int followed = 0;
        double d2 = 0, off2 = 0, spacing = 0, truth2 = 0;
        const int n = 2000;
        for (int k = 1; k <= n; ++k) {
            const double angle = k * step / radius;
            const double tx = radius * std::sin(angle), tz = radius * (1 - std::cos(angle));
            const double x = tx + noise * random.normal(), z = tz + noise * random.normal();
            if (k < 3) {
                contour::accept_any_direction(m, full, x, z, 1);
                fast = full;
                continue;
            }
            contour::accept(m, full, contour::deviation(m, full, x, z, 1), 1);
            if (contour::follow(m, held, fast, x, z, contour::kCalm * m.outlier_cost, d2)) {
                ++followed;
            } else {
                const auto d = contour::deviation(m, fast, x, z, 1);
                contour::accept(m, fast, d, 1);
                contour::hold(m, fast, d, held);
            }
            off2 += (std::pow(fast.x - full.x, 2) + std::pow(fast.z - full.z, 2)) / n;
            truth2 += (std::pow(full.x - tx, 2) + std::pow(full.z - tz, 2)) / n;
            spacing += (fast.spacing() / full.spacing() - 1) / n;
        }
        EXPECT_GT(followed, n / 2) << noise;
        EXPECT_LT(std::sqrt(off2), 0.15 * noise) << noise;
        EXPECT_LT(std::sqrt(off2), 0.25 * std::sqrt(truth2)) << "beside the error both have";
        EXPECT_LT(std::abs(spacing), 0.03) << noise;
    }
}

TEST(MapSpacing, IsTheMaximumOverTheWholeRange) {
    Maker random(3);
    for (int k = 0; k < 2500; ++k) {
        const double s_0 = std::pow(10, random.uniform(-4, 2));
        const double s_meas =
            s_0 * (k % 10 == 0 ? random.uniform(-3, 3) : std::pow(10, random.uniform(-2, 2)));
        const double mu = random.uniform(-0.5, 0.5), sigma = std::pow(10, random.uniform(-3, 0.3));
        const double sn = s_0 * std::pow(10, random.uniform(-3, 2));
        const int i = 1 + k % 8;
        const Oracle oracle{s_meas, s_0, mu, sigma, sn, i};
        const double exact = double(oracle.maximum()), found = map_spacing(s_meas, s_0, mu, sigma, sn, i);
        // Two maxima of equal height: either will do.
        if (std::abs(found / exact - 1) > 1e-6) {
            EXPECT_NEAR(double(oracle.value(logl(found / s_0)) - oracle.value(logl(exact / s_0))), 0, 1e-9)
                << s_meas << ' ' << s_0 << ' ' << mu << ' ' << sigma << ' ' << sn << ' ' << i;
        }
    }
}

TEST(MapSpacing, ScalesWithTheUnitAndSurvivesDegenerateInput) {
    const double s = map_spacing(0.13, 0.146, -0.111, 0.13, 0.02, 3);
    EXPECT_NEAR(map_spacing(130, 146, -0.111, 0.13, 20, 3), 1000 * s, 1e-9 * 1000 * s);
    EXPECT_DOUBLE_EQ(map_spacing(0.2, 0.1, 0, 0.1, 0), 0.2);
    EXPECT_NEAR(map_spacing(0.2, 0.1, 0.1, 0, 0.01), 0.1 * std::exp(0.1), 1e-12);
    EXPECT_DOUBLE_EQ(map_spacing(0.2, 0, 0, 0.1, 0.01), 0.2);
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
          -std::numeric_limits<double>::infinity(), 1e300, -1e300, 0.0}) {
        EXPECT_TRUE(std::isfinite(map_spacing(bad, 0.1, 0, 0.1, 0.01))) << bad;
        (void)map_spacing(0.1, bad, 0, 0.1, 0.01);
        (void)map_spacing(0.1, 0.1, 0, bad, 0.01);
        (void)map_spacing(0.1, 0.1, 0, 0.1, bad);
    }
}

}  // namespace
}  // namespace seamwright
