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

INSTANTIATE_TEST_SUITE_P(Rims, Rim, testing::Values(Grid::raw, Grid::exact));

}  // namespace
}  // namespace seamwright::scenes
