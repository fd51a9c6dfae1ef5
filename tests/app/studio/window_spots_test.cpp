// Spots, poses and the light at the window: taught, confirmed, edited and taken back.

#include <QCheckBox>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QSpinBox>

#include "core/geometry/three_two_one.h"
#include "devices/simulated/cell.h"
#include "devices/simulated/scene/mesh_file.h"
#include "projects/file/project_file.h"
#include "projects/reuse/exchange.h"
#include "projects/reuse/part_type_edits.h"
#include "projects/station/acquire.h"
#include "tests/app/studio/furniture.h"
#include "tests/app/studio/person.h"
#include "widgets/editors/parameter_editor.h"

namespace seamwright {
namespace {

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

// A number that is typed counts when the project is saved, one that is refused holds the saving up, and a field with nothing of
// its own to take back leaves undo to the project.
TEST_F(Furniture, WhatIsTypedIsSaved) {
    DeskPerson me(window());
    me.step(3);
    Desk& desk = studio->desk();
    const auto seen = [](const ParameterEditor* e) {
        return e->isVisible() && e->isEnabled() && e->findChild<QLineEdit*>() &&
               e->value() + 1 <= e->info().maximum;
    };
    // The page may make its fields anew with every edit.
    std::string name;
    const auto editor = [&]() -> ParameterEditor* {
        for (ParameterEditor* e : window().findChildren<ParameterEditor*>())
            if (seen(e) && (name.empty() || e->info().name == name)) return e;
        return nullptr;
    };
    ASSERT_TRUE(editor());
    name = editor()->info().name;
    me.look_at(editor());
    const double before = editor()->value();
    const auto type = [&](const QString& text) {
        auto* line = editor()->findChild<QLineEdit*>();
        QApplication::setActiveWindow(&window());
        line->setFocus();
        line->selectAll();
        QTest::keyClicks(line, text);
    };
    type(QString::number(before + 1));
    EXPECT_EQ(editor()->value(), before) << "not taken yet";
    me.shortcut(Qt::Key_S);
    ASSERT_TRUE(editor());
    EXPECT_EQ(editor()->value(), before + 1);
    EXPECT_FALSE(desk.modified());
    {
        const auto file = ProjectFile::open(desk.path(), FileAccess::read_only);
        ASSERT_TRUE(file) << file.error().sentence();
        EXPECT_EQ(export_project(file->load().value()), export_project(desk.project()));
    }
    auto* line = editor()->findChild<QLineEdit*>();
    line->setFocus();
    QTest::keyClick(line, Qt::Key_Z, Qt::ControlModifier);
    QApplication::processEvents();
    EXPECT_TRUE(desk.modified()) << "undone from within the field";
    EXPECT_EQ(editor()->value(), before);
    type("x");
    me.shortcut(Qt::Key_S);
    EXPECT_TRUE(editor()->refused());
    EXPECT_TRUE(desk.modified()) << "nothing is saved while a value is refused";
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

}  // namespace
}  // namespace seamwright
