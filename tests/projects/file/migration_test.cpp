// Files of older versions, written by their own schema; `tests/data/version<N>.sql` are their dumps.

#include <gtest/gtest.h>

#include "devices/capture/sqlite.h"
#include "projects/file/project_file.h"
#include "projects/file/schema.h"
#include "tests/projects/file/kill_test.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;

TEST(Migration, VersionOneBecomesCurrent) {
    TemporaryFolder folder;
    const fs::path path = folder / "old.seam";
    make_old_version(path, 1);
    const std::string before = file_bytes(path);
    {
        auto file = ProjectFile::open(path, FileAccess::read_only);
        ASSERT_TRUE(file) << file.error().sentence();
        EXPECT_EQ(file->load()->name, "first version");
        EXPECT_EQ(file->runs()->size(), 1u);
    }
    EXPECT_EQ(file_bytes(path), before) << "reading must not migrate the file";
    {
        auto file = ProjectFile::open(path);
        ASSERT_TRUE(file) << file.error().sentence();
        EXPECT_EQ(file->load()->spots.size(), 2u);
        EXPECT_EQ(file->load_run(1)->captures.size(), 2u);
        EXPECT_TRUE(file->check().empty());
        RunRecord run = sample_run(1);
        EXPECT_TRUE(file->append_run(run, *file->load())) << "images need the second version";
    }
    auto db = Database::open(path.string(), SQLITE_OPEN_READONLY);
    EXPECT_EQ(*db->integer("PRAGMA user_version"), current_version());
    std::size_t files = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder.path())) ++files;
    EXPECT_EQ(files, 1u);
}

TEST(Migration, VersionTwoBecomesCurrentAndTakesEvidence) {
    TemporaryFolder folder;
    const fs::path path = folder / "old.seam";
    make_old_version(path, 2);
    {
        const auto reading = ProjectFile::open(path, FileAccess::read_only);
        ASSERT_TRUE(reading) << reading.error().sentence();
        EXPECT_EQ(exact_text(reading->load()->requirements), exact_text(Requirements{})) << "defaults";
        EXPECT_TRUE(reading->evidence()->empty());
    }
    auto file = ProjectFile::open(path);
    ASSERT_TRUE(file) << file.error().sentence();
    EXPECT_EQ(file->runs()->size(), 1u);
    EXPECT_EQ(file->load_run(1)->captures.size(), 2u);
    Project project = file->load().value();
    project.requirements.sigma3_mm = 0.1;
    project.requirements.calibration_age_days = 30;
    ASSERT_TRUE(file->save(project));
    for (int kind = 0; kind < kSampleEvidence; ++kind)
        ASSERT_TRUE(file->append_evidence(sample_evidence(kind), project));
    EXPECT_TRUE(file->check().empty());
    EXPECT_EQ(file->load()->requirements.sigma3_mm, 0.1);
}

TEST(Migration, VersionThreeBecomesCurrentAndTakesPanelJobs) {
    TemporaryFolder folder;
    const fs::path path = folder / "old.seam";
    make_old_version(path, 3);
    auto file = ProjectFile::open(path);
    ASSERT_TRUE(file) << file.error().sentence();
    Project project = file->load().value();
    EXPECT_EQ(project.requirements.sigma3_mm, 0.2);
    EXPECT_EQ(file->evidence()->size(), 1u);
    EXPECT_TRUE(project.panel_jobs.empty());
    EXPECT_FALSE(file->load_run(1)->panel);
    project.panel_jobs = sample_project().panel_jobs;
    ASSERT_TRUE(file->save(project));
    RunRecord run = sample_run(1);
    run.panel = sample_panel_record(1);
    ASSERT_TRUE(file->append_run(run, project));
    EXPECT_EQ(exact_text(file->load()->panel_jobs[0]), exact_text(project.panel_jobs[0]));
    EXPECT_TRUE(file->check().empty());
}

