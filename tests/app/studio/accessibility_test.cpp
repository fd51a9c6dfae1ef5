// Every screen of the program, looked at as an inspector would: with the keyboard alone, with weak eyes, in
// glare, on the smallest window, in both languages and both themes. A second run of ctest does the same at
// twice the size.

#include <gtest/gtest.h>
#include <unistd.h>

#include <QMenu>
#include <QMenuBar>
#include <QSlider>
#include <QSpinBox>
#include <QToolButton>
#include <QTreeWidget>
#include <QWheelEvent>
#include <filesystem>
#include <set>

#include "app/studio/dialogs/command_palette.h"
#include "app/studio/studio.h"
#include "tests/app/studio/person.h"
#include "tests/app/studio/screen_audit.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

class Accessibility : public testing::Test {
  protected:
    std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("seamwright_access_" + std::to_string(::getpid()));
    std::unique_ptr<Studio> studio;
    std::map<QString, QStringList> findings;  // and where they were met first

    void SetUp() override {
        std::filesystem::create_directories(folder);
        QApplication::setAttribute(Qt::AA_DontUseNativeDialogs);
        StudioOptions o;
        o.language = "en";
        o.theme = "light";
        o.settings = QString::fromStdString((folder / "settings.ini").string());
        o.data = QString::fromStdString(folder.string());
        studio = std::make_unique<Studio>(*qApp, o);
        studio->window().resize(1280, 800);
        ASSERT_TRUE(DeskPerson::wait([&] { return studio->desk().station().connected; }));
    }
    void TearDown() override {
        studio.reset();
        std::filesystem::remove_all(folder);
        QString text;
        for (const auto& [what, where] : findings) text += "  " + what + "\n      in " + where.first() + "\n";
        EXPECT_TRUE(findings.empty()) << findings.size() << " findings\n" << text.toStdString();
    }
    MainWindow& window() { return studio->window(); }
    void note(const QStringList& found, const QString& where) {
        for (const QString& one : found) findings[one] << where;
    }
    void show(const QString& language, bool dark) {
        if (studio->language() != language) studio->set_language(language);
        if (studio->dark() != dark) studio->set_dark(dark);
        window().resize(1280, 800);
        QApplication::setActiveWindow(&window());
        QTest::qWait(50);
    }
    // Until every page has the length that its editors ask for.
    void settle() {
        QTest::qWait(100);
        EXPECT_TRUE(DeskPerson::wait([&] {
            QCoreApplication::sendPostedEvents();
            for (const auto* area : window().findChildren<QScrollArea*>())
                if (area->isVisible() && area->widget() && area->widget()->layout() &&
                    area->widget()->height() < area->widget()->heightForWidth(area->widget()->width()))
                    return false;
            return true;
        }));
    }
    // Every page with its usual views, then every view on its own.
    void every_screen(const std::function<void(const QString&)>& look) {
        const QString how = studio->language() + (studio->dark() ? " dark " : " light ");
        for (const Step step : kSteps) {
            window().show_step(step);
            settle();
            look(how + step_name(step));
        }
        for (auto* dock : window().findChildren<QDockWidget*>()) {
            dock->show();
            dock->raise();
            settle();
            look(how + dock->windowTitle());
        }
    }
    void measure_once() {
        DeskPerson me(window());
        me.step(8);
        me.click("measure");
        ASSERT_TRUE(me.wait([&] { return studio->desk().runs()->size() == 1; }));
        ASSERT_TRUE(me.wait([&] { return !studio->desk().worker().busy(); }));
    }
    void nothing_is_cut_off_at(const QSize& size);
    // A pass that drifts: the sensor is turned about its own Z by 1.5 degrees first.
    void record_pass() {
        DeskPerson me(window());
        Desk& desk = studio->desk();
        Spot turned = desk.project().spots.front();
        turned.base_from_flange =
            turned.base_from_flange * Eigen::AngleAxisd(0.026, Eigen::Vector3d::UnitZ());
        ASSERT_TRUE(desk.edit(turned, "pose"));
        desk.selection().select_spot(turned.id);
        me.step(4);
        me.click("start_pass");
        ASSERT_TRUE(me.wait([&] { return desk.worker().busy(); }));
        ASSERT_TRUE(me.wait([&] { return !desk.worker().busy(); }));
        QTest::qWait(100);
    }
};

