// The key in the head of a guided calibration leads from nothing to its use, and says what to do where it cannot.

#include <QScrollBar>

#include "devices/exchange/pose_json.h"
#include "projects/calibrate/session/guide.h"
#include "tests/app/studio/guided.h"
#include "widgets/calibrate/target_view.h"
#include "widgets/desk/calibration_series.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class GuidedLead : public Guided {
  protected:
    static bool ended(const DeskPerson& me) {
        return QTest::qWaitFor(
            [&] {
                auto* lead = me.window().findChild<QPushButton*>("calibration_lead");
                return lead && lead->isVisible() && lead->isEnabled();
            },
            6 * kPatienceMs);
    }
    void TearDown() override {
        me.reset();
        studio.reset();
        Guided::TearDown();
    }
    // The page of the sphere, at 1280 x 800.
    void begin() {
        make_project();
        studio.emplace(*qApp, options());
        window().resize(1280, 800);
        window().show();
        me.emplace(window());
        go_to_page(*me, desk(), "tcp-sphere");
    }
    MainWindow& window() { return studio->window(); }
    Desk& desk() { return studio->desk(); }
    std::optional<Studio> studio;
    std::optional<DeskPerson> me;
    static double scene(const Desk& desk) { return desk.station().sensors.at(0).values.at("scene"); }
};

TEST_F(GuidedLead, FromNothingToTheUse) {
    begin();
    auto* lead = me->find<QPushButton>("calibration_lead");
    ASSERT_TRUE(lead);
    EXPECT_EQ(lead->text(), "Set up the target");
    for (QPushButton* b : window().findChildren<QPushButton*>()) {
        if (b->isVisible() && b->property("next").toBool()) {
            EXPECT_EQ(b, lead) << "another is marked too: " << b->objectName().toStdString();
        }
    }
    // Beside it stands the scene, not another step's contour.
    auto* dock = window().findChild<QWidget*>("dock_scene");
    ASSERT_TRUE(dock);
    EXPECT_FALSE(dock->visibleRegion().isEmpty());
    auto* bar = me->find<QPushButton>("next_step");
    EXPECT_TRUE(bar->accessibleName().startsWith("Sensor on the flange (sphere): Prepare"))
        << bar->accessibleName().toStdString();
    me->click("calibration_lead");
    ASSERT_TRUE(me->wait([&] { return lead->text() == "Capture all"; })) << lead->text().toStdString();
    // Wherever the page is scrolled to, what runs and how to stop it are in sight.
    me->click("calibration_lead");
    for (auto* area : window().findChildren<QScrollArea*>())
        if (area->isVisible()) area->verticalScrollBar()->setValue(area->verticalScrollBar()->maximum());
    ASSERT_TRUE(me->wait([&] { return captures(*me) >= 2; })) << window_text(*me);
    for (const char* name : {"calibration_cancel", "calibration_progress", "calibration_stage"}) {
        auto* w = me->find<QWidget>(name);
        ASSERT_TRUE(w);
        EXPECT_FALSE(w->visibleRegion().isEmpty()) << name;
        EXPECT_EQ(w->visibleRegion().boundingRect().size(), w->size()) << name;
    }
    ASSERT_TRUE(window().focusWidget());
    EXPECT_EQ(window().focusWidget()->objectName(), "calibration_cancel");
    me->picture("guided_lead_series");
    ASSERT_TRUE(ended(*me)) << window_text(*me);
    EXPECT_EQ(lead->text(), "Use this calibration") << me->text_of("calibration_reason").toStdString();
    EXPECT_EQ(window().focusWidget(), lead) << "the key that leads on has the focus";
    me->click("calibration_lead");
    EXPECT_EQ(desk().project().sensors.at(0).calibration_id, desk().project().calibrations.back().id);
    EXPECT_FALSE(lead->isVisible()) << "there is nothing left to do";
    EXPECT_TRUE(bar->accessibleName().startsWith("Next: ")) << bar->accessibleName().toStdString();
}

