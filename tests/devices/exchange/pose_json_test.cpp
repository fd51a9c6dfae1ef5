#include "devices/exchange/pose_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/notation.h"
#include "devices/exchange/json_fields.h"
#include "tests/core/geometry/rotations.h"
#include "tests/devices/real_data.h"

namespace seamwright {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

std::string pose_error(const std::string& text) {
    const auto parsed = parse_json(text, "job.json");
    if (!parsed) return parsed.error().sentence();
    const auto pose = parse_pose(*parsed, "spots[3].workobject_from_sensor");
    return pose ? "accepted" : pose.error().sentence();
}

TEST(PoseJson, AllFormsMeanTheSamePose) {
    for (const auto& w : testing_rotation_vectors()) {
        const Pose pose = make_pose(rotation_exp(w), {1.5, -2000, 3e4});
        const auto abc = kuka_from_rotation(pose.linear());
        const auto q = abb_from_rotation(pose.linear());
        const auto r = ur_from_rotation(pose.linear());
        const json xyz = {1.5, -2000, 3e4};
        json flat = json::array();
        for (int i = 0; i < 16; ++i) flat.push_back(pose.matrix()(i / 4, i % 4));
        const json written = pose_json(pose);
        const json forms[] = {{{"xyz", xyz}, {"abc", {abc.a_deg, abc.b_deg, abc.c_deg}}},
                              {{"xyz", xyz}, {"quat_wxyz", {q.w, q.x, q.y, q.z}}},
                              {{"xyz", xyz}, {"rotvec_rad", {r.x(), r.y(), r.z()}}},
                              {{"matrix", flat}},
                              {{"matrix", written["matrix"]}},
                              written,
                              json::parse(written.dump())};
        for (const json& form : forms) {
            const auto back = parse_pose(form, "p");
            ASSERT_TRUE(back) << back.error().sentence() << form;
            EXPECT_LT(distance_mm(*back, pose), 1e-9);
            EXPECT_LT(angle_rad(*back, pose), 2e-8) << form;
        }
    }
}

TEST(PoseJson, RefusesEverythingElseWithItsPath) {
    EXPECT_THAT(pose_error("[]"), HasSubstr("spots[3].workobject_from_sensor: must be an object"));
    EXPECT_THAT(pose_error("{}"), HasSubstr("no translation"));
    EXPECT_THAT(pose_error(R"({"xyz":[1,2,3]})"), HasSubstr("no rotation"));
    EXPECT_THAT(pose_error(R"({"abc":[1,2,3]})"), HasSubstr("no translation"));
    EXPECT_THAT(pose_error(R"({"xyz":[1,2],"abc":[0,0,0]})"),
                HasSubstr("sensor.xyz: has 2 entries instead of 3"));
    EXPECT_THAT(pose_error(R"({"xyz":[1,2,"3"],"abc":[0,0,0]})"), HasSubstr("xyz[2]: must be a number"));
    EXPECT_THAT(pose_error(R"({"xyz":[1,2,null],"abc":[0,0,0]})"), HasSubstr("xyz[2]"));
    EXPECT_THAT(pose_error(R"({"xyz":[1,2,true],"abc":[0,0,0]})"), HasSubstr("xyz[2]"));
    EXPECT_THAT(pose_error(R"({"xyz":[1,2,NaN],"abc":[0,0,0]})"), HasSubstr("no JSON"));
    EXPECT_THAT(pose_error(R"({"xyz":[1,2,1e999],"abc":[0,0,0]})"), HasSubstr("job.json"));
    EXPECT_THAT(pose_error(R"({"xyz":[1,2,3e6],"abc":[0,0,0]})"), HasSubstr("100 m"));
    EXPECT_THAT(pose_error(R"({"xyz":[1,2,3],"abc":[0,9000,0]})"), HasSubstr("degrees"));
    EXPECT_THAT(pose_error(R"({"xyz":[1,2,3],"abc":[0,0,0],"quat_wxyz":[1,0,0,0]})"), HasSubstr("mixes"));
    EXPECT_THAT(pose_error(R"({"xyz":[1,2,3],"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]})"),
                HasSubstr("mixes"));
    EXPECT_THAT(pose_error(R"({"xyz":[1,2,3],"abc":[0,0,0],"name":"a"})"),
                HasSubstr("sensor.name: is not a known"));
    EXPECT_THAT(pose_error(R"({"xyz":[1,2,3],"xyz":[1,2,3],"abc":[0,0,0]})"), HasSubstr("twice"));
    EXPECT_THAT(pose_error(R"({"xyz":[0,0,0],"quat_wxyz":[1,1,0,0]})"), HasSubstr("quat_wxyz"));
    EXPECT_THAT(pose_error(R"({"xyz":[0,0,0],"quat_wxyz":[0,0,0,0]})"), HasSubstr("quat_wxyz"));
    EXPECT_THAT(pose_error(R"({"xyz":[0,0,0],"rotvec_rad":[0,0,90]})"), HasSubstr("radian"));
    EXPECT_THAT(pose_error(R"({"matrix":[1,0,0]})"), HasSubstr("matrix: has 3 entries instead of 16"));
    EXPECT_THAT(pose_error(R"({"matrix":[[1,0,0,0],[0,1,0,0],[0,0,1,0]]})"), HasSubstr("3 rows"));
    EXPECT_THAT(pose_error(R"({"matrix":[[1,0,0,0],[0,1,0],[0,0,1,0],[0,0,0,1]]})"), HasSubstr("matrix[1]"));
    EXPECT_THAT(pose_error(R"({"matrix":[[2,0,0,0],[0,2,0,0],[0,0,2,0],[0,0,0,1]]})"), HasSubstr("matrix"));
    EXPECT_THAT(pose_error(R"({"matrix":[[-1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]})"), HasSubstr("matrix"));
    EXPECT_THAT(pose_error(R"({"matrix":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[5,6,7,1]]})"), HasSubstr("matrix"));
    json contradicting = pose_json(make_pose(rotation_exp({0.1, 0.2, 0.3}), {1, 2, 3}));
    contradicting["xyz"][0] = 1.01;
    EXPECT_THAT(pose_error(contradicting.dump()), HasSubstr("contradict"));
}

