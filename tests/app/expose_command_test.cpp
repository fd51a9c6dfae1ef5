// `seamwright expose` and `run --paint`: the contract from the outside.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "projects/file/project_file.h"
#include "tests/app/run_program.h"
#include "tests/projects/door_project.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class ExposeCommand : public testing::Test {
  protected:
    std::filesystem::path folder = test_folder("expose"), file = folder / "door.seam";

    void SetUp() override {
        json settings = cell_settings(Pose::Identity());
        settings["optics"] = {{"width", 640}, {"height", 512}};
        settings["exposure_us"] = 20000;  // far too much
        const auto cell = *SimulatedCell::open(settings);
        Project p = door_project(*cell, settings);
        p.spots.resize(3);
        p.regions[0].spot_ids.resize(3);
        ASSERT_TRUE(ProjectFile::create(file, p));
    }
    ~ExposeCommand() override { std::filesystem::remove_all(folder); }
    json ok(std::vector<std::string> arguments, int exit_code = 0) const {
        arguments.insert(arguments.end(), {"--json", "-"});
        const ProgramResult r = run_program(arguments, folder);
        EXPECT_EQ(r.exit_code, exit_code) << r.err << r.out;
        return json::parse(r.out, nullptr, false);
    }
    void refused(std::vector<std::string> arguments, const std::string& part, int exit_code = 2) const {
        const std::string before = slurp(file);
        const ProgramResult r = run_program(arguments, folder);
        EXPECT_EQ(r.exit_code, exit_code) << r.err;
        EXPECT_THAT(r.err, HasSubstr(part));
        EXPECT_EQ(slurp(file), before) << "nothing is half written";
    }
};

TEST_F(ExposeCommand, FindsKeepsSetsAndClears) {
    const std::string f = file.string();
    const json found = ok({"expose", f, "--all", "--find", "--keep"});
    ASSERT_EQ(found["spots"].size(), 3u);
    for (const json& spot : found["spots"]) {
        EXPECT_EQ(spot["verdict"], "fit");
        EXPECT_LT(spot["settings"]["exposure_us"], 5000);
        EXPECT_LE(spot["tried"].size(), 6u);
        EXPECT_EQ(spot["tried"][0]["verdict"], "too bright");
    }
    json list = ok({"expose", f});
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(list["spots"][k]["settings"], found["spots"][k]["settings"]);

    const std::string id = list["spots"][1]["id"];
    ok({"expose", f, "--spots", id, "--set", "exposure_us=812.5", "--set", "gain_db=2"});
    ok({"expose", f, "--spots", id, "--set", "exposure_us=300", "--paint", "white"});
    list = ok({"expose", f, "--all", "--follow", "100..9000"});
    EXPECT_EQ(list["spots"][1]["settings"], (json{{"exposure_us", 812.5}, {"gain_db", 2.0}}));
    EXPECT_EQ(list["spots"][1]["paints"]["white"]["exposure_us"], 300);
    EXPECT_EQ(list["spots"][0]["follow_us"], (json{100.0, 9000.0}));
    list = ok({"expose", f, "--all", "--fixed"});
    EXPECT_TRUE(list["spots"][0]["follow_us"].is_null());

    // The run measures with them, says so, and goes on without what no spot knows.
    const json white = ok({"run", f, "--paint", "white"}, 1);
    EXPECT_EQ(white["spots"][1]["light"]["settings"]["exposure_us"], 300);
    EXPECT_EQ(ok({"run", f}, 1)["spots"][1]["light"]["settings"]["exposure_us"], 812.5);
    EXPECT_THAT(ok({"run", f, "--paint", "41"}, 1)["events"].dump(), HasSubstr("no spot knows"));

    list = ok({"expose", f, "--all", "--clear"});
    EXPECT_TRUE(list["spots"][1]["settings"].empty());
    EXPECT_TRUE(list["spots"][1]["paints"].empty());
}

TEST_F(ExposeCommand, WhatNoRunCouldFollowIsOneSentenceAndChangesNothing) {
    const std::string f = file.string();
    refused({"expose", f, "--set", "exposure_us=800"}, "no spot is named");
    refused({"expose", f, "--spots", "nobody", "--set", "exposure_us=800"}, "there is no spot");
    refused({"expose", f, "--all", "--set", "exposure_us"}, "sets nothing");
    refused({"expose", f, "--all", "--set", "exposure_us=fast"}, "is no number");
    refused({"expose", f, "--all", "--set", "exposure_us=nan"}, "is no number");
    refused({"expose", f, "--all", "--set", "region_width=300"}, "calibration");
    refused({"expose", f, "--all", "--merge", "100,900"}, "stop at the trigger");
    refused({"expose", f, "--all", "--follow", "100"}, "is no range");
    refused({"expose", f, "--all", "--follow", "900..100"}, "follow the paint");
    refused({"expose", f, "--all", "--find", "--set", "gain_db=1"}, "two things");
    refused({"expose", f, "--keep"}, "nothing to keep");
    refused({"expose", (folder / "none.seam").string()}, "none.seam", 3);
    // What the device alone knows is refused by the run, before the robot moves.
    ok({"expose", f, "--all", "--set", "gain_db=300"});
    const ProgramResult r = run_program({"run", f}, folder);
    EXPECT_EQ(r.exit_code, 3);
    EXPECT_THAT(r.err + r.out, HasSubstr("gain_db"));
}

}  // namespace
}  // namespace seamwright
