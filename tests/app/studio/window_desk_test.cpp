// What a careful stranger stumbles over at the desk: numbers that are typed slowly, a part that lies off, charts of another
// project, proofs that are cancelled, keys that lead on.

#include <qcustomplot.h>

#include <QDoubleSpinBox>
#include <QLabel>
#include <QListWidget>
#include <QSignalSpy>
#include <QSpinBox>
#include <QTreeWidget>

#include "projects/proof/present_names.h"
#include "tests/app/studio/furniture.h"
#include "tests/app/studio/person.h"
#include "widgets/pages/regions_page.h"

namespace seamwright {
namespace {

class AtTheDesk : public Furniture {
  protected:
    Desk& desk() { return studio->desk(); }
    const Project& project() { return desk().project(); }
    bool idle() {
        return QTest::qWaitFor([&] { return desk().station().connected && !desk().worker().busy(); }, 60'000);
    }
    void connected(const QString& language = "en") {
        start(true, language);
        ASSERT_TRUE(idle());
    }
    QLineEdit* line_of(const std::string& setting) {
        for (auto* editor : window().findChildren<ParameterEditor*>())
            if (editor->isVisible() && editor->info().name == setting) return editor->findChild<QLineEdit*>();
        ADD_FAILURE() << "there is no visible " << setting;
        return nullptr;
    }
    // As by a hand that looks for each key: the devices tell something new in between.
    void type_slowly(QLineEdit* line, const QString& text) {
        QSignalSpy told(&desk(), &Desk::station_changed);
        for (const QChar c : text) {
            EXPECT_TRUE(told.wait(5000));
            QTest::keyClick(line, c.toLatin1());
        }
        EXPECT_TRUE(told.wait(5000));
    }
    void begin_in(QLineEdit* line) {
        QApplication::setActiveWindow(&window());
        DeskPerson(window()).look_at(line);
        line->setFocus();
        QTest::keyClick(line, Qt::Key_A, Qt::ControlModifier);
    }
    int charted() {
        int points = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) points += window().views().histogram->shown(axis).count;
        return points;
    }
    int drawn() {
        int points = 0;
        auto* plot = window().views().trend->findChild<QCustomPlot*>();
        for (int i = 0; i < plot->graphCount(); ++i) points += plot->graph(i)->dataCount();
        return points;
    }
    QString focused() {
        QTest::qWait(50);
        const QWidget* w = window().focusWidget();
        return w ? w->objectName() : QString();
    }
};

TEST_F(AtTheDesk, WhatIsTypedSlowlyCountsAsItIsTyped) {
    connected();
    DeskPerson me(window());
    me.step(1);
    QLineEdit* age = line_of("calibration_age_days");
    ASSERT_TRUE(age);
    begin_in(age);
    type_slowly(age, "30");
    EXPECT_EQ(age->text(), "30");
    QTest::keyClick(age, Qt::Key_Return);
    EXPECT_EQ(project().requirements.calibration_age_days, 30);
    // Marked again by Return, also for the next second.
    type_slowly(age, "41");
    QTest::keyClick(age, Qt::Key_Return);
    EXPECT_EQ(project().requirements.calibration_age_days, 41);

    auto* workobject = me.find<PoseEditor>("workobject");
    ASSERT_TRUE(workobject);
    QLineEdit* x = workobject->findChildren<QLineEdit*>().front();
    begin_in(x);
    type_slowly(x, "123.4");
    QTest::keyClick(x, Qt::Key_Return);
    EXPECT_NEAR(project().part.base_from_workobject.translation().x(), 123.4, 1e-9);

    // A refusal stays to be read; what holds comes back on Escape.
    begin_in(age);
    type_slowly(age, "x");
    QTest::keyClick(age, Qt::Key_Return);
    QTest::qWait(500);
    EXPECT_EQ(age->text(), "x");
    QTest::keyClick(age, Qt::Key_Escape);
    EXPECT_EQ(age->text(), "41");

    // Another project does not get what was begun for this one.
    begin_in(age);
    type_slowly(age, "7");
    ASSERT_TRUE(desk().save());
    ASSERT_TRUE(studio->create(path("other.seam")));
    QTest::qWait(100);
    EXPECT_EQ(age->text(), "365");
    EXPECT_EQ(project().requirements.calibration_age_days, 365);
}

TEST_F(AtTheDesk, WhatIsTypedAtASpotStaysAtThatSpot) {
    DeskPerson me(window());
    me.step(3);
    ASSERT_GE(project().spots.size(), 2U);
    desk().selection().select_spot(project().spots[0].id);
    QTest::qWait(50);
    QLineEdit* entry = line_of("entry_mm");
    ASSERT_TRUE(entry);
    const QString second = text_from_number(project().spots[1].entry_mm, 1);
    begin_in(entry);
    QTest::keyClicks(entry, "7");
    ASSERT_TRUE(desk().rename_project("another name"));
    QTest::qWait(50);
    EXPECT_EQ(entry->text(), "7");
    desk().selection().select_spot(project().spots[1].id);
    QTest::qWait(50);
    EXPECT_EQ(number_from_text(entry->text()), number_from_text(second));
    QTest::keyClick(entry, Qt::Key_Return);
    EXPECT_EQ(number_from_text(second), project().spots[1].entry_mm);
}

TEST_F(AtTheDesk, APartThatLiesOffIsPutBackNotTaughtAgain) {
    connected("de");
    DeskPerson me(window());
    me.step(1);
    me.click("place_part");
    ASSERT_TRUE(idle());
    // A number is read from its beginning, and is kept whole.
    auto* bend = window().findChild<QLineEdit*>("setting_part_bend_mm");
    ASSERT_TRUE(bend);
    const double is = project().sensors[0].settings.at("part").at("bend_mm").get<double>();
    EXPECT_LE(bend->text().size(), 11) << bend->text().toStdString();
    EXPECT_NEAR(bend->text().toDouble(), is, 1e-5 * std::abs(is));
    EXPECT_EQ(bend->cursorPosition(), 0);

    me.step(6);
    const auto measure_zero = [&] {
        me.find<QSpinBox>("zero_runs")->setValue(3);
        me.click("start_zero");
        ASSERT_TRUE(me.wait([&] { return desk().worker().busy(); }));
        ASSERT_TRUE(idle());
        QTest::qWait(50);
    };
    const auto said = [&] {
        for (const CheckItem& item : desk().checks())
            if (item.step == CheckStep::zero_shift)
                return QString::fromStdString(item.why.in(desk().language()));
        return QString();
    };
    measure_zero();
    EXPECT_TRUE(said().contains("liegt nicht wie eingelernt")) << said().toStdString();
    EXPECT_TRUE(said().contains("Wie eingelernt")) << said().toStdString();
    me.step(8);
    QTest::qWait(50);
    EXPECT_TRUE(me.table("history").contains("Nullverschiebung 1"))
        << me.table("history").join("|").toStdString();

    // The cure that it names is one.
    me.step(1);
    me.click("home_part");
    ASSERT_TRUE(idle());
    me.step(6);
    measure_zero();
    EXPECT_TRUE(said().contains("ergeben null")) << said().toStdString();
}

TEST_F(AtTheDesk, ChartsGoWithTheirProject) {
    connected();
    DeskPerson me(window());
    me.step(8);
    me.click("measure");
    ASSERT_TRUE(me.wait([&] { return desk().runs()->size() == 1 && !desk().worker().busy(); }));
    ASSERT_TRUE(me.wait([&] { return charted() > 0 && drawn() > 0; }));
    me.step(1);
    ASSERT_TRUE(studio->create(path("other.seam")));
    QTest::qWait(50);
    EXPECT_EQ(charted(), 0);
    EXPECT_EQ(drawn(), 0);
}

TEST_F(AtTheDesk, AKnownShiftIsStoppedWhereItWasStartedAndIsNoProduction) {
    connected();
    window().resize(1280, 800);
    DeskPerson me(window());
    me.step(6);
    me.click("start_known");
    ASSERT_TRUE(me.wait([&] { return desk().worker().busy(); }));
    QTest::qWait(100);
    EXPECT_FALSE(me.find<QPushButton>("start_known")->isEnabled());
    EXPECT_FALSE(me.find<QPushButton>("start_zero")->isEnabled());
    for (const char* name : {"progress", "cancel"}) {
        const auto* w = me.find<QWidget>(name);
        ASSERT_TRUE(w);
        EXPECT_EQ(w->visibleRegion().boundingRect().size(), w->size()) << name;
    }
    window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/prove_known_shift.png");
    ASSERT_TRUE(me.wait([&] { return !desk().runs()->empty(); }));
    ASSERT_TRUE(
        me.wait([&] { return me.text_of("sensor_state").contains("measures") || !desk().worker().busy(); }));
    EXPECT_TRUE(me.text_of("sensor_state").contains("measures")) << me.text_of("sensor_state").toStdString();
    EXPECT_TRUE(me.text_of("status_sensors").contains("measures"))
        << me.text_of("status_sensors").toStdString();
    QTest::mouseClick(me.find<QPushButton>("cancel"), Qt::LeftButton);
    ASSERT_TRUE(idle());
    QTest::qWait(50);
    EXPECT_TRUE(me.find<QPushButton>("start_known")->isEnabled());
    ASSERT_FALSE(newest<KnownShift>(desk().facts())) << "it was cancelled";
    me.step(8);
    QTest::qWait(100);
    EXPECT_FALSE(me.table("history").isEmpty());
    EXPECT_EQ(charted(), 0) << "displaced on purpose";
}

TEST_F(AtTheDesk, ARecordedPassIsAcceptedNext) {
    connected();
    DeskPerson me(window());
    me.step(4);
    const auto row = [&](const std::string& id) {
        for (const QTreeWidgetItem* item :
             me.find<QTreeWidget>("spot_tree")
                 ->findItems(QString::fromStdString(id), Qt::MatchExactly | Qt::MatchRecursive))
            return item->text(1);
        return QString();
    };
    for (const Spot& spot : std::vector<Spot>(project().spots)) {
        desk().selection().select_spot(spot.id);
        QTest::qWait(50);
        EXPECT_TRUE(row(spot.id).endsWith("pass open")) << row(spot.id).toStdString();
        EXPECT_EQ(me.find<QPushButton>("head_deed")->text(), "Run entry -> exit");
        me.click("head_deed");
        ASSERT_TRUE(me.wait([&] { return desk().worker().busy(); }));
        ASSERT_TRUE(idle());
        QTest::qWait(50);
        if (!me.find<QPushButton>("accept_pass")->isEnabled()) continue;
        EXPECT_TRUE(row(spot.id).endsWith("pass open")) << "nobody has accepted it";
        me.click("next_step");
        EXPECT_EQ(focused(), "head_deed");
        EXPECT_EQ(me.find<QPushButton>("head_deed")->text(), "Accept");
        me.click("head_deed");
        QTest::qWait(100);
        EXPECT_TRUE(newest_pass(project(), desk().facts(), spot.id));
        EXPECT_TRUE(row(spot.id).endsWith("pass accepted")) << row(spot.id).toStdString();
        EXPECT_NE(me.find<QPushButton>("head_deed")->text(), "Accept");
        return;
    }
    FAIL() << "no pass could be accepted";
}

// The robot does not set out with the number before the one that was typed, unless somebody presses again.
TEST_F(AtTheDesk, ARefusedNumberBeginsNothing) {
    connected();
    DeskPerson me(window());
    const auto typed = [&](const char* field, const char* text, const char* key) {
        auto* box = me.find<QDoubleSpinBox>(field);
        me.look_at(box);
        box->setFocus();
        box->selectAll();
        QTest::keyClicks(box, text);
        me.click(key);
        QTest::qWait(100);
    };
    const auto told = [&](const char* words) {
        auto* line = window().findChild<QLabel*>("trouble_text");
        return line && line->isVisible() && line->text().contains(words);
    };
    me.step(4);
    desk().selection().select_spot(project().spots.front().id);
    QTest::qWait(50);
    typed("pass_step", "1e300", "start_pass");
    EXPECT_FALSE(desk().worker().busy());
    EXPECT_TRUE(told("\"1e300\" is refused")) << "and what to do";
    EXPECT_TRUE(told("press again"));
    me.click("start_pass");
    EXPECT_TRUE(me.wait([&] { return desk().worker().busy(); }));
    desk().worker().cancel();
    ASSERT_TRUE(idle());
    me.step(6);
    typed("shift_range_mm", "abc", "start_known");
    EXPECT_FALSE(desk().worker().busy());
    EXPECT_TRUE(told("\"abc\" is refused"));
}

TEST_F(AtTheDesk, ARecordedPassWaitsWhileAnotherSpotIsLookedAt) {
    connected();
    DeskPerson me(window());
    me.step(4);
    const std::string first = project().spots[0].id, second = project().spots[1].id;
    const auto look_at = [&](const std::string& id) {
        desk().selection().select_spot(id);
        QTest::qWait(50);
    };
    // Before anything is recorded, the lines stand at what the spot has.
    look_at(second);
    EXPECT_EQ(window().views().align->jitter_mm(), project().spots[1].jitter_mm);
    look_at(first);
    EXPECT_EQ(window().views().align->jitter_mm(), project().spots[0].jitter_mm);
    me.click("start_pass");
    ASSERT_TRUE(me.wait([&] { return desk().worker().busy(); }));
    ASSERT_TRUE(idle());
    QTest::qWait(50);
    const QString verdict = me.text_of("align_verdict"), numbers = me.text_of("align_numbers");
    ASSERT_NE(verdict, "no pass recorded");
    ASSERT_NE(verdict, "edge recorded earlier");
    const bool may_accept = me.find<QPushButton>("accept_pass")->isEnabled();
    look_at(second);
    EXPECT_NE(me.text_of("align_numbers"), numbers);
    EXPECT_FALSE(me.find<QPushButton>("accept_pass")->isEnabled());
    EXPECT_EQ(window().views().align->verdict(), "NOT RECORDED");
    look_at(first);
    EXPECT_EQ(me.text_of("align_verdict"), verdict);
    EXPECT_EQ(me.text_of("align_numbers"), numbers);
    EXPECT_EQ(me.find<QPushButton>("accept_pass")->isEnabled(), may_accept);
    // Another name leaves it, another pose does not; undo brings it back.
    ASSERT_TRUE(desk().rename<Spot>(first, "pillar"));
    QTest::qWait(50);
    EXPECT_EQ(me.text_of("align_verdict"), verdict);
    Spot moved = project().spots[0];
    moved.base_from_flange.translate(Eigen::Vector3d(0, 3, 0));
    ASSERT_TRUE(desk().edit(moved));
    QTest::qWait(50);
    EXPECT_NE(me.text_of("align_numbers"), numbers);
    me.shortcut(Qt::Key_Z);
    me.shortcut(Qt::Key_Z);
    EXPECT_EQ(project().spots[0].id, first);
    look_at(first);
    EXPECT_EQ(me.text_of("align_verdict"), verdict);
    EXPECT_EQ(me.text_of("align_numbers"), numbers);
}

TEST_F(AtTheDesk, ARegionWithoutSpotsLeadsToTheTicks) {
    DeskPerson me(window());
    me.step(5);
    me.click("add_region");
    QTest::qWait(50);
    const std::string bare = desk().selection().region();
    EXPECT_FALSE(me.text_of("plan_verdict").contains("there are no spots"));
    EXPECT_TRUE(me.text_of("plan_verdict").contains("No spot is ticked"))
        << me.text_of("plan_verdict").toStdString();
    desk().selection().select_region(project().regions.front().id);
    QTest::qWait(50);
    window().findChild<RegionsPage*>()->point_out();
    QTest::qWait(50);
    EXPECT_EQ(focused(), "region_spots");
    EXPECT_EQ(desk().selection().region(), bare);
    auto* ticks = me.find<QListWidget>("region_spots");
    EXPECT_EQ(ticks->visibleRegion().boundingRect().height(), ticks->height()) << "in view";
    QTest::keyClick(ticks, Qt::Key_Space);
    EXPECT_EQ(project().regions.back().spot_ids.size(), 1U);
}

}  // namespace
}  // namespace seamwright
