// The data and the answer of calibrate on-part as other programs write and read them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/pose.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/methods/methods.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const CalibrationMethod& on_part() {
    return *find_method("on-part");
}
std::string refused(const json& data) {
    const auto solution = solve_calibration(on_part(), data, {});
    return solution ? std::string() : solution.error().sentence();
}

TEST(OnPartJson, AnswersInTheFieldsOfTheContract) {
    const auto solution = solve_calibration(on_part(), on_part().example(), {"P3"});
    ASSERT_TRUE(solution) << solution.error().sentence();
    const json& d = solution->document;
    EXPECT_EQ(d["status"], "ok");
    EXPECT_NEAR(d["latency_s"].get<double>(), 0.004, 5 * d["latency_sigma_s"].get<double>());
    ASSERT_EQ(d["covariance"].size(), 6U);
    const auto pose = parse_pose(d["flange_from_sensor"], "");
    ASSERT_TRUE(pose);
    EXPECT_LT(d["covariance"][3][3].get<double>(), 1e-3) << "rad, not degrees";
    EXPECT_TRUE(d["unobservable"].is_array());
    EXPECT_TRUE(d["advice"].is_string());
    ASSERT_EQ(d["per_pass"].size(), 12U);
    EXPECT_EQ(d["per_pass"][2]["used"], false);
    EXPECT_EQ(d["per_pass"][2]["edge"], "e1");
    EXPECT_EQ(d["edges"][0]["id"], "e1");
    EXPECT_TRUE(d["moved"].is_null());
    EXPECT_TRUE(std::holds_alternative<SensorOnFlange>(solution->found));
}

TEST(OnPartJson, LatencyMayBeFreeANumberOrItsText) {
    json data = on_part().example();
    for (const json& latency : {json(0.004), json("0.004")}) {
        data["latency"] = latency;
        const auto solution = solve_calibration(on_part(), data, {});
        ASSERT_TRUE(solution) << solution.error().sentence();
        EXPECT_EQ(solution->document["latency_s"], 0.004);
        EXPECT_EQ(solution->document["latency_sigma_s"], 0);
    }
    for (const json& bad : {json("soon"), json("0.004 s"), json(true), json::array(), json(7)}) {
        data["latency"] = bad;
        EXPECT_THAT(refused(data), HasSubstr("latency")) << bad;
    }
}

TEST(OnPartJson, UndeterminedHasNoNumbers) {
    json data = on_part().example();
    while (data["passes"].size() > 1) data["passes"].erase(1);
    const auto solution = solve_calibration(on_part(), data, {});
    ASSERT_TRUE(solution) << solution.error().sentence();
    const json& d = solution->document;
    EXPECT_FALSE(serves(solution->verdict()));
    if (d["status"] == "ok") return;
    EXPECT_TRUE(d["flange_from_sensor"].is_null());
    EXPECT_TRUE(d["covariance"].is_null());
    EXPECT_TRUE(d["latency_s"].is_null());
    EXPECT_FALSE(d["advice"].get<std::string>().empty());
}

// Every kind of field in turn as something else: one sentence that says where, and never a throw.
TEST(OnPartJson, HostileDataAreRefusedWhereTheyAreWrong) {
    const json good = on_part().example();
    for (const char* pointer :
         {"/passes", "/passes/1", "/passes/1/edge", "/passes/1/profiles", "/passes/1/profiles/2",
          "/passes/1/profiles/2/time_s", "/passes/1/profiles/2/base_from_flange",
          "/passes/1/profiles/2/point", "/passes/1/profiles/2/point/0"})
        for (const json& other :
             {json(nullptr), json(true), json("x"), json{{"a", 1}}, json::array({1, 2, 3}), json::array()}) {
            json bad = good;
            bad[json::json_pointer(pointer)] = other;
            if (std::string(pointer) == "/passes/1/edge" && other.is_string()) continue;
            std::string sentence;
            EXPECT_NO_THROW(sentence = refused(bad)) << pointer << " = " << other;
            EXPECT_FALSE(sentence.empty()) << pointer << " = " << other;
        }
    json bad = good;
    bad["passes"][1]["profiles"][2]["covariance"] = {{1, 0}, {0}};
    EXPECT_THAT(refused(bad), HasSubstr("passes[1].profiles[2].covariance"));
    bad = good;
    bad["passes"][1]["id"] = "P1";
    EXPECT_THAT(refused(bad), HasSubstr("twice"));
    bad = good;
    bad["prior"] = {{"flange_from_sensor", pose_json(Pose::Identity())}, {"covariance", json::array({1, 2})}};
    EXPECT_THAT(refused(bad), HasSubstr("prior.covariance"));
    for (const json& other : {json(7), json("x"), json::array(), json::object()}) {
        bad["prior"] = other;
        EXPECT_FALSE(refused(bad).empty()) << other;
        json robot = good;
        robot["robot"] = other;
        EXPECT_FALSE(refused(robot).empty()) << other;
    }
    json robot = good;
    robot["robot"] = {{"sigma_mm", 0.03}};
    EXPECT_THAT(refused(robot), HasSubstr("stated in part")) << "its turn would count as exact";
}

}  // namespace
}  // namespace seamwright
