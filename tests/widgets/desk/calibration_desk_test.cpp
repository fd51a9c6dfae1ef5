// A guided calibration at the desk without a screen: the one shot of all sensors of a gripper.
#include "widgets/desk/calibration_desk.h"

#include <gmock/gmock.h>

#include <fstream>

#include "devices/exchange/pose_json.h"
#include "devices/simulated/cell.h"
#include "projects/calibrate/session/answer.h"
#include "projects/measure/measure.h"
#include "projects/reuse/simulated_truth.h"
#include "tests/widgets/desk/desk_fixture.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// Sensors A and B are one head of the cell, so that both see the board; what tells them apart is that B's
// laser plane is held to lie 3 mm beside. G is of another cell, where no board stands; D is on another robot.
class OneShotAtTheDesk : public testing::Test {
  protected:
    TemporaryFolder folder;
    WatchedDesk me;
    Desk& desk = me.desk;
    CalibrationDesk calibration{desk};
    QStringList refusals;
    const json settings = {{"seed", 5}, {"scene", "plate"}};
    std::shared_ptr<SimulatedCell> cell = SimulatedCell::open(settings).value();
    Pose start = simulated_start(*find_method("static"), settings)->base_from_flange;

    // Where the board stands, as a "Plate in the world" found it; seen by the cell's own truth.
    Calibration plate() const {
        Calibration truth;
        truth.model = cell->sensor_model();
        Frame frame;
        cell->render(start, 77, frame);
        SensorSetup eye;
        eye.id = "eye";
        const CalibrationMethod& method = *find_method("hand-eye");
        const auto seen =
            capture_shot(method, default_settings(method), eye, &truth, frame, nullptr, start).value();
        const Pose camera_from_target =
            parse_pose(seen.capture.entry["camera_from_target"], "camera_from_target").value();
        Calibration c;
        c.id = "plate-1";
        c.method = "plate";
        c.sensor_id = "A";
        c.result["world_from_plate"] =
            pose_json(start * cell->flange_from_sensor() * cell->sensor_model().camera_from_laser.inverse() *
                      camera_from_target);
        return c;
    }
    Project cell_of_four() const {
        Project p;
        RobotSetup robot;
        robot.id = "R1";
        robot.driver = "simulated";
        robot.settings = settings;
        robot.identity = make_simulated_robot(cell)->identity().value();
        p.robots = {robot};
        for (const char* id : {"A", "B", "G", "D"}) {
            SensorSetup one;
            one.id = id;
            one.driver = *id == 'G' ? "simulated-gripper" : "simulated";
            one.settings = *id == 'G' ? json{{"head", "H1"}} : settings;
            one.calibration_id = std::string("before-") + id;
            p.sensors.push_back(one);
            SensorSetup as_simulated = one;
            as_simulated.driver = "simulated";
            as_simulated.settings = settings;
            Calibration c = simulated_truth(as_simulated, robot).value();
            c.id = one.calibration_id;
            if (*id == 'B') c.model->camera_from_laser.translation().x() += 3;
            if (*id == 'D') c.robot_id = "R2";
            p.calibrations.push_back(c);
        }
        p.calibrations.push_back(plate());
        return p;
    }
    void SetUp() override {
        QObject::connect(&calibration, &CalibrationDesk::refused, &desk,
                         [this](const QString& sentence) { refusals << sentence; });
        ASSERT_TRUE(desk.create(folder / "a.seam", cell_of_four()));
        ASSERT_TRUE(calibration.open(MethodId("static"), SensorId("A"), RobotId("R1")));
    }
    void connect_and_stand(const Pose& at) {
        if (!desk.station().connected) desk.worker().connect_devices();
        ASSERT_TRUE(wait_until([&] { return desk.station().connected && !desk.worker().busy(); }))
            << me.troubles.join("; ").toStdString();
        desk.worker().go_to("R1", at);
        ASSERT_TRUE(wait_until([&] { return !desk.worker().busy(); }));
    }
    void shoot() {
        ASSERT_TRUE(wait_until([&] { return !calibration.busy(); }));  // of solving
        calibration.capture(false);
        ASSERT_TRUE(wait_until([&] { return !calibration.busy() && !desk.worker().busy(); }, 60000))
            << said();
    }
    std::string said() const { return refusals.join("; ").toStdString(); }
    std::vector<std::string> captured() const {
        std::vector<std::string> ids;
        for (const SessionCapture& c : calibration.session().state().captures) ids.push_back(c.taken->id);
        return ids;
    }
    std::string in_use(const std::string& sensor) const {
        return find_sensor(desk.project(), sensor)->calibration_id;
    }
};

