#include "projects/station/station.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "projects/gate/safety_gate.h"
#include "projects/measure/measure.h"
#include "projects/proof/replay.h"
#include "projects/station/check.h"
#include "tests/projects/fake_cell.h"
#include "tests/projects/file/other_program.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using testing::Contains;
using testing::HasSubstr;

class StationRun : public testing::Test {
  protected:
    void SetUp() override {
        cell->workobject_from_movedworkobject = make_pose(rotation_exp({0.006, -0.004, 0.009}), {3, -4, 2.5});
        connect();
    }
    void connect() {
        station.reset();
        auto file = ProjectFile::create(folder / "cell.seam", cell->project, true);
        ASSERT_TRUE(file) << file.error().sentence();
        station.emplace(std::move(*file), cell->project);
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        sensors["A"] = std::make_unique<FakeSensor>(*cell);
        sensor = static_cast<FakeSensor*>(sensors["A"].get());
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        robots["R1"] = std::make_unique<FakeRobot>(*cell);
        station->connect(std::move(sensors), std::move(robots));
    }
    RunRecord run(bool push = true) {
        options.push = push;
        options.part_id = "car 1";
        auto record = station->run(options);
        EXPECT_TRUE(record) << record.error().sentence();
        EXPECT_FALSE(sensor->started) << "sensors stop with the run";
        auto stored = station->file().load_run(record->number);
        EXPECT_TRUE(stored) << stored.error().sentence();
        // What run() hands back is what the file holds.
        EXPECT_EQ(stored->status, record->status);
        EXPECT_EQ(stored->message, record->message);
        EXPECT_EQ(stored->spots.size(), record->spots.size());
        for (std::size_t i = 0; i < stored->regions.size(); ++i)
            EXPECT_EQ(exact_text(stored->regions[i]), exact_text(record->regions[i]));
        EXPECT_EQ(stored->events.size(), record->events.size());
        // And what the file holds can be computed again.
        auto again = recompute(*stored, *station->file().load_run_setup(record->number));
        EXPECT_TRUE(again);
        EXPECT_TRUE(compare(*stored, *again).empty()) << compare(*stored, *again).front().text;
        return *record;
    }
    void expect_nothing_written() {
        EXPECT_EQ(cell->writes, 0);
        for (const Region& region : cell->project.regions)
            EXPECT_TRUE(cell->frames[region.frame_name].isApprox(region.base_from_frame, 1e-15));
    }
    TemporaryFolder folder;
    std::unique_ptr<FakeCell> cell = make_fake_cell();
    std::optional<Station> station;
    FakeSensor* sensor = nullptr;
    RunOptions options;
};

TEST_F(StationRun, FindsTheDisplacementAndMovesTheFramesWithThePart) {
    const RunRecord record = run();
    EXPECT_EQ(record.status, RunStatus::ok) << record.message;
    ASSERT_EQ(record.regions.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        const RegionRecord& region = record.regions[i];
        ASSERT_TRUE(region.correction);
        const Pose& d = region.correction->displacement.workobject_from_movedworkobject;
        EXPECT_LT(distance_mm(d, cell->workobject_from_movedworkobject), 1e-6);
        EXPECT_LT(angle_rad(d, cell->workobject_from_movedworkobject), 1e-9);
        EXPECT_TRUE(region.gate_passed);
        EXPECT_EQ(region.push.status, PushStatus::written);
        // The path point that sat on the part sits on it again.
        const Region& taught = cell->project.regions[i];
        const Pose& wo = cell->project.part.base_from_workobject;
        const Eigen::Vector3d path_point(120, -40, 60);
        const Eigen::Vector3d on_part = wo.inverse() * taught.base_from_frame * path_point;
        const Eigen::Vector3d after = wo * cell->workobject_from_movedworkobject * on_part;
        EXPECT_LT((cell->frames[taught.frame_name] * path_point - after).norm(), 1e-6);
    }
    EXPECT_EQ(cell->writes, 2);
    EXPECT_EQ(record.captures.size(), 6u);
}

