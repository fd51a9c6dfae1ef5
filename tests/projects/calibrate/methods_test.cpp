#include <gtest/gtest.h>

#include <random>

#include "core/calibration/board/board.h"
#include "projects/calibrate/methods/cameras/stripe_frames.h"
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

// Every field of a document in turn as something else: an answer or one sentence, and never an exception.
TEST_P(EveryMethod, AHostileDocumentIsReadOrRefused) {
    const auto solution = solve_calibration(method_, method_.example(), {});
    ASSERT_TRUE(solution);
    const json flat = solution->document.flatten();
    int tried = 0;
    for (const auto& [pointer, value] : flat.items()) {
        if (++tried > 400) break;
        for (const json& other :
             {json(7), json("x"), json(nullptr), json::array({1}), json{{"a", true}}, json(1e300)}) {
            json hostile = solution->document;
            hostile[json::json_pointer(pointer)] = other;
            EXPECT_NO_THROW({
                const auto read = solution_from_document(hostile);
                EXPECT_TRUE(read || !read.error().sentence().empty());
            }) << pointer
               << " = " << other;
        }
    }
    for (const char* list : {"parameters", "per_pose", "correlations", "proposals", "sensors", "hold_out"}) {
        json hostile = solution->document;
        for (const json& other : {json(7), json::array({7}), json::array({json::array()}), json("x")}) {
            hostile[list] = other;
            EXPECT_NO_THROW((void)solution_from_document(hostile)) << list << " = " << other;
        }
    }
}

// A plate seen from several stands, each off by its own pose error: what the stands disagree by is in the sigma, and a
// set that contradicts itself is never good because its mean is smooth.
json stands(std::mt19937& random, int count, double mm, double deg, const Pose& world_from_plate) {
    std::normal_distribution<double> normal;
    const auto draw = [&](double sigma) {
        return Eigen::Vector3d(sigma * normal(random), sigma * normal(random), sigma * normal(random));
    };
    json list = json::array();
    for (int i = 0; i < count; ++i) {
        const Pose off = make_pose(rotation_exp(draw(deg * kPi / 180)), draw(mm));
        json points = json::array();
        for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), {60, 0, 0}, {60, 50, 0}, {0, 50, 0}}) {
            const Eigen::Vector3d w = world_from_plate * (off * p);
            points.push_back({{"plate", {p.x(), p.y(), p.z()}}, {"world", {w.x(), w.y(), w.z()}}});
        }
        list.push_back({{"id", "P" + std::to_string(i)}, {"points", points}});
    }
    return {{"points", list}};
}

TEST(PlateFromStands, StatesWhatTheStandsDisagreeBy) {
    std::mt19937 random(11);
    const Pose truth = make_pose(rotation_exp({0.1, -0.3, 1.2}), {900, 150, 250});
    const CalibrationMethod& plate = *find_method("plate");
    int inside = 0;
    constexpr int kTrials = 400;
    for (int trial = 0; trial < kTrials; ++trial) {
        const auto solution = solve_calibration(plate, stands(random, 3 + trial % 5, 0.1, 0.0, truth), {});
        ASSERT_TRUE(solution) << solution.error().sentence();
        const UncertainPose& found = std::get<PlateInWorld>(solution->found).world_from_plate;
        const double off = std::abs((found.pose.translation() - truth.translation()).x());
        inside += off < 1.96 * std::sqrt(found.covariance(0, 0));
    }
    EXPECT_GT(inside, 0.92 * kTrials);
    // One stand tells nothing of the robot: what is stated of it is all there is.
    int within = 0, bare = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
        json data = stands(random, 1, 0.1, 0.0, truth);
        const auto hits = [&](const json& given) {
            const auto solution = solve_calibration(plate, given, {});
            if (!solution) return false;
            const UncertainPose& found = std::get<PlateInWorld>(solution->found).world_from_plate;
            return std::abs((found.pose.translation() - truth.translation()).x()) <
                   1.96 * std::sqrt(found.covariance(0, 0));
        };
        bare += hits(data);
        data["robot"] = {{"sigma_mm", 0.1}};
        within += hits(data);
    }
    EXPECT_LT(bare, 0.2 * kTrials);
    EXPECT_GT(within, 0.92 * kTrials);
    const auto wild = solve_calibration(plate, stands(random, 6, 60, 2, truth), {});
    ASSERT_TRUE(wild);
    EXPECT_EQ(wild->verdict(), Verdict::poor) << wild->report.judgement.reason.english();
    EXPECT_NE(wild->report.judgement.reason.english().find("disagree"), std::string::npos);
    const auto calm = solve_calibration(plate, stands(random, 6, 0.005, 0.001, truth), {});
    ASSERT_TRUE(calm);
    EXPECT_EQ(calm->verdict(), Verdict::good) << calm->report.judgement.reason.english();
}

