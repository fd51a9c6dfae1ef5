// What somebody meets who sits before the window for the first time: the way from an empty project on, keys that lead
// somewhere, words that are whole, and nothing that is lost without a word.

#include <QComboBox>
#include <QLabel>
#include <QListWidget>
#include <QMessageBox>
#include <QPushButton>
#include <QRegularExpression>
#include <QScrollArea>
#include <QTableWidget>
#include <map>

#include "tests/app/studio/furniture.h"
#include "tests/app/studio/person.h"
#include "widgets/pages/calibrate_page.h"
#include "widgets/pages/run_page.h"

namespace seamwright {
namespace {

class Newcomer : public Furniture {
  protected:
    Desk& desk() { return studio->desk(); }
    QString focused() {
        QTest::qWait(30);
        const QWidget* w = window().focusWidget();
        return w ? w->objectName() : QString();
    }
    std::optional<Pose> place() {
        const auto& robots = desk().station().robots;
        return robots.empty() ? std::nullopt : robots.front().base_from_flange;
    }
    void connected() {
        start(true);
        ASSERT_TRUE(DeskPerson::wait([&] { return desk().station().connected && !desk().worker().busy(); }));
    }
    static bool wholly_shown(const QWidget* w) {
        for (const QWidget* up = w->parentWidget(); up; up = up->parentWidget())
            if (const auto* area = qobject_cast<const QScrollArea*>(up))
                return area->viewport()->rect().contains(
                    QRect(w->mapTo(area->viewport(), QPoint()), w->size()));
        return w->isVisible();
    }
    // Presses this button of the question as soon as it stands there; false: there was none.
    bool answered(const char* button, const std::function<void()>& deed) {
        bool there = false;
        QTimer look;
        QObject::connect(&look, &QTimer::timeout, &look, [&] {
            auto* box = qobject_cast<QMessageBox*>(QApplication::activeModalWidget());
            if (!box || box->objectName() != "running_question") return;
            look.stop();
            there = true;
            if (!*button) return (void)QTest::keyClick(box->defaultButton(), Qt::Key_Return);
            for (QAbstractButton* b : box->buttons())
                if (b->objectName() == button) return b->click();
        });
        look.start(20);
        deed();
        return there;
    }
};

TEST_F(Newcomer, ANewSimulatedCellIsLedToItsFirstMotion) {
    ASSERT_TRUE(studio->create(path("new.seam")));
    DeskPerson me(window());
    me.step(1);
    for (const char* key : {"add_sensor", "add_robot", "connect"}) {
        me.click("next_step");
        EXPECT_EQ(focused(), key);
        EXPECT_TRUE(wholly_shown(me.find<QPushButton>(key)));
        me.click(key);
    }
    ASSERT_TRUE(me.wait([&] { return desk().station().connected && place(); })) << "it stands nowhere";
    ASSERT_TRUE(me.wait([&] { return me.text_of("status_sensors").contains(" ok "); }))
        << me.text_of("status_sensors").toStdString();
    QTest::keyClick(&window(), Qt::Key_F8);
    ASSERT_TRUE(me.wait([&] { return window().views().jog->isVisible(); }));
    EXPECT_TRUE(me.text_of("jog_place").startsWith("Flange:")) << me.text_of("jog_place").toStdString();
    const Pose before = *place();
    me.choose("jog_frame", "Robot's base");
    me.click("jog_Zplus");
    EXPECT_TRUE(me.wait([&] { return distance_mm(*place(), before) > 0.9; }));
    window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/newcomer_jog.png");
}

TEST_F(Newcomer, ARobotThatTellsNoPlaceIsNotCalledMissing) {
    ASSERT_TRUE(studio->create(path("new.seam")));
    SensorSetup sensor;
    sensor.id = "A";
    sensor.driver = "simulated";
    RobotSetup robot;
    robot.id = "R1";
    robot.driver = "simulated-gripper";
    ASSERT_TRUE(desk().add(sensor));
    ASSERT_TRUE(desk().add(robot));
    desk().worker().connect_devices();
    DeskPerson me(window());
    ASSERT_TRUE(me.wait([&] { return desk().station().connected; }));
    QTest::keyClick(&window(), Qt::Key_F8);
    ASSERT_TRUE(me.wait([&] { return window().views().jog->isVisible(); }));
    EXPECT_TRUE(me.text_of("jog_place").startsWith("The robot does not tell where it stands"))
        << me.text_of("jog_place").toStdString();
}

TEST_F(Newcomer, APushThatWaitsIsInViewAndIsNotLostWithoutAQuestion) {
    connected();
    window().resize(1270, 760);
    DeskPerson me(window());
    EXPECT_FALSE(answered("stay", [&] { EXPECT_TRUE(window().may_leave()); })) << "nothing runs";
    me.step(8);
    me.click("measure_push");
    auto* page = window().findChild<RunPage*>();
    ASSERT_TRUE(me.wait([&] { return page->asks(); }));
    QTest::qWait(200);
    auto* question = window().findChild<QWidget*>("confirm");
    EXPECT_TRUE(wholly_shown(question)) << question->height();
    auto* next = me.find<QPushButton>("next_step");
    EXPECT_EQ(next->accessibleName(), "Answer above: push, or do not push");
    window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/newcomer_push.png");
    me.look_at(me.find<QTableWidget>("history"));
    EXPECT_FALSE(wholly_shown(question));
    me.click("next_step");
    EXPECT_EQ(focused(), "decline");
    EXPECT_TRUE(wholly_shown(question));
    EXPECT_TRUE(answered("", [&] { EXPECT_FALSE(window().may_leave()) << "Stay is what Return does"; }));
    EXPECT_TRUE(answered("", [&] { EXPECT_FALSE(window().close()); }));
    EXPECT_TRUE(page->asks()) << "it still waits";
    // What has to be ended first is said as long as it runs.
    window().findChild<QAction*>("theme")->trigger();
    auto* said = window().findChild<QWidget*>("trouble");
    EXPECT_TRUE(said->isVisible());
    me.click("decline");
    ASSERT_TRUE(me.wait([&] { return !desk().worker().busy(); }));
    EXPECT_TRUE(me.wait([&] { return !said->isVisible(); }));
    desk().selection().select_region(desk().project().regions.front().id);
    me.click("measure");
    EXPECT_TRUE(answered("cancel_and_close", [&] { EXPECT_TRUE(window().may_leave()); }));
    ASSERT_TRUE(me.wait([&] { return !desk().worker().busy(); }));
    // Two parts are two values an axis.
    QTest::qWait(100);
    const auto runs = static_cast<int>(desk().runs()->size());
    for (std::size_t axis = 0; axis < 3; ++axis)
        EXPECT_LE(window().views().histogram->shown(axis).count, runs);
    EXPECT_GE(window().views().histogram->shown(2).count, 1);
}

TEST_F(Newcomer, AProofThatIsOpenIsPointedAtOnItsOwnPage) {
    connected();
    window().resize(1270, 760);
    DeskPerson me(window());
    me.step(6);
    auto* list = me.find<QTableWidget>("checklist");
    const std::map<CheckStep, QString> keys{{CheckStep::zero_shift, "start_zero"},
                                            {CheckStep::known_shift, "start_known"}};
    for (int row = 0; row < static_cast<int>(desk().checks().size()); ++row) {
        const auto key = keys.find(desk().checks()[static_cast<std::size_t>(row)].step);
        if (key == keys.end()) continue;
        list->setCurrentCell(row, 0);
        me.click("open_step");
        EXPECT_EQ(focused(), key->second);
        EXPECT_TRUE(wholly_shown(me.find<QPushButton>(key->second)));
    }
    me.look_at(list);
    me.click("next_step");
    if (window().step() == Step::prove) {
        EXPECT_EQ(focused(), "start_zero");
    }
}

TEST_F(Newcomer, TheRailKeepsItsWords) {
    DeskPerson me(window());
    const auto first = [&] { return window().findChildren<QPushButton*>("rail").front(); };
    window().resize(1200, 760);
    QTest::qWait(50);
    EXPECT_EQ(first()->text(), "1 Cell");
    window().resize(1190, 760);
    QTest::qWait(50);
    EXPECT_EQ(first()->text(), "1");
    int states = 0;
    for (const QLabel* label : first()->parentWidget()->findChildren<QLabel*>()) {
        ++states;
        EXPECT_TRUE(label->text().contains(QRegularExpression("[a-z]{4}"))) << label->text().toStdString();
        EXPECT_GE(label->height(), label->heightForWidth(label->width()));
    }
    EXPECT_EQ(states, static_cast<int>(kSteps.size()));
    window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/newcomer_rail.png");
}

TEST_F(Newcomer, ALongNameLeavesTheOtherColumnsAndItsRefusalIsWhole) {
    connected();
    DeskPerson me(window());
    const std::string name(60, 'n');
    ASSERT_TRUE(desk().rename<SensorSetup>("A", name));
    ASSERT_TRUE(me.wait([&] { return !me.text_of("status_sensors").contains("sensor A"); }))
        << me.text_of("status_sensors").toStdString();
    desk().undo_stack().undo();
    ASSERT_TRUE(me.wait([&] { return !me.text_of("status_sensors").contains(QString::fromStdString(name)); }))
        << me.text_of("status_sensors").toStdString();
    desk().undo_stack().redo();
    me.step(1);
    QTest::qWait(100);
    auto* table = me.find<QTableWidget>("devices");
    for (int column = 0; column < table->columnCount(); ++column)
        EXPECT_LE(table->columnViewportPosition(column) + table->columnWidth(column),
                  table->viewport()->width())
            << column;
    EXPECT_GT(table->columnWidth(3), 60);
    ASSERT_TRUE(desk().add([&] {
        SensorSetup other = desk().project().sensors.front();
        other.id = "B";
        other.calibration_id.clear();
        other.identity = {};
        return other;
    }()));
    QTest::qWait(50);
    table->setCurrentCell(1, 0);
    me.click("rename_device");
    auto* line = window().findChild<QLineEdit*>("new_name");
    ASSERT_TRUE(line);
    line->setText(QString::fromStdString(name));
    QTest::keyClick(line, Qt::Key_Return);
    QTest::qWait(50);
    auto* refused = window().findChild<QLabel*>("rename_refused");
    ASSERT_TRUE(refused && refused->isVisible());
    EXPECT_GE(refused->height(), refused->heightForWidth(refused->width())) << refused->text().toStdString();
    EXPECT_GT(refused->width(), refused->fontMetrics().horizontalAdvance(QString::fromStdString(name)));
    refused->window()->grab().save(QString(SEAMWRIGHT_SCREENS) + "/newcomer_rename.png");
}

TEST_F(Newcomer, TheCameraIsCalibratedFirstAndTheOthersSayThat) {
    ASSERT_TRUE(studio->create(path("new.seam")));
    DeskPerson me(window());
    me.step(1);
    me.click("add_sensor");
    me.step(2);
    QTest::qWait(50);
    auto* page = window().findChild<CalibratePage*>();
    QPushButton* first = nullptr;
    for (auto* b : page->findChildren<QPushButton*>())
        if (b->objectName().startsWith("begin_") && (!first || b->y() < first->y())) first = b;
    ASSERT_TRUE(first);
    EXPECT_EQ(first->objectName(), "begin_stripe-camera");
    EXPECT_TRUE(me.text_of("before_tcp-sphere").contains("needs this first"));
    EXPECT_FALSE(page->findChild<QLabel*>("before_stripe-camera"));
    window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/newcomer_calibrate.png");
}

}  // namespace
}  // namespace seamwright
