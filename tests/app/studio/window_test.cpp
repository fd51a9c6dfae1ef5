// The window's own furniture: docks, recent files, drag and drop, the palette of actions, and what is dragged
// in the views.

#include <gtest/gtest.h>
#include <qcustomplot.h>
#include <unistd.h>

#include <QCheckBox>
#include <QDropEvent>
#include <QLabel>
#include <QListWidget>
#include <QMenu>
#include <QMimeData>
#include <QSignalSpy>
#include <QSpinBox>
#include <QUrl>
#include <filesystem>
#include <fstream>

#include "app/manual/manual_window.h"
#include "app/studio/command_palette.h"
#include "app/studio/studio.h"
#include "core/geometry/three_two_one.h"
#include "devices/simulated/cell.h"
#include "devices/simulated/scene/mesh_file.h"
#include "projects/file/project_file.h"
#include "projects/reuse/part_type_edits.h"
#include "projects/station/acquire.h"
#include "tests/app/studio/person.h"

namespace seamwright {
namespace {

class Furniture : public testing::Test {
  protected:
    std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("seamwright_window_" + std::to_string(::getpid()));
    std::unique_ptr<Studio> studio;

    void SetUp() override {
        std::filesystem::create_directories(folder);
        QApplication::setAttribute(Qt::AA_DontUseNativeDialogs);
        start(false);
    }
    ~Furniture() override {
        studio.reset();
        std::filesystem::remove_all(folder);
    }
    void start(bool connect) {
        studio.reset();
        StudioOptions o;
        o.language = "en";
        o.theme = "light";
        o.settings = path("settings.ini");
        o.data = path("");
        o.connect = connect;
        studio = std::make_unique<Studio>(*qApp, o);
        studio->window().resize(1280, 800);
        QApplication::setActiveWindow(&window());
        QApplication::processEvents();
    }
    QString path(const std::string& name) const { return QString::fromStdString((folder / name).string()); }
    MainWindow& window() { return studio->window(); }
    QDockWidget* dock(const char* name) { return window().findChild<QDockWidget*>(name); }
    // Drops a file onto the window; false: the window does not take it.
    bool drop(const QString& file) {
        QMimeData data;
        data.setUrls({QUrl::fromLocalFile(file)});
        const QPoint at(200, 200);
        QDragEnterEvent enter(at, Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
        enter.ignore();
        QApplication::sendEvent(&window(), &enter);
        if (!enter.isAccepted()) return false;
        QDropEvent event(at, Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
        QApplication::sendEvent(&window(), &event);
        QApplication::processEvents();
        return true;
    }
};

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

TEST_F(Furniture, ASpotIsToldToStandStillAtTheTrigger) {
    DeskPerson me(window());
    me.step(3);
    ASSERT_FALSE(studio->desk().project().spots.at(0).stop_at_trigger);
    auto* box = me.find<QCheckBox>("spot_stop");
    ASSERT_TRUE(box);
    me.look_at(box);
    box->setFocus();
    QTest::keyClick(box, Qt::Key_Space);
    EXPECT_TRUE(studio->desk().project().spots.at(0).stop_at_trigger);
    me.shortcut(Qt::Key_Z);
    EXPECT_FALSE(studio->desk().project().spots.at(0).stop_at_trigger);
    EXPECT_FALSE(box->isChecked());
}

TEST_F(Furniture, ASpotFromTheDrawingIsConfirmedOnThePart) {
    start(true);
    Desk& desk = studio->desk();
    desk.selection().select_spot(desk.project().spots.at(0).id);
    const auto spot = [&]() -> const Spot& { return desk.project().spots.at(0); };
    DeskPerson me(window());
    me.step(3);
    ASSERT_GT(spot().reference_profile.size(), 0U);
    // As a proposal leaves it: drawn a little beside where the part is.
    Spot drawn = spot();
    drawn.reference_state = ReferenceState::from_drawing;
    drawn.reference_mm += Eigen::Vector3d(0.2, 0, -0.1);
    drawn.drawn = DrawingOrigin{"door.step", 1000, 1, "e1", 100, drawn.reference_mm};
    ASSERT_TRUE(desk.edit(drawn, "taken from the drawing"));
    auto* text = me.find<QLabel>("reference");
    ASSERT_TRUE(text);
    EXPECT_TRUE(me.wait([&] { return text->text().contains("not confirmed"); }))
        << text->text().toStdString();
    window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/spot_from_drawing.png");
    me.click("confirm_spot");
    EXPECT_TRUE(me.wait([&] { return spot().reference_state == ReferenceState::measured; }));
    EXPECT_NEAR(spot().reference_mm.x(), drawn.reference_mm.x() - 0.2, 0.1);
    EXPECT_TRUE(me.wait([&] { return !window().findChild<QPushButton*>("confirm_spot")->isVisible(); }));
    window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/spot_confirmed.png");
    me.shortcut(Qt::Key_Z);
    EXPECT_EQ(spot().reference_state, ReferenceState::from_drawing) << "one step back";
}

TEST_F(Furniture, OfSeveralKindsOfPartsTheChosenOneIsMeasured) {
    start(true);
    Desk& desk = studio->desk();
    DeskPerson me(window());
    me.step(8);
    for (const auto* hidden : window().findChildren<QComboBox*>("part_type"))
        EXPECT_FALSE(hidden->isVisible()) << "a project of one kind of part";
    const auto add = [&](const char* id, const char* of) {
        const auto after = *of ? clone_part_type(desk.project(), of, {id, "", 0})
                               : add_part_type(desk.project(), {id, "", 0});
        ASSERT_TRUE(after) << after.error().sentence();
        ASSERT_TRUE(desk.edit_project([&](Project& p) { p = *after; }, "part type"));
    };
    add("left", "");
    add("right", "left");
    QApplication::processEvents();
    auto* types = me.find<QComboBox>("part_type");
    ASSERT_TRUE(types);
    EXPECT_EQ(types->currentText(), "left");
    me.choose("part_type", "right");
    EXPECT_EQ(desk.selection().part_type(), "right");
    window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/part_type.png");
    const auto runs = desk.runs()->size();
    me.click("measure");
    ASSERT_TRUE(me.wait([&] { return desk.runs()->size() > runs && !desk.worker().busy(); }));
    const RunRecord run = desk.run(desk.runs()->front().number).value();
    EXPECT_EQ(run.type_id, "right");
    ASSERT_FALSE(run.spots.empty());
    for (const SpotMeasurement& m : run.spots)
        EXPECT_EQ(find_spot(desk.project(), m.spot_id)->type_id, "right") << m.spot_id;
    // The chosen type is gone: one that there is takes its place.
    const auto without = remove_part_type(desk.project(), "right", true);
    ASSERT_TRUE(without) << without.error().sentence();
    ASSERT_TRUE(desk.edit_project([&](Project& p) { p = *without; }, "part type"));
    EXPECT_EQ(desk.selection().part_type(), "left");
}

TEST_F(Furniture, AFrameIsPickedOnThePartByThreeTwoOne) {
    DeskPerson me(window());
    Desk& desk = studio->desk();
    desk.selection().select_region(desk.project().regions.front().id);
    me.step(5);
    SceneView* scene = window().views().scene;
    if (!scene->has_opengl()) GTEST_SKIP() << "no OpenGL on this display";
    ASSERT_TRUE(QTest::qWaitFor([&] { return scene->has_part(); })) << "its mesh is read beside the window";
    scene->show_view(SceneView::View::front);
    QTest::qWait(100);
    QWidget* canvas = scene->focusProxy();
    std::vector<Eigen::Vector3d> hits;
    QObject::connect(scene, &SceneView::part_picked, &window(),
                     [&](double x, double y, double z) { hits.emplace_back(x, y, z); });
    const auto click = [&](const QPoint& at) { QTest::mouseClick(canvas, Qt::LeftButton, {}, at); };
    // Where on the picture the part is.
    std::vector<std::pair<QPoint, Eigen::Vector3d>> places;
    for (int column = 1; column < 24; ++column)
        for (int row = 1; row < 16; ++row) {
            const QPoint at(column * canvas->width() / 24, row * canvas->height() / 16);
            const std::size_t before = hits.size();
            click(at);
            if (hits.size() > before) places.emplace_back(at, hits.back());
        }
    ASSERT_GT(places.size(), 10U);
    const Region before = desk.project().regions.front();
    const auto by = [&](int axis, bool least) {
        return *std::min_element(places.begin(), places.end(), [&](const auto& a, const auto& b) {
            return least ? a.second[axis] < b.second[axis] : a.second[axis] > b.second[axis];
        });
    };
    const auto left = by(0, true), right = by(0, false), top = by(1, false);
    desk.selection().select_region(before.id);
    me.click("pick_frame");
    for (const auto& at : {left, right, top, left, right}) click(at.first);
    EXPECT_EQ(desk.project().regions.front().base_from_frame.matrix(), before.base_from_frame.matrix())
        << "not before the last click";
    EXPECT_TRUE(me.text_of("pick_said").contains("origin")) << me.text_of("pick_said").toStdString();
    click(top.first);
    const auto frame = frame_by_three_two_one({left.second, right.second, top.second},
                                              {left.second, right.second}, top.second);
    ASSERT_TRUE(frame) << frame.error().sentence();
    const Pose wanted = desk.project().part.base_from_workobject * *frame;
    EXPECT_LT((desk.project().regions.front().base_from_frame.matrix() - wanted.matrix()).norm(), 1e-9);
    const Eigen::Vector3d z = frame->linear().col(2);
    EXPECT_GT(z.z(), 0.5) << "out of the part, as it was looked at";
    desk.undo_stack().undo();
    EXPECT_EQ(desk.project().regions.front().base_from_frame.matrix(), before.base_from_frame.matrix());
    click(top.first);
    EXPECT_EQ(desk.project().regions.front().base_from_frame.matrix(), before.base_from_frame.matrix())
        << "a click after it is no pick";
}

TEST_F(Furniture, ViaPointsAreAddedWhereTheRobotStandsAndTakenOut) {
    start(true);
    Desk& desk = studio->desk();
    desk.selection().select_spot(desk.project().spots.at(1).id);
    const auto via = [&]() -> const std::vector<Pose>& { return desk.project().spots.at(1).via; };
    DeskPerson me(window());
    me.step(3);
    ASSERT_TRUE(me.wait([&] { return desk.station().connected && !desk.worker().busy(); }));
    const auto stands = [&](const Pose& at) {
        desk.worker().go_to(desk.project().robots.front().id, at);
        return me.wait([&] {
            const auto& robots = desk.station().robots;
            return !robots.empty() && robots.front().base_from_flange &&
                   distance_mm(*robots.front().base_from_flange, at) < 1e-6;
        });
    };
    const Pose first = desk.project().spots.at(0).base_from_flange;
    Pose second = first;
    second.translation().z() += 100;
    ASSERT_TRUE(stands(first));
    me.click("add_via");
    ASSERT_TRUE(stands(second));
    me.click("add_via");
    ASSERT_EQ(via().size(), 2U);
    EXPECT_LT(distance_mm(via()[0], first), 1e-6);
    EXPECT_LT(distance_mm(via()[1], second), 1e-6);
    auto* list = me.find<QListWidget>("spot_via");
    ASSERT_TRUE(list);
    ASSERT_EQ(list->count(), 2);
    list->setCurrentRow(0);
    me.click("remove_via");
    ASSERT_EQ(via().size(), 1U);
    EXPECT_LT(distance_mm(via()[0], second), 1e-6);
    me.shortcut(Qt::Key_Z);
    EXPECT_EQ(via().size(), 2U);
    EXPECT_EQ(list->count(), 2);
    // They reach the robot's program and are there when the file is opened again.
    EXPECT_EQ(measuring_program(desk.project(), desk.project().robots.front().id).at(1).via.size(), 2U);
    ASSERT_TRUE(desk.save());
    auto file = ProjectFile::open(path("demo.seam").toStdString(), FileAccess::read_only);
    ASSERT_TRUE(file) << file.error().sentence();
    EXPECT_EQ(file->load()->spots.at(1).via.size(), 2U);
}

TEST_F(Furniture, WhatWasMeasuredAtAnotherPoseOrFeatureGoesWithTheEdit) {
    start(true);
    Desk& desk = studio->desk();
    const auto spot = [&]() -> const Spot& { return desk.project().spots.at(0); };
    desk.selection().select_spot(spot().id);
    DeskPerson me(window());
    me.step(3);
    ASSERT_GT(spot().reference_profile.size(), 0U);

    me.write_pose("spot_pose", spot().base_from_flange);
    EXPECT_GT(spot().reference_profile.size(), 0U) << "the pose through its text is the same pose";
    Pose moved = spot().base_from_flange;
    moved.translation().x() += 5;
    me.write_pose("spot_pose", moved);
    EXPECT_EQ(spot().reference_profile.size(), 0U);
    EXPECT_FALSE(spot().curve);
    EXPECT_EQ(me.text_of("reference"), "Not measured yet.");
    me.shortcut(Qt::Key_Z);
    EXPECT_GT(spot().reference_profile.size(), 0U);

    me.choose("feature_kind", "circle");
    EXPECT_EQ(spot().reference_profile.size(), 0U);
    while (desk.undo_stack().canUndo()) desk.undo_stack().undo();

    // The edit overtakes the measurement: neither is mixed with the other.
    ASSERT_TRUE(me.wait([&] { return desk.station().connected && !desk.worker().busy(); }));
    const Eigen::Vector3d before = spot().reference_mm;
    me.find<QSpinBox>("repeats")->setValue(60);  // time enough for the hand
    QString told;
    QObject::connect(&desk, &Desk::trouble, &desk, [&](const QString& sentence) { told = sentence; });
    me.click("measure_reference");
    me.write_pose("spot_pose", moved);
    ASSERT_TRUE(me.wait([&] { return !told.isEmpty(); }));
    EXPECT_TRUE(told.contains("changed while its reference was measured")) << told.toStdString();
    EXPECT_EQ(spot().reference_profile.size(), 0U);
    EXPECT_EQ(spot().reference_mm, before);
}

TEST_F(Furniture, TheLightOfASpotIsFoundKeptUndoneAndTakenBack) {
    start(true);
    Desk& desk = studio->desk();
    DeskPerson me(window());
    ASSERT_TRUE(me.wait([&] { return desk.station().connected && !desk.worker().busy(); }));
    desk.selection().select_spot(desk.project().spots.front().id);
    me.step(3);
    const auto spot = [&]() -> const Spot& { return desk.project().spots.front(); };
    EXPECT_EQ(me.text_of("spot_light"), "As the sensor stands.");
    me.click("find_light");
    ASSERT_TRUE(me.wait([&] { return !spot().light.empty(); }));
    EXPECT_GT(spot().light.settings.at("exposure_us"), 50);
    EXPECT_GT(spot().reference_profile.size(), 0U) << "light takes no reference away";
    const QString said = QStringLiteral("Exposure %1 µs").arg(spot().light.settings.at("exposure_us"));
    EXPECT_TRUE(me.wait([&] { return me.text_of("spot_light").contains(said); }))
        << me.text_of("spot_light").toStdString();
    EXPECT_TRUE(me.text_of("light_found").contains("Found"));
    ASSERT_TRUE(me.wait([&] { return !desk.worker().busy(); }));
    // What is measured from then on is cut with it, and the reference remembers it.
    me.click("measure_reference");
    ASSERT_TRUE(me.wait(
        [&] { return spot().reference_light && spot().reference_light->settings == spot().light.settings; }));
    me.click("clear_light");
    EXPECT_TRUE(spot().light.empty());
    me.shortcut(Qt::Key_Z);
    EXPECT_FALSE(spot().light.empty());
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
