// `seamwright scan` as a script calls it: driven, kept, listed, written, removed.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "devices/exchange/cloud/cloud_file.h"
#include "projects/file/project_file.h"
#include "tests/app/run_program.h"

namespace seamwright {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

class ScanCommand : public testing::Test {
  protected:
    ScanCommand() : folder_(test_folder("scan_command")) {
        run_program({"gap", at("gap.seam"), "--simulated", "--nozzle-mm", "3"}, folder_);
    }
    ~ScanCommand() override { fs::remove_all(folder_); }
    std::string at(const std::string& name) const { return (folder_ / name).string(); }
    ProgramResult scan(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), {"scan", at("gap.seam")});
        return run_program(arguments, folder_);
    }
    fs::path folder_;
};

TEST_F(ScanCommand, DrivenAlongPosesItIsTheScanAlongTheSpotsAndIsKept) {
    const auto spots =
        scan({"--spots", "S1,S2", "--step-mm", "5", "--out", at("a.ply"), "--keep", "first", "--json", "-"});
    ASSERT_EQ(spots.exit_code, 0) << spots.err;
    const json first = json::parse(spots.out);
    EXPECT_GT(first["profiles"].get<int>(), 5);
    EXPECT_EQ(first["travel_sigma_mm"], 0.0);

    const auto project = ProjectFile::open(at("gap.seam"), FileAccess::read_only)->load();
    std::ofstream csv(at("poses.csv"));
    csv.precision(17);
    for (const std::size_t k : {0U, 1U}) {
        const Eigen::Matrix4d m = project->spots[k].base_from_flange.matrix();
        for (int i = 0; i < 16; ++i) csv << m(i / 4, i % 4) << (i < 15 ? "," : "\n");
    }
    csv.close();
    const auto path = scan({"--path", at("poses.csv"), "--pose-convention", "matrix", "--pose-unit", "mm",
                            "--step-mm", "5", "--keep", "second", "--json", "-"});
    ASSERT_EQ(path.exit_code, 0) << path.err;
    EXPECT_EQ(json::parse(path.out)["profiles"], first["profiles"]);

    const json list = json::parse(scan({"--list", "--json", "-"}).out);
    ASSERT_EQ(list["scans"].size(), 2U);
    EXPECT_EQ(list["scans"][0]["name"], "first");
    EXPECT_EQ(list["scans"][0]["points"], first["points"]);
    EXPECT_EQ(list["scans"][1]["robot"], "R1");

    ASSERT_EQ(scan({"--kept", "first", "--out", at("again.ply")}).exit_code, 0);
    EXPECT_EQ(slurp(at("again.ply")), slurp(at("a.ply")));

    ASSERT_EQ(scan({"--remove", "first"}).exit_code, 0);
    EXPECT_EQ(scan({"--kept", "first", "--out", at("never.ply")}).exit_code, 2);
    EXPECT_FALSE(fs::exists(at("never.ply")));
}

TEST_F(ScanCommand, FitTakesTheScanThatIsKeptByThisName) {
    ASSERT_EQ(scan({"--spots", "S1,S2", "--step-mm", "10", "--keep", "door"}).exit_code, 0);
    const auto fit = run_program(
        {"fit", at("gap.seam"), "--scan", "door", "--mesh", at("gap.ply"), "--json", "-"}, folder_);
    EXPECT_LE(fit.exit_code, 1) << fit.err;
    EXPECT_EQ(json::parse(fit.out)["scan"], "door");
    EXPECT_EQ(
        run_program({"fit", at("gap.seam"), "--scan", "none", "--mesh", at("gap.ply")}, folder_).exit_code,
        3);
}

TEST_F(ScanCommand, WhatIsRefusedIsOneSentenceBeforeTheRobotMovesAndNothingIsKept) {
    ASSERT_EQ(scan({"--spots", "S1,S2", "--step-mm", "20", "--keep", "taken"}).exit_code, 0);
    std::ofstream(at("bad.csv")) << "x_mm,y_mm,z_mm,a,b,c\n1,2,nan,0,0,0\n";
    std::ofstream(at("one.csv")) << "x_mm,y_mm,z_mm,a,b,c\n900,200,700,0,0,0\n";
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"--spots", "S1,S2", "--keep", "taken"},
          {"--spots", "S1,S2"},
          {"--keep", "x"},
          {"--path", at("bad.csv"), "--keep", "x"},
          {"--path", at("one.csv"), "--keep", "x"},
          {"--spots", "S1,nobody", "--keep", "x"},
          {"--spots", "S1,S2", "--keep", std::string(65, 'n')},
          {"--kept", "taken"},
          {"--remove", "nobody"}}) {
        const ProgramResult result = scan(arguments);
        EXPECT_EQ(result.exit_code, 2) << arguments.front() << " " << result.err;
    }
    EXPECT_EQ(json::parse(scan({"--list", "--json", "-"}).out)["scans"].size(), 1U);
}

// Nobody moves the simulated robot meanwhile.
TEST_F(ScanCommand, FollowingARobotThatStandsKeepsNothing) {
    const auto follow = scan({"--follow", "--most-s", "0.5", "--keep", "x"});
    EXPECT_EQ(follow.exit_code, 3) << follow.err;
    EXPECT_EQ(json::parse(scan({"--list", "--json", "-"}).out)["scans"].size(), 0U);
}

}  // namespace
}  // namespace seamwright
