// `seamwright acceptance --data`: the contract from the outside.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/app/run_program.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class AcceptanceCli : public testing::Test {
  protected:
    std::filesystem::path folder = test_folder("acceptance");
    ~AcceptanceCli() override { std::filesystem::remove_all(folder); }
    std::string write(const std::string& name, const std::string& text) {
        std::ofstream(folder / name, std::ios::binary) << text;
        return (folder / name).string();
    }
    ProgramResult run(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "acceptance");
        return run_program(arguments, folder);
    }
    json answer(std::vector<std::string> arguments, int exit_code) {
        arguments.insert(arguments.end(), {"--json", "-"});
        const ProgramResult r = run(arguments);
        EXPECT_EQ(r.exit_code, exit_code) << r.err;
        return json::parse(r.out, nullptr, false);
    }
    void refused(const std::vector<std::string>& arguments, const std::string& part) {
        const ProgramResult r = run(arguments);
        EXPECT_EQ(r.exit_code, 2) << r.err;
        EXPECT_THAT(r.err, HasSubstr(part));
        EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
        EXPECT_EQ(r.out, "");
    }
    // Fifty values of mean 10.01 and s = 0.1 about a reference of 10.
    std::string fifty(bool reference) {
        std::string text = reference ? "part;rehang;run;value;reference\n" : "part;rehang;run;value\n";
        for (int i = 1; i <= 50; ++i) {
            char number[32];
            std::snprintf(number, sizeof number, "%.9f", 10.01 + (i % 2 ? 0.1 : -0.1) * std::sqrt(0.98));
            std::string value = number;
            value.replace(value.find('.'), 1, ",");
            text += "M;1;" + std::to_string(i) + ";" + value + (reference ? ";10\n" : "\n");
        }
        return text;
    }
};

TEST_F(AcceptanceCli, Type1) {
    const std::string file = write("v.csv", fifty(true));
    const json j = answer({"--data", file, "--study", "type1", "--tolerance-mm", "6"}, 0);
    EXPECT_EQ(j["status"], "ok");
    EXPECT_EQ(j["type1"]["n"], 50);
    EXPECT_NEAR(j["type1"]["cg"], 2.0, 1e-6);
    EXPECT_NEAR(j["type1"]["cgk"], 0.59 / 0.3, 1e-6);
    EXPECT_NEAR(j["type1"]["bias"], 0.01, 1e-8);
    EXPECT_LT(j["type1"]["limits"]["cg"][0], 2.0);
    EXPECT_GT(j["type1"]["limits"]["cg"][1], 2.0);
    EXPECT_FALSE(j.contains("type3"));
    const json small = answer({"--data", file, "--study", "type1", "--tolerance-mm", "2"}, 1);
    EXPECT_EQ(small["type1"]["verdict"], "not_ok");
    const json variant = answer({"--data", file, "--study", "type1", "--tolerance-mm", "6", "--share", "0.15",
                                 "--width", "4", "--reference", "10.01"},
                                0);
    EXPECT_NEAR(variant["type1"]["cg"], 0.15 * 6 / 0.4, 1e-6);
    EXPECT_NEAR(variant["type1"]["bias"], 0, 1e-8);
    const ProgramResult text = run({"--data", file, "--study", "type1", "--tolerance-mm", "6"});
    EXPECT_EQ(text.exit_code, 0);
    EXPECT_THAT(text.out, HasSubstr("Cgk"));
}

