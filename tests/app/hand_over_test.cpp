// Proving and handing over from the command line, as a script would: zero shift, known shift, headless run,
// check, report as HTML and PDF without a screen, re-teach.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "projects/file/project_file.h"
#include "tests/app/run_program.h"
#include "tests/projects/door_project.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class HandOverCommands : public testing::Test {
  protected:
    fs::path folder = test_folder("hand_over"), file = folder / "door.seam";
    Project project;

    void SetUp() override {
        nlohmann::json settings = cell_settings(Pose::Identity());
        const auto cell = SimulatedCell::open(settings).value();
        settings["robot"]["frames"]["path"] = pose_json(cell->base_from_workobject());
        project = door_project(*cell, settings);
        // Contour ends scatter more than door_project() states: stated so, no shift contradicts itself.
        for (Spot& spot : project.spots) spot.sigma_mm *= 3;
        project.requirements.sigma3_mm = 1.5;
        project.calibrations[0].created_utc = "2024-01-01T00:00:00.000Z";
        project.requirements.calibration_age_days = 3650;
        project.regions[0].sigma_limit_mm = 0.5;
        project.regions[0].limits = {1.5, 0.15};
        project.requirements.known_shift_mm = 2;  // contour ends are lost farther out
        project.requirements.known_shift_deg = 0.2;
        ASSERT_TRUE(ProjectFile::create(file, project));
        // References as the first run measures them.
        ASSERT_NE(run({"run", file.string()}).exit_code, 3);
        auto opened = ProjectFile::open(file).value();
        const RunRecord first = opened.load_run(1).value();
        for (std::size_t i = 0; i < first.spots.size(); ++i) {
            Spot& spot = project.spots[i];
            spot.enabled = first.spots[i].status == SpotStatus::measured;
            spot.reference_mm = first.spots[i].measured_mm;
            spot.reference_profile.x_mm = {spot.reference_mm.x() - 5, spot.reference_mm.x()};
            spot.reference_profile.z_mm = {spot.reference_mm.z(), spot.reference_mm.z()};
            spot.curve.emplace();
            spot.curve->valid_from_mm = -5, spot.curve->valid_to_mm = 5;
        }
        Project stored = opened.load().value();
        stored.spots = project.spots;
        ASSERT_TRUE(opened.save(stored));
        for (const Spot& spot : stored.spots) {
            FrozenContour frozen;
            frozen.spot_id = spot.id;
            frozen.status = AlignmentStatus::frozen;
            frozen.jitter_mm = spot.jitter_mm;
            ASSERT_TRUE(opened.append_evidence({0, {}, 0, frozen}, stored));
        }
    }
    ~HandOverCommands() override { fs::remove_all(folder); }
    ProgramResult run(const std::vector<std::string>& arguments) const {
        return run_program(arguments, folder);
    }
    json answer(std::vector<std::string> arguments, int exit_code) const {
        arguments.insert(arguments.end(), {"--json", "-"});
        const ProgramResult r = run(arguments);
        EXPECT_EQ(r.exit_code, exit_code) << r.err << r.out;
        return json::parse(r.out, nullptr, false);
    }
    std::string status_of(const json& check, const std::string& step) const {
        for (const json& item : check["checklist"])
            if (item["step"] == step) return item["status"];
        return "?";
    }
};

TEST_F(HandOverCommands, FromOpenStepsToASignedReport) {
    json check = answer({"check", file.string(), "--commissioned"}, 1);
    EXPECT_FALSE(check["commissioned"]);
    EXPECT_EQ(status_of(check, "zero-shift"), "missing");
    EXPECT_NE(status_of(check, "headless"), "done") << "the spots were taught after the first run";

    const json zero = answer({"zero-shift", file.string(), "--runs", "3"}, 0);
    EXPECT_EQ(zero["runs"].size(), 3u);
    const json known =
        answer({"known-shift", file.string(), "--range-mm", "2", "--step-mm", "2", "--range-deg", "0.2",
                "--step-deg", "0.2", "--csv", (folder / "shift.csv").string()},
               0);
    EXPECT_EQ(known["tests"].size(), 18u);
    EXPECT_LT(known["regions"][0]["three_sigma_mm"].get<double>(), 0.5);
    EXPECT_GT(known["proven_translation_mm"].get<double>(), 1.9);
    EXPECT_THAT(slurp(folder / "shift.csv"), HasSubstr("translation,X,-2,"));
    EXPECT_EQ(run({"run", file.string(), "--part", "first", "--push"}).exit_code, 0);

    check = answer({"check", file.string(), "--commissioned", "--connect"}, 0);
    EXPECT_TRUE(check["commissioned"]);
    EXPECT_EQ(check["checklist"].size(), 10u);

    const fs::path html = folder / "report.html", pdf = folder / "report.pdf";
    for (const std::string language : {"en", "de"}) {
        const json report = answer(
            {"report", file.string(), "--html", html.string(), "--pdf", pdf.string(), "--language", language},
            0);
        EXPECT_TRUE(report["open_steps"].empty());
        const std::string page = slurp(html);
        EXPECT_THAT(page,
                    HasSubstr(language == "en" ? "all 10 steps are done" : "alle 10 Schritte sind erledigt"));
        EXPECT_THAT(page, HasSubstr("SIM-1"));
        EXPECT_EQ(slurp(pdf).substr(0, 5), "%PDF-");
        fs::create_directories(SEAMWRIGHT_SCREENS);
        const std::string pictures = std::string(SEAMWRIGHT_SCREENS) + "/report_" + language;
        EXPECT_EQ(std::system(("pdftoppm -r 70 -png '" + pdf.string() + "' '" + pictures + "'").c_str()), 0);
        const fs::path text = folder / "report.txt";
        EXPECT_EQ(std::system(("pdftotext -layout '" + pdf.string() + "' '" + text.string() + "'").c_str()),
                  0);
        EXPECT_THAT(slurp(text), HasSubstr(language == "en" ? "Signature" : "Unterschrift"));
        EXPECT_THAT(slurp(text), HasSubstr("SIM-1"));
    }
}

