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

INSTANTIATE_TEST_SUITE_P(Beads, BeadTop, testing::Values(Grid::raw, Grid::exact));

}  // namespace
}  // namespace seamwright::scenes