TEST(PoseJson, HostileJsonEndsInASentence) {
    EXPECT_THAT(pose_error(""), HasSubstr("empty"));
    EXPECT_THAT(pose_error(std::string(100000, '[')), HasSubstr("job.json"));
    EXPECT_THAT(pose_error(std::string(70, '[') + std::string(70, ']')), HasSubstr("deeper"));
    std::string objects;
    for (int i = 0; i < 200; ++i) objects += R"({"a":)";
    EXPECT_THAT(pose_error(objects + "1" + std::string(200, '}')), HasSubstr("deeper"));
    EXPECT_THAT(pose_error("{\"xyz\":[1,2,3],// comment\n\"abc\":[0,0,0]}"), HasSubstr("no JSON"));
    EXPECT_THAT(pose_error("{\"\xFF\":1}"), HasSubstr("no JSON"));
    EXPECT_THAT(pose_error("{\"xyz\":[1,2,3]"), HasSubstr("no JSON"));
}

TEST(PoseFile, TupleAndYamlAreMetres) {
    const auto tuple = parse_tuple_pose("((1.5, -0.25, 2), (0, 0, 0.70710678118, 0.70710678118))", "p");
    ASSERT_TRUE(tuple) << tuple.error().sentence();
    EXPECT_LT((tuple->translation() - Eigen::Vector3d(1500, -250, 2000)).norm(), 1e-9);
    EXPECT_LT((tuple->linear() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-9);
    const auto blanks = parse_tuple_pose("((1.5 -0.25 2) , (0 0 0.70710678118 0.70710678118))\n", "p");
    ASSERT_TRUE(blanks);
    EXPECT_TRUE(blanks->isApprox(*tuple));
    const auto yaml = parse_yaml_pose(
        "---\nx: 1.5 # metre\r\ny: -0.25\nz: 2\nqx: 0\nqy: 0\nqz: 0.70710678118\nqw: 0.70710678118\n", "p");
    ASSERT_TRUE(yaml) << yaml.error().sentence();
    EXPECT_TRUE(yaml->isApprox(*tuple));
}

TEST(PoseFile, RefusesBrokenFiles) {
    const auto tuple = [](const char* text) {
        const auto p = parse_tuple_pose(text, "pose0001.txt");
        return p ? "accepted" : p.error().sentence();
    };
    EXPECT_THAT(tuple(""), HasSubstr("0 numbers"));
    EXPECT_THAT(tuple("((1, 2, 3), (0, 0, 0))"), HasSubstr("6 numbers"));
    EXPECT_THAT(tuple("((1, 2, 3), (0, 0, 0, 1)) 5"), HasSubstr("more than 7"));
    EXPECT_THAT(tuple("((1, 2, x), (0, 0, 0, 1))"), HasSubstr("no number"));
    EXPECT_THAT(tuple("((1, 2, nan), (0, 0, 0, 1))"), HasSubstr("finite"));
    EXPECT_THAT(tuple("((1, 2, 3), (0, 0, 0, 2))"), HasSubstr("pose0001.txt"));
    EXPECT_THAT(tuple("((1564.5, 99.0, 1329.2), (0, 0, 0, 1))"), HasSubstr("metres"));
    const auto yaml = [](const char* text) {
        const auto p = parse_yaml_pose(text, "0.yaml");
        return p ? "accepted" : p.error().sentence();
    };
    EXPECT_THAT(yaml(""), HasSubstr("x is missing"));
    EXPECT_THAT(yaml("x: 1\nx: 2\n"), HasSubstr("twice"));
    EXPECT_THAT(yaml("x: 1\nroll: 2\n"), HasSubstr("line 2"));
    EXPECT_THAT(yaml("x: \n"), HasSubstr("no number"));
    EXPECT_THAT(yaml("[1, 2, 3]\n"), HasSubstr("key: number"));
}

TEST(PoseFile, RealPosesRead) {
    const auto data = real_data();
    if (data.empty()) GTEST_SKIP() << "skipped: no real data";
    int count = 0;
    for (const auto& folder : {data / "etna", data / "robot_cal_tools/test_set_10x10/poses"}) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
            const auto name = entry.path().filename().string();
            if (entry.path().extension() != ".txt" && entry.path().parent_path().filename() != "poses")
                continue;
            const auto pose = read_pose_file(entry.path());
            ASSERT_TRUE(pose) << pose.error().sentence();
            EXPECT_GT(pose->translation().norm(), 300) << name;  // millimetres
            EXPECT_LT(pose->translation().norm(), 4000) << name;
            ++count;
        }
    }
    EXPECT_GE(count, 39);
}

TEST(Json, Utf16IsNamedAndNoByteOfAFileBreaksTheSentence) {
    for (const std::string& text :
         {std::string("\xFF\xFE{\0}\0", 6), std::string("\xFE\xFF\0{\0}", 6), std::string("{\0}\0", 4)}) {
        const auto parsed = parse_json(text, "job.json");
        ASSERT_FALSE(parsed);
        EXPECT_THAT(parsed.error().sentence(), HasSubstr("UTF-16"));
    }
    const auto parsed = parse_json("{\"a\": \xFF\xFF}", "job.json");
    ASSERT_FALSE(parsed);
    EXPECT_EQ(parsed.error().sentence().find('\xFF'), std::string::npos);
}

}  // namespace
}  // namespace seamwright
