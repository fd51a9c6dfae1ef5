// Offsets from a correlation: kept, switched, taken back, and acting on a run of the Station.

#include "projects/acceptance/study/kept_offsets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "projects/acceptance/study/stored_values.h"
#include "projects/proof/replay.h"
#include "tests/projects/fake_cell.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

RunRecord push(Station& station) {
    RunOptions options;
    options.part_id = "car";
    options.push = true;
    auto run = station.run(options);
    EXPECT_TRUE(run) << run.error().sentence();
    return run.value_or(RunRecord{});
}

// Twelve parts whose values lie `offset` off their references, alternately `scatter` beside.
Acceptance correlation(double offset, double scatter, int parts = 12, double slope = 1) {
    std::vector<StudyValue> values;
    for (int i = 0; i < parts; ++i)
        values.push_back({"P" + std::to_string(i),
                          "1",
                          1,
                          slope * i + offset + (i % 2 ? scatter : -scatter),
                          static_cast<double>(i),
                          {}});
    Acceptance a;
    auto made = correlation_study(values);
    EXPECT_TRUE(made) << made.error().sentence();
    a.correlation = *made;
    a.source.offset.emplace(OffsetOfStudy{"inner", {0, 0, 1}, {}});
    return a;
}

TEST(KeptOffsets, AreVersionsThatActWhenSwitchedOnAndAreTakenBack) {
    Region region;
    region.id = "inner";
    Acceptance a = correlation(0.5, 0.03);
    ASSERT_EQ(keep_offset(region, a, "2024-05-01T12:00:00.000Z").value(), 1);
    EXPECT_EQ(acting_offset(region), nullptr) << "off until a person switches it on";
    EXPECT_NEAR(region.offsets[0].offset_mm.z(), 0.5, 1e-12);
    // s of alternating -+0.03 over 12 is 0.03 sqrt(12 / 11); of the mean s / sqrt(12).
    EXPECT_NEAR(region.offsets[0].covariance_mm2(2, 2), 0.03 * 0.03 / 11, 1e-12);
    ASSERT_TRUE(switch_offset(region, 1));
    ASSERT_NE(acting_offset(region), nullptr);
    EXPECT_THAT(switch_offset(region, 1).error().sentence(), HasSubstr("acts already"));
    // Found while the first one acted, along X: both are in the second.
    a = correlation(-0.2, 0.03);
    a.source.offset->direction = {1, 0, 0};
    a.source.offset->acting = region.offsets[0];
    ASSERT_EQ(keep_offset(region, a, "2024-05-02T12:00:00.000Z").value(), 2);
    EXPECT_LT((region.offsets[1].offset_mm - Eigen::Vector3d(-0.2, 0, 0.5)).norm(), 1e-12);
    EXPECT_NEAR(region.offsets[1].covariance_mm2(0, 0), 0.03 * 0.03 / 11, 1e-12);
    EXPECT_NEAR(region.offsets[1].covariance_mm2(2, 2), 0.03 * 0.03 / 11, 1e-12);
    EXPECT_EQ(acting_offset(region)->version, 1);
    ASSERT_TRUE(switch_offset(region, 2));
    ASSERT_TRUE(switch_offset(region, 0));
    EXPECT_EQ(acting_offset(region), nullptr);
    ASSERT_TRUE(undo_offset(region));
    EXPECT_EQ(acting_offset(region)->version, 2);
    ASSERT_TRUE(undo_offset(region));
    EXPECT_EQ(acting_offset(region)->version, 1);
    ASSERT_TRUE(undo_offset(region));
    EXPECT_EQ(acting_offset(region), nullptr);
    EXPECT_THAT(undo_offset(region).error().sentence(), HasSubstr("no offset was switched"));
    EXPECT_EQ(region.offsets.size(), 2u) << "the versions stay";
    EXPECT_THAT(switch_offset(region, 3).error().sentence(), HasSubstr("no version 3"));
    EXPECT_THAT(switch_offset(region, -1).error().sentence(), HasSubstr("no version -1"));
}

TEST(KeptOffsets, NoneOfWhatProvesNone) {
    Region region;
    region.id = "inner";
    const auto refused = [&](const Acceptance& a, const char* part) {
        const auto kept = keep_offset(region, a, "");
        ASSERT_FALSE(kept);
        EXPECT_THAT(kept.error().sentence(), HasSubstr(part));
        EXPECT_TRUE(region.offsets.empty());
    };
    refused({}, "no correlation");
    refused(correlation(0.001, 0.03), "may be chance");
    refused(correlation(0.5, 0.03, 6), "6 parts");
    refused(correlation(0.5, 0.003, 12, 1.1), "slope");
    Acceptance table = correlation(0.5, 0.03);
    table.source.offset.reset();
    refused(table, "stored runs");
    region.id = "outer";
    refused(correlation(0.5, 0.03), "of this region");
}

