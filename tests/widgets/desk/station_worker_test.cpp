#include "widgets/worker/station_worker.h"

#include <gmock/gmock.h>

#include "devices/exchange/pose_json.h"
#include "devices/simulated/cell.h"
#include "devices/simulated/scene/door.h"
#include "projects/reuse/simulated_truth.h"
#include "tests/widgets/desk/desk_fixture.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

constexpr const char* kFrame = "BASE_top";

// One side of the simulated door; the spots have their features, and no references yet.
Project side_of_a_door() {
    const nlohmann::json settings = {
        {"seed", 4},
        {"robot", {{"frames", {{kFrame, pose_json(default_cell_settings().base_from_workobject)}}}}}};
    const auto cell = SimulatedCell::open(settings).value();
    Project p;
    p.part.base_from_workobject = cell->base_from_workobject();
    SensorSetup sensor;
    sensor.id = "A";
    sensor.driver = "simulated";
    sensor.settings = settings;
    DeviceSession session;
    sensor.identity = (*open_sensor("simulated", settings, session))->identity();
    RobotSetup robot;
    robot.id = "R1";
    robot.driver = "simulated";
    robot.settings = settings;
    robot.identity = (*open_robot("simulated", settings, session))->identity().value();
    p.calibrations = {simulated_truth(sensor, robot).value()};
    sensor.calibration_id = p.calibrations[0].id;
    p.sensors = {sensor};
    p.robots = {robot};
    const DoorRegion side = default_door_regions().front();
    for (const DoorSpot& door : default_door_spots()) {
        if (std::find(side.spot_ids.begin(), side.spot_ids.end(), door.id) == side.spot_ids.end()) continue;
        Spot s;
        s.id = door.id;
        s.sensor_id = "A";
        s.robot_id = "R1";
        s.base_from_flange = cell->flange_for(door.workobject_from_sensor);
        s.feature.kind = "contour-end";
        s.feature.parameters = {{"side", 0}};
        p.spots.push_back(s);
    }
    Region region;
    region.id = side.id;
    region.spot_ids = side.spot_ids;
    region.frame_name = kFrame;
    region.base_from_frame = p.part.base_from_workobject;
    region.sigma_limit_mm = 5;
    region.sigma_limit_deg = 5;
    p.regions = {region};
    return p;
}

class Cancelling : public testing::Test {
  protected:
    TemporaryFolder folder;
    WatchedDesk me;
    Desk& desk = me.desk;
    StationWorker& worker = desk.worker();
    std::vector<std::shared_ptr<const RunRecord>> runs;
    int asked = 0, progress = 0, ended = 0;
    QStringList failures;

    void SetUp() override {
        QObject::connect(&worker, &StationWorker::measured, &desk,
                         [this](const auto& r) { runs.push_back(r); });
        QObject::connect(&worker, &StationWorker::confirm_push, &desk, [this] { ++asked; });
        QObject::connect(&worker, &StationWorker::progressed, &desk, [this] { ++progress; });
        QObject::connect(&worker, &StationWorker::failed, &desk, [this](const QString& s) { failures << s; });
        QObject::connect(&worker, &StationWorker::busy_changed, &desk, [this](bool busy) { ended += !busy; });
        ASSERT_TRUE(desk.create(folder / "a.seam", side_of_a_door()));
        worker.connect_devices();
        ASSERT_TRUE(wait_until([&] { return desk.station().connected; }))
            << me.troubles.join("; ").toStdString();
    }
    // The references, measured as a person has them measured.
    void teach_all() {
        int taught = 0;
        QObject::connect(&worker, &StationWorker::taught, &desk, [&](const auto& t) {
            ++taught;
            EXPECT_TRUE(desk.edit(t->spot));
        });
        for (const Spot& spot : Project(desk.project()).spots) worker.teach(spot, 1);
        ASSERT_TRUE(wait_until([&] { return taught == static_cast<int>(desk.project().spots.size()); }))
            << failures.join("; ").toStdString();
        ASSERT_TRUE(wait_until([&] { return !worker.busy(); }));
        progress = 0;
    }
    bool over() {
        return wait_until([&] { return !worker.busy() && ended > 0; });
    }
    std::vector<RunSummary> stored() const { return desk.runs().value(); }
    static std::size_t measured(const RunRecord& run) {
        return static_cast<std::size_t>(std::count_if(run.spots.begin(), run.spots.end(), [](const auto& s) {
            return s.status == SpotStatus::measured;
        }));
    }
    // Nothing sticks: the next run is a whole one.
    void expect_the_next_run_is_whole() {
        runs.clear();
        worker.measure("next", false, false);
        ASSERT_TRUE(wait_until([&] { return runs.size() == 1; }));
        EXPECT_NE(runs[0]->status, RunStatus::cancelled);
        EXPECT_EQ(measured(*runs[0]), desk.project().spots.size());
    }
};

