// Spots, poses and the light at the window: taught, confirmed, edited and taken back.

#include <QCheckBox>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QSpinBox>
#include <array>
#include <cmath>
#include <random>

#include "core/geometry/three_two_one.h"
#include "devices/simulated/cell.h"
#include "devices/simulated/scene/mesh_file.h"
#include "projects/file/project_file.h"
#include "projects/reuse/exchange.h"
#include "projects/reuse/part_type_edits.h"
#include "projects/station/acquire.h"
#include "tests/app/studio/furniture.h"
#include "tests/app/studio/person.h"
#include "tests/projects/sample_project.h"
#include "widgets/editors/parameter_editor.h"
#include "widgets/pages/teach_live.h"

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
    // Wherever the focus is, and on whatever step: the field still holds what would not be saved.
    const auto refused = [&] { return editor() && editor()->refused(); };
    window().setFocus();
    me.shortcut(Qt::Key_S);
    EXPECT_TRUE(desk.modified());
    ASSERT_TRUE(refused());
    me.step(6);
    me.shortcut(Qt::Key_S);
    EXPECT_TRUE(desk.modified());
    EXPECT_EQ(window().step(), Step::teach) << "where it is mended";
    EXPECT_TRUE(me.wait([&] { return refused() && !editor()->visibleRegion().isEmpty(); }));
    QTest::keyClick(editor()->findChild<QLineEdit*>(), Qt::Key_Escape);
    me.shortcut(Qt::Key_S);
    EXPECT_FALSE(desk.modified());
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
    // Begun for one region, it is neither ended for another nor after a look at another step.
    ASSERT_GE(desk.project().regions.size(), 2U);
    const Project untouched = desk.project();
    const auto begin = [&] {
        desk.selection().select_region(before.id);
        QTest::qWait(50);
        me.click("pick_frame");
        for (const auto& at : {left, right, top}) click(at.first);
    };
    begin();
    desk.selection().select_region(desk.project().regions[1].id);
    QTest::qWait(50);
    for (const auto& at : {left, right, top}) click(at.first);
    EXPECT_EQ(desk.project().regions[1].base_from_frame.matrix(),
              untouched.regions[1].base_from_frame.matrix());
    EXPECT_EQ(me.text_of("pick_said"), "") << "it says that nothing is picked any more";
    begin();
    me.step(4);
    me.step(5);
    for (const auto& at : {left, right, top}) click(at.first);
    EXPECT_EQ(desk.project().regions.front().base_from_frame.matrix(), before.base_from_frame.matrix());
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

// The landmark goes with the template: on a part that lies elsewhere now it is where it was clicked, as the template sees it.
TEST(Landmark, IsCarriedBackIntoTheTaughtFrame) {
    Spot spot;
    spot.id = "S1";
    spot.feature.kind = "template";
    spot.feature.parameters = {{"window_dx_mm", 20}, {"window_dz_mm", 20}, {"window_dphi_deg", 10}};
    std::mt19937 random(11);
    std::normal_distribution<double> noise(0, 0.01);
    const auto contour = [&](double from, double to) {
        Profile p;
        for (double x = from; x <= to; x += 0.1) {
            p.x_mm.push_back(x + noise(random));
            p.z_mm.push_back(8 / (1 + std::exp(-x)) + 0.002 * x * x + noise(random));
            p.segment.push_back(0);
        }
        return p;
    };
    spot.feature.template_profile = contour(-12, 14);
    spot.feature.template_reference_mm = {0, 4};
    const Eigen::Vector2d wanted(6, -5);
    for (const auto& [dx, dz, deg] : {std::array{0., 0., 0.}, {5., -3., 2.}, {-7., 6., -4.}, {2., 9., 5.}}) {
        const Eigen::Rotation2Dd turn(rad_from_deg(deg));
        const Eigen::Vector2d by(dx, dz);
        const auto moved = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d { return turn * p + by; };
        Profile seen = contour(-30, 30);
        for (std::size_t k = 0; k < seen.size(); ++k) {
            const Eigen::Vector2d at = moved({seen.x_mm[k], seen.z_mm[k]});
            seen.x_mm[k] = at.x(), seen.z_mm[k] = at.y();
        }
        const auto after = with_landmark(spot, seen, moved(wanted));
        ASSERT_TRUE(after) << after.error().sentence();
        EXPECT_LT((after->feature.template_reference_mm - wanted).norm(), 0.05) << dx << " " << deg;
    }
    Profile flat;
    for (int k = 0; k < 400; ++k)
        flat.x_mm.push_back(0.1 * k), flat.z_mm.push_back(noise(random)), flat.segment.push_back(0);
    EXPECT_FALSE(with_landmark(spot, flat, wanted));
    spot.feature.template_profile = {};
    EXPECT_FALSE(with_landmark(spot, flat, wanted));
}