TEST_F(StationRun, AProjectFileThatIsReplacedDuringTheRunIsToldBeforeAnythingIsSent) {
    const auto path = folder / "cell.seam";
    for (const bool deleted : {false, true})
        for (const bool asked : {false, true}) {
            connect();
            const auto take_away = [&] {
                if (deleted) {
                    std::filesystem::remove(path);
                } else if (std::filesystem::exists(path)) {
                    ASSERT_TRUE(ProjectFile::create(folder / "other.seam", cell->project, true));
                    std::filesystem::rename(folder / "other.seam", path);
                }
            };
            options = {};
            options.push = true;
            if (asked)
                options.confirm_push = [&](const RunRecord&) {
                    take_away();
                    return true;
                };
            else
                options.progress = [&](const RunProgress& progress) {
                    if (progress.done == 3) take_away();
                };
            const auto record = station->run(options);
            ASSERT_FALSE(record) << deleted << asked;
            EXPECT_EQ(record.error().kind, ErrorKind::file);
            EXPECT_THAT(record.error().sentence(), HasSubstr("replaced or deleted while it was in use"));
            expect_nothing_written();
        }
}

TEST_F(StationRun, DryRunWritesNothing) {
    const RunRecord record = run(false);
    EXPECT_EQ(record.status, RunStatus::ok);
    EXPECT_TRUE(record.regions[0].gate_passed);
    EXPECT_EQ(record.regions[0].push.status, PushStatus::not_pushed);
    EXPECT_FALSE(record.regions[0].base_from_frame.isApprox(cell->project.regions[0].base_from_frame, 1e-6));
    expect_nothing_written();
}

TEST_F(StationRun, ReportedPosesTakeTheRobotOutOfTheMeasurement) {
    std::mt19937 rng(5);
    std::normal_distribution<double> n;
    for (const Spot& spot : cell->project.spots) {
        Vector6 d;
        for (int i = 0; i < 6; ++i) d[i] = i < 3 ? n(rng) : 2e-3 * n(rng);
        cell->reported[spot.id] = cell->actual[spot.id] = retract(spot.base_from_flange, d);
    }
    const RunRecord record = run();
    ASSERT_TRUE(record.regions[0].correction);
    const Pose& d = record.regions[0].correction->displacement.workobject_from_movedworkobject;
    EXPECT_LT(distance_mm(d, cell->workobject_from_movedworkobject), 1e-6);
    EXPECT_LT(angle_rad(d, cell->workobject_from_movedworkobject), 1e-9);
    EXPECT_TRUE(record.spots[0].pose_reported);
    EXPECT_GT(std::abs(record.spots[0].measured_mm.y()), 1e-3);
}

TEST_F(StationRun, DamagedFrameIsReportedNeverMeasured) {
    cell->damaged_at = "S3";
    const RunRecord record = run();
    EXPECT_EQ(record.spots[2].status, SpotStatus::damaged_frame);
    EXPECT_EQ(record.status, RunStatus::refused);
    EXPECT_THAT(record.regions[0].refusals, Contains(HasSubstr("required spot S3 was not measured")));
    EXPECT_EQ(record.captures[2].status, FrameStatus::incomplete);
    EXPECT_EQ(record.captures[2].profile.size(), 0u);
    expect_nothing_written();
}

TEST_F(StationRun, OptionalSpotMayFail) {
    cell->project.spots[2].required = false;
    connect();
    cell->empty_at = "S3";
    const RunRecord record = run();
    EXPECT_EQ(record.spots[2].status, SpotStatus::no_stripe);
    EXPECT_EQ(record.status, RunStatus::ok) << record.message;
    EXPECT_EQ(cell->writes, 2);
}

TEST_F(StationRun, SilentSensorEndsTheRunWithoutPush) {
    cell->silent_sensor_at = "S4";
    const RunRecord record = run();
    EXPECT_EQ(record.status, RunStatus::device);
    EXPECT_THAT(record.message, HasSubstr("silent"));
    EXPECT_EQ(record.spots[2].status, SpotStatus::measured);
    EXPECT_EQ(record.spots[3].status, SpotStatus::not_measured);
    EXPECT_FALSE(record.regions[0].gate_passed);
    expect_nothing_written();
}