TEST_F(Cancelling, ADeviceThatIsRenamedStaysConnected) {
    teach_all();
    const int connection = desk.station().connection;
    int interrupted = 0;
    QObject here;
    QObject::connect(&worker, &StationWorker::state_changed, &here,
                     [&](const auto& state) { interrupted += !state->connected; });
    const auto shown = [&](const std::string& sensor, const std::string& robot) {
        return wait_until([&] {
            const StationState& s = desk.station();
            return s.sensors.size() == 1 && s.robots.size() == 1 && s.sensors[0].id == sensor &&
                   s.robots[0].id == robot && s.robots[0].trouble.empty() && desk.live().age(sensor);
        });
    };
    ASSERT_TRUE(desk.rename<SensorSetup>("A", "left"));
    EXPECT_TRUE(shown("left", "R1"));
    EXPECT_FALSE(desk.live().attached("A"));
    ASSERT_TRUE(desk.rename<RobotSetup>("R1", "big"));
    EXPECT_TRUE(shown("left", "big"));
    desk.undo_stack().undo();
    desk.undo_stack().undo();
    EXPECT_TRUE(shown("A", "R1"));
    desk.undo_stack().redo();
    desk.undo_stack().redo();
    ended = 0;
    worker.measure("renamed", false, false);
    ASSERT_TRUE(over());
    ASSERT_EQ(runs.size(), 1U) << failures.join("; ").toStdString();
    EXPECT_EQ(measured(*runs[0]), desk.project().spots.size());
    EXPECT_EQ(interrupted, 0);
    EXPECT_EQ(desk.station().connection, connection) << "nothing was connected anew";
    // One that is not in the project any more is let go of, and all with it.
    for (const Spot& spot : Project(desk.project()).spots) ASSERT_TRUE(desk.remove<Spot>(spot.id));
    ASSERT_TRUE(desk.remove<SensorSetup>("left"));
    EXPECT_TRUE(wait_until([&] { return !desk.station().connected; }));
}

TEST_F(Cancelling, ASensorThatIsAddedIsConnectedWithTheNextConnecting) {
    SensorSetup second = desk.project().sensors.front();
    second.id = "B";
    second.calibration_id.clear();
    second.identity = {};
    ASSERT_TRUE(desk.add(second));
    // What is connected goes on, and is shown by its newest profile.
    const auto before = desk.live().latest("A");
    EXPECT_TRUE(wait_until([&] {
        const auto now = desk.live().latest("A");
        return now && now != before;
    }));
    EXPECT_TRUE(desk.station().connected);
    EXPECT_FALSE(desk.live().attached("B"));
    worker.connect_devices();
    EXPECT_TRUE(wait_until([&] { return desk.live().attached("B"); }))
        << me.troubles.join("; ").toStdString();
}