TEST_F(Furniture, AReferenceIsClickedForATemplateAtItsSpotAlone) {
    start(true);
    Desk& desk = studio->desk();
    DeskPerson me(window());
    ASSERT_TRUE(me.wait([&] { return desk.station().connected && !desk.worker().busy(); }));
    const auto spot = [&]() -> const Spot& { return desk.project().spots.at(0); };
    desk.selection().select_spot(spot().id);
    me.step(3);
    const auto stands = [&](const Pose& at) {
        desk.worker().go_to(spot().robot_id, at);
        return me.wait([&] {
            const auto& robots = desk.station().robots;
            return !desk.worker().busy() && robots.front().base_from_flange &&
                   distance_mm(*robots.front().base_from_flange, at) < 1e-6;
        });
    };
    QString told;
    QObject::connect(&desk, &Desk::trouble, &desk, [&](const QString& sentence) { told = sentence; });
    ProfilePlot* plot = window().views().profile;
    const auto click = [&](const Eigen::Vector2d& at) {
        told.clear();
        emit plot->reference_clicked({at.x(), at.y()});
        QApplication::processEvents();
    };
    ASSERT_EQ(spot().feature.kind, "template");
    me.click("reference_click");
    EXPECT_EQ(plot->tool(), ProfilePlot::Tool::reference);
    // Elsewhere: refused in one sentence.
    Pose elsewhere = spot().base_from_flange;
    elsewhere.translation().x() += 10;
    ASSERT_TRUE(stands(elsewhere));
    const std::string before = exact_text(desk.project());
    click({0, 10});
    EXPECT_TRUE(told.contains("does not stand at spot")) << told.toStdString();
    EXPECT_EQ(exact_text(desk.project()), before);
    // A template no more than a reference.
    told.clear();
    emit plot->window_dragged({-200, -200, 400, 400});
    QApplication::processEvents();
    EXPECT_TRUE(told.contains("does not stand at spot")) << told.toStdString();
    EXPECT_EQ(exact_text(desk.project()), before);

    ASSERT_TRUE(stands(spot().base_from_flange));
    const auto arrived = std::chrono::steady_clock::now().time_since_epoch();
    ASSERT_TRUE(me.wait([&] {
        const auto live = desk.live().latest(spot().sensor_id);
        return live && live->profile.size() > 100 && live->feature &&
               std::chrono::nanoseconds(live->frame->host_time_ns) > arrived;
    }));
    ASSERT_TRUE(spot().curve);
    const Eigen::Vector2d was = spot().feature.template_reference_mm;
    click(was + Eigen::Vector2d(12, 9));
    EXPECT_EQ(told.toStdString(), "");
    // The demo's part lies as it was taught, within what the robot repeats.
    EXPECT_LT((spot().feature.template_reference_mm - was - Eigen::Vector2d(12, 9)).norm(), 1.0);
    EXPECT_EQ(spot().reference_profile.size(), 0U) << "to be measured anew";
    EXPECT_FALSE(spot().curve) << "the pass was about the old one";
    EXPECT_EQ(me.text_of("head_state"), "Its reference is not measured yet.");
    EXPECT_EQ(plot->tool(), ProfilePlot::Tool::inspect);
    me.shortcut(Qt::Key_Z);
    EXPECT_TRUE(spot().curve);

    // Of every other kind no click is a reference.
    me.choose("feature_kind", "circle");
    QApplication::processEvents();
    EXPECT_FALSE(window().findChild<QPushButton*>("reference_click")->isVisible());
    const std::string other = exact_text(desk.project());
    click({11.9, 10.6});
    EXPECT_EQ(exact_text(desk.project()), other);
}