TEST_F(HandOverCommands, AcceptanceOfTheMeasuringProcess) {
    answer({"zero-shift", file.string(), "--runs", "26"}, 0);
    answer({"known-shift", file.string(), "--range-mm", "4", "--step-mm", "1", "--range-deg", "0.2",
            "--step-deg", "0.1"},
           0);
    fs::create_directories(SEAMWRIGHT_SCREENS);
    for (const std::string language : {"en", "de"}) {
        const fs::path pdf = folder / "acceptance.pdf", text = folder / "acceptance.txt";
        const json a = answer({"acceptance", file.string(), "--tolerance-mm", "8", "--pdf", pdf.string(),
                               "--dfq", (folder / "a.dfq").string(), "--language", language},
                              1);
        ASSERT_TRUE(a["type1"].contains("n") && a["linearity"].contains("n") &&
                    a["stability"].contains("subgroups") && a["vda5"].contains("type3"))
            << a.dump(1);
        EXPECT_TRUE(a["source"]["simulated"]);
        EXPECT_EQ(a["type1"]["n"], 26);
        EXPECT_EQ(a["type1"]["verdict"], "ok") << a["type1"].dump(1);
        EXPECT_LT(a["type1"]["s"].get<double>(), 0.3);
        EXPECT_GT(a["type1"]["s"].get<double>(), 0.001) << "the simulation has noise";
        EXPECT_EQ(a["type3"]["verdict"], "not_done") << "no part was measured twice";
        EXPECT_GE(a["linearity"]["n"].get<int>(), 50);
        EXPECT_NEAR(a["linearity"]["slope"].get<double>(), 0, 0.1);
        EXPECT_EQ(a["stability"]["subgroups"], 5);
        EXPECT_EQ(a["vda5"]["type3"], false);
        EXPECT_EQ(a["correlation"]["verdict"], "not_done");
        EXPECT_THAT(slurp(folder / "a.dfq"), HasSubstr("K2401/1 SIM-1\r\n"));
        const std::string pictures = std::string(SEAMWRIGHT_SCREENS) + "/acceptance_" + language;
        EXPECT_EQ(std::system(("pdftoppm -r 70 -png '" + pdf.string() + "' '" + pictures + "'").c_str()), 0);
        EXPECT_EQ(std::system(("pdftotext -layout '" + pdf.string() + "' '" + text.string() + "'").c_str()),
                  0);
        EXPECT_THAT(slurp(text),
                    HasSubstr(language == "en" ? "the cell was simulated" : "die Zelle war simuliert"));
    }
}

TEST_F(HandOverCommands, ReteachLeadsTheSpotsAlong) {
    {
        auto opened = ProjectFile::open(file).value();
        Project p = opened.load().value();
        p.calibrations.push_back(p.calibrations[0]);
        p.calibrations[1].id = "second";
        p.calibrations[1].flange_from_sensor.translate(Eigen::Vector3d(0, 0, 7));
        ASSERT_TRUE(opened.save(p));
    }
    const json dry =
        answer({"reteach", file.string(), "--sensor", "A", "--calibration", "second", "--dry-run"}, 0);
    EXPECT_NEAR(dry["spots"][0]["moved_mm"].get<double>(), 7, 1e-9);
    EXPECT_EQ(ProjectFile::open(file)->load()->sensors[0].calibration_id, "truth");
    answer({"reteach", file.string(), "--sensor", "A", "--calibration", "second"}, 0);
    EXPECT_EQ(ProjectFile::open(file)->load()->sensors[0].calibration_id, "second");
    EXPECT_EQ(run({"reteach", file.string(), "--sensor", "A", "--calibration", "third"}).exit_code, 2);
}

TEST_F(HandOverCommands, RefusesInOneSentence) {
    for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
             {"report", file.string()},
             {"report", file.string(), "--pdf", (folder / "x.pdf").string(), "--language", "fr"},
             {"known-shift", file.string(), "--step-mm", "0"},
             {"known-shift", file.string(), "--by", "hand"},
             {"zero-shift", file.string(), "--runs", "1"}}) {
        const ProgramResult r = run(arguments);
        EXPECT_EQ(r.exit_code, 2) << arguments[0] << " " << r.err;
        EXPECT_FALSE(r.err.empty());
    }
    EXPECT_EQ(run({"report", file.string(), "--pdf", "/nowhere/x.pdf"}).exit_code, 3);
}

}  // namespace
}  // namespace seamwright
