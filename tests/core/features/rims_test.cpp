// The centre of an arc that straights run into: found, and as unsure as it says, on both grids, over radii, pitches and noises.

#include <gtest/gtest.h>

#include <cmath>

#include "round_shapes.h"

namespace seamwright::scenes {
namespace {

// A sheet that bends down by `sweep` degrees and ends there, or goes on straight.
Scene rim(const RoundShape& kind, Grid grid, double sweep, bool goes_on, Dice& dice) {
    Scene s = scene_of(kind, grid, "circle");
    Sheet sheet{{-kFar, 0}, {0, 0}};
    roll(sheet, 0, -sweep, kind.radius);
    if (goes_on) go(sheet, -sweep, kFar);
    s.sheets = {sheet};
    s.truth = {0, -kind.radius};
    s.turn(dice.uniform(-4, 4), {dice.uniform(-2, 2), dice.uniform(-2, 2)});
    return s;
}

constexpr RoundShape kRims[] = {{3, .03, 640}, {5, .03, 640}, {2, .02, 1280},
                                {5, .05, 320}, {8, .03, 640}, {3, .01, 2048}};
constexpr int kEach = 40;

class Rim : public testing::TestWithParam<Grid> {};

TEST_P(Rim, BesideAStraightInTheWindow) {
    for (const bool known : {false, true}) {
        Coverage count;
        Dice dice(41);
        for (const RoundShape& kind : kRims)
            for (int i = 0; i < kEach; ++i) {
                Scene s = rim(kind, GetParam(), 80, false, dice);
                const double from = s.sheets[0][1].x();
                s.window(from - dice.uniform(0.3, 4.5), from + kind.radius + 1);
                if (known) s.recipe.parameters["radius_mm"] = kind.radius;
                if (dice.chance(0.5)) s.mirror();
                count.add(s, dice);
            }
        count.expect(0.9, 0.93);
    }
}

TEST_P(Rim, BetweenTwoStraights) {
    Coverage count;
    Dice dice(42);
    for (const RoundShape& kind : kRims)
        for (int i = 0; i < kEach; ++i) count.add(rim(kind, GetParam(), 70, true, dice), dice);
    count.expect(0.9, 0.93);
}

TEST_P(Rim, InTheWholeProfile) {
    Coverage count;
    Dice dice(43);
    for (const RoundShape& kind : kRims)
        for (int i = 0; i < kEach; ++i) count.add(rim(kind, GetParam(), 80, false, dice), dice);
    count.expect(0.78, 0.93);
}

// From where it is all arc to where as much straight as the noise just hides is in it.
TEST_P(Rim, BesideHardlyAnyStraight) {
    Coverage count;
    Dice dice(44);
    for (const RoundShape& kind : kRims)
        for (int i = 0; i < kEach; ++i) {
            Scene s = rim(kind, GetParam(), 80, false, dice);
            const double from = s.sheets[0][1].x();
            s.window(from - kind.radius * dice.uniform(-0.3, 0.3), from + kind.radius + 1);
            count.add(s, dice);
        }
    count.expect(0.95, 0.93);
}

// Sides that are bent themselves. A circle of 16 mm lies within three noises of such a rim of 2 mm and of its sides, with more
// points than the rim: refused, or right, never far off.
TEST(RimBetweenBentSides, IsNeverTakenForALargeCircleOfRimAndSides) {
    Dice dice(45);
    for (const auto& [radius, sweep] : {std::pair(2., 60.), {5., 45.}, {5., 60.}}) {
        int found = 0, far = 0;
        for (int i = 0; i < 50; ++i) {
            Scene s = scene_of({radius, .06, 1600}, Grid::exact, "circle");
            s.sensor.points = 800;
            const auto side = [&] { return (dice.chance(0.5) ? 1 : -1) * dice.uniform(200, 1000); };
            const double left = side(), right = side(), degrees = 12 * 180 / M_PI;
            Sheet sheet{{-12, 0}};
            roll(sheet, sweep / 2 + degrees / left, -degrees / left, std::abs(left));
            s.truth = sheet.back() + turned({0, -radius}, rad(sweep / 2));
            roll(sheet, sweep / 2, -sweep, radius);
            roll(sheet, -sweep / 2, -degrees / right, std::abs(right));
            s.sheets = {sheet};
            s.turn(dice.uniform(-15, 15), {dice.uniform(-3, 3) - s.truth.x(), 0});
            const Profile p = s.profile(dice);
            const Feature f = make_feature_finder(s.recipe).value()->find(p);
            if (f.status != FeatureStatus::ok) continue;
            ++found;
            far += (f.point_mm - s.truth).norm() > radius;
        }
        EXPECT_EQ(far, 0) << "of " << found << " rims of " << radius << " mm over " << sweep << " degrees";
        EXPECT_GE(found, 15) << radius << " mm";
    }
}

// An error of form far above a good sensor's noise is no other circle.
TEST(RimWithAnErrorOfForm, IsNoRivalOfItself) {
    Dice dice(46);
    int found = 0;
    for (int i = 0; i < 100; ++i) {
        Scene s = scene_of({8, .003, 1280}, Grid::exact, "circle");
        const double lobes = dice.uniform(2, 5), phase = dice.uniform(0, 6);
        Sheet sheet;
        for (double deg = 150; deg >= 30; deg -= 1)
            sheet.push_back(turned({8 + 0.02 * std::cos(lobes * rad(deg) + phase), 0}, rad(deg)));
        sheet.insert(sheet.begin(), sheet.front() + turned({-kFar, 0}, rad(60)));
        sheet.push_back(sheet.back() + turned({kFar, 0}, rad(-60)));
        s.sheets = {sheet};
        s.turn(dice.uniform(-4, 4), {dice.uniform(-2, 2), dice.uniform(-2, 2)});
        const Feature f = make_feature_finder(s.recipe).value()->find(s.profile(dice));
        EXPECT_NE(f.status, FeatureStatus::ambiguous) << f.message;
        found += f.status == FeatureStatus::ok && (f.point_mm - s.truth).norm() < 0.5;
    }
    EXPECT_GE(found, 95);
}

// A corner's rounding need not be told: it is where its sides meet, with the stated sigma.
TEST(RoundedCorner, NeedsNoBlend) {
    for (const bool rounded : {true, false}) {
        Coverage told, found;
        Dice dice(47);
        for (int i = 0; i < 200; ++i) {
            Scene s = bend(dice, rounded);
            Dice again = dice;
            told.add(s, dice);
            s.recipe.parameters.erase("blend_mm");
            found.add(s, again);
        }
        found.expect(0.9 * told.found / told.all, 0.88);
    }
}

INSTANTIATE_TEST_SUITE_P(Rims, Rim, testing::Values(Grid::raw, Grid::exact));

}  // namespace
}  // namespace seamwright::scenes
