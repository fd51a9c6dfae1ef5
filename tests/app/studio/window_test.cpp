// The window's own furniture: docks, recent files, drag and drop, the palette of actions, and what is dragged
// in the views.

#include <qcustomplot.h>

#include <QDoubleSpinBox>
#include <QLabel>
#include <QListWidget>
#include <QMenu>
#include <QSignalSpy>
#include <fstream>

#include "app/manual/manual_window.h"
#include "app/studio/dialogs/command_palette.h"
#include "devices/simulated/cell.h"
#include "devices/simulated/scene/mesh_file.h"
#include "tests/app/studio/furniture.h"
#include "tests/app/studio/person.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

TEST_F(Furniture, ThePaletteRunsWhatIsTyped) {
    DeskPerson me(window());
    me.shortcut(Qt::Key_K);
    auto* palette = window().findChild<CommandPalette*>();
    ASSERT_TRUE(palette);
    auto* input = palette->findChild<QLineEdit*>("palette_input");
    auto* list = palette->findChild<QListWidget*>("palette_list");
    EXPECT_EQ(list->count(), window().all_actions().size()) << "everything is listed at first";
    QTest::keyClicks(input, "regions");
    ASSERT_GT(list->count(), 0);
    EXPECT_LT(list->count(), window().all_actions().size());
    EXPECT_TRUE(list->item(0)->text().contains("Regions")) << list->item(0)->text().toStdString();
    QTest::keyClick(input, Qt::Key_Return);
    EXPECT_TRUE(me.wait([&] { return window().step() == Step::regions; }));
    EXPECT_TRUE(me.wait([&] { return !window().findChild<CommandPalette*>(); })) << "it has gone";
}

TEST_F(Furniture, ASecondStudioSaysThatTheProjectIsOpenInTheLanguageOfItsWindow) {
    StudioOptions o;
    o.language = "de";
    o.theme = "light";
    o.settings = path("other.ini");
    o.data = path("");
    o.connect = false;
    {
        Studio second(*qApp, o);  // wants the demo project, which the first has open
        EXPECT_FALSE(second.desk().is_open());
        auto* text = second.window().findChild<QLabel*>("trouble_text");
        ASSERT_TRUE(text);
        EXPECT_TRUE(text->isVisible());
        const QString said = text->text();
        EXPECT_TRUE(said.startsWith("Das Projekt wurde nicht geöffnet.")) << said.toStdString();
        EXPECT_TRUE(said.contains("demo.seam: das Projekt ist schon geöffnet")) << said.toStdString();
        EXPECT_TRUE(said.contains("dort weiterarbeiten")) << said.toStdString();
        EXPECT_FALSE(second.open(path("missing.seam")));
        EXPECT_TRUE(text->text().contains("die Datei gibt es nicht")) << text->text().toStdString();
        second.window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/second_studio.png");
    }
    EXPECT_TRUE(studio->desk().is_open());
    EXPECT_TRUE(studio->desk().rename_project("still mine"));
    EXPECT_TRUE(studio->desk().save());
}

TEST_F(Furniture, RecentFilesAreListedNewestFirstAndRemembered) {
    ASSERT_TRUE(studio->create(path("one.seam")));
    ASSERT_TRUE(studio->create(path("two.seam")));
    start(false);  // opens the demo project
    const QStringList recent = studio->recent();
    ASSERT_GE(recent.size(), 3);
    EXPECT_TRUE(recent[0].endsWith("demo.seam"));
    EXPECT_TRUE(recent[1].endsWith("two.seam"));
    EXPECT_TRUE(recent[2].endsWith("one.seam"));
    QMenu* menu = nullptr;
    for (auto* one : window().findChildren<QMenu*>())
        if (one->title() == "Recent") menu = one;
    ASSERT_TRUE(menu);
    emit menu->aboutToShow();
    ASSERT_EQ(menu->actions().size(), recent.size());
    menu->actions()[2]->trigger();
    EXPECT_EQ(studio->desk().path().filename(), "one.seam");
    EXPECT_TRUE(studio->recent()[0].endsWith("one.seam")) << "the opened one is the newest";
    EXPECT_EQ(studio->recent().count(studio->recent()[0]), 1);
}