// Whatever the method: without devices the page says so where it cannot scroll away, and its key connects them.
TEST_F(GuidedLead, WithoutDevicesEveryMethodSaysSoAndLeadsToThem) {
    make_project();
    studio.emplace(*qApp, options());
    window().resize(1280, 800);
    window().show();
    me.emplace(window());
    const auto connect = [&](bool on) {
        on ? desk().worker().connect_devices() : desk().worker().disconnect_devices();
        return me->wait([&] { return desk().station().connected == on && !desk().worker().busy(); });
    };
    ASSERT_TRUE(connect(false));
    me->step(2);
    auto* lead = window().findChild<QPushButton*>("calibration_lead");
    for (const CalibrationMethod& method : calibration_methods()) {
        if (!method.guided) continue;
        me->click("begin_" + QString::fromStdString(method.id));
        ASSERT_TRUE(lead->isVisible()) << method.id;
        EXPECT_TRUE(lead->isEnabled()) << method.id;
        const QString stage = me->text_of("calibration_stage");
        if (method.capture == CaptureKind::files) {
            EXPECT_EQ(lead->text(), "Load from files") << method.id;
            EXPECT_FALSE(stage.contains("not connected")) << method.id;
        } else {
            EXPECT_EQ(lead->text(), "Connect") << method.id;
            EXPECT_TRUE(stage.contains("The devices are not connected")) << method.id;
            EXPECT_TRUE(me->find<QPushButton>("calibration_load")->isEnabled()) << method.id;
        }
        if (method.id == "tcp-sphere") me->picture("guided_lead_offline");
        me->click("calibration_back");
    }
    me->click("begin_tcp-sphere");
    me->click("calibration_lead");
    ASSERT_TRUE(me->wait([&] { return desk().station().connected && lead->text() == "Set up the target"; }));
    EXPECT_FALSE(me->text_of("calibration_stage").contains("not connected"));
    EXPECT_FALSE(window().findChild<QPushButton*>("calibration_connect")->isVisible());
    // What the sensor saw is no live picture when it has gone.
    auto* view = window().findChild<TargetView*>();
    ASSERT_TRUE(me->wait([&] { return view->accessibleDescription().contains("sensor A"); }))
        << view->accessibleDescription().toStdString();
    ASSERT_TRUE(connect(false));
    ASSERT_TRUE(me->wait([&] { return view->accessibleDescription() == "not connected"; }))
        << view->accessibleDescription().toStdString();
}

// A sensor or robot that was renamed or removed beneath the page: followed there, named here.
TEST_F(GuidedLead, ADeviceThatIsGoneIsNamed) {
    begin();
    const auto stage = [&](const char* words) {
        return me->wait([&] { return me->text_of("calibration_stage").contains(words); });
    };
    for (const bool sensor : {true, false}) {
        ASSERT_TRUE(sensor ? desk().remove<SensorSetup>("A") : desk().remove<RobotSetup>("R1"));
        EXPECT_TRUE(stage(sensor ? "Sensor A is not in the project any more"
                                 : "Robot R1 is not in the project any more"));
        desk().undo_stack().undo();
        EXPECT_TRUE(me->wait([&] { return !me->text_of("calibration_stage").contains("any more"); }));
    }
    me->click("calibration_set_target");
    capture(*me, desk());
    ASSERT_FALSE(HasFailure());
    ASSERT_TRUE(desk().rename<SensorSetup>("A", "left"));
    ASSERT_TRUE(desk().rename<RobotSetup>("R1", "big"));
    EXPECT_TRUE(me->wait([&] {
        auto* who = me->find<QLabel>("calibration_who");
        return who && who->text().startsWith("Sensor left on robot big");
    }));
    EXPECT_FALSE(me->text_of("calibration_stage").contains("any more"));
    EXPECT_TRUE(desk().station().connected);
    me->click("calibration_back");
    EXPECT_EQ(me->find<QPushButton>("begin_tcp-sphere")->text(), "Go on");
    me->click("begin_tcp-sphere");
    EXPECT_EQ(captures(*me), 1) << "captured under the former name";
}

// A robot that scatters much: what was captured does not serve, and the key that is marked captures more, round by round;
// stating what the robot scatters is asked for where no view is left.
TEST_F(GuidedLead, ASolutionThatDoesNotServeGetsMorePoses) {
    settings = {{"seed", 5}, {"robot", {{"repeatability_mm", 0.5}}}};
    begin();
    auto* lead = me->find<QPushButton>("calibration_lead");
    me->click("calibration_lead");
    me->click("calibration_lead");
    ASSERT_TRUE(ended(*me)) << window_text(*me);
    const int advised = find_method("tcp-sphere")->advised;
    EXPECT_EQ(captures(*me), advised) << "none is kept back from a solution that does not serve";
    EXPECT_EQ(me->text_of("calibration_verdict"), "poor");
    EXPECT_EQ(lead->text(), "4 more pose(s)") << "one of them to keep back";
    EXPECT_TRUE(me->text_of("calibration_stage").contains("<b>poor</b>")) << "why, in sight beside it";
    me->picture("guided_lead_poor");
    me->click("calibration_lead");
    ASSERT_TRUE(ended(*me)) << window_text(*me);
    EXPECT_EQ(captures(*me), advised + CalibrationSeries::kRound);
    // Kept back by hand: that it agrees with so wide a solution is no good word.
    me->look_at(me->find<QTableWidget>("captures"));
    me->find<QTableWidget>("captures")->setCurrentCell(2, 0);
    me->click("calibration_mark");
    ASSERT_TRUE(solved(*me, window()));
    EXPECT_FALSE(me->text_of("calibration_verified").startsWith("confirmed"))
        << me->text_of("calibration_verified").toStdString();
    me->click("calibration_undo");
    ASSERT_TRUE(solved(*me, window()));
    for (int round = 0; round < 8 && lead->text() != "Capture"; ++round) {
        const int before = captures(*me);
        ASSERT_TRUE(lead->text().endsWith("more pose(s)")) << lead->text().toStdString();
        me->click("calibration_lead");
        ASSERT_TRUE(ended(*me)) << window_text(*me);
        EXPECT_GT(captures(*me), before) << "the marked key does something";
    }
    EXPECT_EQ(lead->text(), "Capture") << "no view is left";
    EXPECT_TRUE(me->text_of("calibration_next").contains("repeatability"))
        << me->text_of("calibration_next").toStdString();
    me->write_parameter("robot_mm", "0.5");
    ASSERT_TRUE(me->wait([&] {
        const auto s =
            CalibrationSession::open(file, MethodId("tcp-sphere"), SensorId("A"), RobotId("R1")).value();
        return s.state().settings.contains("robot") && s.state().settings["robot"]["sigma_mm"] == 0.5;
    }));
    ASSERT_TRUE(solved(*me, window()));
    EXPECT_FALSE(me->text_of("calibration_reason").contains("or state the robot's repeatability"));
    me->click("calibration_undo");
}