TEST_F(AcceptanceCli, FilesOfEveryKind) {
    const std::string file = write("v.csv", fifty(true));
    const auto dfq = folder / "v.dfq", html = folder / "v.html", pdf = folder / "v.pdf",
               xlsx = folder / "v.xlsx";
    const json j =
        answer({"--data", file, "--tolerance-mm", "6", "--nominal", "10", "--dfq", dfq.string(), "--xlsx",
                xlsx.string(), "--html", html.string(), "--pdf", pdf.string(), "--language", "de"},
               1);
    EXPECT_EQ(j["type1"]["verdict"], "ok");
    EXPECT_EQ(j["vda5"]["verdict"], "ok");
    EXPECT_EQ(j["type3"]["verdict"], "not_done");
    EXPECT_EQ(j["stability"]["verdict"], "too_little_data");  // ten subgroups
    EXPECT_THAT(slurp(dfq), HasSubstr("K2110/1 7.0000\r\n"));
    EXPECT_THAT(slurp(dfq), HasSubstr("K0014/1 M\r\n"));
    EXPECT_THAT(slurp(html), HasSubstr("Abnahme des Messprozesses"));
    EXPECT_EQ(slurp(pdf).substr(0, 5), "%PDF-");
    // A workbook is a zip file of tables; cmake unpacks those.
    ASSERT_EQ(std::system(("cd '" + folder.string() + "' && cmake -E tar xf v.xlsx").c_str()), 0);
    const std::string words = slurp(folder / "xl" / "sharedStrings.xml");
    for (const char* word : {"Cgk", "Erforderlich", "Q_MS", "Werte"})
        EXPECT_THAT(words + slurp(folder / "xl" / "workbook.xml"), HasSubstr(word));
    const std::string values = slurp(folder / "xl" / "worksheets" / "sheet2.xml");
    EXPECT_THAT(values, HasSubstr("<row r=\"51\""));
    EXPECT_THAT(values, testing::Not(HasSubstr("<row r=\"52\"")));
}

TEST_F(AcceptanceCli, BadInputIsOneSentence) {
    const std::string file = write("v.csv", fifty(false));
    refused({"--data", file, "--tolerance-mm", "6", "--study", "type1"}, "reference");
    for (const char* none : {"0", "-1", "inf", "nan", "1e9"})
        refused(
            {"--data", file, "--study", "type1", "--reference", "10", std::string("--tolerance-mm=") + none},
            "tolerance");
    refused({"--tolerance-mm", "1"}, "--data");
    refused({"--data", file, file, "--tolerance-mm", "1"}, "--data");
    refused({"--data", write("e.csv", ""), "--tolerance-mm", "1"}, "empty");
    refused({"--data", write("h.csv", "a,b,c\n1,2,3\n"), "--tolerance-mm", "1"}, "no column part");
    refused({"--data", write("n.csv", "part,rehang,run,value\nA,1,1,NaN\n"), "--tolerance-mm", "1"},
            "missing");
    refused({"--data", write("d.csv", "part,rehang,run,value\nA,1,1,1\nA,1,1,2\n"), "--tolerance-mm", "1"},
            "already");
    refused({"--data", write("t.csv", "part,rehang,run,value\nA,1,1,one\n"), "--tolerance-mm", "1"},
            "no number");
    refused({"--data", write("o.csv", "part,rehang,run,value\nA,1,1,1\nB,1,1,2\n"), "--tolerance-mm", "1",
             "--study", "type3"},
            "measured once");
    refused({"--data", write("u.csv", "part,rehang,run,value\nA,1,1,1\nA,1,2,1.1\nB,1,1,2\n"),
             "--tolerance-mm", "1", "--study", "type3"},
            "runs");
    refused({"--data", file, "--tolerance-mm", "1", "--study", "stability", "--subgroup", "0"}, "subgroup");
    refused({"--data", file, "--tolerance-mm", "1", "--region", "edge"}, "--region");
    EXPECT_EQ(run({"--data", (folder / "missing.csv").string(), "--tolerance-mm", "1"}).exit_code, 3);
    EXPECT_EQ(run({"--data", file, "--tolerance-mm", "1", "--study", "type2"}).exit_code, 2);
    EXPECT_EQ(run({"--data", file}).exit_code, 2);
}