TEST_F(Furniture, FilesAreDroppedIntoTheWindow) {
    ASSERT_TRUE(studio->create(path("one.seam")));
    ASSERT_TRUE(studio->create(path("two.seam")));
    ASSERT_TRUE(drop(path("one.seam")));
    EXPECT_EQ(studio->desk().path().filename(), "one.seam");
    const auto cell = SimulatedCell::open(nlohmann::json::object()).value();
    const std::vector<std::byte> mesh = ply_bytes(cell->part_mesh());
    std::ofstream(folder / "door.ply", std::ios::binary)
        .write(reinterpret_cast<const char*>(mesh.data()), static_cast<std::streamsize>(mesh.size()));
    ASSERT_TRUE(drop(path("door.ply")));
    EXPECT_TRUE(QTest::qWaitFor([&] { return !studio->desk().project().part.mesh_ply.empty(); }));
    studio->desk().undo_stack().undo();
    EXPECT_TRUE(studio->desk().project().part.mesh_ply.empty()) << "an import is an edit like others";
    EXPECT_FALSE(drop(path("notes.txt")));
    std::ofstream(folder / "broken.seam") << "no project";
    ASSERT_TRUE(drop(path("broken.seam")));
    EXPECT_EQ(studio->desk().path().filename(), "one.seam") << "what cannot be opened changes nothing";
    DeskPerson me(window());
    EXPECT_FALSE(me.text_of("trouble_text").isEmpty());
}

TEST_F(Furniture, DocksFloatFillTheWindowAndAreRemembered) {
    auto* scene = dock("dock_scene");
    ASSERT_TRUE(scene);
    DeskPerson me(window());
    auto* loose = scene->titleBarWidget()->findChild<QPushButton*>("dock_float");
    ASSERT_TRUE(loose);
    QTest::mouseClick(loose, Qt::LeftButton);
    EXPECT_TRUE(scene->isFloating());
    window().remember();
    start(false);
    EXPECT_TRUE(dock("dock_scene")->isFloating()) << "as it was left";
    window().findChild<QAction*>("reset_layout")->trigger();
    EXPECT_FALSE(dock("dock_scene")->isFloating());

    auto* profile = dock("dock_profile");
    window().views().profile->setFocus();
    QTest::keyClick(&window(), Qt::Key_F11);
    EXPECT_FALSE(window().centralWidget()->isVisible());
    EXPECT_FALSE(dock("dock_scene")->isVisible());
    EXPECT_TRUE(profile->isVisible());
    QTest::keyClick(&window(), Qt::Key_F11);
    EXPECT_TRUE(window().centralWidget()->isVisible());
    EXPECT_TRUE(dock("dock_scene")->isVisible());
}

TEST_F(Furniture, TheJitterWindowIsDraggedOnTheAlignmentPlot) {
    start(true);
    DeskPerson me(window());
    Desk& desk = studio->desk();
    ASSERT_TRUE(me.wait([&] { return desk.station().connected; }));
    me.step(4);
    me.click("start_pass");
    ASSERT_TRUE(me.wait([&] { return desk.worker().busy(); }));
    ASSERT_TRUE(me.wait([&] { return !desk.worker().busy(); }));
    QTest::qWait(100);
    AlignView* view = window().views().align;
    QSignalSpy dragged(view, &AlignView::jitter_dragged);
    QCustomPlot* plot = qobject_cast<QCustomPlot*>(view->focusProxy());
    ASSERT_TRUE(plot);
    const QCPAxisRect* row = plot->axisRect(0);
    const auto at = [&](double travel) {
        return QPoint(static_cast<int>(std::lround(row->axis(QCPAxis::atBottom)->coordToPixel(travel))),
                      row->rect().center().y());
    };
    const double before = view->jitter_mm();
    DeskPerson::drag(plot, at(before), at(before + 4));
    ASSERT_GT(dragged.count(), 0);
    EXPECT_NEAR(view->jitter_mm(), before + 4, 0.3);
    const double wide = view->jitter_mm();
    DeskPerson::drag(plot, at(-wide), at(-2));
    EXPECT_NEAR(view->jitter_mm(), 2, 0.3) << "the other line moves it too: they are symmetric";
    // What is accepted then is what was dragged.
    ASSERT_EQ(me.text_of("align_verdict"), "FROZEN");
    EXPECT_EQ(view->verdict(), "FROZEN");
    // At a tolerance beyond what the project requires, standing still is no good news.
    auto* tolerance = me.find<QDoubleSpinBox>("pass_tolerance");
    ASSERT_TRUE(tolerance);
    me.write(tolerance->findChild<QLineEdit*>(), "5");
    EXPECT_EQ(me.text_of("align_verdict"), "frozen at a widened tolerance");
    EXPECT_EQ(view->verdict(), "WIDENED");
    EXPECT_EQ(me.find<QLabel>("align_verdict")->palette().color(QPalette::WindowText),
              style::attention(window().palette()));
    me.click("accept_pass");
    EXPECT_TRUE(me.text_of("head_state").contains("its pass is not"))
        << me.text_of("head_state").toStdString();
    me.write(tolerance->findChild<QLineEdit*>(), "0.05");
    ASSERT_EQ(me.text_of("align_verdict"), "FROZEN");
    me.click("accept_pass");
    EXPECT_NEAR(desk.project().spots.front().jitter_mm, view->jitter_mm(), 1e-9);
}