TEST_F(OneShotAtTheDesk, OnePressCalibratesWhatSeesTheBoardAndNamesWhatDoesNot) {
    connect_and_stand(start);
    EXPECT_EQ(calibration.shot_sensors(), (std::vector<std::string>{"A", "B", "G"}));
    shoot();
    EXPECT_EQ(captured(), (std::vector<std::string>{"A", "B"}));
    ASSERT_EQ(refusals.size(), 1) << said();
    EXPECT_THAT(said(), HasSubstr("sensor G"));
    for (const SessionCapture& c : calibration.session().state().captures)
        EXPECT_TRUE(std::filesystem::exists(calibration.session().picture_of(*c.taken))) << c.taken->id;
    ASSERT_TRUE(wait_until([&] { return calibration.session().solution() != nullptr; })) << said();

    const Project before = desk.project();
    const auto done = calibration.finish(true);
    ASSERT_TRUE(done) << done.error().sentence();
    ASSERT_EQ(desk.project().calibrations.size(), before.calibrations.size() + 2);
    EXPECT_EQ(calibration.session().used_as(), (std::vector<std::string>{"static-6", "static-7"}));
    EXPECT_EQ(in_use("A"), "static-6");
    EXPECT_EQ(in_use("B"), "static-7");
    EXPECT_EQ(in_use("G"), "before-G");
    const Calibration &a = desk.project().calibrations[5], &b = desk.project().calibrations[6];
    EXPECT_LT(distance_mm(a.flange_from_sensor, cell->flange_from_sensor()), 0.5);
    const Pose b_from_a = cell->sensor_model().camera_from_laser.inverse() * b.model->camera_from_laser;
    EXPECT_LT(distance_mm(b.flange_from_sensor, cell->flange_from_sensor() * b_from_a), 0.5);
    EXPECT_EQ(desk.undo_stack().undoText(), "Use calibrations static-6, static-7");
    desk.undo_stack().undo();
    EXPECT_EQ(bits(desk.project()), bits(before));
}

TEST_F(OneShotAtTheDesk, AnotherShotTakesThePlaceOfTheFirstAndUndoBringsItBack) {
    connect_and_stand(start);
    shoot();
    const auto picture = calibration.session().picture_of(*calibration.session().state().captures[0].taken);
    // From elsewhere: all chains are new, so that none ends in the old place.
    Pose beside = start;
    beside.translation().x() += 4;
    connect_and_stand(beside);
    shoot();
    EXPECT_EQ(captured(), (std::vector<std::string>{"A-2", "B-2"})) << said();
    EXPECT_NE(calibration.session().picture_of(*calibration.session().state().captures[0].taken), picture);
    ASSERT_TRUE(wait_until([&] { return calibration.session().solution() != nullptr; })) << said();
    ASSERT_TRUE(calibration.finish(true));
    EXPECT_LT(
        distance_mm(calibration_of(desk.project(), "A")->flange_from_sensor, cell->flange_from_sensor()),
        0.5);
    calibration.undo_stack().undo();
    EXPECT_EQ(captured(), (std::vector<std::string>{"A", "B"}));
}

TEST_F(OneShotAtTheDesk, WhereNoneSeesTheBoardNothingIsStored) {
    Pose away = start;
    away.translation().x() += 60;  // the board is cut off
    connect_and_stand(away);
    shoot();
    EXPECT_TRUE(captured().empty());
    for (const char* id : {"sensor A", "sensor B", "sensor G"}) EXPECT_THAT(said(), HasSubstr(id));
    EXPECT_FALSE(calibration.undo_stack().canUndo());
    EXPECT_FALSE(calibration.finish(true));
}

