#include <gtest/gtest.h>

#include "projects/calibrate/methods/methods.h"

namespace seamwright {
namespace {

using nlohmann::json;

class EveryMethod : public testing::TestWithParam<std::string> {
  protected:
    const CalibrationMethod& method_ = *find_method(GetParam());
};

TEST_P(EveryMethod, SolvesItsExample) {
    const auto solution = solve_calibration(method_, method_.example(), {});
    ASSERT_TRUE(solution) << solution.error().sentence();
    EXPECT_TRUE(serves(solution->verdict())) << solution->report.judgement.reason.english();
    EXPECT_EQ(solution->document["method"], method_.id);
}

TEST_P(EveryMethod, IsCompleteForAPersonWhoIsLedThroughIt) {
    EXPECT_FALSE(method_.help.empty());
    EXPECT_FALSE(method_.layout.empty());
    EXPECT_FALSE(method_.usage.empty());
    if (!method_.guided) return;
    for (const Text& words : {method_.title, method_.why, method_.file}) {
        EXPECT_FALSE(words.empty());
        EXPECT_NE(words.in(Language::german), words.english());
    }
    EXPECT_FALSE(method_.need.empty());
    EXPECT_LE(method_.fewest, method_.advised);
    EXPECT_TRUE(method_.example().contains(method_.entries)) << "sessions put their captures there";
}

// What is kept as a document comes back as the answer it was; a table is not in it.
TEST_P(EveryMethod, ADocumentIsTheAnswerAgain) {
    const auto solution = solve_calibration(method_, method_.example(), {});
    ASSERT_TRUE(solution);
    const auto again = solution_from_document(json::parse(solution->document.dump()));
    ASSERT_TRUE(again) << again.error().sentence();
    const bool table = std::holds_alternative<PixelTable>(solution->found);
    EXPECT_EQ(again->found.index(), table ? 0 : solution->found.index());
    EXPECT_EQ(again->verdict(), solution->verdict());
    EXPECT_EQ(again->report.judgement.reason.english(), solution->report.judgement.reason.english());
    ASSERT_EQ(again->report.parameters.size(), solution->report.parameters.size());
    for (std::size_t i = 0; i < again->report.parameters.size(); ++i)
        EXPECT_EQ(again->report.parameters[i].value, solution->report.parameters[i].value);
    ASSERT_EQ(again->report.poses.size(), solution->report.poses.size());
    for (std::size_t i = 0; i < again->report.poses.size(); ++i) {
        EXPECT_EQ(again->report.poses[i].id, solution->report.poses[i].id);
        EXPECT_EQ(again->report.poses[i].used, solution->report.poses[i].used);
    }
    EXPECT_EQ(again->report.hold_out.folds, solution->report.hold_out.folds);
    EXPECT_EQ(again->notices.size(), solution->notices.size());
    if (const auto* sensor = std::get_if<SensorOnFlange>(&solution->found)) {
        const UncertainPose& back = std::get<SensorOnFlange>(again->found).flange_from_sensor;
        EXPECT_LT(distance_mm(back.pose, sensor->flange_from_sensor.pose), 1e-9);
        EXPECT_TRUE(back.covariance.isApprox(sensor->flange_from_sensor.covariance, 1e-9));
    }
}

TEST_P(EveryMethod, RefusesWhatIsNoData) {
    for (const json& bad : {json(), json(3), json::array(), json::object(), json("text")}) {
        const auto refused = solve_calibration(method_, bad, {});
        ASSERT_FALSE(refused) << bad;
        EXPECT_EQ(refused.error().kind, ErrorKind::input);
        EXPECT_FALSE(refused.error().sentence().empty());
    }
    for (const json& bad : {json(), json(3), json::array()}) EXPECT_FALSE(solution_from_document(bad));
}

std::vector<std::string> ids() {
    std::vector<std::string> list;
    for (const CalibrationMethod& m : calibration_methods()) list.push_back(m.id);
    return list;
}
INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod, testing::ValuesIn(ids()), [](const auto& one) {
    std::string name = one.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

}  // namespace
}  // namespace seamwright