// Robot and trigger: what is bad input, and what is not there.
TEST_F(AcceptanceCli, RobotAndTriggerAreOfAProject) {
    const std::string empty = (folder / "empty.seam").string();
    ASSERT_EQ(run_program({"new", empty}, folder).exit_code, 0);
    const auto refused_by = [&](const std::vector<std::string>& arguments, const std::string& part,
                                int code = 2) {
        const ProgramResult r = run_program(arguments, folder);
        EXPECT_EQ(r.exit_code, code) << r.err;
        EXPECT_THAT(r.err, HasSubstr(part));
        EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
        EXPECT_EQ(r.out, "");
    };
    refused_by({"acceptance", empty, "--study", "robot"}, "seamwright measure-robot");
    refused_by({"acceptance", empty, "--study", "trigger"}, "seamwright measure-trigger");
    refused_by({"acceptance", "--data", write("v.csv", fifty(true)), "--study", "trigger"}, "FILE.seam");
    refused_by({"acceptance", empty, "--study", "type1"}, "--tolerance-mm");
    refused_by({"measure-robot", "none.seam"}, "none.seam", 3);
    refused_by({"measure-robot", empty}, "no enabled spot is calibrated");
    refused_by({"measure-robot", empty, "--spot", "S1"}, "no spot \"S1\"");
    refused_by({"measure-robot", empty, "--undo"}, "no study of the robot is stored");
    refused_by({"measure-trigger", empty}, "no enabled spot is calibrated");
    refused_by({"measure-trigger", empty, "--undo"}, "no study of the trigger is stored");
    refused_by({"measure-trigger", empty, "--program", "krc"}, "--brand");
    for (const std::vector<std::string>& bad :
         {std::vector<std::string>{"measure-robot", empty, "--returns", "4"},
          {"measure-robot", empty, "--profiles", "1"},
          {"measure-trigger", empty, "--travel-deg", "91"},
          {"measure-trigger", empty, "--passes", "nan"},
          {"measure-trigger", empty, "--speeds", "a,b,c"}})
        EXPECT_EQ(run_program(bad, folder).exit_code, 2) << bad[2];
}

// What the project asks for is kept in it, and what a command gives goes over it.
TEST_F(AcceptanceCli, RequirementsAreKeptInTheProject) {
    const std::string project = (folder / "p.seam").string();
    ASSERT_EQ(run_program({"new", project}, folder).exit_code, 0);
    refused({project, "--study", "type1"}, "--tolerance-mm is required");
    refused({"--data", write("v.csv", fifty(true)), "--tolerance-mm", "6", "--keep-requirements"},
            "FILE.seam");
    refused({project, "--tolerance-mm", "0.8", "--grr-accepted", "40", "--keep-requirements"}, "accept less");
    refused({project, "--tolerance-mm=nan", "--keep-requirements"}, "tolerance");
    refused({project, "--study", "type1"}, "--tolerance-mm is required");  // nothing was kept
    // There is nothing to judge yet; the requirements are kept all the same.
    refused({project, "--tolerance-mm", "0.8", "--share", "0.15", "--width", "4", "--required", "1.67",
             "--keep-requirements"},
            "no region");
    refused({project, "--study", "type1"}, "no region");
    const ProgramResult exported =
        run_program({"export", project, "--out", (folder / "p.json").string()}, folder);
    ASSERT_EQ(exported.exit_code, 0) << exported.err;
    const json kept = json::parse(slurp(folder / "p.json"))["project"]["requirements"]["acceptance"];
    EXPECT_EQ(kept["tolerance_mm"], 0.8);
    EXPECT_EQ(kept["cg_share"], 0.15);
    EXPECT_EQ(kept["cg_width"], 4);
    EXPECT_EQ(kept["cg"], 1.67);
    EXPECT_EQ(kept["cgk"], 1.67);
    EXPECT_EQ(kept["grr_accepted_percent"], 10);
}

TEST_F(AcceptanceCli, EveryRequirementIsNamedWithWhereItIsFrom) {
    const std::string file = write("v.csv", fifty(true));
    const json j =
        answer({"--data", file, "--study", "type1", "--tolerance-mm", "6", "--required", "1.9"}, 0);
    EXPECT_EQ(j["settings"]["from"]["tolerance_mm"], "given");
    EXPECT_EQ(j["settings"]["from"]["cg"], "given");
    EXPECT_EQ(j["settings"]["from"]["cgk"], "given");
    EXPECT_EQ(j["settings"]["from"]["cg_share"], "default");
    EXPECT_EQ(j["settings"]["required_cgk"], 1.9);
    const json apart = answer({"--data", file, "--study", "type1", "--tolerance-mm", "6", "--required", "1.9",
                               "--required-cgk", "1.98"},
                              1);
    EXPECT_EQ(apart["type1"]["verdict"], "not_ok");  // Cg is 2, Cgk 1.97
    EXPECT_EQ(answer({"--data", file, "--study", "type1", "--tolerance-mm", "6", "--required-cgk", "1.95"},
                     0)["settings"]["required_cg"],
              1.33);
}

