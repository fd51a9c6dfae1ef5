// `use`, `teach`, `pass`, `align --live` and `stripe`: what the desk does, done from the command line on the simulated cell,
// whose door is known by its formula (devices/simulated/scene/door.h): at a spot's sensor the edge lies at x = -15, the
// flange at z = 0, and where that ends, at x = -6, the sealing land begins at z = -0.8: the spots' contour end.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <sstream>

#include "projects/file/project_file.h"
#include "projects/measure/measure.h"
#include "projects/reuse/exchange.h"
#include "tests/app/cli_case.h"
#include "tests/projects/door_project.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Deeds : public CliCase {
  protected:
    std::filesystem::path file = folder / "door.seam";
    Project project;

    void SetUp() override {
        json settings = cell_settings(Pose::Identity());
        settings["robot"] = {{"repeatability_mm", 0.005}, {"repeatability_deg", 0.0}};
        const auto cell = *SimulatedCell::open(settings);
        project = door_project(*cell, settings);
        project.spots.resize(3);
        project.regions[0].spot_ids.resize(3);
        for (Spot& s : project.spots) s.jitter_mm = 3;
        save();
    }
    void save() { ASSERT_TRUE(ProjectFile::create(file, project, true)); }
    Project stored() const { return *ProjectFile::open(file, FileAccess::read_only)->load(); }
    json ok(std::vector<std::string> arguments, int exit_code = 0) {
        arguments.insert(arguments.begin() + 1, file.string());
        return answer(std::move(arguments), exit_code);
    }
    // All that the file says of the project; its bytes change with the journal while devices are connected.
    std::string content() const { return export_project(stored(), true).dump(); }
    // One sentence, exit 2 and the project as it was.
    void refused(std::vector<std::string> arguments, const std::string& part, int exit_code = 2) {
        const std::string before = content();
        arguments.insert(arguments.begin() + 1, file.string());
        expect_refused(arguments, part, exit_code);
        EXPECT_TRUE(content() == before) << "nothing is half written";
    }
    // Words of a sentence that the answer offers, without the program's name.
    static std::vector<std::string> words(const std::string& command) {
        std::istringstream in(command);
        std::vector<std::string> all;
        for (std::string word; in >> word;) all.push_back(word);
        all.erase(all.begin());
        return all;
    }
};

// --- use

class Use : public Deeds {
  protected:
    // As the one in use, with its sensor shifted by (0.3, 0, -0.4) mm in its own frame: every point moves by half a
    // millimetre, whatever it is.
    void SetUp() override {
        Deeds::SetUp();
        for (Spot& s : project.spots) s.reference_mm = {-15, 0, 0};
        Calibration shifted = project.calibrations[0];
        shifted.id = "shifted";
        shifted.flange_from_sensor =
            shifted.flange_from_sensor * make_pose(Eigen::Matrix3d::Identity(), {0.3, 0, -0.4});
        Calibration poor = shifted;
        poor.id = "poor";
        poor.verdict = Verdict::poor;
        Calibration nozzle = shifted;
        nozzle.id = "nozzle";
        nozzle.nozzle = NozzleTip{};
        Calibration tabled = project.calibrations[0];
        tabled.id = "tabled";
        tabled.model->table = tabulate(*tabled.model, 8);
        project.calibrations.insert(project.calibrations.end(), {shifted, poor, nozzle, tabled});
        save();
    }
};

TEST_F(Use, TellsWhatMovesAndIsTakenBackAsItSays) {
    const json a = ok({"use", "--calibration", "shifted"});
    EXPECT_EQ(a["status"], "changed");
    EXPECT_EQ(a["sensor"], "A");
    EXPECT_EQ(a["before"], "truth");
    EXPECT_NEAR(a["working_point_mm"].get<double>(), 0.5, 1e-6);
    EXPECT_NEAR(a["difference"]["shift_mm"].get<double>(), 0.5, 1e-9);
    EXPECT_NEAR(a["difference"]["largest_mm"].get<double>(), 0.5, 1e-6);
    ASSERT_EQ(a["spots"].size(), 3u);
    for (const json& s : a["spots"]) EXPECT_NEAR(s["moved_mm"].get<double>(), 0.5, 1e-6);
    EXPECT_EQ(stored().sensors[0].calibration_id, "shifted");

    const json again = ok({"use", "--calibration", "shifted"});
    EXPECT_EQ(again["status"], "unchanged");
    EXPECT_TRUE(again["undo"].is_null());

    const json back = answer(words(a["undo"]), 0);
    EXPECT_EQ(back["calibration"], "truth");
    EXPECT_EQ(stored().sensors[0].calibration_id, "truth");

    const json none = ok({"use", "--none"});
    EXPECT_TRUE(none["calibration"].is_null());
    EXPECT_TRUE(none["working_point_mm"].is_null());
    EXPECT_EQ(stored().sensors[0].calibration_id, "");
    EXPECT_EQ(answer(words(none["undo"]), 0)["calibration"], "truth");
}