std::vector<std::string> ids() {
    std::vector<std::string> list;
    for (const CalibrationMethod& m : calibration_methods()) list.push_back(m.id);
    return list;
}
// Every value of every setting is read back, each number and each choice; what is at its default is as it was at first.
TEST_P(EveryMethod, ItsSettingsAreReadBack) {
    json settings = default_settings(method_);
    const json at_first = settings;
    for (const MethodSetting& s : method_.settings) {
        EXPECT_NE(s.label.in(Language::german), "") << s.info.name;
        std::vector<double> values{s.info.minimum, s.info.maximum};
        for (std::size_t i = 0; i < s.info.choices.size(); ++i) values.push_back(static_cast<double>(i));
        for (const double value : values) {
            ASSERT_TRUE(set_setting(method_, settings, s.info.name, value)) << s.info.name;
            EXPECT_EQ(setting(s, settings), value) << s.info.name;
        }
        EXPECT_FALSE(set_setting(method_, settings, s.info.name, s.info.maximum + 1)) << s.info.name;
        ASSERT_TRUE(set_setting(method_, settings, s.info.name, s.info.default_value));
    }
    EXPECT_EQ(settings, at_first);
}

// The page's words for a board are those of its data.
TEST(BoardSettings, AreTheBoardThatIsLookedFor) {
    const CalibrationMethod& method = *find_method("stripe-camera");
    json settings = default_settings(method);
    const auto plain = parse_board_json(settings["board"], "board");
    ASSERT_TRUE(plain) << plain.error().sentence();
    EXPECT_EQ(plain->pattern, BoardPattern::chessboard);
    EXPECT_EQ(plain->dictionary, -1);
    EXPECT_FALSE(plain->legacy);
    const auto choose = [&](const std::string& name, const std::string& word) {
        for (const MethodSetting& s : method.settings) {
            if (s.info.name != name) continue;
            const auto it = std::find(s.info.choices.begin(), s.info.choices.end(), word);
            ASSERT_NE(it, s.info.choices.end()) << word;
            ASSERT_TRUE(
                set_setting(method, settings, name, static_cast<double>(it - s.info.choices.begin())));
        }
    };
    choose("board_pattern", "charuco");
    choose("board_dictionary", "5x5_100");
    choose("board_legacy", "no");
    ASSERT_TRUE(set_setting(method, settings, "board_marker", 7.5));
    const auto marked = parse_board_json(settings["board"], "board");
    ASSERT_TRUE(marked) << marked.error().sentence();
    EXPECT_EQ(marked->pattern, BoardPattern::charuco);
    EXPECT_EQ(marked->dictionary, dictionary_named("5x5_100"));
    EXPECT_EQ(marked->legacy, false);
    EXPECT_EQ(marked->marker_mm, 7.5);
    choose("board_pattern", "aprilgrid");
    ASSERT_TRUE(set_setting(method, settings, "board_marker", 0));
    EXPECT_FALSE(parse_board_json(settings["board"], "board")) << "an AprilGrid's tags have a size";
}

// Whoever takes the robot's repeatability says so in its layout, is never surer with it, and refuses one that is none.
TEST_P(EveryMethod, TheRobotsRepeatabilityIsInItsSigma) {
    if (!method_.repeatability) return;
    EXPECT_NE(method_.layout.find("\"robot\":{"), std::string::npos);
    json data = method_.example();
    data.erase("robot");
    const auto sigma = [&](const json& given) {
        const auto solution = solve_calibration(method_, given, {});
        EXPECT_TRUE(solution) << (solution ? "" : solution.error().sentence());
        double sum = 0;
        if (solution)
            for (const auto& p : solution->report.parameters) sum += p.sigma;
        return sum;
    };
    const double bare = sigma(data);
    data["robot"] = {{"sigma_mm", 0.5}, {"sigma_deg", 0.05}};
    EXPECT_GT(sigma(data), 1.2 * bare);
    for (const json& bad : {json{{"sigma_mm", -1}}, json{{"sigma_mm", 1e9}}, json{{"sigma_mm", "a lot"}},
                            json{{"sigma_mm", 0.1}, {"sigma_deg", 400}}, json(7), json::array()}) {
        data["robot"] = bad;
        const auto refused = solve_calibration(method_, data, {});
        ASSERT_FALSE(refused) << bad;
        EXPECT_EQ(refused.error().kind, ErrorKind::input) << bad;
    }
}

// A session takes what the project knows of the robot, unless the data say it.
TEST_P(EveryMethod, ASessionBeginsWithTheRobotsMeasuredRepeatability) {
    RobotSetup robot;
    Calibration base;
    base.result = {{"centre_base_mm", {1.0, 2.0, 3.0}}};
    const auto unmeasured = prepared_settings(method_, json::object(), &base, {}, &robot);
    robot.arrival_covariance.diagonal() << 1e-4, 4e-4, 4e-4, 1e-8, 1e-8, 4e-8;
    const auto settings = prepared_settings(method_, json::object(), &base, {}, &robot);
    if (!settings) return;  // it cannot do without what this project does not keep
    EXPECT_FALSE(unmeasured->contains("robot"));
    ASSERT_EQ(settings->contains("robot"), method_.repeatability);
    if (!method_.repeatability) return;
    EXPECT_NEAR((*settings)["robot"]["sigma_mm"].get<double>(), std::sqrt(3e-4), 1e-9);
    EXPECT_NEAR((*settings)["robot"]["sigma_deg"].get<double>(), std::sqrt(2e-8) * 180 / kPi, 1e-9);
    const json own = {{"robot", {{"sigma_mm", 0.7}}}};
    EXPECT_EQ((*prepared_settings(method_, own, &base, {}, &robot))["robot"], own["robot"]);
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod, testing::ValuesIn(ids()), [](const auto& one) {
    std::string name = one.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

}  // namespace
}  // namespace seamwright
