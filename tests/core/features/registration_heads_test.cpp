// Matching in profiles that two heads see from either side and that were merged: points of one head lie four times as far apart
// as the other's and scatter five times as much, and those of a face are in the order of x. Shapes and rays share nothing with
// the estimators nor with the other generators.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/features/contour/contour_model.h"
#include "core/features/contour/face_order.h"
#include "core/features/registration/registration.h"
#include "core/geometry/pose.h"
#include "tests/core/features/two_heads.h"

namespace seamwright {
namespace {

using Eigen::Vector2d;

struct HeadsTally {
    int seen = 0, ok = 0, wrong = 0;
};
HeadsTally match_over(int trials, bool butt) {
    HeadsTally tally;
    Dicing dice{std::mt19937_64(butt ? 77 : 78)};
    for (int i = 0; i < trials; ++i) {
        const double step = dice.uniform(0.5, 2), gap = dice.uniform(0.3, 3), flush = dice.uniform(-0.3, 0.3);
        const Parts parts =
            butt ? Parts{{{-150, 0}, {0, 0}, {0, -3}}, {{gap, flush - 3}, {gap, flush}, {150, flush}}}
                 : Parts{{{-150, 0}, {0, 0}, {0, -step}}, {{-20, -step}, {150, -step}}};
        EyeOfHead eyes[2] = {{0.05, 0.01, dice.uniform(0.25, 0.6)}, {0.2, 0.05, -dice.uniform(0.25, 0.6)}};
        if (dice.uniform(0, 1) < 0.5) {
            std::swap(eyes[0].pitch_mm, eyes[1].pitch_mm);
            std::swap(eyes[0].noise_mm, eyes[1].noise_mm);
        }
        const double dx = dice.uniform(-5, 5), dz = dice.uniform(-5, 5);
        const PlanarMotion truth{dx, dz, dice.uniform(-0.1, 0.1)};
        Parts there = parts;
        for (auto& part : there)
            for (Vector2d& p : part) p = truth * p;
        const DoubleHeadProfile a = merged_view(parts, eyes, dice), b = merged_view(there, eyes, dice);
        if (a.status != DoubleHeadStatus::ok || b.status != DoubleHeadStatus::ok) continue;
        Profile taught;
        for (std::size_t k = 0; k < a.profile.size(); ++k) {
            if (std::abs(a.profile.x_mm[k]) > 9 + (butt ? gap : 0)) continue;
            taught.x_mm.push_back(a.profile.x_mm[k]);
            taught.z_mm.push_back(a.profile.z_mm[k]);
            taught.segment.push_back(a.profile.segment[k]);
        }
        const auto matcher = ContourMatcher::make(taught, Vector2d::Zero());
        if (!matcher) continue;
        ++tally.seen;
        SearchWindow window;
        window.dx_mm = window.dz_mm = 7;
        window.phi_rad = 0.14;
        const Registration r = matcher->match(b.profile, window);
        if (r.status != RegistrationStatus::ok) continue;
        ++tally.ok;
        // The landmark is the taught frame's origin.
        const Vector2d e(r.scene_from_template.dx_mm - truth.dx_mm,
                         r.scene_from_template.dz_mm - truth.dz_mm);
        const double square = e.dot(r.covariance.topLeftCorner<2, 2>().ldlt().solve(e));
        tally.wrong += e.norm() > 0.3 && square > 36;
    }
    return tally;
}

TEST(RegistrationHeads, OfUnequalHeadsLapsAndButtJointsAreRightOrRefused) {
    for (const bool butt : {false, true}) {
        const HeadsTally tally = match_over(300, butt);
        EXPECT_GE(tally.seen, 280);
        EXPECT_EQ(tally.wrong, 0) << (butt ? "butt" : "lap") << " of " << tally.ok;
        EXPECT_GE(tally.ok, (butt ? 0.7 : 0.8) * tally.seen) << (butt ? "butt" : "lap");
    }
}

// Where the spacing of the points changes, a stretch of the curve still lies between the two points that it is of.
TEST(ContourModel, AStretchLiesBetweenItsPointsWhateverTheirSpacing) {
    Profile p;
    for (double x = -8; x < 8; x += x < 0 ? 0.05 : 0.2) {
        p.x_mm.push_back(x);
        p.z_mm.push_back(0.1 * x);
    }
    ContourModel model;
    model.build(p);
    ASSERT_TRUE(model.usable());
    for (const ContourModel::Edge& e : model.edges()) {
        const auto k = static_cast<std::size_t>(e.point);
        const double middle = 0.5 * (model.x()[k] + model.x()[k + 1]);
        EXPECT_NEAR(e.cx, middle, 0.15) << "at " << middle + model.origin().x();
    }
}

// A face in the order of x comes out in the order of z, downwards from the sheet; a groove and noise stay as they are.
TEST(FaceOrder, PointsOfAFaceAreOrderedAlongIt) {
    std::mt19937_64 engine(5);
    std::normal_distribution<double> noise(0, 0.01);
    std::uniform_real_distribution<double> height(-3, 0);
    std::vector<std::pair<double, double>> points;
    for (double x = -5; x < -0.05; x += 0.1) points.emplace_back(x, 0);
    for (int i = 0; i < 30; ++i) {
        const double x = noise(engine);
        points.emplace_back(x, height(engine));
    }
    std::sort(points.begin(), points.end());
    for (double x = 0.15; x < 5; x += 0.1) points.emplace_back(x, -3);
    std::vector<double> x, z, scratch;
    for (const auto& [a, b] : points) x.push_back(a), z.push_back(b);
    EXPECT_FALSE(std::is_sorted(z.rbegin(), z.rend()));
    EXPECT_TRUE(order_faces(contour_pitch(x, z, scratch), x, z));
    EXPECT_TRUE(std::is_sorted(z.rbegin(), z.rend()));

    std::vector<double> gx, gz;
    for (double at = -5; at < 5; at += 0.05) {
        const double e = noise(engine);
        gx.push_back(at);
        gz.push_back(std::min(0.0, 5 * std::abs(at) - 4) + e);
    }
    const std::vector<double> before = gz;
    EXPECT_FALSE(order_faces(contour_pitch(gx, gz, scratch), gx, gz));
    EXPECT_EQ(gz, before);
}

}  // namespace
}  // namespace seamwright
