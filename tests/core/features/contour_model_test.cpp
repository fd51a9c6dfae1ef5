// Laws of a contour's noise, of the curve through it and of the polygon of few points.

#include "core/features/contour/contour_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "contours.h"
#include "core/features/contour/reduce_contour.h"
#include "core/features/kinds/feature_registry.h"

namespace seamwright::test {
namespace {

// Points of a surface measured `apart` lines of an even grid apart, with independent noise, and laid on that grid by straight
// lines between them.
template <class Height>
Profile interpolated(double from_x, double to_x, double pitch, double apart, double noise, Height height,
                     Random& random) {
    std::normal_distribution<double> normal(0, noise);
    const double step = apart * pitch,
                 begin = from_x - step * std::uniform_real_distribution<double>(0, 1)(random);
    std::vector<double> z;
    for (double x = begin; x < to_x + 2 * step; x += step) z.push_back(height(x) + normal(random));
    Profile p;
    for (double x = from_x; x <= to_x; x += pitch) {
        const double at = (x - begin) / step;
        const auto k = static_cast<std::size_t>(at);
        p.x_mm.push_back(x);
        p.z_mm.push_back(z[k] + (at - double(k)) * (z[k + 1] - z[k]));
    }
    return p;
}

TEST(ContourNoiseLaws, IndependentNoiseIsThatOfNeighbours) {
    Random random(11);
    std::vector<double> scratch;
    std::normal_distribution<double> normal;
    for (const bool even : {true, false}) {
        int seen = 0;
        double mean = 0;
        for (int i = 0; i < 300; ++i) {
            Profile p = sample(hem(-15, 15), 0.05);
            add_noise(p, 0.02, random);
            if (!even)
                for (double& x : p.x_mm) x += 0.01 * normal(random);
            const ContourNoise noise = contour_noise(p.x_mm, p.z_mm, scratch);
            seen += noise.measured_apart > 0;
            mean += noise.point_mm / 300;
        }
        EXPECT_LE(seen, even ? 3 : 0);
        EXPECT_NEAR(mean, 0.02, 0.002);
    }
}

// A point between two measured ones has sqrt(2 / 3) of their noise in the mean.
TEST(ContourNoiseLaws, InterpolationIsSeenAndItsNoiseKept) {
    Random random(12);
    std::vector<double> scratch;
    for (const double apart : {1.3, 1.6, 2.0, 2.5})
        for (const double scale : {1.0, 25.4}) {
            const double noise = 0.02 * scale;
            double mean = 0, told = 0;
            for (int i = 0; i < 100; ++i) {
                const Profile p = interpolated(
                    -30 * scale, 30 * scale, 0.05 * scale, apart, noise,
                    [&](double x) { return 0.002 / scale * x * x; }, random);
                const ContourNoise n = contour_noise(p.x_mm, p.z_mm, scratch);
                mean += n.point_mm / 100;
                told += n.measured_apart / 100;
            }
            EXPECT_NEAR(mean, std::sqrt(2.0 / 3) * noise, 0.2 * noise) << apart;
            EXPECT_NEAR(told, apart, 0.2 * apart) << apart;
        }
}

TEST(ContourNoiseLaws, WithoutNoiseNothingIsSeen) {
    std::vector<double> scratch;
    for (const double pitch : {0.02, 0.3}) {
        const Profile p = sample(hem(-15, 15), pitch);
        EXPECT_EQ(contour_noise(p.x_mm, p.z_mm, scratch).measured_apart, 0) << pitch;
    }
}

// Of neighbours alone the noise is a fifth of what it is, and a flat beside the rim passes for a part of it.
TEST(ContourNoiseLaws, TheCentreOfAnInterpolatedRimIsWhereItSays) {
    Random random(13);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto finder = make_feature_finder({"circle", {}, {}, Eigen::Vector2d::Zero()}).value();
    int ok = 0, wrong = 0;
    for (int i = 0; i < 200; ++i) {
        const double radius = 3 + 4 * unit(random), far = radius * std::sin(rad_from_deg(70));
        const Profile p = interpolated(
            -0.5, far, 0.03 + 0.05 * unit(random), 2, 0.01 + 0.04 * unit(random),
            [&](double x) { return x < 0 ? 0 : std::sqrt(std::max(radius * radius - x * x, 0.0)) - radius; },
            random);
        const Feature f = finder->find(p);
        if (f.status != FeatureStatus::ok) continue;
        ++ok;
        const double error = (f.point_mm - Eigen::Vector2d(0, -radius)).norm();
        wrong += error > 0.3 && error > 5 * std::sqrt(f.covariance_mm2.trace());
    }
    EXPECT_GT(ok, 150);
    EXPECT_LE(wrong, 4);
}

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

}  // namespace
}  // namespace seamwright::test
