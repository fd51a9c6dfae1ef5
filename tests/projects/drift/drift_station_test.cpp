// The drift watch beside a station, on the exact cell: W1 is fixed, and what is wrong with the sensor is put there by hand.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "projects/drift/drift_edits.h"
#include "projects/drift/drift_keeper.h"
#include "projects/drift/drift_point.h"
#include "projects/proof/replay.h"
#include "projects/reuse/part_type_edits.h"
#include "projects/station/check.h"
#include "projects/station/watch.h"
#include "tests/projects/fake_cell.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

class DriftStation : public testing::Test {
  protected:
    void SetUp() override {
        cell->noise_mm = 0.05;
        Project p = cell->project;
        Spot w = p.spots.front();
        w.id = "W1";
        p.spots.push_back(w);
        ASSERT_TRUE(set_drift_watch(p, {.spot_ids = {"W1"}}));
        cell->project = p;
        auto file = ProjectFile::create(folder / "cell.seam", p, true);
        ASSERT_TRUE(file) << file.error().sentence();
        station.emplace(std::move(*file), p);
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        sensors["A"] = std::make_unique<FakeSensor>(*cell);
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        robots["R1"] = std::make_unique<FakeRobot>(*cell);
        station->connect(std::move(sensors), std::move(robots));
    }
    // The sensor stands off by that, in its own frame, at every spot.
    void shift_sensor(const Eigen::Vector3d& by) {
        const Pose& f = cell->project.calibrations.front().flange_from_sensor;
        for (const Spot& spot : cell->project.spots)
            cell->actual[spot.id] =
                spot.base_from_flange * f * make_pose(Eigen::Matrix3d::Identity(), by) * f.inverse();
    }
    RunRecord part(bool push = true) {
        RunOptions options;
        options.push = push;
        auto run = station->run(options);
        EXPECT_TRUE(run) << run.error().sentence();
        return run ? *run : RunRecord{};
    }
    void learn(int parts = 30) {
        for (int i = 0; i < parts; ++i) part(false);
        Project p = station->project();
        const auto points = station->file().drift_points();
        ASSERT_EQ(points->size(), static_cast<std::size_t>(parts));
        const auto learnt = learn_drift_watch(p, *points, 0, utc_now());
        ASSERT_TRUE(learnt) << learnt.error().sentence();
        ASSERT_TRUE(station->edit(p));
    }
    // As another program does, while this one runs.
    void acknowledge() {
        auto file = ProjectFile::open(folder / "cell.seam");
        Project p = *file->load();
        const auto done = acknowledge_step(p, *file->drift_points(), "Ada", "tightened", utc_now());
        ASSERT_TRUE(done) << done.error().sentence();
        ASSERT_TRUE(file->save(p));
    }

    TemporaryFolder folder;
    std::unique_ptr<FakeCell> cell = make_fake_cell();
    std::optional<Station> station;
};

TEST_F(DriftStation, ABumpStopsProductionUntilAPersonAcknowledges) {
    learn();
    EXPECT_EQ(part().status, RunStatus::ok);
    const int writes = cell->writes;
    shift_sensor({0.8, 0, 0.6});
    const RunRecord bumped = part();
    EXPECT_EQ(bumped.status, RunStatus::refused);
    EXPECT_THAT(bumped.message.english(), HasSubstr("the drift watch stopped production: a step of"));
    EXPECT_EQ(cell->writes, writes) << "no frame is written";
    EXPECT_TRUE(station->drift().stopped);
    bool alarm = false;
    for (const EventRecord& e : bumped.events)
        alarm = alarm || (e.kind == EventKind::alarm && e.subject == "drift watch");
    EXPECT_TRUE(alarm);
    // Put back, it stays stopped: nobody has looked.
    cell->actual.clear();
    EXPECT_EQ(part().status, RunStatus::refused);
    EXPECT_EQ(cell->writes, writes);
    acknowledge();
    EXPECT_EQ(part().status, RunStatus::ok) << station->drift().text.english();
    EXPECT_FALSE(station->drift().stopped);
    // Acknowledged without mending it: the next point stops it again.
    shift_sensor({0.8, 0, 0.6});
    EXPECT_EQ(part().status, RunStatus::refused);
    acknowledge();
    EXPECT_EQ(part().status, RunStatus::refused) << "what stands elsewhere is never taken for the new place";
}

