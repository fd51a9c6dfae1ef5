#include <gmock/gmock.h>

#include <functional>

#include "projects/calibrate/input/pose_lists.h"
#include "tests/projects/calibrate/convention_cell.h"

namespace seamwright {
namespace {

using namespace elsewhere;
using ::testing::HasSubstr;

TEST(ConventionDetective, GoodDataAreAsGivenAtOnce) {
    const auto of_sphere = asked("tcp-sphere", sphere(1, kAsTheHouse, 12, 0.01, 0));
    EXPECT_EQ(of_sphere.result["verdict"], "as_given") << of_sphere.result;
    EXPECT_EQ(of_sphere.result["tried"], 1);
    EXPECT_TRUE(of_sphere.result["offer"].is_null());
    const auto of_pairs = asked("hand-eye", hand_eye(2, kAsTheHouse, kAsTheHouse));
    EXPECT_EQ(of_pairs.result["verdict"], "as_given") << of_pairs.result;
}

TEST(ConventionDetective, NamesAMatrixByColumns) {
    const json data = sphere(6, [](const Pose& p) { return matrix(p, true, true); });
    EXPECT_FALSE(solve_calibration(*find_method("tcp-sphere"), data, {}));
    const auto answer = asked("tcp-sphere", data);
    ASSERT_EQ(answer.result["verdict"], "named") << answer.result;
    EXPECT_EQ(answer.offer["base_from_flange"], "matrix,mm,transposed");
}

TEST(ConventionDetective, ShuffledPosesEndHonestly) {
    json shuffled = hand_eye(16, kAsTheHouse, kAsTheHouse);
    for (std::size_t i = 0; i + 1 < shuffled["pairs"].size(); ++i)
        std::swap(shuffled["pairs"][i]["base_from_flange"], shuffled["pairs"][i + 1]["base_from_flange"]);
    EXPECT_EQ(asked("hand-eye", shuffled).result["verdict"], "cannot_tell");
}

TEST(ConventionDetective, NamesTheListOfAHandEyeThatIsWrittenOtherwise) {
    const Writing w{"xyz", false};
    const auto robot = asked("hand-eye", hand_eye(8, as(w), kAsTheHouse));
    ASSERT_EQ(robot.result["verdict"], "named") << robot.result;
    EXPECT_EQ(robot.codes, std::vector<std::string>{"base_from_flange=" + w.code()});
    const auto camera = asked("hand-eye", hand_eye(9, kAsTheHouse, as(w)));
    ASSERT_EQ(camera.result["verdict"], "named") << camera.result;
    EXPECT_EQ(camera.codes, std::vector<std::string>{"camera_from_target=" + w.code()});
    const auto both = asked("hand-eye", hand_eye(10, as(w), as(w)));
    ASSERT_EQ(both.result["verdict"], "named") << both.result;
    EXPECT_EQ(both.codes.size(), 2u);
}

// A^-1 X C^-1 = Y is the same statement whichever of the lists is inverted.
TEST(ConventionDetective, WhichListOfAHandEyeIsInvertedCannotBeTold) {
    Writing w;
    w.inverse = true;
    const auto answer = asked("hand-eye", hand_eye(11, as(w), kAsTheHouse));
    ASSERT_EQ(answer.result["verdict"], "cannot_tell") << answer.result;
    EXPECT_THAT(answer.result["sentence"].get<std::string>(), HasSubstr("base_from_flange read as"));
    EXPECT_THAT(answer.result["sentence"].get<std::string>(), HasSubstr("camera_from_target read as"));
}

TEST(ConventionDetective, HostileDataAreRefused) {
    const auto refused = [](const char* method, const json& data) {
        const auto answer = detect_pose_convention(*find_method(method), data, {});
        EXPECT_FALSE(answer) << data.dump().substr(0, 200);
        return answer ? std::string() : answer.error().sentence();
    };
    json data = sphere(20, kAsTheHouse);
    EXPECT_THAT(refused("lens", {{"lines", json::array()}}), HasSubstr("no residual"));
    EXPECT_THAT(refused("static", json::object()), HasSubstr("no residual"));
    EXPECT_FALSE(refused("tcp-sphere", json::array()).empty());
    EXPECT_FALSE(refused("tcp-sphere", {{"radius_mm", 10}, {"observations", json::array()}}).empty());
    json bad = data;
    bad["observations"][3]["base_from_flange"] = 5;
    EXPECT_THAT(refused("tcp-sphere", bad), HasSubstr("observations[3]"));
    bad = data;
    bad["observations"][3]["base_from_flange"]["abc"] = {"a", 1, 2};
    EXPECT_THAT(refused("tcp-sphere", bad), HasSubstr("observations[3]"));
    bad = data;
    bad["observations"][3]["base_from_flange"] = quaternion(Pose::Identity(), true, false);
    EXPECT_THAT(refused("tcp-sphere", bad), HasSubstr("several forms"));
    bad = data;
    bad["observations"][2]["profile"] = "x";
    EXPECT_THAT(refused("tcp-sphere", bad), HasSubstr("profile"));
    for (const json& said : {json("sideways"), json(7), json{{"flange", "zyz"}},
                             json{{"base_from_flange", 3}}, json("quat-wxyz")}) {
        bad = data;
        bad["pose_convention"] = said;
        EXPECT_THAT(refused("tcp-sphere", bad), HasSubstr("pose_convention")) << said;
        EXPECT_FALSE(solve_calibration(*find_method("tcp-sphere"), bad, {})) << said;
    }
}

}  // namespace
}  // namespace seamwright
