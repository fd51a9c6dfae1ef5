#pragma once
// Round pieces of contour before a sensor, and how often a feature of one is found and as unsure as it says.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "contour_scenes.h"
#include "core/features/kinds/feature_registry.h"
#include "core/profile/filter.h"

namespace seamwright::scenes {

struct RoundShape {
    double radius, noise;
    int points;  // on 60 mm
};

inline Scene scene_of(const RoundShape& shape, Grid grid, const char* feature_kind) {
    constexpr double kField = 60;
    Scene s;
    s.sensor.points = shape.points;
    s.sensor.pitch = kField / shape.points;
    s.sensor.noise = shape.noise;
    s.sensor.grid = grid;
    s.recipe.kind = feature_kind;
    return s;
}

struct Coverage {
    int all = 0, found = 0, within = 0;  // within: the stated 95 % ellipse
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

}  // namespace seamwright::scenes
