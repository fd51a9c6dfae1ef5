// The command line as others script against it: names, fields, exit codes, one sentence on stderr.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Core>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/app/cli_case.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

using Cli = CliCase;

TEST_F(Cli, UsageErrorsEndWithTwo) {
    EXPECT_EQ(run({}).exit_code, 2);
    EXPECT_EQ(run({"no-such-command"}).exit_code, 2);
    EXPECT_EQ(run({"correct"}).exit_code, 2);
    EXPECT_EQ(run({"feature", write("p.csv", "x_mm,z_mm\n0,0\n"), "--kind", "no-such-kind"}).exit_code, 2);
    EXPECT_EQ(run({"--help"}).exit_code, 0);
    EXPECT_EQ(run({"--version"}).exit_code, 0);
}

TEST_F(Cli, EveryCommandsHelpShowsAnExample) {
    for (const char* command :
         {"demo",   "new",       "info",          "check",           "run",      "replay",   "export",
          "import", "correct",   "plan",          "filter",          "feature",  "match",    "extract",
          "align",  "calibrate", "devices",       "panel",           "evaluate", "sim-cell", "robot-program",
          "path",   "gap",       "measure-robot", "measure-trigger", "follow"}) {
        const ProgramResult r = run({command, "--help"});
        EXPECT_EQ(r.exit_code, 0) << command;
        EXPECT_THAT(r.out, HasSubstr("Example:")) << command;
        EXPECT_THAT(r.out, HasSubstr("--json")) << command;
    }
}

TEST_F(Cli, APathIsFollowedOnlyByAGuideAndARobotThatTakesCorrectionsInEveryCycle) {
    const std::string project = (folder / "gap.seam").string();
    EXPECT_EQ(run({"gap", project, "--simulated", "--nozzle-mm", "2.5", "--clearance-mm", "0.4"}).exit_code,
              1);
    const std::string guide =
        write("guide.csv", "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n0,0,0,0,0,0\n0,10,0,0,0,0\n0,20,0,0,0,0\n");
    expect_refused({"follow", project}, "there is no guide");
    expect_refused({"follow", project, "--guide", project + ".csv"}, "gap.seam.csv", 3);
    expect_refused(
        {"follow", project, "--guide", write("one.csv", "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n0,0,0,0,0,0\n")},
        "two points");
    expect_refused({"follow", project, "--guide", guide, "--teach"}, "--spot");
    const std::vector<std::pair<std::vector<std::string>, const char*>> wrong_options = {
        {{"follow", project, "--guide", guide, "--limit-mm", "0"}, "limit-mm"},
        {{"follow", project, "--simulate", "ur-rtde"}, "ur-rtde"},
        {{"follow", project, "--bend-mm", "2"}, "--simulate"}};
    for (const auto& [arguments, part] : wrong_options) {
        const ProgramResult r = run(arguments);
        EXPECT_EQ(r.exit_code, 2);
        EXPECT_THAT(r.err, HasSubstr(part));
    }
}

// A hundred thousand arrays in one another: no reader may follow them to the bottom of its stack.
TEST_F(Cli, DeepJsonIsRefusedByEveryCommandThatReadsJson) {
    for (const auto& [open, close] : {std::pair{"[", "]"}, {"{\"a\":", "}"}}) {
        std::string text;
        for (int i = 0; i < 100000; ++i) text += open;
        text += "1";
        for (int i = 0; i < 100000; ++i) text += close;
        const std::string deep = write("deep.json", text);
        const std::string inside = write("inside.json", "{\"spots\":" + text + "}");
        const std::string new_file = (folder / "new.seam").string();
        std::vector<std::vector<std::string>> commands{{"correct", deep},
                                                       {"correct", inside},
                                                       {"plan", deep},
                                                       {"panel", deep},
                                                       {"sim-cell", deep},
                                                       {"import", new_file, "--from", deep},
                                                       {"import", new_file, "--from", inside}};
        for (const char* method : {"lens", "camera", "laser-plane", "lut", "tcp-sphere", "plate", "stereo",
                                   "bundle", "static", "hand-eye"})
            commands.push_back({"calibrate", method, deep});
        // Pose files beside the images, and the list of a recording.
        std::filesystem::create_directories(folder / "images");
        std::ofstream(folder / "images" / "1.json") << text;
        std::ofstream(folder / "images" / "1.csv") << "x_mm,z_mm\n0,1\n0.1,1\n0.2,1\n";
        commands.push_back({"import", new_file, "--from", (folder / "images").string()});
        for (const auto& command : commands) {
            const ProgramResult r = run(command);
            EXPECT_TRUE(r.exit_code == 2 || r.exit_code == 3)
                << command[0] << " " << command[1] << ": " << r.exit_code;
            EXPECT_THAT(r.err, HasSubstr("nested deeper than 64")) << command[0] << " " << command[1];
        }
        // On the command line and on standard input.
        const std::string short_deep = text.substr(0, 40000);
        expect_refused({"import", new_file, "--from", (folder / "images").string(), "--flange-from-sensor",
                        "{\"matrix\":" + short_deep},
                       "nested deeper than 64");
        const std::string part = write("part.txt", "part " + short_deep + "\nstop\n");
        const int status = std::system(("'" SEAMWRIGHT_PROGRAM "' sim-cell --camera '' <'" + part + "' >'" +
                                        (folder / "cell.txt").string() + "' 2>&1")
                                           .c_str());
        EXPECT_TRUE(WIFEXITED(status)) << "sim-cell ended by a signal";
    }
}

