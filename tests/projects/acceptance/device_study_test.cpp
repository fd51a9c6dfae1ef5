// Robot and trigger measured on the simulated cell, kept in the file, set in the project, and taken back.

#include <gmock/gmock.h>

#include "projects/acceptance/equipment/device_studies.h"
#include "tests/projects/acceptance/device_study_cell.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

TEST(MeasureRobot, FindsTheSimulatedRobot) {
    StudyCell cell({}, 3);
    cell.teach_template("T2");
    cell.teach_template("L2");
    MeasureRobotOptions options;
    options.spot_ids = {"T2", "L2"};
    options.profiles = 3;
    int told = 0;
    options.progress = [&](const RunProgress& p) { told = p.done; };
    const auto measured = measure_robot(cell.station(), options);
    ASSERT_TRUE(measured) << measured.error().sentence();
    EXPECT_GT(told, 0);
    const RobotStudy& s = measured->study;
    ASSERT_EQ(s.spots.size(), 2u);
    for (const SpotRepeatability& r : s.spots) {
        const Spot& spot = *find_spot(cell.project(), r.spot_id);
        const auto sees = seen_by(spot, cell.project().calibrations[0].flange_from_sensor);
        const Eigen::Matrix2d truth = sees * cell.arrivals_at(r.spot_id) * sees.transpose();
        EXPECT_GE(r.returns, 28);
        EXPECT_TRUE(r.arrival_x.limits_mm.contains(std::sqrt(truth(0, 0)))) << r.spot_id;
        EXPECT_TRUE(r.arrival_z.limits_mm.contains(std::sqrt(truth(1, 1)))) << r.spot_id;
        EXPECT_TRUE(r.rp_limits_mm.contains(repeatability_of(truth))) << r.spot_id;
        EXPECT_GT(r.noise_mm.x(), 0);
    }
    EXPECT_TRUE(s.unseen.empty()) << "the edges of top and latch run across each other";
    EXPECT_TRUE(s.rp_limits_mm.contains(repeatability_of(cell.arrivals_at("L2"))));

    // Set, kept, and found again with its devices.
    EXPECT_EQ(cell.project().robots[0].arrival_covariance, measured->arrival_covariance);
    EXPECT_GT(cell.project().robots[0].arrival_covariance(0, 0), 0);
    EXPECT_TRUE(cell.project().robots[0].arrival_covariance.bottomRows<3>().isZero());
    const auto stored = stored_robot_study(cell.station().file(), "R1");
    ASSERT_TRUE(stored && *stored);
    EXPECT_EQ((*stored)->study.rp_mm, s.rp_mm);
    EXPECT_TRUE((*stored)->source.simulated);
    EXPECT_EQ((*stored)->source.robot_serial, "SIM-1");
    const auto json = robot_study_json(**stored);
    EXPECT_EQ(json["spots"].size(), 2u);
    EXPECT_EQ(json["source"]["simulated"], true);
    EXPECT_EQ(json["components_measured"], s.seen);

    ASSERT_TRUE(undo_robot_study(cell.station(), "R1"));
    EXPECT_TRUE(cell.project().robots[0].arrival_covariance.isZero(0));
    EXPECT_TRUE(cell.station().file().check().empty());
}

TEST(MeasureRobot, ChoosesSpotsThatTogetherSeeAllDirections) {
    StudyCell cell({}, 4);
    MeasureRobotOptions options;
    options.returns = 5;
    options.profiles = 2;
    options.keep = false;
    const auto measured = measure_robot(cell.station(), options);
    ASSERT_TRUE(measured) << measured.error().sentence();
    EXPECT_GE(measured->study.spots.size(), 2u);
    EXPECT_TRUE(measured->study.unseen.empty());
    EXPECT_TRUE(measured->utc.empty());
    EXPECT_TRUE(cell.project().robots[0].arrival_covariance.isZero(0)) << "a dry run sets nothing";
    EXPECT_TRUE(cell.station().file().evidence()->empty());
    EXPECT_FALSE(undo_robot_study(cell.station(), ""));
}