TEST_F(StationRun, SilentRobotEndsTheRunWithoutPush) {
    cell->silent_robot_at = "S2";
    const RunRecord record = run();
    EXPECT_EQ(record.status, RunStatus::device);
    EXPECT_EQ(record.captures.size(), 1u);
    EXPECT_EQ(record.spots.back().message.english(), "no frame came");
    expect_nothing_written();
}

TEST_F(StationRun, CancelledInTheMiddle) {
    std::stop_source stop;
    options.cancel = stop.get_token();
    cell->on_trigger = [&](const std::string& spot) {
        if (spot == "S3") stop.request_stop();
    };
    const RunRecord record = run();
    EXPECT_EQ(record.status, RunStatus::cancelled);
    EXPECT_EQ(record.captures.size(), 2u);  // the third spot's frame is not waited for
    EXPECT_THAT(record.spots.back().message.english(), testing::HasSubstr("cancelled"));
    EXPECT_THAT(cell->verdicts, testing::ElementsAre(PartVerdict::failed));
    expect_nothing_written();
}

TEST_F(StationRun, TheRobotIsToldHowThePartEnded) {
    run(true);
    EXPECT_THAT(cell->verdicts, testing::ElementsAre(PartVerdict::corrected));
    run(false);
    EXPECT_EQ(cell->verdicts.back(), PartVerdict::refused) << "a dry run releases nothing";
    cell->silent_sensor_at = "S2";
    run(true);
    EXPECT_EQ(cell->verdicts.back(), PartVerdict::failed);
    cell->silent_sensor_at.clear();
    cell->empty_at = "S1";
    run(true);
    EXPECT_EQ(cell->verdicts.back(), PartVerdict::refused);
}

TEST_F(StationRun, RobotThatDoesNotAcknowledgeHasItsFramesRestored) {
    cell->deaf_to = PartVerdict::corrected;
    const RunRecord record = run();
    EXPECT_EQ(record.status, RunStatus::alarm);
    EXPECT_THAT(record.message, HasSubstr("acknowledge"));
    EXPECT_THAT(cell->verdicts, testing::ElementsAre(PartVerdict::corrected, PartVerdict::failed));
    for (const Region& region : cell->project.regions)
        EXPECT_TRUE(cell->frames[region.frame_name].isApprox(region.base_from_frame, 1e-15));
    for (const RegionRecord& region : record.regions) EXPECT_EQ(region.push.status, PushStatus::restored);
}

TEST_F(StationRun, FrameOfAnotherSpotIsDropped) {
    cell->wrong_spot_at = "S2";
    const RunRecord record = run();
    EXPECT_EQ(record.status, RunStatus::ok);
    EXPECT_EQ(record.events.front().kind, EventKind::device);
}

TEST_F(StationRun, ExchangedSensorIsRefused) {
    cell->sensor_identity.serial = "0009";
    const RunRecord record = run();
    EXPECT_EQ(record.status, RunStatus::refused);
    EXPECT_THAT(record.regions[0].refusals, Contains(HasSubstr("0009")));
    expect_nothing_written();
}

TEST_F(StationRun, RobotInAnotherModeIsRefused) {
    cell->mode = RobotMode::manual_reduced;
    EXPECT_EQ(run().status, RunStatus::refused);
    expect_nothing_written();
}

TEST_F(StationRun, OneRefusedRegionHoldsBackTheOthers) {
    cell->project.regions[1].limits.translation_mm = 1;
    connect();
    const RunRecord record = run();
    EXPECT_EQ(record.status, RunStatus::refused);
    EXPECT_TRUE(record.regions[0].gate_passed);
    expect_nothing_written();
}

