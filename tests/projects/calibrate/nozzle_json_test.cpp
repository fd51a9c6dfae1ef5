// The data and the answer of calibrate nozzle as other programs write and read them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/pose.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/detect_convention.h"
#include "projects/calibrate/methods/methods.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const CalibrationMethod& nozzle() {
    return *find_method("nozzle");
}
std::string refused_nozzle(const json& data) {
    const auto solution = solve_calibration(nozzle(), data, {});
    return solution ? std::string() : solution.error().sentence();
}

TEST(NozzleJson, AnswersInTheFieldsOfTheContract) {
    const auto solution = solve_calibration(nozzle(), nozzle().example(), {"T3"});
    ASSERT_TRUE(solution) << solution.error().sentence();
    const json& d = solution->document;
    EXPECT_EQ(d["status"], "ok");
    ASSERT_EQ(d["covariance"].size(), 3U);
    ASSERT_EQ(d["covariance_pose"].size(), 6U);
    const auto pose = parse_pose(d["flange_from_nozzle"], "");
    ASSERT_TRUE(pose);
    const Eigen::Vector3d truth(4.2, -1.6, 231.5);
    EXPECT_LT((pose->translation() - truth).norm(), 4 * d["sigma"]["worst_mm"].get<double>());
    EXPECT_TRUE(d["deviation"]["beyond_chance"]);
    EXPECT_NEAR(d["deviation"]["length_mm"].get<double>(), (truth - Eigen::Vector3d(4, -1, 231)).norm(), 0.3);
    EXPECT_EQ(d["per_pose"][2]["used"], false);
    EXPECT_TRUE(std::holds_alternative<NozzleOnFlange>(solution->found));
}

TEST(NozzleJson, ThePlaceMayBeStatedInTwoWaysAndNotInBoth) {
    json data = nozzle().example();
    const auto by_sigma = solve_calibration(nozzle(), data, {});
    data["target"].erase("sigma_mm");
    const auto exact = solve_calibration(nozzle(), data, {});
    data["target"]["covariance_mm2"] = {{9e-4, 0, 0}, {0, 9e-4, 0}, {0, 0, 9e-4}};
    const auto by_matrix = solve_calibration(nozzle(), data, {});
    ASSERT_TRUE(by_sigma && by_matrix && exact);
    EXPECT_NEAR(by_sigma->document["sigma"]["worst_mm"].get<double>(),
                by_matrix->document["sigma"]["worst_mm"].get<double>(), 1e-9);
    EXPECT_GT(exact->notices.size(), by_sigma->notices.size());
    data["target"]["sigma_mm"] = 0.03;
    EXPECT_THAT(refused_nozzle(data), HasSubstr("the same"));
}

TEST(NozzleJson, UndeterminedHasNoNumbers) {
    json data = nozzle().example();
    while (data["touches"].size() > 3) data["touches"].erase(3);
    const auto solution = solve_calibration(nozzle(), data, {});
    ASSERT_TRUE(solution) << solution.error().sentence();
    const json& d = solution->document;
    EXPECT_EQ(d["status"], "undetermined");
    EXPECT_TRUE(d["flange_from_nozzle"].is_null());
    EXPECT_TRUE(d["sigma"].is_null());
    EXPECT_FALSE(d["advice"].get<std::string>().empty());
    EXPECT_EQ(solution->found.index(), 0U);
}

// Every kind of field in turn as something else: one sentence, and never a throw.
TEST(NozzleJson, HostileDataAreRefusedWhereTheyAreWrong) {
    const json good = nozzle().example();
    for (const char* pointer : {"/touches", "/touches/1", "/touches/1/base_from_flange", "/target",
                                "/target/place_mm", "/target/radius_mm", "/target/sigma_mm", "/sigma_mm",
                                "/tip_radius_mm", "/programmed", "/robot", "/robot/sigma_mm"})
        for (const json& other :
             {json(true), json("x"), json{{"a", 1}}, json::array({1, 2}), json::array()}) {
            json bad = good;
            bad[json::json_pointer(pointer)] = other;
            std::string sentence;
            EXPECT_NO_THROW(sentence = refused_nozzle(bad)) << pointer << " = " << other;
            EXPECT_FALSE(sentence.empty()) << pointer << " = " << other;
        }
    json bad = good;
    bad["target"]["covariance_mm2"] = {{1, 0, 0}, {0, 1}, {0, 0, 1}};
    bad["target"].erase("sigma_mm");
    EXPECT_THAT(refused_nozzle(bad), HasSubstr("covariance_mm2"));
    bad = good;
    bad["target"]["radius"] = 25;
    EXPECT_THAT(refused_nozzle(bad), HasSubstr("radius"));
    bad = good;
    bad["touches"][4]["id"] = "T1";
    EXPECT_THAT(refused_nozzle(bad), HasSubstr("twice"));
    bad = good;
    bad.erase("target");
    EXPECT_THAT(refused_nozzle(bad), HasSubstr("target"));
    EXPECT_FALSE(refused_nozzle(json::object()).empty());
}

// Touches whose poses are the flange's view of the base are read so, and it is said.
TEST(NozzleJson, AConventionOfItsPosesIsFound) {
    json data = nozzle().example();
    for (json& touch : data["touches"]) {
        const auto pose = parse_pose(touch["base_from_flange"], "");
        ASSERT_TRUE(pose);
        touch["base_from_flange"] = pose_json(pose->inverse());
    }
    const auto wrong = solve_calibration(nozzle(), data, {});
    EXPECT_FALSE(wrong && serves(wrong->verdict()));
    const auto found = detect_pose_convention(nozzle(), data, {});
    ASSERT_TRUE(found) << found.error().sentence();
    EXPECT_EQ(found->found.finding, ConventionFinding::named) << found->found.sentence;
}

TEST(NozzleJson, TheSphereComesFromTheCalibrationInUse) {
    Calibration base;
    base.result = {{"centre_base_mm", {900, 150, 250}},
                   {"radius_mm", 25},
                   {"centre_covariance_mm2", {{1e-4, 0, 0}, {0, 1e-4, 0}, {0, 0, 1e-4}}}};
    const auto settings = prepared_settings(nozzle(), default_settings(nozzle()), &base, {}, nullptr);
    ASSERT_TRUE(settings) << settings.error().sentence();
    json data = nozzle().example();
    const json own = data["target"];
    data.update(*settings);
    EXPECT_EQ(data["target"]["radius_mm"], 25);
    const auto solution = solve_calibration(nozzle(), data, {});
    ASSERT_TRUE(solution) << solution.error().sentence();
    EXPECT_EQ(solution->document["status"], "ok");
    EXPECT_TRUE(solution->document["deviation"].is_null()) << "tool 0 is no tool";
    // Another calibration has measured it anew; what a file gave stays.
    base.id = "newer";
    base.result["centre_base_mm"] = {901, 150, 250};
    EXPECT_EQ((*prepared_settings(nozzle(), *settings, &base, {}, nullptr))["target"]["place_mm"][0], 901);
    EXPECT_EQ((*prepared_settings(nozzle(), nozzle().example(), &base, {}, nullptr))["target"], own);
    const auto nothing = prepared_settings(nozzle(), default_settings(nozzle()), nullptr, {}, nullptr);
    ASSERT_FALSE(nothing);
    EXPECT_THAT(nothing.error().sentence(), HasSubstr("sphere"));
}

}  // namespace
}  // namespace seamwright