// The end of a contour falls on a pixel and stays on it while the robot stands: no scatter there tells of its error.
TEST(MeasureRobot, AFeatureThatErrsWithThePlaceIsNamed) {
    StudyCell cell({}, 4);
    MeasureRobotOptions options;
    options.spot_ids = {"L2"};
    options.returns = 10;
    options.profiles = 3;
    options.keep = false;
    const auto by_end = measure_robot(cell.station(), options);
    ASSERT_TRUE(by_end) << by_end.error().sentence();
    const auto named = [](const MeasuredRobot& m) {
        return std::any_of(m.source.remarks.begin(), m.source.remarks.end(), [](const Text& remark) {
            return remark.english().find("errs with the place") != std::string::npos;
        });
    };
    EXPECT_TRUE(named(*by_end)) << by_end->returns.spots[0].stated_mm.transpose();
    cell.teach_template("L2");
    const auto by_template = measure_robot(cell.station(), options);
    ASSERT_TRUE(by_template) << by_template.error().sentence();
    EXPECT_FALSE(named(*by_template));
}

TEST(MeasureRobot, Refuses) {
    StudyCell cell({}, 5);
    const auto refused = [&](const char* part, const auto& spoil) {
        MeasureRobotOptions options;
        options.spot_ids = {"L2"};
        spoil(options);
        const auto measured = measure_robot(cell.station(), options);
        ASSERT_FALSE(measured) << part;
        EXPECT_THAT(measured.error().sentence(), HasSubstr(part));
    };
    refused("4 returns", [](auto& o) { o.returns = 4; });
    refused("1 profiles", [](auto& o) { o.profiles = 1; });
    refused("no spot \"X\"", [](auto& o) { o.spot_ids = {"L2", "X"}; });
    refused("cancelled", [](auto& o) {
        std::stop_source stop;
        stop.request_stop();
        o.cancel = stop.get_token();
    });
    cell.station().disconnect();
    refused("not connected", [](auto&) {});
}

TEST(MeasureTrigger, FindsTheSimulatedTrigger) {
    const StudyTruth truth;
    StudyCell cell(truth, 6);
    cell.teach_template("L2");
    MeasureTriggerOptions options;
    options.spot_id = "L2";
    options.travel_deg = 45;
    const auto measured = measure_trigger(cell.station(), options);
    ASSERT_TRUE(measured) << measured.error().sentence();
    ASSERT_TRUE(measured->study) << measured->unseen.english();
    const TriggerStudy& s = *measured->study;
    EXPECT_EQ(s.speeds_mm_s, (std::vector<double>{25, 50, 100}));
    EXPECT_TRUE(s.latency_limits_ms.contains(truth.latency_ms)) << s.latency_ms;
    EXPECT_TRUE(s.jitter_limits_ms.contains(truth.jitter_ms())) << s.jitter_ms;
    EXPECT_NEAR(s.half_width_mm(100), truth.jitter_mm, 0.4);
    EXPECT_EQ(cell.project().robots[0].trigger_latency_ms, s.latency_ms);
    for (const Spot& spot : cell.project().spots)
        EXPECT_NEAR(spot.jitter_mm, s.half_width_mm(spot.speed_mm_s), 1e-12) << spot.id;
    const auto stored = stored_trigger_study(cell.station().file());
    ASSERT_TRUE(stored && *stored);
    EXPECT_EQ((*stored)->study->latency_ms, s.latency_ms);
    EXPECT_EQ(trigger_study_json(**stored)["replaced_jitter_mm"]["L2"], 3);

    ASSERT_TRUE(undo_trigger_study(cell.station()));
    EXPECT_EQ(cell.project().robots[0].trigger_latency_ms, 0);
    for (const Spot& spot : cell.project().spots) EXPECT_EQ(spot.jitter_mm, 3);
    EXPECT_TRUE(cell.station().file().check().empty());
}

