#include "projects/reuse/exchange.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "devices/exchange/tables/profile_csv.h"
#include "projects/proof/replay.h"
#include "projects/station/check.h"
#include "projects/station/station.h"
#include "tests/projects/fake_cell.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(Export, ProjectRoundTripsThroughText) {
    Project project = sample_project();
    const std::string text = export_project(project, true).dump(2);
    auto again = import_project(*parse_json(text, "x.json"), "x.json");
    ASSERT_TRUE(again) << again.error().sentence();
    project.part.mesh_ply.clear();
    EXPECT_EQ(exact_text(*again), exact_text(project));
    EXPECT_THAT(text, HasSubstr("\"abc\""));
    EXPECT_THAT(text, HasSubstr("\"matrix\""));

    const std::string slim = export_project(project).dump();
    EXPECT_LT(slim.size(), text.size() / 3);
    for (Spot& spot : project.spots) spot.reference_profile = spot.feature.template_profile = {};
    for (PanelJob& job : project.panel_jobs)
        for (PanelPlace& place : job.places) place.reference_profile = {};
    EXPECT_EQ(exact_text(*import_project(*parse_json(slim, ""))), exact_text(project));
}

TEST(Export, PosesAreReadInEveryForm) {
    nlohmann::json document = export_project(sample_project());
    nlohmann::json& pose = document["project"]["regions"][0]["base_from_frame"];
    const Pose expected = sample_project().regions[0].base_from_frame;
    const Eigen::Quaterniond q(expected.linear());
    const Eigen::Vector3d w = rotation_log(expected.linear());
    const nlohmann::json xyz = pose["xyz"], abc = pose["abc"];
    for (const nlohmann::json& form :
         {nlohmann::json{{"xyz", xyz}, {"abc", abc}},
          nlohmann::json{{"xyz", xyz}, {"quat_wxyz", {q.w(), q.x(), q.y(), q.z()}}},
          nlohmann::json{{"xyz", xyz}, {"rotvec_rad", {w.x(), w.y(), w.z()}}}}) {
        pose = form;
        auto project = import_project(document);
        ASSERT_TRUE(project) << project.error().sentence();
        EXPECT_TRUE(project->regions[0].base_from_frame.isApprox(expected, 1e-12));
    }
}

TEST(Export, HostileDocumentsAreRefusedWithTheirPlace) {
    const nlohmann::json good = export_project(sample_project(), true);
    const auto refused = [&](auto spoil, const char* words) {
        nlohmann::json bad = good;
        spoil(bad);
        auto project = import_project(bad, "x.json");
        ASSERT_FALSE(project) << words;
        EXPECT_EQ(project.error().kind, ErrorKind::input);
        EXPECT_THAT(project.error().sentence(), HasSubstr(words));
        EXPECT_THAT(project.error().sentence(), HasSubstr("x.json"));
    };
    using J = nlohmann::json&;
    refused([](J j) { j = nlohmann::json::array(); }, "no exported project");
    refused([](J j) { j["format"] = "other"; }, "no exported project");
    refused([](J j) { j["version"] = 99; }, "newer");
    refused([](J j) { j.erase("version"); }, "version");
    refused([](J j) { j["project"] = 7; }, "object was expected");
    refused([](J j) { j["project"]["spots"][2]["sigma_mm"] = "wide"; }, "spots[2].sigma_mm");
    refused([](J j) { j["project"]["spots"][2]["sigmamm"] = 1; }, "unknown field");
    refused(
        [](J j) {
            j["project"]["spots"][1]["base_from_flange"] = {{"xyz", {1, 2, 3}}};
        },
        "spots[1].base_from_flange");
    refused([](J j) { j["project"]["regions"][0]["free"] = {true, false}; }, "6 entries were expected");
    refused([](J j) { j["project"]["sensors"][0]["peaks"]["scan"] = "diagonal"; }, "sensors[0].peaks.scan");
    refused([](J j) { j["project"]["spots"][0]["reference_profile"]["z_mm"].erase(0); }, "differ in length");
    refused([](J j) { j["project"]["calibrations"][0]["model"]["table"]["rows"] = 9; }, "table");
}

