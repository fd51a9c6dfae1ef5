// Look-up tables: what they state against the truth of a world of its own, for lenses as they are built, with a robot as
// the stage whose arrivals scatter.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/calibration/table/lookup_table_calibration.h"
#include "tests/core/calibration/independent/plain_world.h"

namespace seamwright {
namespace {

using namespace plain;

struct Table {
    Lens lens;
    Motion camera_from_laser;
    Vec2 see(const Vec2& xz) const { return lens.see(camera_from_laser * Vec3(xz.x(), 0, xz.y())); }
    // Where a pixel's ray meets the light: Newton by differences.
    std::optional<Vec2> at(const Vec2& pixel) const {
        Vec2 xz(0, 0);
        for (int round = 0; round < 30; ++round) {
            const Vec2 miss = see(xz) - pixel;
            Eigen::Matrix2d j;
            for (int k = 0; k < 2; ++k) j.col(k) = (see(xz + 1e-3 * Vec2::Unit(k)) - see(xz)) / 1e-3;
            const Vec2 step = j.partialPivLu().solve(miss);
            if (!step.allFinite()) return std::nullopt;
            xz -= step;
            if (step.norm() < 1e-9) return xz;
        }
        return std::nullopt;
    }
};

struct World {
    int count = 100;
    double noise_px = 0.1, stage_mm = 0;
    bool grid = true, stated = false;
};

void run(const World& w, int trials, Share& s, Share& middle) {
    for (int trial = 0; trial < trials; ++trial) {
        Dice dice(static_cast<unsigned>(7919 * trial + 13 * w.count + static_cast<int>(1e4 * w.noise_px) +
                                        static_cast<int>(1e5 * w.stage_mm)));
        Table world;
        world.lens = any_lens(dice);
        // The light lies before the camera and is seen from 25 to 45 degrees aside.
        world.camera_from_laser = motion(Vec3(dice.u(0.8, 1.1), dice.u(-0.1, 0.1), dice.u(-0.1, 0.1)),
                                         Vec3(dice.u(-10, 10), dice.u(-10, 10), dice.u(300, 400)));
        const int side = static_cast<int>(std::lround(std::sqrt(w.count)));
        std::vector<LaserPair> pairs;
        for (int i = 0; static_cast<int>(pairs.size()) < w.count && i < 100 * w.count; ++i) {
            const Vec2 pixel =
                w.grid ? Vec2(20 + (i % side) * 1240.0 / (side - 1), 20 + (i / side) * 920.0 / (side - 1))
                       : Vec2(dice.u(10, 1270), dice.u(10, 950));
            const auto xz = world.at(pixel);
            if (!xz || (world.see(*xz) - pixel).norm() > 1e-6) continue;
            // The robot says xz and stands beside it.
            const Vec2 seen = world.see(*xz + w.stage_mm * Vec2(dice.n(), dice.n())) +
                              w.noise_px * Vec2(dice.n(), dice.n());
            pairs.push_back({fmt::format("p{}", i), seen.cwiseMax(0).cwiseMin(Vec2(1279, 959)), *xz});
        }
        LookupTableOptions options;
        options.step_px = 32;
        if (w.stated) options.place_sigma_mm = w.stage_mm;
        if (static_cast<int>(pairs.size()) < w.count) continue;  // a lens that folds
        const auto r = calibrate_lookup_table(1280, 960, pairs, options);
        ASSERT_TRUE(r) << r.error().sentence();
        const auto& p = r->report.parameters;
        for (std::size_t k = 0; k + 1 < p.size(); k += 2) {
            double u = 0, v = 0;
            ASSERT_EQ(std::sscanf(p[k].name.c_str(), "x(%lf,%lf)", &u, &v), 2);
            const auto truth = world.at({u, v});
            ASSERT_TRUE(truth);
            for (int c = 0; c < 2; ++c) {
                const auto& q = p[k + static_cast<std::size_t>(c)];
                (k == 0 ? middle : s).add(q.value - (*truth)(c), q.sigma);
            }
        }
    }
}

// 25 pairs are advised; fewer that stand in a grid tell as much as they say.
TEST(LookupTableIntervals, HoldTheTruth) {
    constexpr int kTrials = 20;
    Share rims, middles;
    for (const int count : {16, 25, 49, 100, 225})
        for (const bool grid : {true, false})
            for (const double px : {0.05, 0.4})
                for (const double stage_mm : {0.0, 0.05}) {
                    if (count < 25 && !grid) continue;
                    Share rim, middle;
                    run({count, px, stage_mm, grid, false}, kTrials, rim, middle);
                    rim.print(fmt::format("{} {} px {} mm {} rim", count, grid ? "grid" : "scattered", px,
                                          stage_mm));
                    rims.add(rim), middles.add(middle);
                }
    rims.print("all, towards the rim");
    middles.print("all, in the middle");
    for (const Share& s : {rims, middles}) {
        EXPECT_GT(s.value(), 0.92);
        EXPECT_LT(s.value(), 0.98);
    }
}

// A stage that is stated counts where few pairs do not show it.
TEST(LookupTableIntervals, AStatedStageIsNeverLess) {
    Share known, unknown, middle;
    run({16, 0.02, 0.1, true, true}, 100, known, middle);
    run({16, 0.02, 0.1, true, false}, 100, unknown, middle);
    known.print("stage stated");
    unknown.print("stage not stated");
    EXPECT_GT(known.value(), 0.93);
    EXPECT_LT(known.nees, 0.95 * unknown.nees);
}

}  // namespace
}  // namespace seamwright