// The end of a contour again: in motion it falls on other pixels than where the robot stops.
TEST(MeasureTrigger, AFeatureThatErrsWithThePlaceIsNamed) {
    const auto remarks = [](bool by_template) {
        StudyCell cell({}, 6);
        if (by_template) cell.teach_template("L2");
        MeasureTriggerOptions options;
        options.spot_id = "L2";
        options.travel_deg = 45;
        options.keep = false;
        const auto measured = measure_trigger(cell.station(), options);
        EXPECT_TRUE(measured && measured->study);
        std::string said;
        if (measured)
            for (const Text& remark : measured->source.remarks) said += remark.english() + "\n";
        return said;
    };
    EXPECT_THAT(remarks(false), HasSubstr("errs by the pixel"));
    EXPECT_THAT(remarks(true), testing::Not(HasSubstr("errs by the pixel")));
}

TEST(MeasureTrigger, AContourAlongTheTravelIsRefusedAndThePassNamed) {
    StudyCell cell({}, 7);
    MeasureTriggerOptions options;
    options.spot_id = "L2";
    const auto measured = measure_trigger(cell.station(), options);
    ASSERT_TRUE(measured) << measured.error().sentence();
    EXPECT_FALSE(measured->study);
    EXPECT_THAT(measured->unseen.english(), HasSubstr("--travel-deg 45"));
    EXPECT_TRUE(cell.station().file().evidence()->empty());
    EXPECT_EQ(cell.project().spots[0].jitter_mm, 3);
    EXPECT_EQ(trigger_study_json(*measured)["status"], "not_seen");
}

TEST(MeasureTrigger, TheRoundGoesThereAndBackAtEverySpeed) {
    StudyCell cell({}, 8);
    const Spot& spot = *find_spot(cell.project(), "L2");
    const Pose& flange_from_sensor = cell.project().calibrations[0].flange_from_sensor;
    const auto moves = trigger_moves(spot, flange_from_sensor, 0, {50, 100, 200});
    ASSERT_EQ(moves.size(), 8u);
    EXPECT_EQ(moves[0].spot_id, "L2_F0");
    EXPECT_TRUE(moves[0].stop_at_trigger);
    EXPECT_EQ(moves[7].spot_id, "L2_B200");
    const MeasuringMove as_in_a_run = measuring_move(spot, flange_from_sensor);
    for (std::size_t i = 0; i < moves.size(); ++i) {
        EXPECT_LT(distance_mm(moves[i].trigger, spot.base_from_flange), 1e-12);
        EXPECT_LT(distance_mm(i % 2 ? moves[i].exit : moves[i].entry, as_in_a_run.entry), 1e-9);
        EXPECT_LT(distance_mm(i % 2 ? moves[i].entry : moves[i].exit, as_in_a_run.exit), 1e-9);
        EXPECT_LT(angle_rad(moves[i].entry, moves[i].exit), 1e-12) << "the orientation is held";
        if (i == 0) continue;
        EXPECT_LT(distance_mm(moves[i - 1].exit, moves[i].entry), 1e-12) << "no way between the passes";
    }
}

TEST(MeasureTrigger, Refuses) {
    StudyCell cell({}, 9);
    const auto refused = [&](const char* part, const auto& spoil) {
        MeasureTriggerOptions options;
        options.spot_id = "L2";
        options.travel_deg = 45;
        spoil(options);
        const auto measured = measure_trigger(cell.station(), options);
        ASSERT_FALSE(measured) << part;
        EXPECT_THAT(measured.error().sentence(), HasSubstr(part));
    };
    refused("2 speeds", [](auto& o) { o.speeds_mm_s = {50, 100}; });
    refused("3 speeds", [](auto& o) { o.speeds_mm_s = {50, 50, 100}; });
    refused("plausible", [](auto& o) { o.speeds_mm_s = {50, -1, 100}; });
    refused("plausible", [](auto& o) { o.speeds_mm_s = {50, 60, 1e9}; });
    refused("1 passes", [](auto& o) { o.passes = 1; });
    refused("90", [](auto& o) { o.travel_deg = std::nan(""); });
    refused("no spot \"X\"", [](auto& o) { o.spot_id = "X"; });
    cell.station().disconnect();
    refused("not connected", [](auto&) {});
}

}  // namespace
}  // namespace seamwright
