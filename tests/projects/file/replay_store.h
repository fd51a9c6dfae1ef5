#pragma once
// A file with many stored runs of the fake cell, made through the station.

#include <gtest/gtest.h>

#include "projects/proof/replay.h"
#include "projects/station/station.h"
#include "tests/projects/fake_cell.h"
#include "tests/projects/sample_project.h"

namespace seamwright {

// `runs` runs of `spots` spots with noise, every tenth with a damaged frame; half way the project is edited. Each run is a
// part of its own where `part` is empty.
inline void store_runs(const std::filesystem::path& path, int runs, int spots, const std::string& part = {}) {
    auto cell = make_fake_cell(spots);
    cell->noise_mm = 0.02;
    for (Spot& spot : cell->project.spots) spot.required = spot.id != "S2";
    // Two kinds of features.
    for (std::size_t i = 1; i < cell->project.spots.size(); i += 5) {
        FeatureRecipe recipe;
        recipe.kind = "template";
        recipe.template_profile = cell->cut(cell->project.spots[i]);
        recipe.template_reference_mm = {1.5, -2};
        cell->project.spots[i].feature = recipe;
    }
    auto file = ProjectFile::create(path, cell->project);
    ASSERT_TRUE(file) << file.error().sentence();
    Station station(std::move(*file), cell->project);
    std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
    sensors["A"] = std::make_unique<FakeSensor>(*cell);
    std::map<std::string, std::unique_ptr<RobotLink>> robots;
    robots["R1"] = std::make_unique<FakeRobot>(*cell);
    station.connect(std::move(sensors), std::move(robots));
    std::normal_distribution<double> n;
    for (int i = 0; i < runs; ++i) {
        Vector6 d;
        for (int k = 0; k < 6; ++k) d[k] = k < 3 ? 2 * n(cell->rng) : 3e-3 * n(cell->rng);
        cell->workobject_from_movedworkobject = retract(Pose::Identity(), d);
        cell->damaged_at = i % 10 == 3 ? "S2" : "";
        if (i == runs / 2) {
            Project edited = station.project();
            edited.spots[0].reference_mm.x() += 0.1;
            edited.sensors[0].filter.band_sigmas = 5;
            ASSERT_TRUE(station.edit(edited));
        }
        RunOptions options;
        options.part_id = part;
        auto record = station.run(options);
        ASSERT_TRUE(record) << record.error().sentence();
        ASSERT_TRUE(record->status == RunStatus::ok || record->status == RunStatus::refused)
            << record->message;
    }
}

// Reproduced bit for bit, whatever the number of threads.
inline void expect_reproduced(const std::filesystem::path& path, int runs, int spots) {
    for (const int jobs : {1, 2, 3}) {
        ReplayOptions options;
        options.jobs = jobs;
        int told = 0;
        options.progress = [&](int done, int total) {
            EXPECT_EQ(done, ++told);
            EXPECT_EQ(total, runs);
        };
        auto result = replay(path, options);
        ASSERT_TRUE(result) << result.error().sentence();
        EXPECT_EQ(result->runs, runs);
        EXPECT_EQ(result->captures, runs * spots);
        EXPECT_EQ(told, runs);
        for (const ReplayDifference& d : result->differences)
            ADD_FAILURE() << d.run << " " << d.what << ": " << d.text;
    }
}

}  // namespace seamwright