// The reference as a part type of its own, which the robot calls between the parts.
TEST_F(DriftStation, AReferenceWithoutRegionsIsMeasuredWhereOthersArePushed) {
    Project p = *add_part_type(station->project(), {"door", "", 1});
    p.part_types.push_back({"reference", "", 9});
    p.spots.back().type_id = "reference";
    ASSERT_TRUE(station->edit(p));
    cell->project = p;
    EXPECT_EQ(runnable_type(p, "reference", true).value_or(""), "reference");
    RunOptions options;
    options.push = true;
    options.part_type = "9";
    const auto run = station->run(options);
    ASSERT_TRUE(run) << run.error().sentence();
    EXPECT_EQ(run->status, RunStatus::ok);
    EXPECT_EQ(run->message.english(), "measured; there is no region to correct");
    EXPECT_FALSE(run->push) << "nothing is told to have been pushed";
    EXPECT_EQ(cell->writes, 0);
    EXPECT_EQ(station->file().drift_points()->size(), 1u);
    options.part_type = "door";
    EXPECT_TRUE(station->run(options)->push);
    p.drift.reset();
    EXPECT_FALSE(runnable_type(p, "reference", true)) << "no reference: a type that was forgotten";
}

TEST_F(DriftStation, AStopOutlivesTheProgram) {
    learn();
    shift_sensor({0.8, 0, 0.6});
    EXPECT_EQ(part().status, RunStatus::refused);
    cell->actual.clear();
    const auto reading = ProjectFile::open(folder / "cell.seam", FileAccess::read_only);
    ASSERT_TRUE(reading);
    const auto standing = stored_standing(*reading, *reading->load(), utc_now());
    ASSERT_TRUE(standing);
    EXPECT_TRUE(standing->stopped);
    EXPECT_EQ(standing->verdict, DriftVerdict::step);
    station->disconnect();
    auto again = Station::open(folder / "cell.seam");
    std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
    sensors["A"] = std::make_unique<FakeSensor>(*cell);
    std::map<std::string, std::unique_ptr<RobotLink>> robots;
    robots["R1"] = std::make_unique<FakeRobot>(*cell);
    again->connect(std::move(sensors), std::move(robots));
    RunOptions options;
    options.push = true;
    EXPECT_EQ(again->run(options)->status, RunStatus::refused);
}

TEST_F(DriftStation, ADriftIsNamedAndCompensatedOnlyWhereAPersonSwitchedItOn) {
    learn();
    int named = 0;
    for (int i = 1; i <= 20; ++i) {
        shift_sensor({0.02 * i, 0, -0.02 * i});
        const RunRecord run = part();
        EXPECT_FALSE(run.regions.front().drift->compensated) << "off until a person switches it on";
        if (!named && station->drift().change == DriftChange::drift) named = i;
    }
    EXPECT_GT(named, 0) << station->drift().text.english();
    EXPECT_FALSE(station->drift().stopped);
    EXPECT_EQ(station->drift().verdict, DriftVerdict::recalibrate) << "0.4 mm off";

    Project p = station->project();
    ASSERT_TRUE(switch_compensation(p, *station->file().drift_points(), true, DriftOf::sensor, 1, utc_now()));
    ASSERT_TRUE(station->edit(p));
    RunRecord last;
    for (int i = 0; i < 8; ++i) last = part();  // it has come to rest
    ASSERT_TRUE(last.regions.front().drift);
    EXPECT_TRUE(last.regions.front().drift->compensated);
    EXPECT_THAT(said_of(*last.regions.front().drift).english(), HasSubstr("mm are taken off"));
    // The sensor moved by +: what it sees moved by -.
    EXPECT_NEAR(last.regions.front().drift->shift_mm.x(), -0.4, 0.08);
    EXPECT_NEAR(last.regions.front().drift->shift_mm.z(), 0.4, 0.08);
    EXPECT_LT(
        last.regions.front().correction->displacement.workobject_from_movedworkobject.translation().norm(),
        0.1)
        << "nothing was displaced";
    const auto stored = station->file().load_run(last.number);
    ASSERT_TRUE(stored) << stored.error().sentence();
    EXPECT_TRUE(stored->regions.front().drift->compensated);
    const auto replayed = replay(folder / "cell.seam", {});
    ASSERT_TRUE(replayed) << replayed.error().sentence();
    EXPECT_TRUE(replayed->differences.empty());

    // Beyond what may be taken off nothing is pushed.
    p = station->project();
    ASSERT_TRUE(
        switch_compensation(p, *station->file().drift_points(), true, DriftOf::sensor, 0.2, utc_now()));
    ASSERT_TRUE(station->edit(p));
    const RunRecord beyond = part();
    EXPECT_EQ(beyond.status, RunStatus::refused);
    EXPECT_THAT(beyond.message.english(), HasSubstr("beyond what may be compensated"));

    ASSERT_TRUE(switch_compensation(p, {}, false, DriftOf::sensor, 1, utc_now()));
    ASSERT_TRUE(station->edit(p));
    EXPECT_FALSE(part().regions.front().drift->compensated);
    EXPECT_TRUE(station->file().check().empty());
}

