// Single features over some hundred scenes of every kind: right, refused, wrong and yet ok.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cstdio>
#include <functional>

#include "contour_scenes.h"
#include "core/features/kinds/feature_registry.h"
#include "core/profile/filter.h"
#include "joints.h"

namespace seamwright::scenes {
namespace {

struct Kind {
    const char* name;
    std::function<Scene(Dice&)> make;
    double least_right;
};

const std::vector<Kind>& kinds() {
    static const std::vector<Kind> all{
        {"bare edge", bare_edge, 0.99},
        {"edge beyond the field", edge_out_of_field, 1},
        {"window ends before the edge", window_before_the_end, 1},
        {"lap, upper sheet asked for", [](Dice& d) { return lap(d, "highest"); }, 0.99},
        {"lap, lower sheet asked for", [](Dice& d) { return lap(d, "lowest"); }, 0.99},
        {"lap, nothing asked for", [](Dice& d) { return lap(d, "default"); }, 1},
        {"hem flange, radius 0.9 to 1.5", [](Dice& d) { return rounded_rim(d, 0.9, 1.5); }, 0.99},
        {"rounded rim, radius 1.5 to 8", [](Dice& d) { return rounded_rim(d, 1.5, 8); }, 0.99},
        {"butt gap 0.2 to 3", [](Dice& d) { return gap_rim(d, 0.2, 3, 0.3); }, 0.99},
        {"hole rim, 3 to 20 wide", [](Dice& d) { return gap_rim(d, 3, 20, 0); }, 0.99},
        {"one sharp corner", [](Dice& d) { return bend(d, false); }, 0.99},
        {"one rounded corner", [](Dice& d) { return bend(d, true); }, 0.99},
        {"groove in a window", [](Dice& d) { return groove(d, "window"); }, 0.99},
        {"groove, lowest asked for", [](Dice& d) { return groove(d, "lowest"); }, 0.99},
        {"groove, nothing asked for", [](Dice& d) { return groove(d, "default"); }, 1},
        {"T-joint, flank 70 to 80 degrees", t_joint, 0.99},
        {"Z-fold, nothing asked for", z_fold, 1},
        {"bare edge with burr", burr_end, 0.95},
        {"fillet weld, toe in a window", weld_toe, 0.99},
        {"embossed bead, its top", [](Dice& d) { return bead_top(d, true); }, 0.97},
        {"sharp ridge, its top", [](Dice& d) { return bead_top(d, false); }, 1},
        {"rim radius 2 to 8, its centre", rim_centre, 0.92},
        {"template of any joint", template_of, 0.94},
    };
    return all;
}

// What neighbours have in common; such a sensor delivers the lines as they stand.
struct Shared {
    int smoothed = 1, speckle = 1;
    bool any() const { return smoothed > 1 || speckle > 1; }
};

Tally tally_of(const Kind& kind, const Shared& shared, int trials) {
    const char* seed = std::getenv("SEAMWRIGHT_SEED");
    Tally tally;
    Dice dice(seed ? std::strtoull(seed, nullptr, 10) : 11);
    for (int i = 0; i < trials; ++i) {
        Scene scene = kind.make(dice);
        if (dice.chance(0.5)) scene.mirror();
        // Which sheet covers the other is a matter of the z axis; a recipe for a sensor that looks along -z says the segment.
        const bool asks = scene.recipe.kind != "contour-end" || scene.recipe.parameters.contains("segment");
        if (dice.chance(0.3) && asks) scene.look_down();
        if (shared.any()) scene.sensor.grid = Grid::exact;
        const double noise = scene.sensor.noise;
        if (shared.speckle > 1) scene.sensor.noise = 0;
        Profile profile = scene.profile(dice);
        scene.sensor.noise = noise;
        if (shared.speckle > 1) speckle(profile, noise, shared.speckle, dice);
        smooth(profile, shared.smoothed);
        EXPECT_TRUE(filter_profile(profile, {}));
        auto finder = make_feature_finder(scene.recipe);
        if (!finder) {
            ++tally.refused;
            continue;
        }
        const Feature f = (*finder)->find(profile);
        const int wrong = tally.wrong, refused = tally.refused;
        tally.add(scene, f);
        if ((tally.wrong > wrong || tally.refused > refused) && std::getenv("SEAMWRIGHT_SCENES"))
            std::printf(
                "  %s %d: %s (%.3f %.3f) for (%.3f %.3f), sigma %.3f; %d x %.3f noise %.3f grid %d "
                "missing %.3f reversed %d down %d: %s\n",
                kind.name, i, std::string(to_string(f.status)).c_str(), f.point_mm.x(), f.point_mm.y(),
                scene.truth.x(), scene.truth.y(), std::sqrt(f.covariance_mm2.trace()), scene.sensor.points,
                scene.sensor.pitch, scene.sensor.noise, int(scene.sensor.grid), scene.sensor.missing,
                scene.sensor.reversed, scene.sensor.down, f.message.english().c_str());
    }
    std::printf("%-34s right %3d  refused %3d  wrong %3d of %d\n", kind.name, tally.right, tally.refused,
                tally.wrong, tally.all());
    return tally;
}

TEST(ContourScenes, RightOrRefusedButNeverWrong) {
    for (const Kind& kind : kinds()) {
        const Tally tally = tally_of(kind, {}, trials_of(500));
        // Where a lap's step is at the limit of what can be seen, about nine sigma, one end in some hundred
        // is that of the other sheet.
        EXPECT_LE(tally.wrong, tally.all() / 500) << kind.name;
        EXPECT_GE(tally.right, kind.least_right * tally.all()) << kind.name;
    }
}

// A lap whose step a mean of `neighbours` leaves steeper than 63 degrees: what is flatter is a flank to anybody.
Scene clear_lap(Dice& dice, const char* meant, int neighbours) {
    for (;;) {
        Scene s = lap(dice, meant);
        const Vector2d along = (s.sheets[0][1] - s.sheets[0][0]).normalized(),
                       down = s.sheets[1][0] - s.sheets[0][1];
        if (std::abs(along.x() * down.y() - along.y() * down.x()) > 2 * neighbours * s.sensor.pitch) return s;
    }
}

// Whether a hem of few points is a line or an arc, nobody knows: its end is as unsure as both make it.
TEST(ContourScenes, RoundedEndsAreAsUnsureAsTheySay) {
    for (const auto& [least, most, covered] : {std::array{0.9, 1.5, 0.85}, {1.5, 8.0, 0.86}}) {
        Dice dice(12);
        int found = 0, within = 0;
        for (int i = 0; i < 1000; ++i) {
            const Scene scene = rounded_rim(dice, least, most);
            Profile profile = scene.profile(dice);
            ASSERT_TRUE(filter_profile(profile, {}));
            const Feature f = make_feature_finder(scene.recipe).value()->find(profile);
            if (f.status != FeatureStatus::ok) continue;
            const Eigen::Vector2d e = f.point_mm - scene.truth;
            ++found;
            within += e.dot(f.covariance_mm2.inverse() * e) < 5.991;
        }
        EXPECT_GE(found, 980);
        EXPECT_GE(within, covered * found) << least << " to " << most;
        EXPECT_LE(within, 0.98 * found) << least << " to " << most;
    }
}
TEST(ContourScenes, SharedNoiseMakesNoOthers) {
    for (const Shared shared : {Shared{.smoothed = 3}, {.smoothed = 5}, {.speckle = 5}}) {
        const int neighbours = shared.smoothed;
        const std::vector<Kind> kinds{
            {"bare edge", bare_edge, 0.98},
            {"edge beyond the field", edge_out_of_field, 1},
            {"window ends before the edge", window_before_the_end, 0.995},
            {"lap, upper sheet asked for", [=](Dice& d) { return clear_lap(d, "highest", neighbours); },
             0.98},
            {"lap, lower sheet asked for", [=](Dice& d) { return clear_lap(d, "lowest", neighbours); }, 0.98},
            {"lap, nothing asked for", [=](Dice& d) { return clear_lap(d, "default", neighbours); }, 0.98},
            {"rounded rim, radius 1.5 to 8", [](Dice& d) { return rounded_rim(d, 1.5, 8); }, 0.96},
            {"hole rim, 3 to 20 wide", [](Dice& d) { return gap_rim(d, 3, 20, 0); }, 0.97},
            {"butt gap 0.2 to 3", [](Dice& d) { return gap_rim(d, 0.2, 3, 0.3); }, 0.98},
            {"one sharp corner", [](Dice& d) { return bend(d, false); }, 0.98},
            {"fillet weld, toe in a window", weld_toe, 0.97},
        };
        for (const Kind& kind : kinds) {
            const Tally tally = tally_of(kind, shared, trials_of(300));
            EXPECT_LE(tally.wrong, tally.all() / 200)
                << kind.name << " " << shared.smoothed << shared.speckle;
            EXPECT_GE(tally.right, kind.least_right * tally.all())
                << kind.name << " " << shared.smoothed << shared.speckle;
        }
    }
}

TEST(ContourScenes, FlanksKeepTheirPoints) {
    static constexpr const char* grids[] = {"x with noise", "exact x", "resampled"};
    for (const double slope : {45., 60., 70., 75., 80., 83.})
        for (int grid = 0; grid < 3; ++grid) {
            Dice dice(12);
            int lost = 0, all = 0, bad = 0, marked = 0;
            for (int i = 0; i < 100; ++i) {
                SensorModel sensor = SensorModel::any(dice);
                sensor.grid = static_cast<Grid>(grid);
                sensor.noise = std::min(sensor.noise, 0.3 * sensor.pitch);
                Flanks f = flanks(sensor, slope, static_cast<int>(dice.uniform(10, 110)), dice);
                ASSERT_TRUE(filter_profile(f.profile, {}));
                int here = 0;
                for (const int k : f.of_flank) here += f.profile.segment[std::size_t(k)] == kOutlier;
                for (std::size_t k = 0; k < f.profile.size(); ++k)
                    marked += std::isfinite(f.profile.z_mm[k]) && f.profile.segment[k] == kOutlier;
                lost += here;
                all += static_cast<int>(f.of_flank.size());
                bad += here > 0.2 * double(f.of_flank.size());
            }
            std::printf(
                "flanks of %2.0f degrees, %-12s lost %5.2f %%  (%d profiles lost more than a fifth), marked "
                "%d\n",
                slope, grids[grid], 100. * lost / all, bad, marked);
            // Interpolated points of a flank of 80 degrees scatter by more than noise alone.
            EXPECT_LE(lost, (grid == 2 ? 0.03 : 0.002) * all) << slope << " " << grids[grid];
        }
}

}  // namespace
}  // namespace seamwright::scenes