TEST(Export, FileHoldsRunsAndEvents) {
    TemporaryFolder folder;
    auto file = ProjectFile::create(folder / "a.seam", sample_project());
    ASSERT_TRUE(file->append_run(sample_run(1), sample_project()));
    auto document = export_file(*file);
    ASSERT_TRUE(document);
    EXPECT_EQ((*document)["runs"].size(), 1u);
    EXPECT_EQ((*document)["runs"][0]["spots"].size(), 4u);
    EXPECT_EQ((*document)["runs"][0]["regions"][0]["correction"]["status"], "under_determined");
    EXPECT_EQ((*document)["events"][0]["kind"], "refusal");
    EXPECT_TRUE(import_project(*document));
}

// A recorded cell becomes a folder of CSVs with poses, the folder a project, the project a run with the same
// correction.
class Recorded : public testing::Test {
  protected:
    void SetUp() override {
        const Pose displaced = make_pose(rotation_exp({0.005, -0.003, 0.007}), {2, -3, 1.5});
        record("taught", Pose::Identity());
        record("car", displaced);
        truth = displaced;
    }
    void record(const std::string& name, const Pose& displacement) {
        cell->workobject_from_movedworkobject = displacement;
        auto file = ProjectFile::create(folder / (name + ".seam"), cell->project);
        ASSERT_TRUE(file);
        Station station(std::move(*file), cell->project);
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        sensors["A"] = std::make_unique<FakeSensor>(*cell);
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        robots["R1"] = std::make_unique<FakeRobot>(*cell);
        station.connect(std::move(sensors), std::move(robots));
        ASSERT_TRUE(station.run({}));
        auto written = export_profiles(station.file(), 1, ProfileFormat::csv, folder / name);
        ASSERT_TRUE(written) << written.error().sentence();
        EXPECT_EQ(written->size(), 2 * cell->project.spots.size());
    }
    FolderImport options() const {
        FolderImport o;
        o.folder = folder / "car";
        o.reference_folder = folder / "taught";
        o.feature.kind = "contour-end";
        o.feature.parameters = {{"side", 1}};
        o.flange_from_sensor = cell->project.calibrations[0].flange_from_sensor;
        o.base_from_workobject = cell->project.part.base_from_workobject;
        o.calibration_verdict = Verdict::good;
        return o;
    }
    TemporaryFolder folder;
    std::unique_ptr<FakeCell> cell = make_fake_cell();
    Pose truth = Pose::Identity();
};

TEST_F(Recorded, FolderOfProfilesGivesARunAndACorrection) {
    auto imported = import_folder(options());
    ASSERT_TRUE(imported) << imported.error().sentence();
    EXPECT_FALSE(imported->in_pixels);
    EXPECT_EQ(imported->project.spots.size(), 6u);
    for (const Error& finding : check(imported->project)) ADD_FAILURE() << finding.sentence();
    ASSERT_TRUE(ProjectFile::create(folder / "import.seam", imported->project));
    auto station = Station::open(folder / "import.seam");
    ASSERT_TRUE(station);
    auto connected = station->connect();
    ASSERT_TRUE(connected) << connected.error().sentence();
    auto run = station->run({});
    ASSERT_TRUE(run) << run.error().sentence();
    EXPECT_EQ(run->status, RunStatus::ok) << run->message;
    ASSERT_TRUE(run->regions[0].correction);
    const Pose& d = run->regions[0].correction->displacement.workobject_from_movedworkobject;
    EXPECT_LT(distance_mm(d, truth), 1e-6);
    EXPECT_LT(angle_rad(d, truth), 1e-9);
}

// The field of the sensor that recorded them lies beside x = 0. What it lists of the taught part tells that its last line is its
// rim: a part whose edges lie beyond is not measured there.
TEST(FolderOfProfiles, AnEdgeBeyondTheFieldIsNotAtItsRim) {
    const TemporaryFolder folder;
    const auto record = [&](const std::string& name, double edge_mm) {
        std::mt19937_64 random(7);
        std::normal_distribution<double> noise(0, 0.01);
        for (int spot = 0; spot < 4; ++spot) {
            std::string csv = "x_mm,z_mm\n";
            for (int i = 0; i <= 1200; ++i) {
                const double x = 0.05 * i;
                csv += fmt::format("{},{}\n", x,
                                   x < edge_mm ? fmt::format("{:.4f}", noise(random)) : std::string());
            }
            const std::string stem = fmt::format("S{}", spot + 1);
            std::filesystem::create_directories(folder / name);
            ASSERT_TRUE(write_text_file(folder / name / (stem + ".csv"), csv));
            ASSERT_TRUE(write_text_file(folder / name / (stem + ".json"),
                                        fmt::format("{{\"xyz\":[{},{},500],\"abc\":[{},0,180]}}",
                                                    300 * (spot % 2), 300 * (spot / 2), 40 * spot)));
        }
    };
    record("taught", 45);
    record("near", 52);
    record("beyond", 63);
    for (const auto& [name, measured] : {std::pair{"near", true}, {"beyond", false}}) {
        FolderImport o;
        o.folder = folder / name;
        o.reference_folder = folder / "taught";
        o.feature.kind = "contour-end";
        o.feature.parameters = {{"side", 1}};
        o.calibration_verdict = Verdict::good;
        const auto imported = import_folder(o);
        ASSERT_TRUE(imported) << imported.error().sentence();
        const fs::path path = folder / (std::string(name) + ".seam");
        ASSERT_TRUE(ProjectFile::create(path, imported->project));
        auto station = Station::open(path);
        ASSERT_TRUE(station->connect());
        const auto run = station->run({});
        ASSERT_TRUE(run) << run.error().sentence();
        for (const SpotMeasurement& m : run->spots)
            EXPECT_EQ(m.status, measured ? SpotStatus::measured : SpotStatus::no_feature)
                << name << ": " << m.message;
    }
}

