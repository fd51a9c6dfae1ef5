#include "projects/reuse/reteach.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "projects/measure/measure.h"
#include "projects/station/station.h"
#include "tests/projects/door_project.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

Pose sensor_at_part(const Project& p, const Spot& spot) {
    return p.part.base_from_workobject.inverse() * spot.base_from_flange *
           calibration_of(p, spot)->flange_from_sensor;
}

Calibration another(const Project& project, const Pose& offset) {
    Calibration c = project.calibrations[0];
    c.id = "C2";
    c.flange_from_sensor = c.flange_from_sensor * offset;
    return c;
}

TEST(Reteach, WhatWasTaughtInPixelsIsNotLedToMillimetres) {
    Project project = sample_project();
    project.calibrations.push_back(another(project, make_pose(rotation_exp({0, 3, 0}), {500, -3, 200})));
    project.calibrations[0].method = "pixels";
    const auto refused = after_exchange(project, {"A", "C2", {}});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::input);
    EXPECT_THAT(refused.error().sentence(), testing::HasSubstr("taught in pixels"));
}

TEST(Reteach, TheSensorStandsWhereItStood) {
    Project project = sample_project();
    project.calibrations.push_back(another(project, make_pose(rotation_exp({0.1, -0.05, 0.2}), {5, -3, 12})));
    const Pose base = make_pose(rotation_exp({0, 0, 0.3}), {100, 50, -20});
    const auto done = after_exchange(project, {"A", "C2", base});
    ASSERT_TRUE(done) << done.error().sentence();
    EXPECT_EQ(done->project.sensors[0].calibration_id, "C2");
    ASSERT_EQ(done->spots.size(), project.spots.size());
    for (std::size_t i = 0; i < project.spots.size(); ++i) {
        EXPECT_TRUE(sensor_at_part(done->project, done->project.spots[i])
                        .isApprox(sensor_at_part(project, project.spots[i]), 1e-9));
        EXPECT_GT(done->spots[i].moved_mm, 1);
        Spot same = done->project.spots[i];
        same.base_from_flange = project.spots[i].base_from_flange;
        EXPECT_EQ(exact_text(same), exact_text(project.spots[i])) << "nothing else of the spot changes";
    }
    const Pose before = project.part.base_from_workobject.inverse() * project.regions[0].base_from_frame;
    const Pose after = base.inverse() * done->project.regions[0].base_from_frame;
    EXPECT_TRUE(after.isApprox(before, 1e-9));
}

TEST(Reteach, RefusesWhatCannotBeKnown) {
    Project project = sample_project();
    EXPECT_FALSE(after_exchange(project, {"B", "C1", std::nullopt}));
    EXPECT_FALSE(after_exchange(project, {"A", "C2", std::nullopt}));
    project.calibrations.push_back(another(project, Pose::Identity()));
    project.calibrations[1].verdict = Verdict::poor;
    EXPECT_FALSE(after_exchange(project, {"A", "C2", std::nullopt}));
    project.calibrations[1].verdict = Verdict::usable;
    EXPECT_TRUE(after_exchange(project, {"A", "C2", std::nullopt}));
    project.calibrations[1].sensor_id = "B";
    EXPECT_FALSE(after_exchange(project, {"A", "C2", std::nullopt}));
    project.sensors[0].calibration_id.clear();
    EXPECT_FALSE(after_exchange(project, {"A", "C1", std::nullopt}));
    project = sample_project();
    project.spots[1].sensor_id = "B";
    EXPECT_FALSE(after_exchange(project, {"A", "C1", Pose::Identity()}))
        << "another sensor's spot stays behind";
}

// The point of it: a sensor mounted otherwise measures the taught part as before, with nothing taught again.
TEST(Reteach, AnotherMountingOnTheSimulatedCellStillReadsZero) {
    TemporaryFolder folder;
    nlohmann::json settings = cell_settings(Pose::Identity());
    const auto cell = SimulatedCell::open(settings).value();
    Project project = door_project(*cell, settings);
    auto taught = [&](const Project& p, const std::string& name) {
        auto station = Station(ProjectFile::create(folder / name, p).value(), p);
        EXPECT_TRUE(station.connect());
        return station.run({}).value();
    };
    const RunRecord first = taught(project, "before.seam");
    for (std::size_t i = 0; i < first.spots.size(); ++i) {
        project.spots[i].enabled = first.spots[i].status == SpotStatus::measured;
        project.spots[i].reference_mm = first.spots[i].measured_mm;
    }
    const Pose offset = make_pose(rotation_exp({0.02, 0.03, -0.04}), {8, -6, 4});
    settings["flange_from_sensor"] = pose_json(cell->flange_from_sensor() * offset);
    settings["serial"] = "SIM-2";
    project.sensors[0].settings = project.robots[0].settings = settings;
    project.calibrations.push_back(another(project, offset));
    DeviceSession session;
    project.calibrations[1].sensor_identity = open_sensor("simulated", settings, session).value()->identity();
    project.calibrations[1].robot_identity =
        open_robot("simulated", settings, session).value()->identity().value();
    const auto exchanged = after_exchange(project, {"A", "C2", std::nullopt});
    ASSERT_TRUE(exchanged) << exchanged.error().sentence();
    const RunRecord run = taught(exchanged->project, "after.seam");
    ASSERT_TRUE(run.regions[0].correction) << run.message;
    EXPECT_TRUE(run.regions[0].gate_passed) << testing::PrintToString(run.regions[0].refusals);
    const Pose d = run.regions[0].correction->displacement.workobject_from_movedworkobject;
    const Eigen::Vector3d middle(500, 375, 0);
    EXPECT_LT((d * middle - middle).norm(), 0.25);
}

}  // namespace
}  // namespace seamwright