TEST_F(Use, ATableOfTheSameCameraMovesNothing) {
    const json a = ok({"use", "--calibration", "tabled"});
    EXPECT_LT(a["working_point_mm"].get<double>(), 0.005);
    // And back through the table's inverse.
    const json b = ok({"use", "--calibration", "shifted"});
    EXPECT_NEAR(b["working_point_mm"].get<double>(), 0.5, 0.005);
}

TEST_F(Use, ListsAndRefuses) {
    const json list = ok({"use", "--list"});
    ASSERT_EQ(list["calibrations"].size(), 5u);
    EXPECT_EQ(list["calibrations"][0]["in_use"], true);
    EXPECT_EQ(list["calibrations"][2]["verdict"], "poor");
    EXPECT_EQ(ok({"use"}), list);
    refused({"use", "--calibration", "poor"}, "calibration poor is poor");
    refused({"use", "--calibration", "nozzle"}, "record");
    refused({"use", "--calibration", "nobody"}, "there is no calibration \"nobody\"");
    refused({"use", "--calibration", "shifted", "--sensor", "B"}, "there is no sensor \"B\"");
    refused({"use", "--calibration", "missing.seam"}, "missing.seam", 3);
    refused({"use", "--calibration", "shifted", "--calibration-id", "x"}, "another file");
    EXPECT_EQ(run({"use", file.string(), "--calibration", "shifted", "--none"}).exit_code, 2);
    EXPECT_EQ(run({"use", (folder / "no.seam").string()}).exit_code, 3);
}

TEST_F(Use, TakesOneFromAnotherProject) {
    Project other = project;
    other.calibrations[0].id = "truth";
    other.calibrations[0].flange_from_sensor =
        other.calibrations[0].flange_from_sensor * make_pose(Eigen::Matrix3d::Identity(), {0, 0.2, 0});
    const auto path = folder / "other.seam";
    ASSERT_TRUE(ProjectFile::create(path, other));
    const json a = ok({"use", "--calibration", path.string(), "--calibration-id", "truth", "--sensor", "A"});
    EXPECT_EQ(a["calibration"], "truth-2");
    EXPECT_NEAR(a["working_point_mm"].get<double>(), 0.2, 1e-6);
    EXPECT_EQ(stored().calibrations.size(), 6u);
    refused({"use", "--calibration", path.string(), "--calibration-id", "none", "--sensor", "A"}, "\"none\"");
}

// --- teach

TEST_F(Deeds, TeachMeasuresTheDoorsContourWhereItIs) {
    const json a = ok({"teach", "T1", "--live", "--repeats", "3"});
    EXPECT_EQ(a["status"], "taught");
    EXPECT_EQ(a["new"], false);
    EXPECT_EQ(a["arrivals"], 3);
    EXPECT_EQ(a["measurements"], 6);
    EXPECT_NEAR(a["reference"][0].get<double>(), -6, 0.1);
    EXPECT_NEAR(a["reference"][2].get<double>(), -0.8, 0.05);
    const Project p = stored();
    const Spot& s = *find_spot(p, "T1");
    EXPECT_EQ(s.reference_mm.x(), a["reference"][0].get<double>());
    EXPECT_GT(s.reference_profile.size(), 100u);
    EXPECT_EQ(s.reference_state, ReferenceState::measured);
    EXPECT_EQ(s.sigma_mm, project.spots[0].sigma_mm) << "what was not asked for stays";

    // A piece of the hem as template, with the edge as its landmark, and a field.
    const json t = ok({"teach", "T1", "--kind", "template", "--window=-16,-3,25,3", "--reference=-15,0",
                       "--set", "window_dx_mm=12", "--field", "jitter_mm=2", "--repeats", "2"});
    EXPECT_EQ(t["kind"], "template");
    EXPECT_GT(t["template_points"], 50);
    EXPECT_NEAR(t["reference"][0].get<double>(), -15, 0.05) << "the landmark is carried along";
    EXPECT_EQ(find_spot(stored(), "T1")->jitter_mm, 2);
    EXPECT_EQ(t["parameters"]["window_dx_mm"], 12);

    // A further spot, beside the first: in its own name, without a region.
    const json fresh = ok({"teach", "S9", "--pose", pose_json(project.spots[1].base_from_flange).dump(),
                           "--kind", "contour-end", "--set", "side=left", "--repeats", "1"});
    EXPECT_EQ(fresh["new"], true);
    EXPECT_EQ(stored().spots.size(), 4u);
}

