#include <gmock/gmock.h>

#include <functional>

#include "projects/calibrate/pose_lists.h"
#include "tests/projects/calibrate/convention_cell.h"

namespace seamwright {
namespace {

using namespace elsewhere;
using simulation::any_cell;
using simulation::any_hand_eye_cell;
using simulation::HandEyeCell;
using simulation::Random;
using simulation::SphereCell;
using ::testing::HasSubstr;
using WriteOne = std::function<json(const Pose&)>;

const WriteOne kAsTheHouse = [](const Pose& p) { return misread(p, {}); };
WriteOne as(const Writing& writing) {
    return [writing](const Pose& p) { return misread(p, writing); };
}

json sphere(unsigned seed, const WriteOne& written, int poses = 9, double noise_mm = 0.03,
            double robot_mm = 0.05) {
    Random random(seed);
    SphereCell cell = any_cell(random);
    cell.noise_mm = noise_mm;
    cell.robot_mm = robot_mm;
    cell.robot_deg = robot_mm / 10;
    return sphere_data(cell, simulation::sphere_observations(cell, poses, random), written);
}

json hand_eye(unsigned seed, const WriteOne& robot, const WriteOne& camera) {
    Random random(seed);
    const HandEyeCell cell = any_hand_eye_cell(random);
    return hand_eye_data(cell.mount, simulation::hand_eye_pairs(cell, 10, random), robot, camera);
}

TEST(ConventionDetective, GoodDataAreAsGivenAtOnce) {
    const auto of_sphere = asked("tcp-sphere", sphere(1, kAsTheHouse, 12, 0.01, 0));
    EXPECT_EQ(of_sphere.result["verdict"], "as_given") << of_sphere.result;
    EXPECT_EQ(of_sphere.result["tried"], 1);
    EXPECT_TRUE(of_sphere.result["offer"].is_null());
    const auto of_pairs = asked("hand-eye", hand_eye(2, kAsTheHouse, kAsTheHouse));
    EXPECT_EQ(of_pairs.result["verdict"], "as_given") << of_pairs.result;
}

TEST(ConventionDetective, NamesWhatTheSphereWasWrittenIn) {
    for (const Writing& w : {Writing{"xyz", true}, Writing{"zyx", false, false, false, 1000}}) {
        const auto answer = asked("tcp-sphere", sphere(5, as(w)));
        ASSERT_EQ(answer.result["verdict"], "named") << w.code() << answer.result;
        EXPECT_EQ(answer.offer["base_from_flange"], w.code());
        EXPECT_LT(answer.result["best"]["residual_mm"], 0.5);
        // Taken by saying it: the calibration is then good, and the file's numbers are what they were.
        json data = sphere(5, as(w));
        data["pose_convention"] = answer.offer;
        const auto solved = calibrate_tcp_sphere_json(data, {});
        ASSERT_TRUE(solved) << solved.error().sentence();
        EXPECT_EQ(solved->result["status"], "ok") << solved->result["reason"];
        EXPECT_EQ(solved->result["pose_convention"], answer.offer);
        EXPECT_EQ(asked("tcp-sphere", data).result["verdict"], "as_given");
    }
}

TEST(ConventionDetective, NamesQuaternionsAndMatrices) {
    const auto name = [](const WriteOne& written) {
        const auto answer = asked("tcp-sphere", sphere(6, written));
        return answer.result["verdict"] == "named" ? answer.offer["base_from_flange"].get<std::string>()
                                                   : answer.result.dump();
    };
    EXPECT_EQ(name([](const Pose& p) { return quaternion(p, false, false); }), "quat-xyzw,mm");
    EXPECT_EQ(name([](const Pose& p) { return quaternion(p.inverse(), false, false); }),
              "quat-xyzw,mm,inverse");
    EXPECT_EQ(name([](const Pose& p) { return matrix(p, true, true); }), "matrix,mm,transposed");
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

// One angle alone: the turns about the axis read alike in half of the conventions.
TEST(ConventionDetective, OneAxisCannotBeToldAndNamesBoth) {
    Random random(12);
    SphereCell cell = any_cell(random);
    cell.tilt_deg = 0;
    auto observations = simulation::sphere_observations(cell, 12, random);
    std::vector<Writing> equal;
    for (const bool fixed : {false, true})
        for (const auto& axes : orders())
            if (axes.find('z') == 2 && axes[0] != axes[2]) equal.push_back({axes, fixed});
    // Flange poses that turn about z alone, written in an order that ends in z, read in one that begins with it.
    for (auto& o : observations) {
        Pose p = o.base_from_flange;
        const double turn = rotation_log(p.linear()).z();
        o.base_from_flange = make_pose(elsewhere::turn('z', turn), p.translation());
    }
    const auto answer = asked("tcp-sphere", sphere_data(cell, observations, as(equal.front())));
    EXPECT_EQ(answer.result["verdict"], "cannot_tell") << answer.result;
}

TEST(ConventionDetective, NoiseWrongRadiusAndShuffledPosesEndHonestly) {
    Random random(13);
    const WriteOne noise = [&](const Pose&) {
        return json{
            {"xyz", {simulation::uniform(random, -900, 900), simulation::uniform(random, -900, 900), 700}},
            {"abc",
             {simulation::uniform(random, -180, 180), simulation::uniform(random, -90, 90),
              simulation::uniform(random, -180, 180)}}};
    };
    const auto of_noise = asked("tcp-sphere", sphere(14, noise));
    EXPECT_EQ(of_noise.result["verdict"], "cannot_tell") << of_noise.result;
    EXPECT_GT(of_noise.result["tried"], 90);
    json wrong_radius = sphere(15, kAsTheHouse);
    wrong_radius["radius_mm"] = 14.5;
    EXPECT_EQ(asked("tcp-sphere", wrong_radius).result["verdict"], "cannot_tell");
    json shuffled = hand_eye(16, kAsTheHouse, kAsTheHouse);
    for (std::size_t i = 0; i + 1 < shuffled["pairs"].size(); ++i)
        std::swap(shuffled["pairs"][i]["base_from_flange"], shuffled["pairs"][i + 1]["base_from_flange"]);
    EXPECT_EQ(asked("hand-eye", shuffled).result["verdict"], "cannot_tell");
    EXPECT_EQ(asked("hand-eye", hand_eye(17, noise, kAsTheHouse)).result["verdict"], "cannot_tell");
}

TEST(ConventionDetective, HostileDataAreRefused) {
    const auto refused = [](const char* method, const json& data) {
        const auto answer = detect_pose_convention(method, data, {});
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
        EXPECT_FALSE(calibrate_tcp_sphere_json(bad, {})) << said;
    }
}

}  // namespace
}  // namespace seamwright