// Who changes names among two devices before the station has seen either is not answered by the wrong one.
TEST(RenamedDevices, AreNeverMixedUp) {
    TemporaryFolder folder;
    Project two = side_of_a_door();
    two.sensors.push_back(two.sensors[0]);
    two.sensors[1].id = "B";
    two.robots.push_back(two.robots[0]);
    two.robots[1].id = "R2";
    auto file = ProjectFile::create(folder / "two.seam", two);
    ASSERT_TRUE(file) << file.error().sentence();
    Station station(std::move(*file), two);
    const auto connect = [&] {
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        for (const char* id : {"A", "B"})
            sensors[id] = make_simulated_sensor(SimulatedCell::open({{"serial", id}}).value());
        for (const char* id : {"R1", "R2"})
            robots[id] = make_simulated_robot(SimulatedCell::open({{"serial", id}}).value());
        station.use(two);
        station.connect(std::move(sensors), std::move(robots));
    };
    two.sensors[0].settings["serial"] = "A";
    two.sensors[1].settings["serial"] = "B";
    two.robots[0].settings["serial"] = "R1";
    two.robots[1].settings["serial"] = "R2";
    connect();
    Project next = two;
    next.sensors[0].id = "left";
    next.robots[1].id = "big";
    const ProfileSource *a = station.sensor("A"), *b = station.sensor("B");
    const RobotLink *r1 = station.robot("R1"), *r2 = station.robot("R2");
    station.use(next);
    EXPECT_TRUE(station.connected());
    EXPECT_EQ(station.sensor("left"), a);
    EXPECT_EQ(station.sensor("A"), nullptr);
    EXPECT_EQ(station.sensor("B"), b);
    EXPECT_EQ(station.robot("R1"), r1);
    EXPECT_EQ(station.robot("big"), r2);
    EXPECT_EQ(station.robot("R2"), nullptr);
    // A name that passes to the other device at the same time.
    connect();
    next = two;
    next.robots[0].id = "R3";
    next.robots[1].id = "R1";
    station.use(next);
    EXPECT_FALSE(station.connected());
    connect();
    next = two;
    std::swap(next.sensors[0].id, next.sensors[1].id);
    station.use(next);
    EXPECT_FALSE(station.connected());
    // Another name and other settings: nobody knows whether it is the same.
    connect();
    next = two;
    next.sensors[0].id = "left";
    next.sensors[0].settings["serial"] = "C";
    station.use(next);
    EXPECT_FALSE(station.connected());
}

// Where there is no station, whoever asks hears why, and nobody waits for ever.
TEST(WithoutAStation, EveryRequestIsAnswered) {
    TemporaryFolder folder;
    WatchedDesk me;
    StationWorker& worker = me.desk.worker();
    QStringList failures;  // the desk says them, and that it cannot note them in a file that has gone
    QObject::connect(&worker, &StationWorker::failed, &me.desk,
                     [&](const QString& said) { failures << said; });
    const auto one_sentence = [&](const char* why) {
        ASSERT_TRUE(wait_until([&] { return !failures.isEmpty() && !worker.busy(); }))
            << "nobody heard of it";
        EXPECT_EQ(failures.size(), 1) << failures.join("; ").toStdString();
        EXPECT_THAT(failures.join("; ").toStdString(), HasSubstr(why));
        failures.clear();
    };
    int ended = 0;
    QObject::connect(&worker, &StationWorker::busy_changed, &me.desk, [&](bool busy) { ended += !busy; });
    const auto ask_for_everything = [&](const char* why) {
        worker.connect_devices();
        one_sentence(why);
        worker.measure("part", false, false);
        one_sentence(why);
        EXPECT_TRUE(wait_until([&] { return ended == 2; })) << "whoever shows that it runs waits for its end";
        QString trouble;
        QObject here;
        QObject::connect(&worker, &StationWorker::arrived, &here,
                         [&](const std::string&, const QString& said) { trouble = said; });
        worker.go_to("R1", Pose::Identity());
        one_sentence(why);
        EXPECT_THAT(trouble.toStdString(), HasSubstr(why));
        std::shared_ptr<const CalibrationShots> taken;
        int number = 0;
        QObject::connect(&worker, &StationWorker::shots_taken, &here, [&](const auto& shots, int of) {
            taken = shots;
            number = of;
        });
        const int asked = worker.take_shots({"A"}, "R1", false);
        ASSERT_TRUE(wait_until([&] { return taken != nullptr; })) << "a capture waits for ever";
        EXPECT_EQ(number, asked);
        ASSERT_EQ(taken->size(), 1U);
        ASSERT_FALSE(taken->at(0));
        EXPECT_THAT(taken->at(0).error().sentence(), HasSubstr(why));
        ended = 0;
    };
    ask_for_everything("no project is open");
    // The project is on the screen, but its file has gone from under the station.
    const auto file = folder / "a.seam";
    ASSERT_TRUE(me.desk.create(file, side_of_a_door()));
    worker.close();
    std::filesystem::remove(file);
    worker.open(file, me.desk.project());
    one_sentence("a.seam");
    ended = 0;
    ask_for_everything("a.seam");
}