TEST_F(Deeds, TeachTakesProfilesFromFiles) {
    // A sheet that ends at x = 4.03, with a bent down flank.
    const auto sheet = [&](const std::string& name, double lift) {
        std::string text = "x_mm,z_mm\n";
        for (int i = 0; i <= 400; ++i) {
            const double x = -16 + 0.05 * i;
            text += fmt::format("{},{}\n", x, lift + (i % 2 ? 0.004 : -0.004));
        }
        return write(name, text);
    };
    const std::string a = sheet("a.csv", 1.0), b = sheet("b.csv", 1.1);
    const json t =
        ok({"teach", "S7", "--profile", a, "--profile", b, "--kind", "contour-end", "--set", "side=right",
            "--pose", pose_json(project.spots[1].base_from_flange).dump(), "--field", "sigma_mm=0.2"});
    EXPECT_EQ(t["new"], true);
    EXPECT_EQ(t["measurements"], 2);
    EXPECT_NEAR(t["reference"][0].get<double>(), 4.0, 0.1);
    EXPECT_NEAR(t["reference"][2].get<double>(), 1.05, 0.02);
}

TEST_F(Deeds, TeachRefusesInOneSentence) {
    refused({"teach", "T1", "--kind", "triangle"}, "unknown feature kind");
    refused({"teach", "T1", "--kind", "template"}, "the template is missing");
    refused({"teach", "T1", "--window=0,0,5,5"}, "only the kind \"template\"");
    refused({"teach", "T1", "--kind", "template", "--window=5,0,0,5"}, "the window is empty");
    refused({"teach", "T1", "--set", "sidewards=1"}, "has no setting");
    refused({"teach", "T1", "--field", "colour=1"}, "has no field");
    refused({"teach", "T1", "--field", "sigma_mm=-1"}, "sigma_mm");
    refused({"teach", "S8", "--sensor", "Z"}, "\"Z\" is not in the project");
    refused({"teach", "T1", "--profile", "none.csv"}, "none.csv", 3);
    refused({"teach", "T1", "--profile", "x.csv", "--live"}, "from files and from the sensor");
    refused({"teach", "T1", "--kind", "template", "--window=200,200,210,210"}, "fewer than 20 points");
}

// --- pass

TEST_F(Deeds, APassIsAcceptedWhereTheContourStandsStill) {
    ok({"teach", "T2", "--repeats", "2"});
    const json none = ok({"pass", "T2", "list"});
    EXPECT_EQ(none["status"], "none");

    const std::string before = content();
    const std::string csv = (folder / "pass.csv").string();
    const json seen = ok({"pass", "T2", "record", "--out", csv});
    EXPECT_EQ(seen["status"], "frozen");
    EXPECT_EQ(seen["done"], "recorded");
    EXPECT_TRUE(content() == before) << "recording keeps nothing";
    // The same is judged from the file, and by `align --live`.
    const json judged = answer({"align", csv, "--project", file.string(), "--spot", "T2"}, 0);
    EXPECT_NEAR(judged["yaw_deg"].get<double>(), seen["yaw_deg"].get<double>(), 0.05);
    EXPECT_EQ(answer({"align", file.string(), "T2", "--live"}, 0)["status"], "frozen");

    const json accepted = ok({"pass", "T2", "accept", "--jitter-mm", "2"});
    EXPECT_EQ(accepted["done"], "accepted");
    EXPECT_GT(accepted["evidence"], 0);
    const Project p = stored();
    EXPECT_TRUE(find_spot(p, "T2")->curve.has_value());
    EXPECT_EQ(find_spot(p, "T2")->jitter_mm, 2);
    const json list = ok({"pass", "T2", "list"});
    EXPECT_EQ(list["status"], "accepted");
    ASSERT_EQ(list["passes"].size(), 1u);
    EXPECT_EQ(list["passes"][0]["status"], "frozen");
    EXPECT_LE(list["passes"][0]["expected_error_mm"], list["passes"][0]["tolerance_mm"]);
    // A larger jitter than was judged does not hold any more.
    Project wider = p;
    for (Spot& s : wider.spots) s.jitter_mm = 8;
    ASSERT_TRUE(ProjectFile::open(file)->save(wider));
    EXPECT_EQ(ok({"pass", "T2", "list"})["status"], "stale");
}