TEST_F(Furniture, ATickThatIsRefusedComesBackAndAMessageMovesNothing) {
    DeskPerson me(window());
    Desk& desk = studio->desk();
    me.step(3);
    desk.selection().select_spot(desk.project().spots.at(0).id);
    QApplication::processEvents();
    auto* title = window().findChild<QLabel*>("page_title");
    ASSERT_TRUE(title);
    const auto places = [&] {
        QStringList all;
        for (const QWidget* w : window().findChildren<QPushButton*>())
            if (const QPoint at = w->mapTo(&window(), QPoint());
                w->isVisible() && w->objectName() != "dismiss")
                all << QStringLiteral("%1 %2 %3").arg(w->objectName()).arg(at.x()).arg(at.y());
        return all.join("; ").toStdString();
    };
    QTest::qWait(300);
    const auto before = places();
    emit desk.trouble("Something went wrong somewhere; look at it and do what has to be done there.");
    QTest::qWait(50);
    auto* frame = window().findChild<QFrame*>("trouble");
    ASSERT_TRUE(frame->isVisible());
    EXPECT_EQ(places(), before) << "nothing moves from under the pointer";
    auto* text = window().findChild<QLabel*>("trouble_text");
    EXPECT_GE(text->height(), text->heightForWidth(text->width())) << "all of it is read";
    window().grab().save(QString(SEAMWRIGHT_SCREENS) + "/message.png");
    ASSERT_TRUE(desk.rename_project("another"));
    EXPECT_FALSE(frame->isVisible()) << "an edit has succeeded since";
    emit desk.trouble("Once more.");
    EXPECT_TRUE(frame->isVisible());
    me.step(4);
    EXPECT_FALSE(frame->isVisible()) << "it was about the step that is left";
    me.step(3);

    // A name that is used already is refused where it is typed, and stays.
    me.click("rename_spot");
    auto* dialog = window().findChild<QDialog*>("rename_dialog");
    ASSERT_TRUE(dialog && dialog->isVisible());
    auto* line = dialog->findChild<QLineEdit*>("new_name");
    const std::string id = desk.project().spots.at(0).id, used = desk.project().spots.at(1).id;
    EXPECT_EQ(line->text().toStdString(), id);
    line->setText(QString::fromStdString(used));
    dialog->findChild<QPushButton*>("rename_ok")->click();
    EXPECT_TRUE(dialog->isVisible());
    EXPECT_EQ(line->text().toStdString(), used);
    auto* refused = dialog->findChild<QLabel*>("rename_refused");
    EXPECT_TRUE(refused->isVisible());
    EXPECT_TRUE(refused->text().contains("is used already")) << refused->text().toStdString();
    EXPECT_FALSE(frame->isVisible()) << "in the dialog alone";
    line->setText("Säule links oben, dritter Punkt");
    dialog->findChild<QPushButton*>("rename_ok")->click();
    EXPECT_EQ(desk.project().spots.at(0).id, "Säule links oben, dritter Punkt");

    // Nobody signed in: the tick shows what is.
    ASSERT_TRUE(desk.save());
    desk.close();
    {
        auto file = ProjectFile::open(path("demo.seam").toStdString());
        ASSERT_TRUE(file) << file.error().sentence();
        ASSERT_TRUE(file->add_user("ada", Role::administrator, "correct horse battery"));
    }
    ASSERT_TRUE(desk.open(path("demo.seam").toStdString()));
    QTest::qWait(100);
    for (auto* asks : window().findChildren<QDialog*>("sign_in_dialog")) asks->reject();
    desk.selection().select_spot(desk.project().spots.at(0).id);
    me.step(3);
    auto* enabled = me.find<QCheckBox>("spot_enabled");
    ASSERT_TRUE(enabled && enabled->isChecked());
    enabled->click();
    QTest::qWait(50);
    EXPECT_TRUE(desk.project().spots.at(0).enabled);
    EXPECT_TRUE(enabled->isChecked());
    EXPECT_TRUE(me.text_of("trouble_text").contains("nobody is signed in"));
}

}  // namespace
}  // namespace seamwright
