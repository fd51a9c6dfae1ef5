// The whole way on the simulated door: frames rendered by the cell, measured by the station, recorded to a
// folder, imported from there without any device, measured again.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "devices/exchange/pose_json.h"
#include "devices/simulated/cell.h"
#include "devices/simulated/scene/door.h"
#include "projects/proof/replay.h"
#include "projects/reuse/exchange.h"
#include "projects/station/station.h"
#include "tests/projects/door_project.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

const Pose kDisplacement = make_pose(rotation_exp({0.004, -0.003, 0.005}), {2.5, -1.5, 2.0});

RunRecord run_project(const std::filesystem::path& path, const Project& project) {
    EXPECT_TRUE(ProjectFile::create(path, project, true));
    auto station = Station::open(path);
    EXPECT_TRUE(station) << station.error().sentence();
    auto connected = station->connect();
    EXPECT_TRUE(connected) << connected.error().sentence();
    auto run = station->run({});
    EXPECT_TRUE(run) << run.error().sentence();
    auto again = replay(path, {});
    EXPECT_TRUE(again) << again.error().sentence();
    EXPECT_TRUE(again->differences.empty());
    return *run;
}

TEST(SimulatedDoor, MeasuredRecordedImportedMeasured) {
    TemporaryFolder folder;
    const nlohmann::json undisplaced = cell_settings(Pose::Identity()),
                         displaced = cell_settings(kDisplacement);
    auto cell = SimulatedCell::open(undisplaced);
    ASSERT_TRUE(cell) << cell.error().sentence();
    Project project = door_project(**cell, undisplaced);

    const RunRecord taught = run_project(folder / "taught.seam", project);
    int measured = 0;
    for (std::size_t i = 0; i < taught.spots.size(); ++i) {
        measured += taught.spots[i].status == SpotStatus::measured;
        project.spots[i].enabled = taught.spots[i].status == SpotStatus::measured;
        project.spots[i].reference_mm = taught.spots[i].measured_mm;
    }
    ASSERT_GE(measured, 9) << "of " << taught.spots.size() << ": " << taught.spots[0].message;

    project.sensors[0].settings = project.robots[0].settings = displaced;
    const RunRecord run = run_project(folder / "car.seam", project);
    EXPECT_EQ(run.status, RunStatus::ok) << run.message;
    ASSERT_TRUE(run.regions[0].correction);
    const Pose d = run.regions[0].correction->displacement.workobject_from_movedworkobject;
    // The error lies within the stated covariance (chi square, six degrees of freedom, 0.1 %), and is small
    // where the spots are about: robot and jitter are in the spots' sigma.
    const Vector6 error = difference(d, kDisplacement);
    EXPECT_LT(error.dot(run.regions[0].correction->covariance.ldlt().solve(error)), 22.5);
    const Eigen::Vector3d middle(500, 375, 0);
    EXPECT_LT((d * middle - kDisplacement * middle).norm(), 0.2);

    for (const char* name : {"taught", "car"}) {
        auto file = ProjectFile::open(folder / (std::string(name) + ".seam"));
        auto written = export_profiles(*file, 1, ProfileFormat::csv, folder / name);
        ASSERT_TRUE(written) << written.error().sentence();
    }
    FolderImport options;
    options.folder = folder / "car";
    options.reference_folder = folder / "taught";
    options.feature = edge_recipe();
    options.flange_from_sensor = (*cell)->flange_from_sensor();
    options.base_from_workobject = (*cell)->base_from_workobject();
    options.calibration_verdict = Verdict::good;
    options.sigma_mm = 0.1;
    auto imported = import_folder(options);
    ASSERT_TRUE(imported) << imported.error().sentence();
    const RunRecord again = run_project(folder / "import.seam", imported->project);
    ASSERT_TRUE(again.regions[0].correction) << again.message;
    const Pose e = again.regions[0].correction->displacement.workobject_from_movedworkobject;
    EXPECT_LT((e * middle - kDisplacement * middle).norm(), 0.2);
    EXPECT_LT((e * middle - d * middle).norm(), 0.03) << "the recording tells what the cell told";
}

}  // namespace
}  // namespace seamwright
