// What the regions page promises against what the gate then does, on the simulated door.

#include <gtest/gtest.h>

#include "devices/exchange/pose_json.h"
#include "projects/proof/checklist.h"
#include "projects/proof/forecast.h"
#include "projects/proof/known_shift.h"
#include "projects/proof/zero_shift.h"
#include "tests/projects/commissioned.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

struct Commissioned {
    TemporaryFolder folder;
    std::optional<Station> station;

    Commissioned(int seed, const std::vector<PlannedSpot>& spots) {
        const nlohmann::json settings = {
            {"seed", seed},
            {"robot",
             {{"frames", {{"BASE_Region1", pose_json(default_cell_settings().base_from_workobject)}}}}}};
        const auto cell = SimulatedCell::open(settings).value();
        const Project bare = bare_project(settings).value();
        station.emplace(ProjectFile::create(folder / "door.seam", bare).value(), bare);
        EXPECT_TRUE(station->connect());
        for (const PlannedSpot& spot : spots) {
            const auto done = commission_spot(*station, *cell, spot);
            EXPECT_TRUE(done) << done.error().sentence();
        }
        EXPECT_TRUE(add_region(*station));
    }
    RegionForecast forecast() const {
        return forecast_region(station->project(), station->project().regions[0]).value();
    }
    CheckItem item(CheckStep step) {
        Facts facts;
        EXPECT_TRUE(gather(station->file(), facts));
        return checklist(station->project(), facts).at(static_cast<std::size_t>(step));
    }
};

constexpr PlannedSpot kTop{2, TaughtBy::wide_template}, kBottom{6, TaughtBy::wide_template},
    kHinge{11, TaughtBy::wide_template}, kCorner{0, TaughtBy::wide_template};

TEST(Commissioning, WhatIsForecastSureEnoughIsNeverRefused) {
    for (int seed = 1; seed <= 4; ++seed) {
        Commissioned door(seed, {kTop, kBottom, kHinge, kCorner});
        const RegionForecast forecast = door.forecast();
        EXPECT_TRUE(forecast.enough()) << forecast.sigma_mm;
        EXPECT_TRUE(door.item(CheckStep::observable).done());
        ASSERT_TRUE(measure_zero_shift(*door.station, {3, {}, {}, {}, {}}));
        EXPECT_TRUE(door.item(CheckStep::zero_shift).done());
        KnownShiftOptions options;
        options.grid.step_mm = 10;
        options.grid.step_deg = 1;
        double largest = 0;
        options.measured = [&](const RunRecord& run) {
            for (const RegionRecord& r : run.regions)
                largest = std::max(largest, r.correction->sigma_at_spots_mm);
        };
        const auto proof = prove_known_shift(*door.station, options);
        ASSERT_TRUE(proof) << proof.error().sentence();
        EXPECT_TRUE(door.item(CheckStep::known_shift).done())
            << door.item(CheckStep::known_shift).why.in(Language::english);
        EXPECT_LE(largest, forecast.sigma_mm) << "the weakest direction is no weaker than its worst spot";
        // 54 or more deviations: their rms within a third of what was promised for the worst of them.
        EXPECT_LT(proven_accuracy(*proof, "Region1").three_sigma_mm, 3 * forecast.sigma_mm * 1.33);
    }
}

TEST(Commissioning, WhatIsNotSureEnoughIsSaidBeforehandWithItsCure) {
    const PlannedSpot end{6, TaughtBy::contour_end};
    Commissioned door(1, {kTop, end, kHinge});
    const RegionForecast forecast = door.forecast();
    EXPECT_FALSE(forecast.enough());
    ASSERT_FALSE(forecast.cures.empty());
    for (const Cure& cure : forecast.cures) EXPECT_LT(cure.sigma_mm, forecast.sigma_mm);
    // It would indeed have been refused.
    const auto zero = measure_zero_shift(*door.station, {3, {}, {}, {}, {}});
    ASSERT_TRUE(zero);
    EXPECT_GE(zero->refused, 1);
    // The cure does what it promises: the second spot by a template.
    const auto better = std::find_if(forecast.cures.begin(), forecast.cures.end(), [](const Cure& c) {
        return c.what.in(Language::english).starts_with("spot S2: its feature");
    });
    ASSERT_NE(better, forecast.cures.end());
    Commissioned cured(1, {kTop, kBottom, kHinge});
    EXPECT_NEAR(cured.forecast().sigma_mm / better->sigma_mm, 1, 0.1);
}

}  // namespace
}  // namespace seamwright
