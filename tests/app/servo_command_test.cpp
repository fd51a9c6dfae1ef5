// `panel --servo` on the simulated gripper: learnt, kept, served, told beside the single step, replayed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

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