// What was required of before stays, what the acceptance asks for has its defaults and is kept from here on; and
// a run's setup does not hold it, so that another tolerance is no other measuring process.
TEST(Migration, VersionFiveBecomesCurrentAndTakesAcceptance) {
    TemporaryFolder folder;
    const fs::path path = folder / "old.seam";
    make_old_version(path, 5);
    {
        auto reading = ProjectFile::open(path, FileAccess::read_only);
        ASSERT_TRUE(reading) << reading.error().sentence();
        EXPECT_EQ(reading->load()->requirements.acceptance, AcceptanceRequirements{});
    }
    auto file = ProjectFile::open(path);
    ASSERT_TRUE(file) << file.error().sentence();
    Project project = file->load().value();
    EXPECT_EQ(project.requirements.sigma3_mm, 0.2);
    EXPECT_EQ(project.requirements.acceptance.cg_share, 0.2);
    const auto before = file->setup_of(project);
    ASSERT_TRUE(before) << before.error().sentence();
    project.requirements.acceptance = {1.5, 0.25, 0.15, 4, 1.67, 1.5, 20, 25, 6, 10, 20};
    ASSERT_TRUE(file->save(project));
    EXPECT_EQ(*file->setup_of(project), *before);
    const auto opened = ProjectFile::open(path);
    const Project again = opened->load().value();
    EXPECT_EQ(again.requirements.acceptance, project.requirements.acceptance);
    EXPECT_EQ(again.requirements.sigma3_mm, 0.2);
    EXPECT_TRUE(opened->check().empty());
}

// A file of before has no guide, takes one, and its chain and checks know it.
TEST(Migration, OlderVersionsTakeAGuide) {
    for (int version = 1; version <= 13; ++version) {
        TemporaryFolder folder;
        const fs::path path = folder / "old.seam";
        make_old_version(path, version);
        auto file = ProjectFile::open(path);
        ASSERT_TRUE(file) << version << file.error().sentence();
        EXPECT_TRUE(file->guides()->empty());
        EXPECT_FALSE(file->load_guide("top.csv"));
        const std::string csv = "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\r\n0,0,0,0,0,0\r\n0,9,0,0,0,0\r\n";
        const auto kept = file->keep_guide("top.csv", csv);
        ASSERT_TRUE(kept) << kept.error().sentence();
        // sha256sum of these bytes.
        EXPECT_EQ(kept->hash, "5eb4fbf1c93a9fb1644d5a87bb8b35c919843732dbb552577a3a44a72c275b45");
        EXPECT_EQ(file->keep_guide("other name", csv)->utc, kept->utc) << "kept once";
        const auto again = ProjectFile::open(path);
        ASSERT_TRUE(again);
        ASSERT_EQ(again->guides()->size(), 1u);
        EXPECT_EQ(again->load_guide(kept->hash)->csv, csv);
        EXPECT_EQ(again->load_guide("top.csv")->hash, kept->hash);
        EXPECT_TRUE(again->check().empty());
    }
}

// What was taught before there were drawings was taught on the part; a spot from the drawing is kept as such.
TEST(Migration, SpotsOfOlderVersionsAreMeasuredAndTakeTheDrawing) {
    for (int version = 1; version <= 6; ++version) {
        TemporaryFolder folder;
        const fs::path path = folder / "old.seam";
        make_old_version(path, version);
        auto file = ProjectFile::open(path);
        ASSERT_TRUE(file) << file.error().sentence();
        Project project = file->load().value();
        ASSERT_FALSE(project.spots.empty());
        for (const Spot& spot : project.spots) {
            EXPECT_EQ(spot.reference_state, ReferenceState::measured);
            EXPECT_FALSE(spot.drawn);
        }
        const auto before = file->setup_of(project);
        project.spots[0].reference_state = ReferenceState::from_drawing;
        project.spots[0].drawn =
            DrawingOrigin{"door.step", 1234567890123, 0xfedcba98, "e12", 17.25, {1.5, 0, -2}};
        ASSERT_TRUE(file->save(project));
        EXPECT_NE(*file->setup_of(project), *before);
        const auto opened = ProjectFile::open(path);
        const Spot again = opened->load()->spots[0];
        EXPECT_EQ(exact_text(again), exact_text(project.spots[0]));
        EXPECT_EQ(again.reference_state, ReferenceState::from_drawing);
        ASSERT_TRUE(again.drawn);
        EXPECT_EQ(again.drawn->bytes, 1234567890123u);
        EXPECT_EQ(again.drawn->crc32, 0xfedcba98u);
        EXPECT_TRUE(opened->check().empty());
    }
}