TEST_F(Recorded, WithoutReferenceFolderTheFolderIsTheTaughtState) {
    FolderImport o = options();
    o.reference_folder.reset();
    o.calibration_verdict = Verdict::undetermined;
    auto imported = import_folder(o);
    ASSERT_TRUE(imported);
    ASSERT_FALSE(imported->notes.empty());
    ASSERT_TRUE(ProjectFile::create(folder / "import.seam", imported->project));
    auto station = Station::open(folder / "import.seam");
    ASSERT_TRUE(station->connect());
    auto run = station->run({});
    ASSERT_TRUE(run);
    ASSERT_TRUE(run->regions[0].correction);
    EXPECT_LT(distance_mm(run->regions[0].correction->displacement.workobject_from_movedworkobject,
                          Pose::Identity()),
              1e-9);
    EXPECT_EQ(run->status, RunStatus::refused) << "no verdict on the calibration";
}

TEST_F(Recorded, SpotsMissingInTheReferenceAreSwitchedOff) {
    fs::remove(folder / "taught" / "S2.csv");
    fs::remove(folder / "taught" / "S2.json");
    auto imported = import_folder(options());
    ASSERT_TRUE(imported);
    int off = 0;
    for (const Spot& spot : imported->project.spots) off += !spot.enabled;
    EXPECT_EQ(off, 1);
    EXPECT_EQ(imported->project.regions[0].spot_ids.size(), 5u);
    EXPECT_THAT(imported->notes, testing::Contains(HasSubstr("S2")));
}

TEST_F(Recorded, HostileFolders) {
    FolderImport o = options();
    o.folder = folder / "nothing";
    EXPECT_FALSE(import_folder(o));
    fs::create_directory(folder / "nothing");
    EXPECT_FALSE(import_folder(o));
    o = options();
    o.feature.kind = "nose";
    EXPECT_FALSE(import_folder(o));
    o = options();
    o.sigma_mm = -1;
    EXPECT_FALSE(import_folder(o));
    o = options();
    o.flange_from_sensor(0, 0) = 7;
    EXPECT_FALSE(import_folder(o));
    write_bytes(folder / "taught" / "S3.csv", "x_mm;z_mm\n1;2\n");
    auto broken = import_folder(options());
    ASSERT_TRUE(broken) << "one unreadable reference switches its spot off";
    EXPECT_THAT(broken->notes, testing::Contains(HasSubstr("S3")));
    write_bytes(folder / "car" / "S1.json", "not a pose");
    EXPECT_FALSE(import_folder(options()));
}

TEST_F(Recorded, PointCloudsStandInBase) {
    auto file = ProjectFile::open(folder / "taught.seam");
    for (const ProfileFormat format : {ProfileFormat::ply, ProfileFormat::pcd}) {
        auto written = export_profiles(*file, 1, format, folder / "clouds");
        ASSERT_TRUE(written);
        ASSERT_EQ(written->size(), 6u);
        const std::string text = file_bytes(written->front());
        EXPECT_THAT(text, HasSubstr(format == ProfileFormat::ply ? "element vertex 300" : "POINTS 300"));
        // The last point is half a pitch from the taught edge.
        std::istringstream lines(text.substr(0, text.size() - 1));
        std::string line, last;
        while (std::getline(lines, line)) last = line;
        double x = 0, y = 0, z = 0;
        ASSERT_EQ(std::sscanf(last.c_str(), "%lf %lf %lf", &x, &y, &z), 3);
        const Spot& spot = cell->project.spots[0];
        const Eigen::Vector3d edge =
            spot.base_from_flange * cell->project.calibrations[0].flange_from_sensor * spot.reference_mm;
        EXPECT_NEAR((Eigen::Vector3d(x, y, z) - edge).norm(), 0.025, 1e-6);
    }
    EXPECT_FALSE(export_profiles(*file, 9, ProfileFormat::csv, folder / "clouds"));
}

