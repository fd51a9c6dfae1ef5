// The joints at which a single feature is most easily wrong and yet ok; the long test has every kind of them.

#include "contour_scenes.h"

#include <gtest/gtest.h>

#include <functional>

#include "core/features/kinds/feature_registry.h"
#include "core/profile/filter.h"

namespace seamwright::scenes {
namespace {

Feature found(const Scene& scene, Dice& dice) {
    Profile profile = scene.profile(dice);
    EXPECT_TRUE(filter_profile(profile, {}));
    return make_feature_finder(scene.recipe).value()->find(profile);
}

Tally tally(const std::function<Scene(Dice&)>& make, std::uint64_t seed) {
    Tally t;
    Dice dice(seed);
    for (int i = 0; i < 60; ++i) {
        Scene scene = make(dice);
        if (dice.chance(0.5)) scene.mirror();
        t.add(scene, found(scene, dice));
    }
    return t;
}

TEST(ContourSceneEnds, TheFieldsRimIsNoEnd) {
    const Tally t = tally(edge_out_of_field, 21);
    EXPECT_EQ(t.wrong, 0);
    Dice dice(22);
    const Feature f = found(edge_out_of_field(dice), dice);
    EXPECT_EQ(f.status, FeatureStatus::not_found);
    EXPECT_NE(f.message.english().find("leaves the sensor's field"), std::string::npos) << f.message;
}

TEST(ContourSceneEnds, WithoutEmptyLinesTheRecipeSaysWhereTheFieldEnds) {
    Dice dice(23);
    for (int i = 0; i < 40; ++i) {
        Scene s = edge_out_of_field(dice);
        s.sensor.rows_dropped = true;
        s.sensor.reversed = false;
        // The sheet's other end lies inside, so that nothing tells the field but the recipe.
        s.sheets[0][0] = s.sheets[0][1] - Vector2d(1.4 * s.sensor.half_field(), 0);
        s.recipe.parameters["field_x_min_mm"] = -s.sensor.half_field();
        s.recipe.parameters["field_x_max_mm"] = s.sensor.half_field();
        EXPECT_NE(found(s, dice).status, FeatureStatus::ok);
        Scene inside = bare_edge(dice);
        inside.sensor.rows_dropped = true;
        inside.recipe.parameters["field_x_min_mm"] = -inside.sensor.half_field();
        inside.recipe.parameters["field_x_max_mm"] = inside.sensor.half_field();
        const Feature f = found(inside, dice);
        EXPECT_EQ(f.status, FeatureStatus::ok) << f.message;
        EXPECT_TRUE(Tally::is_right(inside, f));
    }
}

TEST(ContourSceneEnds, OfALapTheAskedSheet) {
    for (const char* which : {"highest", "lowest", "default"}) {
        const Tally t = tally([&](Dice& d) { return lap(d, which); }, 24);
        EXPECT_EQ(t.wrong, 0) << which;
        EXPECT_LE(t.refused, 1) << which;
    }
    Dice dice(25);
    const Feature f = found(lap(dice, "default"), dice);
    EXPECT_EQ(f.status, FeatureStatus::ambiguous);
    EXPECT_EQ(f.rivals_mm.size(), 2U) << f.message;
}

TEST(ContourSceneEnds, TheRimOfAHoleOrGap) {
    for (const double widest : {3., 20.}) {
        const Tally t = tally([&](Dice& d) { return gap_rim(d, 0.2, widest, 0.3); }, 26);
        EXPECT_EQ(t.wrong, 0) << widest;
        EXPECT_LE(t.refused, 1) << widest;
    }
}

TEST(ContourSceneEnds, ACodeForNoReturnIsNoContour) {
    Dice dice(27);
    for (const double code : {-9999., -32768., -99.999, 0., 9999.99})
        for (int i = 0; i < 12; ++i) {
            const Scene s = i % 2 ? bare_edge(dice) : gap_rim(dice, 3, 20, 0);
            Profile p = s.profile(dice);
            for (double& z : p.z_mm)
                if (std::isnan(z)) z = code;
            ASSERT_TRUE(filter_profile(p, {}));
            const Feature f = make_feature_finder(s.recipe).value()->find(p);
            ASSERT_EQ(f.status, FeatureStatus::ok) << code << ": " << f.message;
            EXPECT_TRUE(Tally::is_right(s, f)) << code;
        }
}

TEST(ContourSceneCorners, OneOfSeveralOnlyWhenAsked) {
    for (const char* which : {"window", "lowest", "default"}) {
        const Tally t = tally([&](Dice& d) { return groove(d, which); }, 28);
        EXPECT_EQ(t.wrong, 0) << which;
        EXPECT_LE(t.refused, 1) << which;
    }
    EXPECT_EQ(tally(z_fold, 29).wrong, 0);
    Dice dice(30);
    const Feature f = found(z_fold(dice), dice);
    EXPECT_EQ(f.status, FeatureStatus::ambiguous) << f.message;
    EXPECT_EQ(f.rivals_mm.size(), 2U);
}

// Every second point of a profile sees the same corners as the others.
TEST(ContourSceneCorners, OddAndEvenPointsAgreeOrNeitherAnswers) {
    Dice dice(31);
    for (int i = 0; i < 60; ++i) {
        Scene s = i % 2 ? z_fold(dice) : groove(dice, "default");
        const double far = dice.uniform(8, 25);
        s.window(s.truth.x() - far, s.truth.x() + dice.uniform(8, 25));
        const Profile all = s.profile(dice);
        Vector2d places[2];
        int ok = 0;
        for (int odd = 0; odd < 2; ++odd) {
            Profile half;
            for (std::size_t k = std::size_t(odd); k < all.size(); k += 2)
                half.x_mm.push_back(all.x_mm[k]), half.z_mm.push_back(all.z_mm[k]);
            ASSERT_TRUE(filter_profile(half, {}));
            const Feature f = make_feature_finder(s.recipe).value()->find(half);
            if (f.status == FeatureStatus::ok) places[ok++] = f.point_mm;
        }
        if (ok == 2) {
            EXPECT_LT((places[0] - places[1]).norm(), 0.5) << i;
        }
    }
}

TEST(ContourSceneCorners, AFlankOfEightyDegrees) {
    const Tally t = tally(t_joint, 32);
    EXPECT_EQ(t.wrong, 0);
    EXPECT_LE(t.refused, 1);
}

TEST(ContourSceneFlanks, TheFilterKeepsTheirPoints) {
    Dice dice(33);
    for (const double slope : {60., 75., 80., 83.}) {
        int lost = 0, all = 0;
        for (int i = 0; i < 30; ++i) {
            SensorModel sensor = SensorModel::any(dice);
            sensor.grid = i % 2 ? Grid::exact : Grid::raw;
            sensor.noise = std::min(sensor.noise, 0.3 * sensor.pitch);
            Flanks f = flanks(sensor, slope, static_cast<int>(dice.uniform(10, 110)), dice);
            ASSERT_TRUE(filter_profile(f.profile, {}));
            for (const int k : f.of_flank) lost += f.profile.segment[std::size_t(k)] == kOutlier;
            all += static_cast<int>(f.of_flank.size());
        }
        EXPECT_LE(lost, 0.002 * all) << slope;
    }
}

}  // namespace
}  // namespace seamwright::scenes