// What was cancelled answers too, before what was asked for afterwards.
TEST_F(OneShotAtTheDesk, TheAnswerToACancelledCaptureIsNotThatToTheNext) {
    connect_and_stand(start);
    ASSERT_TRUE(wait_until([&] { return !calibration.busy(); }));
    calibration.capture(false);
    calibration.cancel();
    shoot();
    EXPECT_EQ(captured(), (std::vector<std::string>{"A", "B"})) << said();
    ASSERT_EQ(refusals.size(), 1) << said();
    EXPECT_THAT(said(), HasSubstr("sensor G"));
}

// The chains name their sensors, and the list on the disk does.
TEST_F(OneShotAtTheDesk, RenamedSensorsAndRobotsKeepTheirCaptures) {
    connect_and_stand(start);
    shoot();
    ASSERT_TRUE(wait_until([&] { return calibration.session().solution() != nullptr; })) << said();
    ASSERT_TRUE(desk.rename<SensorSetup>("B", "right"));
    ASSERT_TRUE(desk.rename<SensorSetup>("A", "left"));
    ASSERT_TRUE(desk.rename<RobotSetup>("R1", "big"));
    EXPECT_EQ(calibration.session().sensor_id(), "left");
    EXPECT_EQ(calibration.session().robot_id(), "big");
    ASSERT_TRUE(wait_until([&] { return calibration.session().solution() != nullptr; })) << said();
    const auto made = calibrations_of_session(calibration.session(), desk.project());
    ASSERT_TRUE(made) << made.error().sentence();
    EXPECT_EQ(made->at(0).sensor_id, "left");
    EXPECT_EQ(made->at(1).sensor_id, "right");
    EXPECT_EQ(made->at(0).robot_id, "big");
    calibration.close();
    ASSERT_TRUE(calibration.open(MethodId("static"), SensorId("left"), RobotId("big")));
    EXPECT_EQ(captured().size(), 2U);
    for (int i = 0; i < 3; ++i) desk.undo_stack().undo();
    EXPECT_EQ(calibration.session().sensor_id(), "A");
    EXPECT_EQ(captured().size(), 2U);
    EXPECT_TRUE(calibrations_of_session(calibration.session(), desk.project()));
    desk.undo_stack().redo();
    // The names are not saved.
    calibration.close();
    ASSERT_TRUE(desk.open(folder / "a.seam"));
    ASSERT_TRUE(calibration.open(MethodId("static"), SensorId("A"), RobotId("R1")));
    EXPECT_EQ(captured().size(), 2U);
    EXPECT_TRUE(me.troubles.empty()) << me.troubles.join("; ").toStdString();
}

// A chain that stays must end where the new ones do.
TEST_F(OneShotAtTheDesk, ChainsOfTwoReferencesAreNotMixed) {
    const auto file = folder / "chains.json";
    const json at = pose_json(make_pose(rotation_exp({0.2, 0, 0}), {10, 20, 300}));
    const auto write = [&](std::initializer_list<const char*> ids) {
        json chains = json::array();
        for (const char* id : ids)
            chains.push_back(
                {{"id", id}, {"world_from_plate", at}, {"plate_from_camera", at}, {"camera_from_laser", at}});
        std::ofstream(file) << json{{"reference_from_world", {{"pose", pose_json(start.inverse())}}},
                                    {"sensors", chains}};
    };
    const auto load = [&] {
        calibration.load(file);
        ASSERT_TRUE(wait_until([&] { return !calibration.busy(); }));
    };
    write({"A", "D"});
    load();
    ASSERT_EQ(captured().size(), 2U) << said();
    Pose beside = start;
    beside.translation().x() += 4;
    connect_and_stand(beside);
    shoot();
    EXPECT_THAT(said(), HasSubstr("the robot has moved since the first shot"));
    EXPECT_EQ(captured(), (std::vector<std::string>{"A", "D"}));
    // Without D's chain there is none that stays.
    ASSERT_TRUE(calibration.remove("D"));
    refusals.clear();
    shoot();
    EXPECT_EQ(captured(), (std::vector<std::string>{"A-2", "B"})) << said();
    write({"A"});
    refusals.clear();
    load();
    EXPECT_THAT(said(), HasSubstr("another reference"));
    EXPECT_EQ(captured(), (std::vector<std::string>{"A-2", "B"}));
}

}  // namespace
}  // namespace seamwright