// A file of before watches nothing, takes a watch, and keeps its points when the runs are deleted.
TEST(Migration, OlderVersionsTakeADriftWatch) {
    for (int version = 1; version <= 9; ++version) {
        TemporaryFolder folder;
        const fs::path path = folder / "old.seam";
        make_old_version(path, version);
        auto file = ProjectFile::open(path);
        ASSERT_TRUE(file) << version << file.error().sentence();
        Project project = file->load().value();
        EXPECT_FALSE(project.drift);
        EXPECT_TRUE(file->drift_points()->empty());
        const auto before = file->setup_of(project);
        project.drift.emplace().spot_ids = {"W1"};
        project.drift->set_aside = {{1, 2, "2026-06-02T09:00:00.000Z", "Ada", "it was loose"}};
        ASSERT_TRUE(file->save(project));
        EXPECT_EQ(*file->setup_of(project), *before) << "what acts is said by the run";
        DriftPoint point;
        point.run = 1;
        point.values_mm = {1.0 / 3, -2};
        point.sigma_mm = {0.1, 0.1};
        point.mark = 0xfedcba98u;
        point.text =
            Text("a step of {:+.3f} mm in {}: sensor, robot or reference was knocked", 0.5, "X of W1");
        for (int i = 1; i <= 3; ++i) EXPECT_EQ(*file->append_drift_point(point), i);
        ASSERT_TRUE(file->delete_run(1));
        const auto again = ProjectFile::open(path);
        EXPECT_EQ(exact_text(*again->load()->drift), exact_text(*project.drift));
        EXPECT_EQ(exact_text(**again->load_drift_watch()), exact_text(*project.drift));
        const auto points = again->drift_points(2);
        ASSERT_EQ(points->size(), 2u);
        EXPECT_EQ(points->front().id, 2) << "the newest, oldest first";
        EXPECT_EQ(points->front().values_mm, point.values_mm);
        point.step = true;
        ASSERT_TRUE(file->append_drift_point(point));
        point.step = false;
        ASSERT_TRUE(file->append_drift_point(point));
        const auto last = again->drift_points(1);
        ASSERT_EQ(last->size(), 2u) << "a step is never left out";
        EXPECT_TRUE(last->front().step);
        EXPECT_EQ(last->back().id, 5);
        EXPECT_EQ(points->front().text.english(), point.text.english());
        EXPECT_TRUE(again->check().empty());
    }
}

TEST(Migration, AFailedOneLeavesTheOldFile) {
    TemporaryFolder folder;
    const fs::path path = folder / "old.seam";
    make_old_version(path, 1);
    {
        // A table that the second version wants to make stands there already.
        sqlite3* db = nullptr;
        ASSERT_EQ(sqlite3_open(path.c_str(), &db), SQLITE_OK);
        ASSERT_EQ(sqlite3_exec(db, "CREATE TABLE images (x)", nullptr, nullptr, nullptr), SQLITE_OK);
        sqlite3_close(db);
    }
    const std::string before = file_bytes(path);
    EXPECT_FALSE(ProjectFile::open(path));
    EXPECT_EQ(file_bytes(path), before);
}

TEST(Migration, VersionsCountUp) {
    std::int32_t version = 0;
    for (const Migration& step : migrations()) EXPECT_EQ(step.version, ++version);
    EXPECT_EQ(version, current_version());
}

}  // namespace
}  // namespace seamwright