TEST_F(Recorded, NamesThatAreNoFileNames) {
    Project project = cell->project;
    project.spots[0].id = "../../etc/passwd";
    project.spots[1].id = "Tür 1";
    for (Region& region : project.regions)
        region.spot_ids = {project.spots[0].id, project.spots[1].id, "S3", "S4", "S5", "S6"};
    cell->project = project;
    record("odd", Pose::Identity());
    for (const auto& entry : fs::directory_iterator(folder / "odd"))
        EXPECT_THAT(entry.path().filename().string(), testing::MatchesRegex("[A-Za-z0-9_-]+\\.(csv|json)"));
}

// Middle of the saturated pixels of an image row: what anybody would take for the stripe.
double saturated_middle(const StripeImage& image, int row) {
    double sum = 0, count = 0;
    for (int u = 0; u < image.width; ++u)
        if (std::to_integer<int>(image.pixels[static_cast<std::size_t>(row) * image.row_bytes +
                                              static_cast<std::size_t>(u)]) >= 250) {
            sum += u;
            ++count;
        }
    return sum / count;
}

// Real frames and poses, no calibration: measured in pixels, nothing can be pushed.
TEST(RealFrames, FolderOfImagesGivesARunInPixels) {
    const char* overridden = std::getenv("SEAMWRIGHT_DATA");
    const fs::path data = fs::path(overridden ? overridden : SEAMWRIGHT_SHARED_DATA) / "etna" / "root";
    if (!fs::exists(data)) GTEST_SKIP() << "skipped: no real data";
    TemporaryFolder folder;
    FolderImport o;
    o.folder = data;
    o.feature.kind = "contour-end";
    o.feature.parameters = {
        {"side", 1}, {"segment", 1}, {"fit_length_mm", 80}};  // pixels: end of the longest piece
    o.peaks.scan = ScanLines::rows;
    o.sigma_mm = 1;
    auto imported = import_folder(o);
    ASSERT_TRUE(imported) << imported.error().sentence();
    EXPECT_TRUE(imported->in_pixels);
    EXPECT_EQ(imported->project.calibrations[0].method, "pixels");
    EXPECT_THAT(imported->notes, testing::Contains(HasSubstr("pixels")));
    const fs::path path = folder / "etna.seam";
    ASSERT_TRUE(ProjectFile::create(path, imported->project));
    auto station = Station::open(path);
    ASSERT_TRUE(station);
    auto connected = station->connect();
    ASSERT_TRUE(connected) << connected.error().sentence();
    RunOptions options;
    options.push = true;
    options.keep_images = true;
    auto run = station->run(options);
    ASSERT_TRUE(run) << run.error().sentence();
    EXPECT_EQ(run->spots.size(), 8u);
    for (const SpotMeasurement& m : run->spots) {
        ASSERT_EQ(m.status, SpotStatus::measured) << m.spot_id << ": " << m.message;
        EXPECT_GE(m.feature.points_used, 30) << m.spot_id;
        const StoredImage& image = *run->captures[static_cast<std::size_t>(m.capture)].image;
        ASSERT_EQ(image.width, 1280);
        // The line through two rows shortly before, continued to the end.
        const int row = static_cast<int>(std::lround(m.feature.point_mm.x()));
        const double near = saturated_middle(image.view(), row - 10),
                     far = saturated_middle(image.view(), row - 60);
        EXPECT_NEAR(m.feature.point_mm.y(), near + (near - far) / 50 * 10, 3) << m.spot_id;
    }
    EXPECT_EQ(run->status, RunStatus::refused);
    EXPECT_THAT(run->regions[0].refusals, testing::Contains(HasSubstr("undetermined, not good or usable")));
    // From the stored images everything comes out again.
    auto replayed = replay(path, {});
    ASSERT_TRUE(replayed) << replayed.error().sentence();
    EXPECT_EQ(replayed->captures, 8);
    EXPECT_TRUE(replayed->differences.empty());
}

}  // namespace
}  // namespace seamwright