// What a person or a script makes of the simulated cell while it is served.
TEST_F(Cli, TheSimulatedCellObeysItsLines) {
    const std::string lines = write("lines.txt",
                                    R"(part {"displacement": {"xyz": [1, 2, 3], "abc": [0, 0, 0]}}
shift {"xyz": [0.5, 0, 0], "abc": [0, 0, 0]}
shift 7
camera off
camera on
camera sideways
type left
stop
)");
    const std::string out = (folder / "cell.txt").string();
    ASSERT_EQ(
        std::system(
            ("'" SEAMWRIGHT_PROGRAM "' sim-cell --camera free <'" + lines + "' >'" + out + "' 2>&1").c_str()),
        0)
        << slurp(out);
    std::vector<json> said;
    std::istringstream text(slurp(out));
    for (std::string line; std::getline(text, line);)
        if (line.starts_with("{")) said.push_back(json::parse(line));
    ASSERT_EQ(said.size(), 9u) << slurp(out);
    const auto place = [](const json& state) {
        const auto xyz = state["part"]["displacement"]["xyz"].get<std::vector<double>>();
        return Eigen::Vector3d(xyz[0], xyz[1], xyz[2]);
    };
    EXPECT_NEAR((place(said[1]) - Eigen::Vector3d(1, 2, 3)).norm(), 0, 1e-9);
    EXPECT_NEAR((place(said[2]) - Eigen::Vector3d(1, 2, 3)).norm(), 0.5, 1e-9)
        << "a robot that stands off sees the part off";
    EXPECT_EQ(said[2]["shift"]["xyz"][0], 0.5);
    EXPECT_EQ(said[3]["ok"], false);
    EXPECT_EQ(said[4]["camera"]["plugged"], false);
    EXPECT_EQ(said[5]["camera"]["plugged"], true);
    EXPECT_EQ(said[5]["camera"]["address"], said[0]["camera"]["address"]);
    EXPECT_THAT(said[6]["error"].get<std::string>(), HasSubstr("camera on, or camera off"));
    EXPECT_THAT(said[7]["error"].get<std::string>(), HasSubstr("has no part types"));
    EXPECT_EQ(said[8]["ok"], true);
}

TEST_F(Cli, ProjectFilesAreMadeToldAndChecked) {
    const std::string file = (folder / "door.seam").string();
    EXPECT_EQ(run({"new", file, "--name", "Door"}).exit_code, 0);
    expect_refused({"new", file}, "door.seam", run({"new", file}).exit_code);
    EXPECT_EQ(answer({"info", file}, 0)["name"], "Door");
    EXPECT_EQ(run({"info", write("text.seam", "no project")}).exit_code, 3);
    EXPECT_EQ(run({"info", (folder / "missing.seam").string()}).exit_code, 3);
    EXPECT_EQ(run({"check", write("empty.seam", "")}).exit_code, 3);
    const std::string exported = (folder / "door.json").string(), again = (folder / "again.seam").string();
    EXPECT_EQ(run({"export", file, "--out", exported}).exit_code, 0);
    EXPECT_EQ(run({"import", again, "--from", exported}).exit_code, 0);
    EXPECT_EQ(answer({"info", again}, 0)["name"], "Door");
}

TEST_F(Cli, EvaluateIsTheSameForASeedWhateverTheNumberOfJobs) {
    const std::vector<std::string> arguments{"evaluate", "--experiment", "2", "--seed", "3", "--jobs"};
    auto one = arguments, three = arguments;
    one.push_back("1");
    three.push_back("3");
    const json a = answer(one, 0);
    EXPECT_EQ(a, answer(three, 0));
    const json& e = a["experiments"][0];
    EXPECT_EQ(e["experiment"], 2);
    for (const char* column : {"translation", "rotation", "both"}) {
        EXPECT_GT(e["columns"][column]["three_sigma_mm"].get<double>(), 0.02);
        EXPECT_EQ(e["columns"][column]["refused"], 0);
    }
    EXPECT_EQ(run({"evaluate", "--experiment", "6"}).exit_code, 2);
}

TEST_F(Cli, DevicesListsTheDrivers) {
    const json a = answer({"devices"}, 0);
    std::vector<std::string> names;
    for (const char* list : {"sensor_drivers", "robot_drivers"})
        for (const json& driver : a[list]) names.push_back(driver["name"]);
    EXPECT_THAT(names, testing::IsSupersetOf({"simulated", "replay", "genicam", "kuka-eki", "kuka-kvp",
                                              "kuka-rsi", "abb-rapid"}));
    expect_refused({"robot-program", "none.seam", "--brand", "kuka", "--out", "krc"}, "none.seam", 3);
}

}  // namespace
}  // namespace seamwright