TEST_F(Furniture, ADistanceIsMeasuredOnTheProfile) {
    ProfilePlot* plot = window().views().profile;
    plot->set_view(QRectF(-30, -20, 60, 40));
    QSignalSpy measured(plot, &ProfilePlot::measured);
    QWidget* canvas = plot->focusProxy();
    canvas->setFocus();
    QTest::keyClick(canvas, Qt::Key_M);
    ASSERT_EQ(plot->tool(), ProfilePlot::Tool::measure);
    for (const QPointF mm : {QPointF(-8, -3), QPointF(4, 2)})
        QTest::mouseClick(canvas, Qt::LeftButton, {}, canvas->mapFrom(plot, plot->to_screen(mm)).toPoint());
    ASSERT_EQ(measured.count(), 1);
    EXPECT_NEAR(measured[0][0].toDouble(), 13, 0.3);
    EXPECT_NEAR(measured[0][1].toDouble(), 22.62, 1.5);
    QTest::keyClick(canvas, Qt::Key_Escape);
    EXPECT_EQ(plot->tool(), ProfilePlot::Tool::inspect);
}

TEST_F(Furniture, ARegionOfInterestIsDraggedOnTheCameraImage) {
    CameraView* view = window().views().camera;
    dock("dock_camera")->show();
    dock("dock_camera")->raise();
    QTest::qWait(50);
    std::vector<std::byte> pixels(320 * 200);
    StripeImage image;
    image.pixels = pixels.data();
    image.width = 320;
    image.height = 200;
    image.row_bytes = 320;
    image.bit_depth = 8;
    view->set_frame(image, nullptr);
    view->fit();
    QSignalSpy dragged(view, &CameraView::region_dragged);
    QWidget* surface = view->focusProxy();
    const auto at = [&](int u, int v) {
        return surface->mapFrom(view, view->to_screen(QPointF(u, v))).toPoint();
    };
    DeskPerson::drag(surface, at(40, 30), at(200, 120));
    EXPECT_EQ(dragged.count(), 0) << "without the tool a drag moves the picture";
    view->fit();
    view->set_region_tool(true);
    DeskPerson::drag(surface, at(40, 30), at(200, 120));
    ASSERT_EQ(dragged.count(), 1);
    const QRect region = dragged[0][0].toRect();
    EXPECT_NEAR(region.left(), 40, 1);
    EXPECT_NEAR(region.top(), 30, 1);
    EXPECT_NEAR(region.right(), 200, 1);
    EXPECT_NEAR(region.bottom(), 120, 1);
    DeskPerson me(window());
    EXPECT_TRUE(me.text_of("trouble_text").contains("part of its image"))
        << "no sensor is connected that could";
}

TEST_F(Furniture, F1OpensTheManualAtTheStep) {
    window().show_step(Step::teach);
    QTest::keyClick(&window(), Qt::Key_F1);
    auto* manual = window().findChild<ManualWindow*>();
    ASSERT_TRUE(manual);
    EXPECT_TRUE(manual->isVisible());
    EXPECT_EQ(manual->page(), "teach");
    auto* words = manual->findChild<QLineEdit*>("manual_words");
    auto* contents = manual->findChild<QListWidget*>("manual_contents");
    words->setText("Modbus");
    int left = 0;
    for (int k = 0; k < contents->count(); ++k) left += contents->item(k)->isHidden() ? 0 : 1;
    EXPECT_EQ(left, 1);
    EXPECT_EQ(manual->page(), "production") << "the page with the words is shown";
    manual->grab().save(QString(SEAMWRIGHT_SCREENS) + "/manual.png");
    words->clear();
    manual->findChild<QPushButton*>("manual_back")->click();
    EXPECT_EQ(manual->page(), "teach");
    window().activateWindow();
    window().show_step(Step::run);
    QTest::keyClick(&window(), Qt::Key_F1);
    EXPECT_EQ(manual->page(), "run");
}

}  // namespace
}  // namespace seamwright