TEST_F(DriftStation, AnOldWatchCompensatesNothing) {
    learn();
    Project p = station->project();
    p.drift->compensate = true;
    const auto points = station->file().drift_points();
    EXPECT_TRUE(drift_standing(p, *points, points->back().utc, 0).acting.compensated);
    const DriftStanding due = drift_standing(p, *points, points->back().utc, 1);
    EXPECT_TRUE(due.due);
    EXPECT_TRUE(due.acting.compensated);
    const DriftStanding old = drift_standing(p, *points, points->back().utc, 2);
    EXPECT_TRUE(old.old);
    EXPECT_FALSE(old.acting.compensated);
    EXPECT_FALSE(old.acting.why.empty());
}

TEST_F(DriftStation, APointOfAnotherPoseOrCalibrationIsNotCompared) {
    learn();
    Project p = station->project();
    p.spots.back().base_from_flange.translation().x() += 1;
    ASSERT_TRUE(station->edit(p));
    cell->project = p;
    part();
    EXPECT_EQ(station->file().drift_points()->back().verdict, DriftVerdict::learning);
    EXPECT_FALSE(station->drift().stopped);
}

TEST_F(DriftStation, WrongWatchesAreRefused) {
    const auto refused = [&](const DriftSettings& settings, const char* why) {
        Project p = station->project();
        const auto set = set_drift_watch(p, settings);
        ASSERT_FALSE(set) << why;
        EXPECT_THAT(set.error().sentence(), HasSubstr(why));
    };
    refused({.spot_ids = {"nobody"}}, "has no spot nobody");
    refused({.spot_ids = {"W1", "W1"}}, "twice");
    refused({.spot_ids = {station->project().regions.front().spot_ids.front()}}, "moves with the part");
    refused({.limit_mm = 0}, "limit_mm");
    refused({.limit_mm = std::numeric_limits<double>::quiet_NaN()}, "limit_mm");
    refused({.every_parts = -1}, "every_parts");
    refused({.pause_minutes = 1e9}, "pause_minutes");
    Project p = station->project();
    EXPECT_FALSE(learn_drift_watch(p, {}, 0, utc_now())) << "no point";
    EXPECT_FALSE(switch_compensation(p, {}, true, DriftOf::sensor, 0.3, utc_now())) << "nothing is learnt";
    EXPECT_FALSE(acknowledge_step(p, {}, "Ada", "", utc_now())) << "no step";
    p.drift.reset();
    EXPECT_FALSE(switch_compensation(p, {}, false, DriftOf::sensor, 0.3, utc_now()));
    p = station->project();
    p.regions.front().spot_ids.push_back("W1");
    bool found = false;
    for (const Error& e : check(p)) found = found || e.sentence().find("drift watch") != std::string::npos;
    EXPECT_TRUE(found);
}

// Two references from different sides: a drift of the robot is one of the robot, and none of the sensor.
TEST(DriftShift, ReferencesFromDifferentSidesTellSensorFromRobot) {
    const auto cell = make_fake_cell();
    Project p = cell->project;
    DriftWatch watch;
    Spot w1 = p.spots.front(), w2 = w1;
    w1.id = "W1";
    w2.id = "W2";
    w2.base_from_flange.linear() = w2.base_from_flange.linear() * rotation_exp({0, 0, 1.5});
    p.spots.push_back(w1);
    p.spots.push_back(w2);
    watch.spot_ids = {"W1", "W2"};
    LearntDrift& learnt = watch.learnt.emplace();
    std::vector<double> level, sigma(4, 0.01);
    const Eigen::Vector3d shift(0.1, -0.2, 0.15);
    for (const Spot& spot : {w1, w2}) {
        const Eigen::Vector3d seen =
            (spot.base_from_flange * p.calibrations.front().flange_from_sensor).linear().transpose() * shift;
        for (const int axis : {0, 2}) {
            learnt.directions.push_back({spot.id, axis, 0, 0.01, 0, 0});
            level.push_back(seen[axis]);
        }
    }
    watch.drifts = DriftOf::robot;
    const auto robot = drift_shift(p, watch, level, sigma);
    ASSERT_TRUE(robot);
    EXPECT_NEAR((robot->shift_mm - shift).norm(), 0, 1e-9);
    EXPECT_GT(robot->probability, 0.5);
    watch.drifts = DriftOf::sensor;
    const auto sensor = drift_shift(p, watch, level, sigma);
    ASSERT_TRUE(sensor);
    EXPECT_LT(sensor->probability, 0.001);
    EXPECT_FALSE(drift_shift(p, watch, std::vector<double>(3), sigma));
}

}  // namespace
}  // namespace seamwright
