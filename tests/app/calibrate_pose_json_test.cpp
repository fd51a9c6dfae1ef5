#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/exchange/pose_json.h"
#include "projects/calibrate/methods/methods.h"
#include "tests/core/calibration/pose/hand_eye_simulation.h"
#include "tests/core/calibration/sphere/sphere_simulation.h"

namespace seamwright {
namespace {

using namespace simulation;
using nlohmann::json;
using ::testing::HasSubstr;

json sphere_json(const SphereCell& cell, const std::vector<SphereObservation>& observations) {
    json data;
    data["radius_mm"] = cell.radius;
    for (const auto& o : observations) {
        json profile = json::array();
        for (size_t i = 0; i < o.profile.size(); ++i)
            profile.push_back({o.profile.x_mm[i], number_json(o.profile.z_mm[i])});
        data["observations"].push_back(
            {{"id", o.id},
             {"base_from_flange", {{"matrix", pose_json(o.base_from_flange)["matrix"]}}},
             {"profile", profile}});
    }
    return data;
}

TEST(CalibrateJson, TcpSphereFollowsTheContract) {
    Random random(1);
    const SphereCell cell = any_cell(random);
    const auto observations = sphere_observations(cell, 9, random);
    auto outcome = solve_calibration(*find_method("tcp-sphere"), sphere_json(cell, observations), {});
    ASSERT_TRUE(outcome.has_value()) << outcome.error().sentence();
    EXPECT_TRUE(serves(outcome->verdict()));
    const json& r = outcome->document;
    EXPECT_EQ(r["status"], "ok");
    EXPECT_EQ(r["verdict"], "good");
    const auto pose = parse_pose(r["flange_from_sensor"], "flange_from_sensor");
    ASSERT_TRUE(pose.has_value());
    EXPECT_LT(distance_mm(*pose, cell.flange_from_sensor), 0.1);
    EXPECT_EQ(r["centre_base_mm"].size(), 3u);
    EXPECT_EQ(r["per_pose"].size(), 9u);
    EXPECT_EQ(r["per_pose"][0]["id"], "P1");
    EXPECT_LT(r["rms_mm"].get<double>(), 0.05);
    for (const char* key : {"xyz_mm", "abc_deg", "centre_mm"}) EXPECT_EQ(r["sigma"][key].size(), 3u) << key;
    EXPECT_EQ(r["covariance"].size(), 9u);

    const auto fewer = solve_calibration(*find_method("tcp-sphere"), sphere_json(cell, observations), {"P2"});
    ASSERT_TRUE(fewer.has_value());
    EXPECT_FALSE(fewer->document["per_pose"][1]["used"].get<bool>());
}

TEST(CalibrateJson, UndeterminedHasNoNumbersAndExitCodeOne) {
    Random random(2);
    SphereCell cell = any_cell(random);
    cell.tilt_deg = cell.turn_deg = 0;
    const auto outcome = solve_calibration(*find_method("tcp-sphere"),
                                           sphere_json(cell, sphere_observations(cell, 9, random)), {});
    ASSERT_TRUE(outcome.has_value());
    EXPECT_FALSE(serves(outcome->verdict()));
    EXPECT_EQ(outcome->document["status"], "undetermined");
    EXPECT_EQ(outcome->document["verdict"], "undetermined");
    EXPECT_TRUE(outcome->document["flange_from_sensor"].is_null());
    EXPECT_TRUE(outcome->document["radius_mm"].is_null());
    EXPECT_FALSE(outcome->document["proposals"].empty());
}

TEST(CalibrateJson, TcpSphereRefusesHostileData) {
    Random random(3);
    const SphereCell cell = any_cell(random);
    const json good = sphere_json(cell, sphere_observations(cell, 6, random));
    const auto expect_error = [](const json& data, const char* word) {
        const auto outcome = solve_calibration(*find_method("tcp-sphere"), data, {});
        ASSERT_FALSE(outcome.has_value()) << word;
        EXPECT_THAT(outcome.error().sentence(), HasSubstr(word));
    };
    expect_error(json::array(), "object");
    expect_error(json(nullptr), "object");
    json bad = good;
    bad.erase("radius_mm");
    expect_error(bad, "radius_mm");
    bad = good;
    bad["radius_mm"] = "12";
    expect_error(bad, "radius_mm");
    bad = good;
    bad["observations"] = 5;
    expect_error(bad, "observations");
    bad = good;
    bad["observations"][2] = 7;
    expect_error(bad, "observations[2]");
    bad = good;
    bad["observations"][2].erase("base_from_flange");
    expect_error(bad, "base_from_flange");
    bad = good;
    bad["observations"][1]["profile"][3] = {1, 2, 3};
    expect_error(bad, "profile[3]");
    bad = good;
    bad["observations"][1]["profile"][3] = {"a", 2};
    expect_error(bad, "profile[3]");
    bad = good;
    bad["observations"][1]["id"] = "P1";
    expect_error(bad, "twice");
    bad = good;
    bad["observations"] = json::array();
    expect_error(bad, "too few");
}

TEST(CalibrateJson, HandEyeBothMounts) {
    for (unsigned seed = 0; seed < 8; ++seed) {
        Random random(seed);
        const HandEyeCell cell = any_hand_eye_cell(random);
        json data;
        data["mount"] = std::string(name_of(cell.mount));
        for (const auto& pair : hand_eye_pairs(cell, 9, random))
            data["pairs"].push_back({{"base_from_flange", pose_json(pair.base_from_flange)},
                                     {"camera_from_target", pose_json(pair.camera_from_target)}});
        const auto outcome = solve_calibration(*find_method("hand-eye"), data, {});
        ASSERT_TRUE(outcome.has_value()) << outcome.error().sentence();
        EXPECT_TRUE(serves(outcome->verdict())) << outcome->document["reason"];
        const char* key = cell.mount == Mount::eye_in_hand ? "flange_from_camera" : "base_from_camera";
        const auto pose = parse_pose(outcome->document[key], key);
        ASSERT_TRUE(pose.has_value());
        EXPECT_LT(distance_mm(*pose, cell.x), 3);
        EXPECT_EQ(outcome->document["per_pose"][8]["id"], "8");
    }
    EXPECT_FALSE(
        solve_calibration(*find_method("hand-eye"), {{"mount", "sideways"}, {"pairs", json::array()}}, {})
            .has_value());
    EXPECT_FALSE(solve_calibration(*find_method("hand-eye"), {{"pairs", json::array()}}, {}).has_value());
}

json pairs_json(const std::vector<HandEyePair>& pairs) {
    json list = json::array();
    for (const HandEyePair& p : pairs) {
        const json robot = pose_json(p.base_from_flange), camera = pose_json(p.camera_from_target);
        list.push_back({{"id", p.id},
                        {"base_from_flange", {{"xyz", robot["xyz"]}, {"abc", robot["abc"]}}},
                        {"camera_from_target", {{"xyz", camera["xyz"]}, {"abc", camera["abc"]}}}});
    }
    return {{"mount", "eye_in_hand"}, {"pairs", list}};
}

TEST(CalibrateJson, HandEyeNamesTheUnitThatFits) {
    Random random(12);
    HandEyeCell cell = any_hand_eye_cell(random);
    cell.mount = Mount::eye_in_hand;
    cell.x = make_pose(any_rotation(random), {60, -20, 150});
    cell.y = make_pose(any_rotation(random), {900, 150, 400});
    cell.sigma_mm = 0.03;
    cell.sigma_rad = 2e-4;
    const json good = pairs_json(hand_eye_pairs(cell, 10, random));
    const auto cure = [&](const json& data) {
        const auto r = solve_calibration(*find_method("hand-eye"), data, {});
        if (!r) return r.error().sentence();
        EXPECT_FALSE(serves(r->verdict()));
        return r->report.judgement.cure.english();
    };
    const auto times = [&](const char* list, const char* part, double factor) {
        json data = good;
        for (json& pair : data["pairs"])
            for (json& v : pair[list][part]) v = v.get<double>() * factor;
        return data;
    };
    EXPECT_TRUE(serves(solve_calibration(*find_method("hand-eye"), good, {})->verdict()));
    EXPECT_THAT(cure(times("base_from_flange", "abc", kPi / 180)), HasSubstr("base_from_flange are radians"));
    EXPECT_THAT(cure(times("camera_from_target", "abc", kPi / 180)),
                HasSubstr("camera_from_target are radians"));
    json both = times("base_from_flange", "abc", kPi / 180);
    for (json& pair : both["pairs"])
        for (json& v : pair["camera_from_target"]["abc"]) v = v.get<double>() * kPi / 180;
    EXPECT_THAT(cure(both), HasSubstr("both lists are radians"));
    EXPECT_THAT(cure(times("camera_from_target", "xyz", 1 / 25.4)),
                HasSubstr("camera_from_target are inches"));
    EXPECT_THAT(cure(times("base_from_flange", "xyz", 1 / 25.4)), HasSubstr("base_from_flange are inches"));
}

TEST(CalibrateJson, PlateStaticAndDrift) {
    Random random(4);
    const Pose truth = make_pose(any_rotation(random), {2000, 300, 500});
    json plate;
    for (int i = 0; i < 6; ++i) {
        const Eigen::Vector3d p(uniform(random, -100, 100), uniform(random, -100, 100), 0), w = truth * p;
        plate["points"].push_back({{"plate", {p.x(), p.y(), p.z()}}, {"world", {w.x(), w.y(), w.z()}}});
    }
    const auto solved = solve_calibration(*find_method("plate"), plate, {});
    ASSERT_TRUE(solved.has_value()) << solved.error().sentence();
    EXPECT_TRUE(serves(solved->verdict()));
    EXPECT_LT(distance_mm(*parse_pose(solved->document["world_from_plate"], ""), truth), 1e-6);

    const Pose plate_from_camera = make_pose(any_rotation(random), {0, 20, 300});
    const Pose camera_from_laser = make_pose(any_rotation(random), {5, 60, 100});
    json chain;
    chain["world_from_plate"] = {{"pose", pose_json(truth)}, {"sigma_mm", 0.01}, {"sigma_deg", 0.001}};
    chain["camera_from_plate"] = pose_json(plate_from_camera.inverse());
    chain["camera_from_laser"] = pose_json(camera_from_laser);
    const auto one = solve_calibration(*find_method("static"), chain, {});
    ASSERT_TRUE(one.has_value()) << one.error().sentence();
    EXPECT_TRUE(serves(one->verdict()));
    EXPECT_LT(distance_mm(*parse_pose(one->document["world_from_laser"], ""),
                          truth * plate_from_camera * camera_from_laser),
              1e-6);
    EXPECT_TRUE(one->document["sensors"][0]["sigma"].is_object());
    json bare = chain;
    bare["world_from_plate"] = pose_json(truth);
    const auto unknown = solve_calibration(*find_method("static"), bare, {});
    ASSERT_TRUE(unknown.has_value());
    for (const char* key : {"sigma", "covariance", "working_sigma_mm"})
        EXPECT_TRUE(unknown->document["sensors"][0][key].is_null()) << key;
    EXPECT_THAT(unknown->document["reason"].get<std::string>(), HasSubstr("unknown"));
    chain["camera_from_laser"] = 3;
    EXPECT_FALSE(solve_calibration(*find_method("static"), chain, {}).has_value());

    const SphereCell cell = any_cell(random);
    json drift;
    drift["flange_from_sensor"] = pose_json(cell.flange_from_sensor);
    drift["radius_mm"] = cell.radius;
    for (int k = 0; k < 3; ++k) {
        SphereCell now = cell;
        now.centre_base += Eigen::Vector3d(70 * (k == 1), 60 * (k == 2), 0);
        const json views = sphere_json(now, sphere_observations(now, 5, random));
        for (json o : views["observations"]) {
            o["id"] = std::to_string(k) + o["id"].get<std::string>();
            o["centre_base_mm"] = vector_json(now.centre_base);
            drift["observations"].push_back(o);
        }
    }
    const auto held = solve_calibration(*find_method("drift"), drift, {});
    ASSERT_TRUE(held.has_value()) << held.error().sentence();
    EXPECT_EQ(held->document["status"], "holds") << held->document["reason"];
    drift["flange_from_sensor"] =
        pose_json(retract(cell.flange_from_sensor, (Vector6() << 0.6, -0.5, 0.4, 0, 0, 0).finished()));
    const auto moved = solve_calibration(*find_method("drift"), drift, {});
    ASSERT_TRUE(moved.has_value());
    EXPECT_EQ(moved->document["status"], "drifted");
    EXPECT_FALSE(serves(moved->verdict()));
    EXPECT_NEAR(moved->document["change_mm"].get<double>(), std::sqrt(0.77), 0.15);
}

// Nothing but the advised views of the one sphere that the sensor was calibrated with, as the desk hands them on.
TEST(CalibrateJson, TheAdvisedViewsTellWhetherACalibrationHolds) {
    const CalibrationMethod& method = *find_method("drift");
    int holds = 0, drifted = 0;
    for (unsigned seed = 300; seed < 320; ++seed) {
        Random random(seed);
        const SphereCell cell = any_cell(random);
        const auto first = solve_calibration(*find_method("tcp-sphere"),
                                             sphere_json(cell, sphere_observations(cell, 12, random)), {});
        ASSERT_TRUE(first.has_value()) << first.error().sentence();
        json drift = sphere_json(cell, sphere_observations(cell, method.advised, random));
        for (const char* key : {"flange_from_sensor", "centre_base_mm", "covariance"})
            drift[key] = first->document[key];
        const auto answer = solve_calibration(method, drift, {});
        ASSERT_TRUE(answer.has_value()) << answer.error().sentence();
        holds += answer->document["status"] == "holds" ? 1 : 0;
        drifted += answer->document["status"] == "drifted" ? 1 : 0;
    }
    EXPECT_GE(holds, 16);
    EXPECT_LE(drifted, 1);
}

}  // namespace
}  // namespace seamwright
