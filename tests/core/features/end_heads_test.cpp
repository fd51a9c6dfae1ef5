// Ends, corners and rims in profiles that two heads see from either side and that were merged: what is "ok" is at its place.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "core/features/feature.h"
#include "core/features/kinds/feature_registry.h"
#include "core/numbers.h"
#include "tests/core/features/two_heads.h"

namespace seamwright {
namespace {

using Eigen::Vector2d;

struct HeadsEnd {
    int seen = 0, ok = 0, wrong = 0, covered = 0;
};

// `parts` have what is meant at the origin.
template <class Parts_of>
HeadsEnd tally_of(int trials, unsigned seed, const FeatureRecipe& recipe, const Parts_of& parts_of) {
    HeadsEnd tally;
    Dicing dice{std::mt19937_64(seed)};
    const auto finder = make_feature_finder(recipe).value();
    for (int i = 0; i < trials; ++i) {
        Parts parts = parts_of(dice);
        EyeOfHead eyes[2] = {{0.05, 0.01, dice.uniform(0.25, 0.6)}, {0.2, 0.05, -dice.uniform(0.25, 0.6)}};
        if (dice.uniform(0, 1) < 0.5) {
            std::swap(eyes[0].pitch_mm, eyes[1].pitch_mm);
            std::swap(eyes[0].noise_mm, eyes[1].noise_mm);
        }
        const Vector2d at(dice.uniform(-5, 5), dice.uniform(-5, 5));
        const Eigen::Rotation2Dd turn(dice.uniform(-0.1, 0.1));
        for (auto& part : parts)
            for (Vector2d& p : part) p = turn * p + at;
        const DoubleHeadProfile m = merged_view(parts, eyes, dice);
        if (m.status != DoubleHeadStatus::ok) continue;
        ++tally.seen;
        const Feature f = finder->find(m.profile);
        if (f.status != FeatureStatus::ok) continue;
        ++tally.ok;
        const Vector2d e = f.point_mm - at;
        const double square = e.dot(f.covariance_mm2.ldlt().solve(e));
        tally.covered += square < 5.991;
        tally.wrong += e.norm() > 0.3 && square > 36;
    }
    return tally;
}

FeatureRecipe recipe_of(const char* kind, const ParameterValues& parameters) {
    return {kind, parameters, {}, Vector2d::Zero()};
}

// Where a head sees the upper sheet's face the contour goes on without an end; an end there is the sheet's all the same.
TEST(EndHeads, TheUpperSheetOfALapEndsAtItsEnd) {
    for (const bool face : {false, true})
        for (const double least : {0.5, 1.0, 2.0}) {
            const auto lap = [&](Dicing& dice) {
                const double step = dice.uniform(least, 2 * least);
                Parts parts{{{-150, 0}, {0, 0}}, {{-20, -step}, {150, -step}}};
                if (face) parts[0].emplace_back(0, -step);
                return parts;
            };
            const HeadsEnd t = tally_of(200, 5, recipe_of("contour-end", {{"side", 1}, {"segment", 2}}), lap);
            EXPECT_EQ(t.seen, 200);
            EXPECT_EQ(t.wrong, 0) << "step " << least << (face ? ", face" : "");
            EXPECT_GE(t.covered, 0.9 * t.ok - 4) << "step " << least << (face ? ", face" : "");
            EXPECT_GE(t.ok, face ? 20 : 195) << "step " << least;
            // The lower sheet leaves the field farther out: which of the two is meant is not said.
            EXPECT_EQ(tally_of(50, 5, recipe_of("contour-end", {{"side", 1}}), lap).ok, 0);
        }
}

TEST(EndHeads, AnEdgeIsFoundAndTheRimOfTheFieldIsNone) {
    const FeatureRecipe recipe = recipe_of("contour-end", {{"side", 1}});
    const HeadsEnd edge = tally_of(200, 6, recipe, [](Dicing&) { return Parts{{{-150, 0}, {0, 0}}}; });
    EXPECT_EQ(edge.ok, 200);
    EXPECT_GE(edge.covered, 184);
    EXPECT_EQ(tally_of(200, 6, recipe, [](Dicing&) { return Parts{{{-150, 0}, {30, 0}}}; }).ok, 0);
}

TEST(EndHeads, TheGroundOfAGrooveIsTheCorner) {
    for (const double angle : {60.0, 90.0, 120.0}) {
        const double half = 3 * std::tan(rad_from_deg(angle / 2));
        const HeadsEnd t = tally_of(200, 7, recipe_of("corner", {{"which", 2}}), [&](Dicing&) {
            return Parts{{{-150, 3}, {-half, 3}, {0, 0}, {half, 3}, {150, 3}}};
        });
        EXPECT_EQ(t.wrong, 0) << angle;
        EXPECT_GE(t.ok, 170) << angle;
    }
}

}  // namespace
}  // namespace seamwright
