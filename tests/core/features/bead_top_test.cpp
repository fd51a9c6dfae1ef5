// The top of a bead: found with nothing but what is meant, and as unsure as it says, on both grids, over radii, pitches and noises.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "round_shapes.h"

namespace seamwright::scenes {
namespace {

constexpr int kEach = 40;
class BeadTop : public testing::TestWithParam<Grid> {};

// Of a circle's segment of height 2 mm, asked with nothing but what is meant.
TEST_P(BeadTop, ABeadsTopIsFoundByItself) {
    static constexpr RoundShape kBeads[] = {
        {5, .05, 800}, {5, .03, 640}, {4, .02, 640}, {5, .05, 1280}, {8, .03, 640}};
    for (const int smoothed : {1, 5}) {
        Coverage count;
        Dice dice(45);
        for (const RoundShape& kind : kBeads)
            for (int i = 0; i < kEach; ++i) {
                Scene s = scene_of(kind, GetParam(), "extremum");
                const double half = std::acos((kind.radius - 2) / kind.radius);
                Sheet sheet{{-kFar, 0}, {-kind.radius * std::sin(half), 0}};
                const double half_deg = half * 180 / std::numbers::pi;
                roll(sheet, half_deg, -2 * half_deg, kind.radius);
                go(sheet, 0, kFar);
                s.sheets = {sheet};
                s.truth = {0, 2};
                s.turn(0, {dice.uniform(-8, 8), dice.uniform(-8, 8)});
                if (dice.chance(0.5)) s.look_down();
                count.add(s, dice, GetParam() == Grid::exact ? smoothed : 1);
            }
        count.expect(0.8, 0.8);
    }
}

// A bead that leans: exp(-w^2 / 2) over a width that grows to one side. Noise hides the lean from a parabola, not its effect.
TEST_P(BeadTop, OfABeadThatLeansIsAsUnsureAsItSays) {
    Coverage count;
    Dice dice(46);
    for (const double lean : {0., .1, .25})
        for (const double noise : {.02, .06})
            for (int i = 0; i < 40; ++i) {
                Scene s = scene_of({0, noise, 1600}, GetParam(), "extremum");
                Sheet sheet{{-kFar, 0}};
                for (double x = -6; x <= 6; x += 0.05) {
                    const double w = lean > 0 ? std::log1p(std::max(lean * x / 2, -.95)) / (lean / 2) : x;
                    sheet.push_back({x, 2 * std::exp(-0.5 * std::pow(w / 2, 2))});
                }
                go(sheet, 0, kFar);
                s.sheets = {sheet};
                s.truth = {0, 2};
                s.turn(0, {dice.uniform(-4, 4), dice.uniform(-4, 4)});
                s.window(s.truth.x() - 7, s.truth.x() + 7);
                if (dice.chance(0.5)) s.mirror();
                count.add(s, dice);
            }
    count.expect(0.95, 0.93);
}

// Few points on the bead, each the mean of five.
TEST_P(BeadTop, OfFewSmoothedPointsIsAsUnsureAsItSays) {
    Coverage count;
    Dice dice(47);
    for (int i = 0; i < 200; ++i) {
        const double radius = dice.uniform(3, 10);
        Scene s = scene_of({radius, .05, 300}, GetParam(), "extremum");
        Sheet sheet{{-kFar, 0}, {-0.8 * radius, 0}};
        const double half_deg = std::asin(0.8) * 180 / std::numbers::pi;
        roll(sheet, half_deg, -2 * half_deg, radius);
        go(sheet, 0, kFar);
        s.sheets = {sheet};
        s.truth = {0, 0.4 * radius};
        s.turn(0, {dice.uniform(-8, 8), dice.uniform(-8, 8)});
        count.add(s, dice, GetParam() == Grid::exact ? 5 : 1);
    }
    count.expect(0.1, 0.7);
}

INSTANTIATE_TEST_SUITE_P(Beads, BeadTop, testing::Values(Grid::raw, Grid::exact));

}  // namespace
}  // namespace seamwright::scenes