TEST_F(AcceptanceCli, StudiesAreNotMeasuredWithOptionsThatAreNone) {
    const std::string project = (folder / "p.seam").string(), data = write("v.csv", fifty(true));
    ASSERT_EQ(run_program({"new", project}, folder).exit_code, 0);
    refused({"--data", data, "--tolerance-mm", "1", "--runs", "5", "--study", "type1"}, "FILE.seam");
    refused({project, "--tolerance-mm", "1", "--runs", "5"}, "one study at a time");
    refused({project, "--tolerance-mm", "1", "--runs", "0", "--study", "type1"}, "--runs");
    refused({project, "--tolerance-mm", "1", "--runs", "5", "--study", "linearity"}, "known-shift");
    refused({project, "--tolerance-mm", "1", "--runs", "5", "--study", "type3"}, "--parts");
    refused({project, "--tolerance-mm", "1", "--runs", "5", "--study", "type3", "--parts", "A,A"}, "twice");
    refused({project, "--tolerance-mm", "1", "--runs", "5", "--study", "type1"}, "no region");
    refused({project, "--keep-offset", "--tolerance-mm", "1"}, "correlation");
    refused({project, "--switch-offset", "1"}, "no region");
    refused({project, "--undo-offset"}, "no region");
    refused({"--data", data, "--switch-offset", "1"}, "FILE.seam");
    EXPECT_EQ(run({project, "--tolerance-mm", "1", "--parts", "A,B"}).exit_code, 2) << "needs --runs";
    EXPECT_EQ(run({project, "--tolerance-mm", "1", "--study", "type1", "--runs", "many"}).exit_code, 2);
}

TEST_F(AcceptanceCli, SensorAgainstItsArtefacts) {
    json points = json::array();
    for (const double height : {-0.8, -0.4, 0.0, 0.4, 0.8})
        for (int i = 0; i < 12; ++i) {
            const double turn = i * 3.14159265358979 / 6, across = std::sqrt(1 - height * height);
            const double r = 15.004 + (i % 2 ? 0.003 : -0.003);
            points.push_back({r * across * std::cos(turn), r * across * std::sin(turn), 100 + r * height});
        }
    json data = {
        {"limits_mm", {{"form", 0.01}, {"size", 0.01}}},
        {"spheres", {{{"id", "K1"}, {"diameter_mm", 30}, {"certificate", "D-K 1"}, {"points", points}}}}};
    const std::string file = write("s.json", data.dump()), html = (folder / "s.html").string();
    const json good = answer({"--study", "sensor", "--sensor-data", file, "--html", html}, 0);
    EXPECT_EQ(good["status"], "ok");
    EXPECT_NEAR(good["sensor"]["spheres"][0]["probing_form"]["value"], 0.006, 1e-9);
    EXPECT_NEAR(good["sensor"]["spheres"][0]["probing_size"]["value"], 0.008, 1e-6);
    EXPECT_THAT(slurp(html), HasSubstr("probing form"));
    data["limits_mm"]["size"] = 0.005;
    EXPECT_EQ(answer({"--study", "sensor", "--sensor-data", write("t.json", data.dump())}, 1)["status"],
              "not_ok");
    data.erase("limits_mm");
    EXPECT_EQ(answer({"--study", "sensor", "--sensor-data", write("u.json", data.dump())}, 0)["status"],
              "not_judged");
    refused({"--study", "sensor"}, "--sensor-data");
    refused({"--study", "sensor", "--sensor-data", write("e.json", "")}, "e.json");
    refused({"--study", "sensor", "--sensor-data",
             write("n.json", R"({"spheres":[{"id":"K","points":[[1,2,NaN]]}]})")},
            "n.json");
    data["spheres"].push_back(data["spheres"][0]);
    refused({"--study", "sensor", "--sensor-data", write("d.json", data.dump())}, "two artefacts");
    refused({"--study", "type1", "--sensor-data", file, "--data", file, "--tolerance-mm", "1"},
            "study sensor");
    EXPECT_EQ(run({"--study", "sensor", "--sensor-data", (folder / "none.json").string()}).exit_code, 3);
}

}  // namespace
}  // namespace seamwright