TEST_F(Accessibility, EverythingHasNameAndTooltipAndIsReachedByKeyboard) {
    measure_once();
    for (const QString& language : {QString("en"), QString("de")}) {
        show(language, false);
        every_screen([&](const QString& where) {
            note(audit::nameless(window()), where);
            note(audit::unreachable(window()), where);
        });
    }
    // The rail's other steps are reached by arrows from the chosen one.
    show("en", false);
    window().show_step(Step::cell);
    const auto rails = window().findChildren<QPushButton*>("rail");
    rails[0]->setFocus();
    for (int i = 1; i < 7; ++i) {
        QTest::keyClick(QApplication::focusWidget(), Qt::Key_Down);
        EXPECT_EQ(QApplication::focusWidget(), rails[i]);
        EXPECT_EQ(window().step(), kSteps[static_cast<std::size_t>(i)]);
    }
}

// A wheel that passes over a box scrolls the page. Nothing of the project changes by it, on any page.
TEST_F(Accessibility, TheWheelChangesNoValueWithoutTheFocus) {
    Desk& desk = studio->desk();
    desk.selection().select_spot(desk.project().spots.front().id);
    int boxes = 0;
    every_screen([&](const QString& where) {
        window().setFocus();
        if (QWidget* focused = QApplication::focusWidget()) focused->clearFocus();
        for (QWidget* box : window().findChildren<QWidget*>()) {
            const auto* number = qobject_cast<QAbstractSpinBox*>(box);
            const auto* choice = qobject_cast<QComboBox*>(box);
            const auto* slider = qobject_cast<QSlider*>(box);
            if (!box->isVisible() || !box->isEnabled() || !(number || choice || slider)) continue;
            const auto value = [&] {
                return number   ? number->text()
                       : choice ? choice->currentText()
                                : QString::number(slider->value());
            };
            const QString before = value();
            const QPointF at = QRectF(box->rect()).center();
            for (const int turn : {120, -120, -120}) {
                QWheelEvent wheel(at, box->mapToGlobal(at), {}, {0, turn}, Qt::NoButton, Qt::NoModifier,
                                  Qt::NoScrollPhase, false);
                QApplication::sendEvent(number ? box->findChild<QWidget*>() : box, &wheel);
            }
            EXPECT_EQ(value(), before) << where.toStdString() << " " << box->objectName().toStdString();
            EXPECT_NE(box->focusPolicy(), Qt::WheelFocus) << box->objectName().toStdString();
            ++boxes;
        }
    });
    EXPECT_GT(boxes, 20);
    EXPECT_FALSE(desk.modified());
}

TEST_F(Accessibility, EveryActionHasAWordATipAndAShortcutOfItsOwn) {
    std::set<QString> keys;
    for (const QAction* a : window().all_actions()) {
        EXPECT_FALSE(a->toolTip().isEmpty()) << a->objectName().toStdString();
        for (const QKeySequence& k : a->shortcuts())
            EXPECT_TRUE(keys.insert(k.toString()).second) << k.toString().toStdString() << " is taken twice";
    }
    // What is done often has one.
    for (const char* often : {"save", "open", "undo", "redo", "palette", "next", "measure_now", "cancel_work",
                              "full", "freeze", "connect_all"}) {
        const auto* a = window().findChild<QAction*>(often);
        ASSERT_TRUE(a) << often;
        EXPECT_FALSE(a->shortcut().isEmpty()) << often;
    }
    // A dock's shortcut brings it to the front with the focus inside.
    const auto docks = window().findChildren<QDockWidget*>();
    ASSERT_EQ(docks.size(), 8);
    for (QDockWidget* dock : docks) {
        const auto* a = window().findChild<QAction*>("show_" + dock->objectName());
        ASSERT_TRUE(a);
        QApplication::setActiveWindow(&window());
        const QKeyCombination key = a->shortcut()[0];
        QTest::keyClick(&window(), key.key(), key.keyboardModifiers());
        QTest::qWait(30);
        EXPECT_FALSE(dock->visibleRegion().isEmpty()) << dock->objectName().toStdString();
        EXPECT_TRUE(dock->isAncestorOf(QApplication::focusWidget())) << dock->objectName().toStdString();
    }
}

