// Gap width on sheets that stop square or in a rounded rim, cast by vertical rays: the shapes, the rays and
// the truth (the outermost place along the left surface that any ray meets) share nothing with the gauge.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

#include "core/features/gap/gap_flush.h"
#include "core/profile/filter.h"

namespace seamwright {
namespace {

using Outline = std::vector<Eigen::Vector2d>;

struct GapScene {
    std::vector<Outline> sheets;
    // Height of the highest sheet at x, and which it is; NaN between them.
    double height(double x, int& sheet) const {
        double best = std::nan("");
        for (std::size_t s = 0; s < sheets.size(); ++s)
            for (std::size_t i = 0; i + 1 < sheets[s].size(); ++i) {
                const Eigen::Vector2d &a = sheets[s][i], &b = sheets[s][i + 1];
                if ((x < a.x()) == (x < b.x())) continue;
                const double z = a.y() + (x - a.x()) / (b.x() - a.x()) * (b.y() - a.y());
                if (best >= z) continue;
                best = z;
                sheet = static_cast<int>(s);
            }
        return best;
    }
};

// A sheet that ends towards +x at 0, its top at z = 0.
Outline rim(double radius_mm) {
    Outline o{{-15, 0}};
    if (radius_mm <= 0) {
        o.emplace_back(0, 0);
        o.emplace_back(0, -1);
    }
    for (int k = 0; radius_mm > 0 && k <= 60; ++k) {
        const double a = M_PI / 2 - M_PI * k / 60;
        o.emplace_back(radius_mm * (std::cos(a) - 1), radius_mm * (std::sin(a) - 1));
    }
    o.emplace_back(-15, o.back().y());
    return o;
}

void turn(Outline& o, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    for (auto& p : o) p = Eigen::Vector2d(c * p.x() - s * p.y(), s * p.x() + c * p.y());
}

struct Tally {
    int asked = 0, ok = 0, inside = 0, far = 0;
    double error = 0, sigma = 0;
};

Tally measure(double radius_mm, double pitch_mm, double noise_mm, int trials, std::mt19937_64& engine) {
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal;
    Tally tally;
    for (int trial = 0; trial < trials; ++trial) {
        const double wanted = 3 * pitch_mm + 0.2 * std::pow(50, uniform(engine));
        const double tilt = 0.2 * (uniform(engine) - 0.5);
        Outline left = rim(radius_mm), right = rim(radius_mm);
        for (auto& p : right) p.x() = -p.x();
        turn(right, 0.1 * (uniform(engine) - 0.5));
        double nearest = 1e9;
        for (const auto& p : right) nearest = std::min(nearest, p.x());
        const double flush = 6 * (uniform(engine) - 0.5);
        for (auto& p : right) p += Eigen::Vector2d(wanted - nearest, flush);
        turn(left, tilt);
        turn(right, tilt);
        const GapScene scene{{left, right}};
        const Eigen::Vector2d u(std::cos(tilt), std::sin(tilt));
        double edge[2] = {-1e9, 1e9};
        // An outline is straight between its corners: the outermost place is a corner that is seen.
        for (const Outline& o : scene.sheets)
            for (const auto& corner : o)
                for (const double x : {corner.x() - 1e-7, corner.x() + 1e-7}) {
                    int sheet = 0;
                    const double z = scene.height(x, sheet);
                    if (!std::isfinite(z)) continue;
                    const double along = u.dot(Eigen::Vector2d(x, z));
                    edge[sheet] = sheet == 0 ? std::max(edge[0], along) : std::min(edge[1], along);
                }
        Profile p;
        for (double x = -14 + pitch_mm * uniform(engine); x < 14 + wanted; x += pitch_mm) {
            int sheet = 0;
            const bool missing = uniform(engine) < 0.01;
            p.x_mm.push_back(x);
            p.z_mm.push_back(missing ? std::nan("") : scene.height(x, sheet) + noise_mm * normal(engine));
        }
        EXPECT_TRUE(filter_profile(p, {}));
        GapFlushSettings settings;
        settings.surface_mm = 6;
        settings.edge_skip_mm = std::max(1.5, 1.2 * radius_mm);
        const GapFlush f = GapFlushGauge(settings).measure(p);
        ++tally.asked;
        if (f.status != GapFlushStatus::ok) continue;
        const double error = f.gap_mm - (edge[1] - edge[0]), sigma = std::sqrt(f.covariance(0, 0));
        ++tally.ok;
        tally.inside += std::abs(error) < 2 * sigma;
        tally.far += std::abs(error) > 6 * sigma;
        tally.error += error;
        tally.sigma += sigma;
    }
    return tally;
}

TEST(GapWidth, IsAsSureAsItSaysOverPitchNoiseGapFlushAndRim) {
    std::mt19937_64 engine(31);
    for (const double radius : {0.0, 0.5, 1.5, 4.0}) {
        Tally all;
        for (const double pitch : {0.02, 0.05, 0.1, 0.2, 0.3})
            for (const double noise : {0.01, 0.03, 0.1}) {
                const Tally t = measure(radius, pitch, noise, 60, engine);
                EXPECT_GE(t.ok, 0.7 * t.asked) << "radius " << radius << " pitch " << pitch << " " << noise;
                EXPECT_LT(std::abs(t.error), 0.5 * t.sigma) << radius << " pitch " << pitch << " " << noise;
                all.asked += t.asked;
                all.ok += t.ok;
                all.inside += t.inside;
                all.far += t.far;
                all.error += t.error;
                all.sigma += t.sigma;
            }
        EXPECT_GE(all.ok, 0.9 * all.asked) << radius;
        EXPECT_NEAR(double(all.inside) / all.ok, 0.95, 0.022) << radius;
        EXPECT_LE(all.far, 0.005 * all.ok) << radius;
        EXPECT_LT(std::abs(all.error), 0.15 * all.sigma) << radius;
    }
}

}  // namespace
}  // namespace seamwright