TEST(KeptOffsets, ActOnARunAndAreSaidInIt) {
    TemporaryFolder folder;
    auto cell = make_fake_cell();
    cell->workobject_from_movedworkobject = make_pose(rotation_exp({0.006, -0.004, 0.009}), {3, -4, 2.5});
    Region& region = cell->project.regions[0];
    region.offsets = {{1, "2024-05-01T12:00:00.000Z", "cmm", {0.1, -0.2, 0.3}}};
    region.offsets[0].covariance_mm2(1, 1) = 0.0004;
    region.offset_switches = {0, 1};
    Station station(ProjectFile::create(folder / "cell.seam", cell->project).value(), cell->project);
    std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
    sensors["A"] = std::make_unique<FakeSensor>(*cell);
    std::map<std::string, std::unique_ptr<RobotLink>> robots;
    robots["R1"] = std::make_unique<FakeRobot>(*cell);
    station.connect(std::move(sensors), std::move(robots));
    const RunRecord run = push(station);
    EXPECT_EQ(run.status, RunStatus::ok) << run.message;
    const RegionRecord &inner = run.regions[0], &outer = run.regions[1];
    ASSERT_TRUE(inner.offset);
    EXPECT_EQ(inner.offset->version, 1);
    EXPECT_FALSE(outer.offset) << "has none";
    const Pose& with = inner.correction->displacement.workobject_from_movedworkobject;
    const Pose& without = outer.correction->displacement.workobject_from_movedworkobject;
    EXPECT_LT((without.translation() - with.translation() - Eigen::Vector3d(0.1, -0.2, 0.3)).norm(), 1e-9);
    EXPECT_LT(angle_rad(with, without), 1e-12);
    EXPECT_NEAR(
        std::pow(inner.correction->sigma_xyz_mm.y(), 2) - std::pow(outer.correction->sigma_xyz_mm.y(), 2),
        0.0004, 1e-9);
    EXPECT_NEAR(inner.correction->covariance_systematic(1, 1) - outer.correction->covariance_systematic(1, 1),
                0.0004, 1e-9);
    EXPECT_GT(inner.correction->sigma_at_spots_mm, 0.02);
    // What was pushed lies beside by as much.
    const Pose pushed = cell->frames[region.frame_name];
    const Pose& wo = cell->project.part.base_from_workobject;
    const Pose unshifted = wo * cell->workobject_from_movedworkobject * wo.inverse() * region.base_from_frame;
    EXPECT_NEAR((pushed.translation() - unshifted.translation()).norm(),
                Eigen::Vector3d(0.1, -0.2, 0.3).norm(), 1e-5);
    EXPECT_TRUE(std::any_of(run.events.begin(), run.events.end(), [](const EventRecord& e) {
        return e.subject == "inner" && e.text.english().find("kept offset 1 acts") == 0;
    }));
    const RunRecord stored = station.file().load_run(run.number).value();
    ASSERT_TRUE(stored.regions[0].offset);
    EXPECT_EQ(stored.regions[0].offset->offset_mm, inner.offset->offset_mm);
    const auto again = recompute(stored, *station.file().load_run_setup(run.number));
    ASSERT_TRUE(again);
    EXPECT_TRUE(compare(stored, *again).empty()) << "bit for bit";
    const auto values = stored_values(station.file(), "inner");
    ASSERT_TRUE(values) << values.error().sentence();
    ASSERT_TRUE(values->source.offset && values->source.offset->acting);
    EXPECT_THAT(values->source.remarks.front().english(), HasSubstr("kept offset 1 acts"));
}

// Not finite in a file that somebody wrote: the gate refuses, nothing is written.
TEST(KeptOffsets, OneThatIsNoNumberStopsAtTheGate) {
    TemporaryFolder folder;
    auto cell = make_fake_cell();
    cell->project.regions[0].offsets = {{1, "", "", {0, std::nan(""), 0}}};
    cell->project.regions[0].offset_switches = {1};
    Station station(ProjectFile::create(folder / "cell.seam", cell->project).value(), cell->project);
    std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
    sensors["A"] = std::make_unique<FakeSensor>(*cell);
    std::map<std::string, std::unique_ptr<RobotLink>> robots;
    robots["R1"] = std::make_unique<FakeRobot>(*cell);
    station.connect(std::move(sensors), std::move(robots));
    const RunRecord run = push(station);
    EXPECT_EQ(run.status, RunStatus::refused);
    EXPECT_EQ(cell->writes, 0);
}

}  // namespace
}  // namespace seamwright