TEST_F(Accessibility, WordsStandOutInBothThemes) {
    measure_once();
    record_pass();
    for (const bool dark : {false, true}) {
        show("de", dark);
        every_screen([&](const QString& where) {
            note(audit::faint(window()), where);
            note(audit::colour_alone(window()), where);
        });
        CommandPalette palette(window().all_actions(), &window());
        palette.show();
        QTest::qWait(50);
        note(audit::faint(palette), "palette");
        // What is drawn by hand takes its colours from here.
        const QPalette p = dark ? style::dark_palette() : style::light_palette();
        const auto legible = [&](const QColor& word, const QColor& ground, const char* what) {
            EXPECT_GE(audit::contrast(word, ground), 4.5)
                << what << (dark ? " dark " : " light ") << word.name().toStdString() << " on "
                << ground.name().toStdString();
        };
        for (const auto role : {QPalette::Window, QPalette::Base, QPalette::AlternateBase}) {
            const QColor ground = p.color(role);
            legible(style::text(p), ground, "text");
            legible(style::quiet_text(p), ground, "quiet text");
            legible(style::good(p), ground, "good");
            legible(style::attention(p), ground, "attention");
            legible(style::alarm(p), ground, "alarm");
            legible(style::selection(p), ground, "selection");
            legible(style::outlier(p), ground, "outlier");
            legible(p.color(QPalette::Link), ground, "link");
        }
        legible(p.color(QPalette::ToolTipText), p.color(QPalette::ToolTipBase), "tooltip");
        legible(p.color(QPalette::PlaceholderText), p.color(QPalette::Base), "placeholder");
        legible(p.color(QPalette::HighlightedText), p.color(QPalette::Highlight), "chosen");
        for (const auto role : {QPalette::WindowText, QPalette::ButtonText, QPalette::Text})
            for (const auto ground : {QPalette::Window, QPalette::Button, QPalette::Base})
                legible(p.color(QPalette::Disabled, role), p.color(ground), "disabled");
        // Lines and marks need 3 : 1 (WCAG 2.1, 1.4.11).
        for (int segment = 0; segment < 5; ++segment)
            EXPECT_GE(audit::contrast(style::segment(segment, p), style::plot_ground(p)), 3) << segment;
        EXPECT_GE(audit::contrast(style::axis(p), style::plot_ground(p)), 3);
        // Neighbouring segments are told apart without hue.
        for (int segment = 0; segment < 4; ++segment)
            EXPECT_GE(audit::contrast(style::segment(segment, p), style::segment(segment + 1, p)), 1.2)
                << segment << (dark ? " dark" : " light");
    }
}

// From a small laptop to the hall's large screen: everything fits, and the sensor stays in sight.
TEST_F(Accessibility, TheLiveProfileKeepsAThirdOfEveryWindow) {
    show("de", false);
    for (const QSize size : {QSize(1366, 768), QSize(1920, 1080), QSize(1280, 680), QSize(1180, 660)}) {
        every_screen([&](const QString& where) {
            window().resize(size);
            settle();
            const QString at = QString("%1 x %2, ").arg(size.width()).arg(size.height()) + where;
            EXPECT_EQ(window().size(), size) << at.toStdString() << ": the window cannot be so small";
            const QWidget* profile = window().views().profile;
            if (profile->isVisible() && !profile->visibleRegion().isEmpty()) {
                EXPECT_GE(profile->height(), 0.35 * size.height() - 1) << at.toStdString();
            }
            note(audit::cut_off(window()), at);
        });
        window().grab().save(QString(SEAMWRIGHT_SCREENS) + QString("/window_%1.png").arg(size.width()));
    }
}

void Accessibility::nothing_is_cut_off_at(const QSize& size) {
    measure_once();
    record_pass();
    for (const QString& language : {QString("en"), QString("de")}) {
        show(language, false);
        window().resize(size);
        every_screen([&](const QString& where) {
            EXPECT_EQ(window().size(), size) << where.toStdString() << ": the window cannot be so small";
            window().resize(size);
            note(audit::cut_off(window()), where);
            std::filesystem::create_directories(SEAMWRIGHT_SCREENS);
            window().grab().save(QStringLiteral(SEAMWRIGHT_SCREENS "/%1x%2 %3.png")
                                     .arg(size.width())
                                     .arg(size.height())
                                     .arg(where));
        });
        // The message bar, the question before a push, every kind of feature.
        emit studio->desk().trouble(
            "the camera does not answer on 192.168.100.17:3956; check cable, power and address, then connect "
            "again");
        window().show_step(Step::teach);
        settle();
        DeskPerson me(window());
        auto* kind = me.find<QComboBox>("feature_kind");
        ASSERT_TRUE(kind);
        for (int i = 0; i < kind->count(); ++i) {
            me.choose("feature_kind", kind->itemText(i));
            settle();
            note(audit::cut_off(window()), language + " teach " + kind->itemText(i));
        }
        while (studio->desk().undo_stack().canUndo()) studio->desk().undo_stack().undo();
        CommandPalette palette(window().all_actions(), &window());
        palette.show();
        QTest::qWait(50);
        note(audit::cut_off(palette), "palette");
    }
}

TEST_F(Accessibility, NothingIsCutOffAt1280By800) {
    nothing_is_cut_off_at({1280, 800});
}
TEST_F(Accessibility, NothingIsCutOffAtTheSmallestWindow) {
    nothing_is_cut_off_at({1180, 660});
    show("en", false);
    window().resize(1180, 660);
    every_screen([&](const QString& where) { note(audit::unreachable(window()), where); });
}

}  // namespace
}  // namespace seamwright