TEST_F(Cancelling, ARunStopsAtOnceAndIsKeptAsCancelled) {
    teach_all();
    bool cancelled = false;
    QObject::connect(
        &worker, &StationWorker::progressed, &desk,
        [&](int done, int total) {
            if (done < total && !std::exchange(cancelled, true)) worker.cancel();
        },
        Qt::DirectConnection);  // in the midst, not when it is over
    worker.measure("x", true, false);
    ASSERT_TRUE(wait_until([&] { return runs.size() == 1; }));
    EXPECT_EQ(runs[0]->status, RunStatus::cancelled);
    EXPECT_LT(measured(*runs[0]), desk.project().spots.size());
    EXPECT_EQ(asked, 0);
    for (const RegionRecord& region : runs[0]->regions) EXPECT_FALSE(region.refusals.empty());
    ASSERT_EQ(stored().size(), 1U);
    EXPECT_EQ(stored()[0].status, RunStatus::cancelled);
    EXPECT_EQ(stored()[0].part_id, "x");
    expect_the_next_run_is_whole();
}

TEST_F(Cancelling, WhatStillWaitsIsCancelledToo) {
    teach_all();
    for (int i = 0; i < 3; ++i) worker.measure("waits", true, false);
    worker.cancel();
    EXPECT_TRUE(worker.busy());
    ASSERT_TRUE(wait_until([&] { return runs.size() == 3; }));
    for (const auto& run : runs) EXPECT_EQ(run->status, RunStatus::cancelled);
    EXPECT_LT(measured(*runs[1]) + measured(*runs[2]), 1U) << "the robot is not sent anywhere for them";
    EXPECT_EQ(asked, 0);
    expect_the_next_run_is_whole();
}

TEST_F(Cancelling, APushThatWaitsForItsAnswerIsNotPushed) {
    teach_all();
    for (const bool pushes : {false, true}) {
        runs.clear();
        asked = 0;
        worker.measure("x", true, false);
        ASSERT_TRUE(wait_until([&] { return asked == 1 || !runs.empty(); }));
        ASSERT_EQ(asked, 1) << runs[0]->message;
        if (pushes)
            worker.answer_push(true);
        else
            worker.cancel();
        ASSERT_TRUE(wait_until([&] { return runs.size() == 1; }));
        EXPECT_EQ(runs[0]->status, pushes ? RunStatus::ok : RunStatus::cancelled) << runs[0]->message;
        ASSERT_EQ(runs[0]->regions.size(), 1U);
        EXPECT_EQ(runs[0]->regions[0].push.before.has_value(), pushes) << "the robot was written to";
    }
}

TEST_F(Cancelling, AnOldAnswerDoesNotPushTheNextPart) {
    teach_all();
    worker.answer_push(true);
    worker.measure("x", true, false);
    ASSERT_TRUE(wait_until([&] { return asked == 1 || !runs.empty(); }));
    ASSERT_EQ(asked, 1);
    EXPECT_FALSE(wait_until([&] { return !runs.empty(); }, 300)) << "it waits for its own answer";
    worker.answer_push(false);
    ASSERT_TRUE(wait_until([&] { return runs.size() == 1; }));
    EXPECT_EQ(runs[0]->status, RunStatus::cancelled);
    EXPECT_FALSE(runs[0]->regions[0].push.before) << "the robot was written to";
}