TEST_F(StationRun, SecondPushGoingWrongTakesTheFirstBack) {
    for (const bool spoil : {true, false}) {
        (spoil ? cell->write_spoils : cell->write_fails) = "BASE_outer";
        connect();
        const RunRecord record = run();
        EXPECT_EQ(record.status, RunStatus::alarm);
        EXPECT_EQ(record.regions[0].push.status, PushStatus::restored) << record.regions[0].push.message;
        EXPECT_EQ(record.regions[1].push.status, PushStatus::restored) << record.regions[1].push.message;
        for (const Region& region : cell->project.regions)
            EXPECT_LT(distance_mm(cell->frames[region.frame_name], region.base_from_frame), 1e-9);
        cell->write_spoils.clear();
    }
}

TEST_F(StationRun, CapturesAreInTheFileWhileTheRobotTravels) {
    int seen = 0;
    options.progress = [&](const RunProgress& progress) {
        if (progress.done == 0 || progress.text.english().starts_with("region") ||
            progress.text.english().starts_with("robot"))
            return;
        ++seen;
        auto reader = ProjectFile::open(folder / "cell.seam", FileAccess::read_only);
        ASSERT_TRUE(reader) << reader.error().sentence();
        const RunSummary now = reader->runs()->back();
        EXPECT_EQ(now.status, RunStatus::interrupted);
        EXPECT_EQ(now.captures, progress.done - 1) << "all but the one that just came";
        EXPECT_EQ(now.spots, progress.done - 1);
        EXPECT_TRUE(reader->check().empty());
        const auto stored = reader->load_run(now.number);
        ASSERT_TRUE(stored) << stored.error().sentence();
        auto again = recompute(*stored, cell->project);
        ASSERT_TRUE(again) << again.error().sentence();
    };
    const RunRecord record = run();
    EXPECT_EQ(seen, static_cast<int>(record.spots.size()));
    const auto stored = station->file().load_run(record.number);
    ASSERT_TRUE(stored);
    EXPECT_EQ(stored->status, RunStatus::ok);
    ASSERT_EQ(stored->captures.size(), record.captures.size());
    for (std::size_t i = 0; i < record.captures.size(); ++i)
        EXPECT_TRUE(same_bits(stored->captures[i], record.captures[i])) << i;
    EXPECT_TRUE(compare(*stored, *recompute(*stored, cell->project)).empty());
}

TEST_F(StationRun, WhatALinkTellsIsInTheRunsEvents) {
    cell->notices = {"1 connections of an unknown peer were refused"};
    const RunRecord record = run();
    const auto events = station->file().events(record.number);
    ASSERT_TRUE(events);
    EXPECT_TRUE(std::any_of(events->begin(), events->end(), [](const EventRecord& e) {
        return e.kind == EventKind::device && e.subject == "R1" &&
               e.text == "1 connections of an unknown peer were refused";
    }));
}

TEST_F(StationRun, MeasuredBeforeThePartCameIsStale) {
    // The frame's time lies before the run began: a frame from a buffer.
    class Late : public FakeSensor {
      public:
        using FakeSensor::FakeSensor;
        Expected<FramePtr> wait_next(std::chrono::milliseconds timeout) override {
            auto frame = FakeSensor::wait_next(timeout);
            if (frame) (*frame)->host_time_ns -= 3'600'000'000'000;
            return frame;
        }
    };
    std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
    sensors["A"] = std::make_unique<Late>(*cell);
    sensor = static_cast<FakeSensor*>(sensors["A"].get());
    std::map<std::string, std::unique_ptr<RobotLink>> robots;
    robots["R1"] = std::make_unique<FakeRobot>(*cell);
    station->connect(std::move(sensors), std::move(robots));
    const RunRecord record = run();
    EXPECT_EQ(record.status, RunStatus::refused);
    EXPECT_THAT(record.regions[0].refusals, Contains(HasSubstr("stale")));
    expect_nothing_written();
}

