// What is edited at the window: counts when it was typed, is refused where it stands, needs a project, and is shown as it was
// written.

#include <QAbstractItemView>
#include <QAbstractSpinBox>
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QMessageBox>
#include <QScrollArea>
#include <QScrollBar>
#include <QToolTip>
#include <QWheelEvent>

#include "projects/file/project_file.h"
#include "projects/hand_over/hand_over.h"
#include "tests/app/studio/furniture.h"
#include "tests/app/studio/person.h"
#include "widgets/menu_signs.h"

namespace seamwright {
namespace {

class Edits : public Furniture {
  protected:
    Desk& desk() { return studio->desk(); }
    const Project& project() { return desk().project(); }
    QLineEdit* setting(const char* name) {
        DeskPerson me(window());
        auto* all = me.find<QPushButton>("all_settings");
        if (!all->isChecked()) me.click("all_settings");
        return me.find<QLineEdit>(name);
    }
    // And stays in the field.
    void type(QLineEdit* line, const QString& text) {
        ASSERT_TRUE(line);
        QApplication::setActiveWindow(&window());
        DeskPerson(window()).look_at(line);
        line->setFocus();
        line->selectAll();
        QTest::keyClicks(line, text);
        EXPECT_TRUE(line->hasFocus());
    }
    QString trouble() {
        const auto* text = window().findChild<QLabel*>("trouble_text");
        return text->isVisible() ? text->text() : QString();
    }
};

TEST_F(Edits, SettingsOfADeviceThatAreTypedCountOnSaveAndOnConnect) {
    ASSERT_TRUE(studio->create(path("new.seam")));
    DeskPerson me(window());
    me.step(1);
    me.click("add_sensor");
    ASSERT_EQ(project().sensors.size(), 1U);
    QTest::qWait(50);
    const auto exposure = [&] {
        const auto& settings = project().sensors[0].settings;
        return settings.contains("exposure_us") ? settings["exposure_us"].get<double>() : 0;
    };
    type(setting("setting_exposure_us"), "123");
    EXPECT_NE(exposure(), 123) << "not taken yet";
    me.shortcut(Qt::Key_S);
    EXPECT_EQ(exposure(), 123);
    EXPECT_FALSE(desk().modified());
    {
        const auto file = ProjectFile::open(desk().path(), FileAccess::read_only);
        ASSERT_TRUE(file) << file.error().sentence();
        EXPECT_EQ(file->load().value().sensors[0].settings["exposure_us"], 123);
    }
    // The key, from within the field.
    type(setting("setting_exposure_us"), "124");
    QTest::keyClick(&window(), Qt::Key_F4);
    EXPECT_EQ(exposure(), 124);
    ASSERT_TRUE(me.wait([&] { return desk().station().connected && !desk().worker().busy(); }));
    // The button, though the field was left for another before.
    type(setting("setting_exposure_us"), "125");
    QTest::keyClick(setting("setting_exposure_us"), Qt::Key_Tab);
    EXPECT_EQ(exposure(), 124);
    me.click("connect");
    EXPECT_EQ(exposure(), 125);
    ASSERT_TRUE(me.wait([&] { return desk().station().connected && !desk().worker().busy(); }));
    // What was typed of one device is not lost by a look at another, nor by one at another page.
    type(setting("setting_exposure_us"), "126");
    me.click("add_robot");
    EXPECT_EQ(exposure(), 126) << "its row is the chosen one";
    me.find<QTableWidget>("devices")->setCurrentCell(0, 0);
    type(setting("setting_exposure_us"), "126.5");
    me.find<QTableWidget>("devices")->setCurrentCell(1, 0);
    EXPECT_EQ(exposure(), 126.5);
    me.find<QTableWidget>("devices")->setCurrentCell(0, 0);
    type(setting("setting_exposure_us"), "127");
    me.step(3);
    me.shortcut(Qt::Key_S);
    EXPECT_EQ(exposure(), 127);
    EXPECT_FALSE(desk().modified());
    desk().undo_stack().undo();
    EXPECT_EQ(exposure(), 126.5) << "as any other edit";
}

// Wherever a field stood on the page, and whoever of the form had the focus: the message that refuses it lies beside it.
TEST_F(Edits, ARefusedSettingIsNeverUnderTheMessageThatRefusesIt) {
    for (const char* language : {"en", "de"}) {
        start(false, language);
        DeskPerson me(window());
        me.step(1);
        (void)setting("setting_seed");
        QStringList names;
        for (const QLineEdit* line : window().findChildren<QLineEdit*>())
            if (line->isVisible() && line->objectName().startsWith("setting_") &&
                line->alignment().testFlag(Qt::AlignRight))
                names << line->objectName();
        ASSERT_GE(names.size(), 8);
        auto* frame = window().findChild<QFrame*>("trouble");
        QScrollArea* area = nullptr;
        for (QWidget* up = setting("setting_seed"); up && !area; up = up->parentWidget())
            area = qobject_cast<QScrollArea*>(up);
        ASSERT_TRUE(area);
        for (const QString& name : names) {
            QLineEdit* line = setting(name.toUtf8());
            type(line, "abc");
            // Left for another one of the form; then it stands at the lower end, where messages lie.
            QLineEdit* other =
                setting(name == names.front() ? names.back().toUtf8() : names.front().toUtf8());
            other->setFocus();
            const int below = line->mapTo(area->widget(), QPoint(0, line->height())).y();
            area->verticalScrollBar()->setValue(below - area->viewport()->height());
            me.shortcut(Qt::Key_S);
            QTest::qWait(50);
            EXPECT_FALSE(trouble().isEmpty()) << name.toStdString();
            EXPECT_TRUE(line->hasFocus()) << name.toStdString() << ": Esc would not reach it";
            const QWidget* row = line->parentWidget();  // with its name and why it is refused
            EXPECT_EQ(row->visibleRegion().boundingRect(), row->rect()) << name.toStdString();
            const QRect at(row->mapTo(&window(), QPoint()), row->size());
            const QRect over(frame->mapTo(&window(), QPoint()), frame->size());
            EXPECT_FALSE(at.intersects(over)) << name.toStdString();
            if (name == names.back())
                window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/refused_" + language + ".png");
            QTest::keyClick(line, Qt::Key_Escape);
            EXPECT_NE(line->text(), "abc");
            me.shortcut(Qt::Key_S);
            if (frame->isVisible()) me.click("dismiss");
        }
        // The page's end can be read while a message lies over it.
        emit desk().trouble("Something went wrong somewhere.");
        area->verticalScrollBar()->setValue(area->verticalScrollBar()->maximum());
        const int end = area->widget()->mapTo(&window(), QPoint(0, area->widget()->height())).y();
        EXPECT_LE(end, frame->mapTo(&window(), QPoint()).y());
    }
}

TEST_F(Edits, ASettingThatIsRefusedHoldsSavingUpUntilItIsMended) {
    DeskPerson me(window());
    me.step(1);
    QTest::qWait(50);
    ASSERT_TRUE(desk().rename_project("another"));
    const auto before = project().sensors[0].settings;
    type(setting("setting_exposure_us"), "abc");
    me.shortcut(Qt::Key_S);
    EXPECT_TRUE(trouble().contains("refused")) << trouble().toStdString();
    EXPECT_TRUE(desk().modified());
    // Also when it is left: the page is shown again.
    me.step(3);
    me.shortcut(Qt::Key_S);
    EXPECT_TRUE(desk().modified());
    EXPECT_EQ(window().step(), Step::cell);
    EXPECT_TRUE(trouble().contains("A: the settings are not taken over")) << trouble().toStdString();
    EXPECT_TRUE(trouble().contains("Esc")) << trouble().toStdString();
    QTest::keyClick(&window(), Qt::Key_F4);
    QTest::qWait(200);
    EXPECT_FALSE(desk().station().connected);
    QLineEdit* line = setting("setting_exposure_us");
    EXPECT_FALSE(line->visibleRegion().isEmpty()) << "the marked field is in view";
    window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/settings_refused.png");
    line->setFocus();
    QTest::keyClick(line, Qt::Key_Escape);
    EXPECT_NE(line->text(), "abc");
    me.shortcut(Qt::Key_S);
    EXPECT_FALSE(desk().modified());
    EXPECT_EQ(project().sensors[0].settings, before);
    // What is no JSON comes back by the same key.
    me.click("settings_as_text");
    auto* text = me.find<QPlainTextEdit>("settings");
    text->setFocus();
    QTest::keyClicks(text, "{");
    me.shortcut(Qt::Key_S);
    EXPECT_TRUE(trouble().contains("no JSON")) << trouble().toStdString();
    QTest::keyClick(text, Qt::Key_Escape);
    EXPECT_FALSE(text->toPlainText().startsWith("{{"));
    EXPECT_TRUE(window().may_leave());
}

TEST_F(Edits, NothingIsEditedWithoutAProject) {
    StudioOptions o;
    o.language = "en";
    o.theme = "light";
    o.settings = path("other.ini");
    o.data = path("");
    o.connect = false;
    Studio second(*qApp, o);  // wants the demo project, which the first has open
    ASSERT_FALSE(second.desk().is_open());
    second.window().resize(1440, 900);
    QApplication::setActiveWindow(&second.window());
    DeskPerson me(second.window());
    for (const Step step : kSteps) {
        me.step(static_cast<int>(step) + 1);
        QTest::qWait(50);
        const QLabel* state = me.find<QLabel>("page_state");
        EXPECT_TRUE(state->text().startsWith("No project is open: open one or make a new one"))
            << state->text().toStdString();
        const QWidget* whole = me.find<QStackedWidget>("pages")->currentWidget();
        for (const QWidget* w : whole->findChildren<QWidget*>()) {
            if (!w->isVisible()) continue;
            if (!qobject_cast<const QAbstractButton*>(w) && !qobject_cast<const QLineEdit*>(w) &&
                !qobject_cast<const QComboBox*>(w) && !qobject_cast<const QAbstractSpinBox*>(w) &&
                !qobject_cast<const QAbstractItemView*>(w))
                continue;
            EXPECT_FALSE(w->isEnabled())
                << step_name(step).toStdString() << ": " << w->objectName().toStdString();
        }
    }
    second.window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/no_project.png");
    EXPECT_EQ(me.find<QPushButton>("next_step")->accessibleName(),
              "Open a project, or make a new one in the menu File");
    for (const char* name : {"save", "save_as", "export_json", "connect_all", "measure_now", "mirror"})
        EXPECT_FALSE(second.window().findChild<QAction*>(name)->isEnabled()) << name;
    for (const char* name : {"new", "open", "demo", "import_json"})
        EXPECT_TRUE(second.window().findChild<QAction*>(name)->isEnabled()) << name;
    SensorSetup sensor;
    sensor.id = "A";
    sensor.driver = "simulated";
    const auto added = second.desk().add(sensor);
    ASSERT_FALSE(added);
    EXPECT_EQ(added.error().sentence(), "no project is open; open or make one");
    EXPECT_FALSE(second.desk().modified());

    ASSERT_TRUE(second.create(path("new.seam")));
    me.step(1);
    QTest::qWait(50);
    me.click("add_sensor");
    EXPECT_EQ(second.desk().project().sensors.size(), 1U);
    EXPECT_TRUE(second.window().findChild<QAction*>("save")->isEnabled());
    EXPECT_FALSE(me.find<QLabel>("page_state")->text().contains("No project"));
}

TEST_F(Edits, AFrameThatAnotherRegionWritesIsRefusedInItsField) {
    DeskPerson me(window());
    me.step(5);
    ASSERT_GE(project().regions.size(), 2U);
    const std::string first = project().regions[0].frame_name, second = project().regions[1].frame_name;
    desk().selection().select_region(project().regions[1].id);
    QTest::qWait(50);
    auto* line = me.find<QLineEdit>("frame_name");
    ASSERT_TRUE(line);
    ASSERT_EQ(line->text().toStdString(), second);
    const auto refused = [&]() -> QString {
        for (const QLabel* label : line->parentWidget()->findChildren<QLabel*>())
            if (label->isVisible()) return label->text();
        return {};
    };
    // No controller tells upper from lower case.
    const QString other = QString::fromStdString(first).toLower();
    ASSERT_NE(other.toStdString(), first);
    me.write(line, other);
    EXPECT_EQ(project().regions[1].frame_name, second);
    EXPECT_EQ(refused().toStdString(), "refused: region " + project().regions[1].id + ": region " +
                                           project().regions[0].id + " writes the same frame " + first +
                                           "; give each region its own frame");
    EXPECT_EQ(line->text(), other) << "it stays as it was typed";
    window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/frame_refused.png");
    ASSERT_TRUE(desk().rename_project("another"));
    QTest::qWait(50);
    EXPECT_EQ(line->text(), other);
    line->setFocus();
    me.shortcut(Qt::Key_S);
    EXPECT_TRUE(desk().modified()) << "nothing is saved while a value is refused";
    QTest::keyClick(line, Qt::Key_Escape);
    EXPECT_EQ(line->text().toStdString(), second);
    EXPECT_EQ(refused(), QString());
    me.shortcut(Qt::Key_S);
    EXPECT_FALSE(desk().modified());
    me.write(line, "BASE_OTHER");
    EXPECT_EQ(project().regions[1].frame_name, "BASE_OTHER");
    // What is made by a key has one of its own too.
    ASSERT_TRUE(desk().rename<Region>(project().regions[0].id, "old"));
    Region r = project().regions[0];
    r.frame_name = "base_region1";
    ASSERT_TRUE(desk().edit(r));
    me.click("add_region");
    ASSERT_EQ(project().regions.back().id, "Region1");
    EXPECT_EQ(project().regions.back().frame_name, "BASE_Region1_2");
}

// A name that looks like markup.
constexpr const char* kNames[] = {"<b>x</b>", "<img src='icons/save.svg'>", "a < b & c"};

TEST_F(Edits, NamesThatLookLikeMarkupAreShownAsTheyAre) {
    const QString first = kNames[0];
    ASSERT_TRUE(desk().rename_project(kNames[0]));
    ASSERT_TRUE(desk().rename<SensorSetup>(project().sensors[0].id, kNames[0]));
    ASSERT_TRUE(desk().rename<RobotSetup>(project().robots[0].id, kNames[1]));
    ASSERT_TRUE(desk().rename<Region>(project().regions[0].id, kNames[0]));
    for (std::size_t i = 0; i < 3; ++i) ASSERT_TRUE(desk().rename<Spot>(project().spots[i].id, kNames[i]));
    desk().worker().connect_devices();
    DeskPerson me(window());
    ASSERT_TRUE(me.wait([&] { return desk().station().connected && !desk().worker().busy(); }));
    int shown = 0;
    const auto all_plain = [&](const std::string& where) {
        QTest::qWait(50);
        for (const QWidget* top : QApplication::topLevelWidgets())
            for (const QLabel* label : top->findChildren<QLabel*>()) {
                if (!label->isVisible() || !Qt::mightBeRichText(label->text())) continue;
                shown += label->text().contains(first);
                if (label->textFormat() == Qt::PlainText) continue;
                // Formatted on purpose: what it is given is escaped.
                EXPECT_TRUE(label->textFormat() == Qt::RichText && !label->text().contains(first))
                    << where << ": " << label->text().toStdString();
            }
    };
    for (const std::string& spot : {project().spots[0].id, project().spots[2].id})
        for (const Step step : kSteps) {
            desk().selection().select_spot(spot);
            desk().selection().select_region(project().regions[0].id);
            me.step(static_cast<int>(step) + 1);
            all_plain(step_name(step).toStdString());
        }
    EXPECT_GT(shown, 5) << "the names are on the screen";
    window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/names_like_markup.png");

    // Messages, tips and questions.
    emit desk().trouble(QStringLiteral("sensor %1: it is away").arg(first));
    all_plain("message");
    QToolTip::showText(window().mapToGlobal(QPoint(40, 40)), first, &window());
    bool tip = false;
    for (QWidget* top : QApplication::topLevelWidgets())
        if (auto* label = qobject_cast<QLabel*>(top); label && label->isVisible() && label->text() == first) {
            tip = true;
            EXPECT_EQ(label->textFormat(), Qt::PlainText);
        }
    EXPECT_TRUE(tip);
    QToolTip::hideText();
    ASSERT_TRUE(studio->create(path("<b>x.seam")));
    ASSERT_TRUE(desk().rename_project("edited"));
    bool asked = false;
    QTimer::singleShot(100, &window(), [&] {
        auto* box = qobject_cast<QMessageBox*>(QApplication::activeModalWidget());
        ASSERT_TRUE(box);
        asked = true;
        int labels = 0;
        for (const QLabel* label : box->findChildren<QLabel*>())
            if (label->text().contains("<b>x")) {
                ++labels;
                EXPECT_EQ(label->textFormat(), Qt::PlainText);
            }
        EXPECT_EQ(labels, 1);
        box->button(QMessageBox::Discard)->click();
    });
    EXPECT_TRUE(window().may_leave());
    EXPECT_TRUE(asked);
}

TEST_F(Edits, KeysAndMenusShowTheSignsOfAName) {
    ASSERT_TRUE(desk().rename<Spot>(project().spots[0].id, "a & b"));
    EXPECT_TRUE(without_marks(window().findChild<QAction*>("undo")->text()).endsWith(" to a & b"));
    ASSERT_TRUE(studio->create(path("this & that.seam")));
    for (auto* menu : window().findChildren<QMenu*>()) {
        if (menu->title() != "Recent") continue;
        emit menu->aboutToShow();
        EXPECT_TRUE(without_marks(menu->actions()[0]->text()).endsWith("this & that.seam"))
            << menu->actions()[0]->text().toStdString();
    }
    EXPECT_EQ(without_marks(with_signs("&a && b &")), "&a && b &");
    EXPECT_EQ(without_marks("&File"), "File");
}

TEST_F(Edits, TheReportShowsNamesThatLookLikeMarkup) {
    ASSERT_TRUE(desk().rename_project(kNames[1]));
    ASSERT_TRUE(desk().rename<SensorSetup>(project().sensors[0].id, kNames[0]));
    ASSERT_TRUE(desk().rename<Region>(project().regions[0].id, kNames[0]));
    ASSERT_TRUE(desk().rename<Spot>(project().spots[0].id, kNames[2]));
    ASSERT_TRUE(desk().save());
    const auto page = hand_over_report(desk().file(), project(), desk().facts(), {});
    ASSERT_TRUE(page) << page.error().sentence();
    const std::string html = page->html();
    for (const char* name : kNames) EXPECT_EQ(html.find(name), std::string::npos) << name;
    EXPECT_NE(html.find("&lt;b&gt;x&lt;/b&gt;"), std::string::npos);
    EXPECT_NE(html.find("a &lt; b &amp; c"), std::string::npos);
    EXPECT_NE(html.find("&lt;img src=&#39;icons"), std::string::npos);
}

class TheScene : public Edits {
  protected:
    SceneView* scene() { return window().views().scene; }
    void SetUp() override {
        Edits::SetUp();
        if (!scene()->has_opengl()) GTEST_SKIP() << "no OpenGL on this display";
        ASSERT_TRUE(QTest::qWaitFor([&] { return scene()->has_part(); }));
    }
    QPointF place_of(const Spot& spot) {
        return scene()->to_screen(workobject_from_sensor(project(), spot) * spot.reference_mm);
    }
    // Of the view: the part of it that the spots fill, 0 where one is out of it.
    double filled() {
        QRectF box;
        for (const Spot& spot : project().spots) {
            const QPointF at = place_of(spot);
            if (!scene()->rect().contains(at.toPoint())) return 0;
            box |= QRectF(at - QPointF(1, 1), QSizeF(2, 2));
        }
        return std::max(box.width() / scene()->width(), box.height() / scene()->height());
    }
    void go_near(int turns) {
        QWidget* canvas = scene()->focusProxy();
        const QPointF middle = canvas->rect().center();
        for (int i = 0; i < std::abs(turns); ++i) {
            QWheelEvent wheel(middle, canvas->mapToGlobal(middle), {}, QPoint(0, turns > 0 ? 240 : -240),
                              Qt::NoButton, {}, Qt::NoScrollPhase, false);
            QApplication::sendEvent(canvas, &wheel);
        }
    }
};

TEST_F(TheScene, IsFittedToAnotherProjectOnceAndToNoEdit) {
    EXPECT_GT(filled(), 0.3) << "the first one";
    const Project demo = project();
    // Spots far away, and no mesh.
    Project far = demo;
    far.part = {};
    for (Spot& spot : far.spots) spot.base_from_flange.pretranslate(Eigen::Vector3d(4000, 0, 0));
    ASSERT_TRUE(desk().create(folder / "far.seam", far));
    ASSERT_TRUE(QTest::qWaitFor([&] { return !scene()->has_part(); }));
    QTest::qWait(50);
    EXPECT_GT(filled(), 0.3);
    window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/another_project.png");
    // A person's look stays, whatever is edited.
    go_near(3);
    const QPointF looked_at = place_of(project().spots[0]);
    Spot moved = project().spots[1];
    moved.base_from_flange.pretranslate(Eigen::Vector3d(0, 500, 0));
    ASSERT_TRUE(desk().edit(moved));
    ASSERT_TRUE(desk().remove<Spot>(project().spots.back().id));
    ASSERT_TRUE(desk().save_as(folder / "far too.seam"));
    QTest::qWait(100);
    EXPECT_EQ(place_of(project().spots[0]), looked_at);
    // With a mesh, which is read beside the window.
    ASSERT_TRUE(desk().create(folder / "near.seam", demo));
    ASSERT_TRUE(QTest::qWaitFor([&] { return scene()->has_part(); }));
    QTest::qWait(50);
    EXPECT_GT(filled(), 0.3);
    // The same part and the same spots: it is another project all the same.
    go_near(-12);
    ASSERT_LT(filled(), 0.2);
    ASSERT_TRUE(studio->open_demo(true));
    QTest::qWait(100);
    EXPECT_GT(filled(), 0.3);
}

}  // namespace
}  // namespace seamwright