TEST_F(Cancelling, TeachingGivesNoSpot) {
    int taught = 0;
    QObject::connect(&worker, &StationWorker::taught, &desk, [&] { ++taught; });
    QObject::connect(
        &worker, &StationWorker::progressed, &desk, [&] { worker.cancel(); }, Qt::DirectConnection);
    ended = 0;
    worker.teach(desk.project().spots[0], 200);
    ASSERT_TRUE(over());
    ASSERT_TRUE(wait_until([&] { return !failures.isEmpty(); }));
    EXPECT_THAT(failures[0].toStdString(), HasSubstr("cancelled"));
    EXPECT_EQ(taught, 0);
}

TEST_F(Cancelling, APassGivesNoContour) {
    int passed = 0;
    QObject::connect(&worker, &StationWorker::passed, &desk, [&] { ++passed; });
    QObject::connect(
        &worker, &StationWorker::progressed, &desk, [&] { worker.cancel(); }, Qt::DirectConnection);
    ended = 0;
    worker.record_pass(desk.project().spots[0], 0.05, {});
    ASSERT_TRUE(over());
    ASSERT_TRUE(wait_until([&] { return !failures.isEmpty(); }));
    EXPECT_THAT(failures[0].toStdString(), HasSubstr("cancelled"));
    EXPECT_EQ(passed, 0);
}

TEST_F(Cancelling, AZeroShiftEndsWithTheRunThatRuns) {
    teach_all();
    QObject::connect(
        &worker, &StationWorker::measured, &desk, [&] { worker.cancel(); }, Qt::DirectConnection);
    ended = 0;
    worker.zero_shift(50);
    ASSERT_TRUE(over());
    EXPECT_GE(stored().size(), 1U);
    EXPECT_LE(stored().size(), 2U);
}

TEST_F(Cancelling, LeavingTheProjectEndsWhatRuns) {
    teach_all();
    for (int i = 0; i < 5; ++i) worker.measure("left", true, false);
    ASSERT_TRUE(wait_until([&] { return progress > 0; }));
    ASSERT_TRUE(desk.create(folder / "b.seam", Project{}));
    ASSERT_TRUE(wait_until([&] { return !worker.busy(); }));
    EXPECT_TRUE(stored().empty()) << "the run is no run of the new project";
    EXPECT_FALSE(desk.station().connected);
    desk.close();
    const auto old = ProjectFile::open(folder / "a.seam").value().runs().value();
    ASSERT_EQ(old.size(), 1U) << "those that waited are gone";
    EXPECT_EQ(old[0].status, RunStatus::cancelled);
}

// What the old project's devices said stands in the queue while the screen opens another: it is not of that one.
TEST_F(Cancelling, WhatTheOldProjectsDevicesSaidIsNotOfTheNewOne) {
    Project other = desk.project();
    other.sensors[0].identity.serial = "another camera";
    other.robots[0].identity.serial = "another controller";
    int taught = 0;
    QObject::connect(&worker, &StationWorker::taught, &desk, [&] { ++taught; });
    worker.teach(desk.project().spots[0], 1);
    // Unheard, until the reference is measured and the devices have told their state.
    for (int i = 0; i < 2000 && worker.busy(); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_FALSE(worker.busy());
    std::this_thread::sleep_for(std::chrono::milliseconds(1200));
    ASSERT_TRUE(desk.create(folder / "b.seam", other));
    EXPECT_FALSE(wait_until([&] { return taught > 0 || desk.station().connected; }, 500));
    EXPECT_EQ(taught, 0) << "it would be the reference of this project's spot of that name";
    EXPECT_EQ(desk.project().sensors[0].identity.serial, "another camera");
    EXPECT_EQ(desk.project().robots[0].identity.serial, "another controller");
    EXPECT_EQ(bits(desk.project()), bits(other));
    for (const EventRecord& e : desk.events().value())
        EXPECT_NE(e.text.english(), "devices connected") << "nothing was connected here";
}

}  // namespace
}  // namespace seamwright
