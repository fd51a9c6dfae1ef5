// `panel --servo` on the simulated gripper: learnt, kept, served, told beside the single step, replayed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/app/cli_case.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

using ServoCommand = CliCase;

TEST_F(ServoCommand, LearnsKeepsAndServesBesideTheSingleStep) {
    const std::string file = (folder / "try.seam").string();
    const json a = answer(
        {"panel", file, "--simulated", "--seed", "3", "--servo", "--learn", "--push", "--part", "P7"}, 0);
    ASSERT_TRUE(a.contains("panel")) << a;
    EXPECT_EQ(a["status"], "ok");
    const json& servo = a["panel"]["servo"];
    EXPECT_THAT((std::vector<std::string>{"reached", "settled"}),
                testing::Contains(servo["status"].get<std::string>()));
    ASSERT_GE(servo["moves"].size(), 2u);
    EXPECT_LT(servo["moves"].back()["rms_mm"].get<double>(), servo["moves"].front()["rms_mm"].get<double>());
    EXPECT_LT(servo["single_step"]["apart_mm"].get<double>(), 0.5);
    EXPECT_EQ(servo["moves_made"].get<std::size_t>() + 1, servo["moves"].size());
    EXPECT_GT(servo["before_rms_mm"].get<double>(), servo["after_rms_mm"].get<double>());
    EXPECT_LT(servo["single_step"]["foreseen_rms_mm"].get<double>(), 0.3);
    EXPECT_EQ(a["panel"]["verdict"], "in_tolerance");
    // What was learnt is the project's: the next panel is served by it, dry, and nothing moves.
    const json b = answer({"panel", file, "--servo"}, 0);
    EXPECT_TRUE(b["panel"]["after"].empty());
    EXPECT_EQ(b["panel"]["gate_passed"], true);
    EXPECT_EQ(answer({"replay", file}, 0)["status"], "ok");
}

TEST_F(ServoCommand, SaysHowFarTheLearntSensitivityIsOffTheComputedOne) {
    const std::string file = (folder / "try.seam").string();
    const json a = answer({"panel", file, "--simulated", "--seed", "3", "--servo", "--learn"}, 0);
    // Sensors and calibrations are the simulation's: noise alone, 0.03 mm or so of a move of 1 mm, is between them.
    EXPECT_LT(a["beside_computed"]["off_share"].get<double>(), 0.1);
    EXPECT_LT(a["beside_computed"]["largest_mm"].get<double>(), 0.15);
    EXPECT_THAT(a["places"], testing::Contains(a["beside_computed"]["place"]));
}

TEST_F(ServoCommand, TakesAJobFromAnExportIntoAProject) {
    const std::string file = (folder / "try.seam").string(), out = (folder / "out.json").string();
    ASSERT_EQ(run({"panel", file, "--simulated", "--seed", "3"}).exit_code, 0);
    ASSERT_EQ(run({"export", file, "--out", out}).exit_code, 0);
    json job = json::parse(std::ifstream(out))["project"]["panel_jobs"][0];
    job["gap_tolerance_mm"] = 0.25;
    // In the place of the one of its name, as it is or in an export that holds it.
    EXPECT_EQ(answer({"panel", file, "--take", write("job.json", job.dump())}, 0)["status"], "taken");
    EXPECT_EQ(
        answer({"panel", file, "--set", "flush_tolerance_mm", "0.3"}, 0)["settings"]["gap_tolerance_mm"],
        0.25);
    EXPECT_EQ(answer({"panel", file, "--take", out}, 0)["job"], "panel");
    EXPECT_EQ(answer({"panel", file}, 0)["panel"]["gate_passed"], true);
    // Beside it, in a frame of its own; a frame that is another's is told before anything moves.
    job["id"] = "second";
    job["frame_name"] = "second";
    EXPECT_EQ(answer({"panel", file, "--take", write("second.json", job.dump())}, 0)["job"], "second");
    expect_refused({"panel", file}, "several panel jobs");

    job["robot_id"] = "R9";
    expect_refused({"panel", file, "--take", write("bad.json", job.dump())}, "R9");
    expect_refused({"panel", file, "--take", write("measures.json", R"({"spots":[]})")}, "measures");
    expect_refused({"panel", write("alone.json", job.dump())}, "--take");
    expect_refused({"panel", file, "--take", (folder / "none.json").string()}, "none.json", 3);
}

TEST_F(ServoCommand, RefusesInOneSentence) {
    const std::string file = (folder / "try.seam").string();
    ASSERT_EQ(run({"panel", file, "--simulated", "--seed", "3"}).exit_code, 0);
    expect_refused({"panel", file, "--servo"}, "its sensitivity is not learnt");
    expect_refused({"panel", file, "--servo", "--learn", "--step-mm", "50"}, "steps of 50 mm");
    EXPECT_EQ(run({"panel", file, "--learn"}).exit_code, 2);
    EXPECT_EQ(run({"panel", file, "--servo", "--gain", "7"}).exit_code, 2);
    expect_refused({"panel", file, "--servo", "--job", "nobody"}, "there is no panel job \"nobody\"");
}

}  // namespace
}  // namespace seamwright