TEST_F(Deeds, ADriftIsToldWithItsCureAndAdoptedPassesFreeze) {
    ok({"teach", "T2", "--repeats", "2"});
    project = stored();
    // The sensor, and its travel with it, turned by 3 degrees about its own Z.
    const Pose f = project.calibrations[0].flange_from_sensor;
    for (Spot& s : project.spots)
        if (s.id == "T2")
            s.base_from_flange = s.base_from_flange * f *
                                 make_pose(rotation_exp({0, 0, rad_from_deg(3)}), Eigen::Vector3d::Zero()) *
                                 f.inverse();
    save();
    const json drift = ok({"pass", "T2", "accept"}, 1);
    EXPECT_EQ(drift["status"], "drifting");
    EXPECT_EQ(drift["done"], "recorded");
    // The edge of the door bends, and so does its direction: a quarter of a degree.
    EXPECT_NEAR(std::abs(drift["yaw_deg"].get<double>()), 3, 0.4);
    EXPECT_FALSE(drift["cure"].get<std::string>().empty());
    EXPECT_NEAR(drift["cure_about_z_deg"].get<double>(), -drift["yaw_deg"].get<double>(), 1e-9);
    EXPECT_FALSE(find_spot(stored(), "T2")->curve);
    EXPECT_EQ(answer({"align", file.string(), "T2", "--live"}, 1)["cure"], drift["cure"]);

    const json adopted = ok({"pass", "T2", "adopt"});
    EXPECT_EQ(adopted["done"], "adopted");
    EXPECT_EQ(find_spot(stored(), "T2")->reference_profile.size(), 0u) << "it was about another pose";
    ok({"teach", "T2", "--repeats", "2"});
    EXPECT_EQ(ok({"pass", "T2", "accept"})["done"], "accepted");
}

TEST_F(Deeds, PassRefusesInOneSentence) {
    refused({"pass", "nobody", "record"}, "there is no spot \"nobody\"");
    refused({"pass", "nobody", "list"}, "there is no spot \"nobody\"");
    EXPECT_EQ(run({"pass", file.string(), "T1", "fly"}).exit_code, 2);
    expect_refused({"pass", file.string(), "T1", "record", "--step-mm", "0"}, "a step of 0 mm");
    expect_refused({"align", file.string(), "--live"}, "no spot is named");
    expect_refused({"align", file.string(), "T1"}, "one file too many");
}

// --- stripe

TEST_F(Deeds, StripeShowsAndSetsWhatASensorsFramesGoThrough) {
    json a = ok({"stripe", "A"});
    EXPECT_EQ(a["status"], "ok");
    EXPECT_EQ(a["settings"]["scan"], "columns");
    EXPECT_EQ(a["settings"]["per_line"], 3);
    a = ok({"stripe", "A", "--set", "peak_method=gaussian", "--set", "per_line=5", "--set", "band_sigmas=5.5",
            "--set", "as_delivered=yes"});
    EXPECT_EQ(a["changed"], (json{"peak_method", "per_line", "band_sigmas", "as_delivered"}));
    const SensorSetup s = stored().sensors[0];
    EXPECT_EQ(s.peaks.method, PeakMethod::gaussian);
    EXPECT_EQ(s.peaks.per_line, 5);
    EXPECT_EQ(s.filter.band_sigmas, 5.5);
    EXPECT_TRUE(s.filter.as_delivered);
    EXPECT_EQ(s.peaks.max_width_px, project.sensors[0].peaks.max_width_px);
    // They count: without candidates enough no peak is found where none may be so wide.
    ok({"stripe", "A", "--defaults", "--set", "min_width_px=60"});
    EXPECT_EQ(run({"teach", file.string(), "T1", "--repeats", "1"}).exit_code, 2);
    ok({"stripe", "A", "--defaults"});
    EXPECT_EQ(ok({"teach", "T1", "--repeats", "1"})["status"], "taught");
}

TEST_F(Deeds, StripeTakesAllOrNothing) {
    refused({"stripe", "Z"}, "no sensor \"Z\"");
    refused({"stripe", "A", "--set", "colour=red"}, "a sensor has no field");
    refused({"stripe", "A", "--set", "per_line"}, "sets nothing");
    refused({"stripe", "A", "--set", "per_line=many"}, "is not a number");
    refused({"stripe", "A", "--set", "per_line=0"}, "per_line");
    refused({"stripe", "A", "--set", "per_line=4", "--set", "peak_method=magic"}, "one of");
    refused({"stripe", "A", "--set", "min_width_px=90"}, "max_width_px");
    refused({"stripe", "A", "--set", "lookahead=9"}, "min_segment_points");
    refused({"stripe", "A", "--set", "noise_mm=nan"}, "noise_mm");
}

// --- track

TEST_F(Deeds, TrackRefusesImagesOfAnotherSizeThanTheCalibrations) {
    ASSERT_TRUE(project.calibrations[0].model);
    ASSERT_GT(project.calibrations[0].model->camera.width, 160);
    std::string pgm = "P5\n160 120\n255\n" + std::string(160 * 120, '\x08');
    for (int u = 0; u < 160; ++u) pgm[pgm.size() - 160 * 60 + static_cast<std::size_t>(u)] = '\x7f';
    const std::string image = write("frame.pgm", pgm);
    expect_refused({"track", image, "--columns", "--calibration", file.string(), "--calibration-id",
                    project.calibrations[0].id},
                   "160 x 120 pixels");
    answer({"track", image, "--columns"}, 0);
}

}  // namespace
}  // namespace seamwright