TEST_F(StationRun, WrongSpotIsFoundAndLeftOut) {
    cell->project.spots.clear();
    cell = make_fake_cell(8);
    cell->workobject_from_movedworkobject = make_pose(rotation_exp({0.002, -0.004, 0.003}), {1, -2, 2.5});
    cell->noise_mm = 0.01;
    connect();
    cell->actual["S5"] =
        retract(cell->project.spots[4].base_from_flange, (Vector6() << 3, 3, 3, 0, 0, 0).finished());
    const RunRecord record = run();
    ASSERT_TRUE(record.regions[0].correction) << record.regions[0].refusals.front();
    std::vector<std::string> out;
    for (const SpotResidual& spot : record.regions[0].correction->spots)
        if (!spot.used) out.push_back(spot.id);
    EXPECT_THAT(out, testing::ElementsAre("S5"));
    EXPECT_EQ(record.status, RunStatus::ok) << record.message;
    EXPECT_THAT(record.message, HasSubstr("left out, contradicting the others: S5"));
}

TEST_F(StationRun, ProgressIsTold) {
    std::vector<std::string> told;
    options.progress = [&](const RunProgress& p) {
        told.push_back(std::to_string(p.done) + "/" + std::to_string(p.total));
    };
    run(false);
    EXPECT_THAT(told, testing::ElementsAre("1/6", "2/6", "3/6", "4/6", "5/6", "6/6"));
}

TEST_F(StationRun, RefusesWithoutDevicesOrSpots) {
    station->disconnect();
    EXPECT_FALSE(station->run({}));
    for (Spot& spot : cell->project.spots) spot.enabled = false;
    connect();
    EXPECT_FALSE(station->run({}));
    EXPECT_TRUE(station->file().runs()->empty());
}

TEST_F(StationRun, UnknownDriverIsAnError) {
    auto opened = Station::open(folder / "cell.seam");
    ASSERT_TRUE(opened);
    auto connected = opened->connect();
    ASSERT_FALSE(connected);
    EXPECT_THAT(connected.error().sentence(), HasSubstr("fake"));
    EXPECT_FALSE(opened->connected());
}

TEST_F(StationRun, DevicesThatAnotherProgramHasAreRefusedInOneSentence) {
    const auto path = folder / "cell.seam";
    std::optional<OtherProgram> other(std::in_place, path, FileUse::For::devices);
    ASSERT_TRUE(other->has_it);
    auto second = Station::open(path);
    ASSERT_TRUE(second) << second.error().sentence();
    const auto refused = second->connect();
    ASSERT_FALSE(refused);
    const std::string sentence = refused.error().sentence();
    EXPECT_EQ(refused.error().kind, ErrorKind::usage);
    EXPECT_THAT(sentence, testing::StartsWith(path.string() + ": the devices of the project are in use"));
    EXPECT_THAT(sentence, HasSubstr("process " + std::to_string(other->pid())));
    EXPECT_THAT(sentence, HasSubstr("; disconnect them there"));
    EXPECT_THAT(sentence, testing::Not(HasSubstr("\n")));
    EXPECT_FALSE(second->connected());
    EXPECT_FALSE(second->run({})) << "nothing is commanded";

    // Simulated devices are each program's own.
    Project simulated = second->project();
    for (SensorSetup& setup : simulated.sensors)
        setup.driver = "simulated", setup.settings = nlohmann::json::object();
    for (RobotSetup& setup : simulated.robots)
        setup.driver = "simulated", setup.settings = nlohmann::json::object();
    second->use(simulated);
    const auto own = second->connect();
    EXPECT_TRUE(own) << own.error().sentence();
    second->disconnect();

    other.reset();
    second = Station::open(path);
    ASSERT_TRUE(second);
    const auto free = second->connect();
    ASSERT_FALSE(free) << "this one fails at its first device";
    EXPECT_THAT(free.error().sentence(), HasSubstr("\"fake\""));
    EXPECT_TRUE(FileUse::take(path, FileUse::For::devices)) << "a station that gave up holds nothing";
}

TEST_F(StationRun, PlausibleProjectHasNoFindings) {
    for (const Error& finding : check(cell->project)) ADD_FAILURE() << finding.sentence();
}

}  // namespace
}  // namespace seamwright
