// The top of a bead: found with nothing but what is meant, and as unsure as it says, on both grids, over radii, pitches and noises.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "contour_scenes.h"
#include "core/features/kinds/feature_registry.h"
#include "core/profile/filter.h"

namespace seamwright::scenes {
namespace {

struct Bead {
    double radius, noise;
    int points;  // on 60 mm
};
constexpr double kField = 60;

Scene scene_of(const Bead& kind, Grid grid, const char* name) {
    Scene s;
    s.sensor.points = kind.points;
    s.sensor.pitch = kField / kind.points;
    s.sensor.noise = kind.noise;
    s.sensor.grid = grid;
    s.recipe.kind = name;
    return s;
}

struct Tops {
    int all = 0, found = 0, within = 0;
    void add(const Scene& s, Dice& dice, int smoothed = 1) {
        Profile p = s.profile(dice);
        smooth(p, smoothed);
        EXPECT_TRUE(filter_profile(p, {}));
        const Feature f = make_feature_finder(s.recipe).value()->find(p);
        ++all;
        if (f.status != FeatureStatus::ok) return;
        const Vector2d e = f.point_mm - s.truth;
        ++found;
        within += e.dot(f.covariance_mm2.ldlt().solve(e)) < 5.991;
    }
    void expect(double least_found, double least_within) const {
        EXPECT_GE(found, least_found * all);
        EXPECT_GE(within, least_within * found);
    }
};

constexpr int kEach = 40;
class BeadTop : public testing::TestWithParam<Grid> {};

// Of a circle's segment of height 2 mm, asked with nothing but what is meant.
TEST_P(BeadTop, ABeadsTopIsFoundByItself) {
    static constexpr Bead kBeads[] = {
        {5, .05, 800}, {5, .03, 640}, {4, .02, 640}, {5, .05, 1280}, {8, .03, 640}};
    for (const int smoothed : {1, 5}) {
        Tops count;
        Dice dice(45);
        for (const Bead& kind : kBeads)
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