TEST_F(GuidedLead, AFirstCaptureThatWasNotTheTargetIsNamed) {
    begin();
    me->click("calibration_set_target");
    capture(*me, desk());
    ASSERT_FALSE(HasFailure());
    // The same profile as if it had been taken elsewhere.
    auto session =
        CalibrationSession::open(file, MethodId("tcp-sphere"), SensorId("A"), RobotId("R1")).value();
    json entry = session.state().captures.at(0).taken->entry;
    Pose at = parse_pose(entry["base_from_flange"], "base_from_flange").value();
    at.translation() += Eigen::Vector3d(-150, 60, 80);
    entry["base_from_flange"] = pose_json(at);
    entry["id"] = "elsewhere";
    const fs::path path = folder / "elsewhere.json";
    std::ofstream(path) << json{{"radius_mm", 25}, {"observations", {entry}}};
    me->find<QTableWidget>("captures")->setCurrentCell(0, 0);
    me->click("calibration_remove");
    ASSERT_TRUE(me->wait([&] { return captures(*me) == 0; }));
    me->answer_file_dialog(QString::fromStdString(path.string()));
    me->click("calibration_load");
    ASSERT_TRUE(me->wait([&] { return captures(*me) == 1; })) << window_text(*me);
    me->click("calibration_lead");
    ASSERT_TRUE(me->wait(
        [&] { return !window_text(*me).empty() && me->find<QLabel>("calibration_said")->isVisible(); }));
    EXPECT_NE(window_text(*me).find("first capture was probably not the target"), std::string::npos)
        << window_text(*me);
    EXPECT_FALSE(me->find<QLabel>("calibration_said")->visibleRegion().isEmpty());
    me->picture("guided_lead_first");
}

// Whoever goes to another step measures the part there; whoever comes back has the target again.
TEST_F(GuidedLead, TheSimulatedTargetGoesWithThePage) {
    begin();
    EXPECT_EQ(scene(desk()), 0);
    me->click("calibration_set_target");
    ASSERT_TRUE(me->wait([&] { return scene(desk()) != 0; }));
    me->step(3);
    EXPECT_TRUE(me->wait([&] { return scene(desk()) == 0; })) << "the part stands before the sensor again";
    me->step(2);
    EXPECT_TRUE(me->wait([&] { return scene(desk()) != 0; }));
    EXPECT_EQ(me->find<QPushButton>("calibration_lead")->text(), "Capture all");
    me->click("calibration_back");
    EXPECT_TRUE(me->wait([&] { return scene(desk()) == 0; }));
    EXPECT_FALSE(window().findChild<QWidget*>("calibration_stage")->isVisible());
    EXPECT_TRUE(me->find<QLabel>("page_title"));
}

TEST_F(GuidedLead, BeginningAnewCanBeTakenBack) {
    begin();
    me->click("calibration_set_target");
    for (int i = 0; i < 3; ++i) {
        capture(*me, desk());
        ASSERT_FALSE(HasFailure());
    }
    me->click("calibration_anew");
    ASSERT_TRUE(me->wait([&] { return captures(*me) == 0; }));
    capture(*me, desk());
    me->click("calibration_undo");
    ASSERT_TRUE(me->wait([&] { return captures(*me) == 0; }));
    me->click("calibration_undo");
    ASSERT_TRUE(me->wait([&] { return captures(*me) == 3; })) << window_text(*me);
    me->click("calibration_redo");
    ASSERT_TRUE(me->wait([&] { return captures(*me) == 0; })) << window_text(*me);
    me->click("calibration_redo");
    ASSERT_TRUE(me->wait([&] { return captures(*me) == 1; })) << window_text(*me);
    me->click("calibration_undo");
    me->click("calibration_undo");
    ASSERT_TRUE(me->wait([&] { return captures(*me) == 3; })) << window_text(*me);
    me->click("calibration_undo");
    ASSERT_TRUE(me->wait([&] { return captures(*me) == 2; })) << "what was done before is undone after it";
}

}  // namespace
}  // namespace seamwright
