// Laws of the curve through a contour's points and of the polygon of few points.

#include "core/features/contour/contour_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "contours.h"
#include "core/features/contour/reduce_contour.h"

namespace seamwright::test {
namespace {

TEST(ReduceContour, KeepsEveryPointWithinTolerance) {
    Random random(2);
    Profile p = sample(hem(-20, 20), 0.05);
    add_noise(p, 0.03, random);
    std::vector<int> kept;
    for (const double tolerance : {0.01, 0.05, 0.3, 2.0}) {
        reduce_contour(p.x_mm, p.z_mm, tolerance, kept);
        ASSERT_GE(kept.size(), 2U);
        EXPECT_EQ(kept.front(), 0);
        EXPECT_EQ(kept.back(), static_cast<int>(p.size()) - 1);
        EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
        for (std::size_t k = 1; k < kept.size(); ++k) {
            const Eigen::Vector2d a(p.x_mm[kept[k - 1]], p.z_mm[kept[k - 1]]),
                b(p.x_mm[kept[k]], p.z_mm[kept[k]]);
            for (int i = kept[k - 1]; i <= kept[k]; ++i) {
                const Eigen::Vector2d q(p.x_mm[i], p.z_mm[i]);
                const double t = std::clamp((q - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
                EXPECT_LE((q - a - t * (b - a)).norm(), tolerance * (1 + 1e-12));
            }
        }
    }
}

TEST(ReduceContour, SmallAndDegenerateInput) {
    std::vector<int> kept{7};
    const std::vector<double> none, one{1}, same(50, 2.0);
    reduce_contour(none, none, 0.1, kept);
    EXPECT_TRUE(kept.empty());
    reduce_contour(one, one, 0.1, kept);
    EXPECT_EQ(kept, std::vector<int>{0});
    reduce_contour(same, same, 0.1, kept);
    EXPECT_EQ(kept, (std::vector<int>{0, 49}));
    // A comb deeper than any stack would bear: every point is kept.
    std::vector<double> x, z;
    for (int i = 0; i < 3000; ++i) {
        x.push_back(i);
        z.push_back((i % 2) * (1.0 + i));
    }
    reduce_contour(x, z, 0.1, kept);
    EXPECT_EQ(kept.size(), x.size());
}

// Oracle: every edge tried for every query.
TEST(ContourModel, NearestPlaceAgreesWithBruteForce) {
    Random random(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    Profile overhang;
    for (int i = 0; i <= 400; ++i) {  // most of a circle, x turns back
        const double a = rad_from_deg(-60 + 300.0 * i / 400);
        overhang.x_mm.push_back(5 * std::cos(a));
        overhang.z_mm.push_back(5 * std::sin(a));
    }
    for (const Profile& p : {sample(hem(-10, 10), 0.1), overhang, sample(step(-5, 5, 2), 0.05)}) {
        ContourModel model;
        model.build(p);
        ASSERT_TRUE(model.usable());
        int found = 0;
        for (int q = 0; q < 400; ++q) {
            const double x = 12 * unit(random), z = 6 * unit(random), radius = 1.5;
            double best = radius;
            for (const auto& e : model.edges()) {
                const double dx = x - e.cx, dz = z - e.cz;
                const double u = dx * e.tx + dz * e.tz;
                const double residual = dz * e.tx - dx * e.tz - 0.5 * e.curvature * u * u;
                const double out = std::max(std::abs(u) - e.half, 0.0);
                if (out > 0.5 * model.pitch().distance && (u > 0 ? e.next : e.previous) < 0) continue;
                best = std::min(best, std::hypot(out, residual));
            }
            const auto foot = model.nearest(x, z, radius);
            if (best >= radius) {
                EXPECT_LT(foot.edge, 0);
                continue;
            }
            ++found;
            ASSERT_GE(foot.edge, 0) << x << " " << z << " " << best;
            const auto& e = model.edges()[foot.edge];
            const double d = std::hypot(std::max(std::abs(foot.u) - e.half, 0.0), foot.residual);
            // Nodes stand in for edges, so of two edges about equally near the other one may be taken.
            EXPECT_NEAR(d, best, 0.02 + 0.05 * best);
        }
        EXPECT_GT(found, 20);
    }
}

TEST(ContourModel, NoiseEstimateAndFittedCurve) {
    Random random(4);
    for (const double sigma : {0.005, 0.02, 0.05}) {
        Profile p;
        for (int i = 0; i < 1000; ++i) {
            p.x_mm.push_back(0.05 * i);
            p.z_mm.push_back(0.002 * p.x_mm.back() * p.x_mm.back());
        }
        add_noise(p, sigma, random);
        ContourModel model;
        model.build(p);
        EXPECT_NEAR(model.sigma_mm(), sigma, 0.1 * sigma);
        double sum = 0;
        for (const auto& e : model.edges()) {
            const double x = e.cx + model.origin().x(), z = e.cz + model.origin().y();
            sum += std::pow(z - 0.002 * x * x, 2);
        }
        EXPECT_LT(std::sqrt(sum / double(model.edges().size())), 0.35 * sigma);
    }
}

// A step that a mean over neighbours has drawn out is a step again, in the middle of its ramp; a flank that is a little
// longer than a mean makes of any step stays one.
TEST(ContourModel, AStepDrawnOutByAMeanIsAStep) {
    for (const int many : {3, 5, 7})
        for (const double slope_deg : {0., 12.})
            for (const bool flank : {false, true}) {
                Random random(5);
                std::normal_distribution<double> noise(0, 0.02);
                constexpr double kPitch = 0.05, kStep = 1, kEdge_mm = 10.01;
                const double wide = flank ? 4 * many * kPitch : 0;
                std::vector<double> raw;
                Profile p;
                for (int i = 0; i < 600; ++i) {
                    const double x = kPitch * i,
                                 part = std::clamp((x - kEdge_mm) / std::max(wide, 1e-9), 0.0, 1.0);
                    p.x_mm.push_back(x);
                    raw.push_back(x * std::tan(rad_from_deg(slope_deg)) - part * kStep + noise(random));
                }
                for (int i = 0; i < 600; ++i) {
                    const int from = std::max(i - many / 2, 0), to = std::min(i + many / 2, 599);
                    p.z_mm.push_back(std::accumulate(&raw[from], &raw[to] + 1, 0.0) / (to - from + 1));
                }
                ContourModel model;
                model.build(p);
                EXPECT_NEAR(model.pitch().shared, many, 1) << many;
                EXPECT_NEAR(model.sigma_mm(), 0.02 / std::sqrt(many), 0.004) << many << " " << slope_deg;
                int walls = 0;
                for (const auto& e : model.edges()) {
                    walls += e.wall;
                    if (!e.wall) continue;
                    EXPECT_NEAR(e.cx + model.origin().x(), kEdge_mm, kPitch) << many << " " << slope_deg;
                    EXPECT_NEAR(2 * std::abs(e.cx - model.x()[std::size_t(e.point)]), many * kPitch,
                                1.01 * kPitch);
                }
                EXPECT_EQ(walls, flank ? 0 : 1) << many << " " << slope_deg;
            }
}

}  // namespace
}  // namespace seamwright::test
