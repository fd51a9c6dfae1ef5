// JSON poses of other hands: units, angles, tool and frame act on them as on a table.
#include "devices/exchange/tables/json_poses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/geometry/notation.h"
#include "devices/exchange/pose_json.h"
#include "tests/devices/temporary_folder.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

const std::string kMetres = R"({"xyz":[0.8,-0.05,0.6],"abc":[90,0,0]})";
const std::string kRadian = R"({"xyz":[800,-50,600],"abc":[1.5707963267948966,0,0]})";
const Pose kMeant = make_pose(rotation_from_kuka({90, 0, 0}), {800, -50, 600});

void expect_pose(const std::string& text, const PoseLayout& layout) {
    const auto table = parse_pose_table("[" + text + "]", "poses.json", layout);
    ASSERT_TRUE(table) << table.error().sentence();
    EXPECT_TRUE(table->poses.front().pose.isApprox(kMeant, 1e-9)) << text;
}
void expect_refused(const std::string& text, const PoseLayout& layout, const std::string& words) {
    const auto table = parse_pose_table("[" + text + "]", "poses.json", layout);
    ASSERT_FALSE(table) << text;
    EXPECT_THAT(table.error().sentence(), HasSubstr(words));
}

TEST(JsonPoses, UnitsAreAskedForAndAct) {
    expect_refused(kMetres, {}, "--pose-unit");
    expect_refused(kRadian, {}, "--pose-angle");
    expect_pose(kMetres, {"", "m", "", {}, {}});
    // A few degrees are no radian.
    EXPECT_TRUE(parse_json_poses(R"([{"xyz":[800,-50,600],"abc":[0.5,-3,1.2]}])", "poses", {}));
    EXPECT_TRUE(parse_json_poses(R"([{"xyz":[800,-50,600],"abc":[0,0,3]}])", "poses", {}));
    expect_pose(kRadian, {"kuka-abc", "mm", "rad", {}, {}});
    // What the program itself writes is not asked, wherever it stands.
    const Pose near = make_pose(rotation_from_kuka({1, 2, 3}), {4, 5, 6});
    const auto own = parse_pose_table("[" + pose_json(near).dump() + "]", "p", {});
    ASSERT_TRUE(own) << own.error().sentence();
    EXPECT_TRUE(own->poses.front().pose.isApprox(near, 1e-12));
}

TEST(JsonPoses, WhatTheirKeysSayAnOptionCannotChange) {
    expect_refused(kMetres, {"fanuc-wpr", "m", "", {}, {}}, "--pose-convention fanuc-wpr cannot act");
    expect_refused(R"({"xyz":[800,0,0],"quat_wxyz":[1,0,0,0]})", {"", "", "rad", {}, {}},
                   "--pose-angle cannot act");
    expect_refused(R"({"xyz":[800,0,0],"rotvec_rad":[1,0,0]})", {"", "", "deg", {}, {}},
                   "--pose-angle deg cannot act");
    const auto program = parse_pose_table("DEFDAT D\nDECL E6POS XP1={X 800,Y 0,Z 600,A 90,B 0,C 0}\nENDDAT\n",
                                          "d.dat", {"", "m", "", {}, {}});
    ASSERT_FALSE(program);
    EXPECT_THAT(program.error().sentence(), HasSubstr("--pose-unit m cannot act"));
}

TEST(JsonPoses, FilesBesideFramesAreJudgedTogetherAndBroughtToTheFlange) {
    const TemporaryFolder folder;
    const auto file = [&](const std::string& name, const std::string& text) {
        std::ofstream(folder.path() / name) << text;
        return folder.path() / name;
    };
    const std::vector<std::filesystem::path> files{
        file("S1.json", kMetres), file("S2.json", R"({"xyz":[0.9,0,0.7],"quat_wxyz":[1,0,0,0]})")};
    const auto asked = read_frame_poses(files, {});
    ASSERT_FALSE(asked);
    EXPECT_THAT(asked.error().sentence(), HasSubstr("--pose-unit"));
    PoseLayout layout{"", "m", "", make_pose(Eigen::Matrix3d::Identity(), {0, 0, 100}),
                      make_pose(Eigen::Matrix3d::Identity(), {1000, 0, 0})};
    const auto poses = read_frame_poses(files, layout);
    ASSERT_TRUE(poses) << poses.error().sentence();
    EXPECT_NEAR((*poses)[0].translation().x(), 1800, 1e-9);
    EXPECT_NEAR((*poses)[0].translation().z(), 500, 1e-9);
    EXPECT_NEAR((*poses)[1].translation().z(), 600, 1e-9);
    // An angle of few degrees shows as degrees by the other spots'.
    const std::vector<std::filesystem::path> degrees{
        file("A1.json", R"({"xyz":[800,0,600],"abc":[2,0,0]})"),
        file("A2.json", R"({"xyz":[800,0,600],"abc":[90,0,0]})")};
    EXPECT_TRUE(read_frame_poses(degrees, {}));
    const std::vector<std::filesystem::path> called{
        file("B.json", R"({"base_from_flange":{"xyz":[800,0,600],"abc":[90,0,0]}})")};
    layout.unit.clear();
    const auto named = read_frame_poses(called, layout);
    ASSERT_FALSE(named);
    EXPECT_THAT(named.error().sentence(), HasSubstr("--flange-from-tool cannot act"));
    EXPECT_TRUE(read_frame_poses(called, {}));
}

TEST(JsonPoses, PosesAsRobotsPrintThem) {
    const PoseLayout none;
    for (const std::string text :
         {"p[0.8, -0.05, 0.6, 0, 0, 1.5707963267948966]\n", "{X 800,Y -50,Z 600,A 90,B 0,C 0,S 2,T 35}\n",
          "# stamp tx ty tz qx qy qz qw\n1710000000.1 0.8 -0.05 0.6 0 0 0.70710678118 0.70710678118\n",
          "x,y,z,qx,qy,qz,qw\n800,-50,600,0,0,0.70710678118,0.70710678118\n"}) {
        PoseLayout layout = none;
        if (text.front() == '#') layout.unit = "m";
        if (text.front() == 'x') layout.convention = "quat-xyzw";
        const auto table = parse_pose_table(text, "poses.txt", layout);
        ASSERT_TRUE(table) << table.error().sentence() << text;
        EXPECT_TRUE(table->poses.front().pose.isApprox(kMeant, 1e-6)) << text;
    }
    const auto mixed = parse_pose_table("p[0.8,0,0.6,0,0,1]\n{X 800,Y -50,Z 600,A 90,B 0,C 0}\n", "p", none);
    EXPECT_FALSE(mixed);
}

}  // namespace
}  // namespace seamwright
