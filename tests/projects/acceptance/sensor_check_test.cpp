// The sensor check from files and from the profiles that a calibration keeps.

#include "projects/acceptance/equipment/sensor_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "devices/exchange/pose_json.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const Pose kFlangeFromSensor = make_pose(rotation_exp({0.1, 0.7, -0.3}), {30, -20, 250});

// What a sensor at (x, y, z of the sensor's axes from the sphere's centre) sees of a sphere of that radius, cut at
// y_cut of the sphere: the upper arc, radially off by a wave.
json observation(int i, const Eigen::Vector3d& centre_base, double radius, double wave = 0) {
    const double cut = -9 + 3.0 * i, turn = 0.25 * i;
    const Pose base_from_sensor =
        make_pose(rotation_exp({0.2 * std::sin(turn), 0.2 * std::cos(turn), turn}), Eigen::Vector3d::Zero());
    const Pose at = make_pose(base_from_sensor.linear(),
                              centre_base + base_from_sensor.linear() * Eigen::Vector3d(0, cut, -200));
    json profile = json::array();
    const double across = std::sqrt(radius * radius - cut * cut);
    for (int k = -60; k <= 60; ++k) {
        const double angle = k * 0.02;
        const double off = (k % 2 ? wave : -wave) * radius / across;
        profile.push_back({(across + off) * std::sin(angle), 200 - (across + off) * std::cos(angle)});
    }
    profile.push_back(nullptr);
    return {{"id", "p" + std::to_string(i)},
            {"base_from_flange", pose_json(at * kFlangeFromSensor.inverse())},
            {"profile", profile}};
}

json observations(const Eigen::Vector3d& centre, double radius, double wave = 0) {
    json list = json::array();
    for (int i = 0; i < 7; ++i) list.push_back(observation(i, centre, radius, wave));
    return list;
}

TEST(SensorCheck, ProfilesOfTwoSpheresAtKnownPoses) {
    const json data = {
        {"sensor", "A"},
        {"flange_from_sensor", pose_json(kFlangeFromSensor)},
        {"limits_mm", {{"form", 0.05}, {"size", 0.02}, {"distance", 0.02}}},
        {"spheres",
         {{{"id", "K1"},
           {"diameter_mm", 30.01},
           {"diameter_u_mm", 0.001},
           {"certificate", "D-K 0815"},
           {"observations", observations({1000, 0, 500}, 15)}},
          {{"id", "K2"}, {"diameter_mm", 30}, {"observations", observations({1000, 100, 500}, 15)}}}},
        {"distances", {{{"from", "K1"}, {"to", "K2"}, {"length_mm", 99.99}}}}};
    const auto check = sensor_check(data, "data.json", nullptr);
    ASSERT_TRUE(check) << check.error().sentence();
    EXPECT_NEAR(check->study.spheres[0].size->value_mm, -0.01, 1e-6);
    EXPECT_NEAR(check->study.spheres[0].form.value_mm, 0, 1e-6);
    EXPECT_NEAR(check->study.distances[0].error.value_mm, 0.01, 1e-6);
    EXPECT_EQ(check->study.verdict, AcceptanceVerdict::ok);
    const json j = sensor_check_json(*check);
    EXPECT_EQ(j["certificates"]["K1"], "D-K 0815");
    EXPECT_EQ(j["verdict"], "ok");
    EXPECT_EQ(j["spheres"][1]["probing_size"]["verdict"], "ok");
    report::Page page("t", "de");
    add_chapter(page, Language::german, *check);
    for (const char* word : {"Antastabweichung", "Kugelabstand", "D-K 0815", "VDI/VDE 2634"})
        EXPECT_THAT(page.text(), HasSubstr(word));
}

TEST(SensorCheck, TheProfilesThatACalibrationKeeps) {
    Project project = sample_project();
    Calibration& c = project.calibrations[0];
    c.flange_from_sensor = kFlangeFromSensor;
    c.raw = {{"data", {{"radius_mm", 15}, {"observations", observations({900, 10, 400}, 15.005)}}},
             {"exclude", {"p3"}}};
    const json certificate = {{"spheres", {{{"id", "ball"}, {"diameter_mm", 30}}}}};
    const auto check = sensor_check(certificate, "certificate.json", &project);
    ASSERT_TRUE(check) << check.error().sentence();
    EXPECT_NEAR(check->study.spheres[0].size->value_mm, 0.01, 1e-6);
    EXPECT_EQ(check->study.spheres[0].points, 6 * 121) << "what the calibration left out is left out";
    EXPECT_EQ(check->study.verdict, AcceptanceVerdict::too_little_data) << "no permitted error";
    EXPECT_EQ(check->source.sensor_serial, "0001");
    ASSERT_EQ(check->remarks.size(), 1u);
    EXPECT_THAT(check->remarks[0].english(), HasSubstr("calibration C1"));
    project.calibrations[0].raw = json::object();
    EXPECT_THAT(sensor_check(certificate, "certificate.json", &project).error().sentence(),
                HasSubstr("no data of \"ball\""));
}

TEST(SensorCheck, HostileFiles) {
    const json sphere = {{"id", "K"}, {"observations", observations({0, 0, 0}, 15)}};
    const auto refused = [](const json& data, const char* part) {
        const auto check = sensor_check(data, "data.json", nullptr);
        ASSERT_FALSE(check) << data.dump().substr(0, 200);
        EXPECT_THAT(check.error().sentence(), HasSubstr(part));
        EXPECT_THAT(check.error().sentence(), HasSubstr("data.json"));
        EXPECT_EQ(check.error().kind, ErrorKind::input);
    };
    const json pose = pose_json(kFlangeFromSensor);
    refused(json::array(), "");
    refused(json::object(), "no sphere");
    refused({{"sphere", {sphere}}}, "sphere");
    refused({{"spheres", {sphere}}}, "flange_from_sensor");
    refused({{"spheres", sphere}, {"flange_from_sensor", pose}}, "spheres");
    refused({{"spheres", {{{"id", "K"}}}}}, "no data");
    refused({{"spheres", {{{"points", json::array()}}}}}, "id");
    refused({{"spheres", {{{"id", "K"}, {"points", {{1, 2}}}}}}}, "points");
    refused({{"spheres", {{{"id", "K"}, {"points", json::array()}}}}}, "0 points");
    refused({{"limits_mm", {{"form", "much"}}}}, "form");
    json bad = sphere;
    bad["observations"][2]["profile"][4] = {1, 2, 3};
    refused({{"spheres", {bad}}, {"flange_from_sensor", pose}}, "[x, z]");
    bad = sphere;
    bad["observations"][2].erase("base_from_flange");
    refused({{"spheres", {bad}}, {"flange_from_sensor", pose}}, "base_from_flange");
    // No sphere in any profile.
    bad = sphere;
    for (json& o : bad["observations"])
        for (json& point : o["profile"])
            if (!point.is_null()) point[1] = 0.01 * point[0].get<double>();
    refused({{"spheres", {bad}}, {"flange_from_sensor", pose}}, "0 points");
    refused({{"spheres", {sphere}},
             {"flange_from_sensor", pose},
             {"distances", {{{"from", "K"}, {"to", "K"}, {"length_mm", 1}}}}},
            "two spheres");
}

}  // namespace
}  // namespace seamwright
