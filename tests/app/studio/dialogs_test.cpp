// The deeds with a window of their own: the path corrected by a run, the controller's program, spots from the drawing, the
// gap along a path.

#include <gtest/gtest.h>

#include <QAction>
#include <QMouseEvent>
#include <fstream>

#include "app/studio/studio.h"
#include "devices/drawing/door_step.h"
#include "devices/exchange/tables/path_csv.h"
#include "devices/simulated/scene/door.h"
#include "projects/file/project_file.h"
#include "projects/reuse/part_type_edits.h"
#include "projects/reuse/simulated_truth.h"
#include "tests/app/studio/person.h"
#include "widgets/dialogs/gap_dialog.h"
#include "widgets/dialogs/path_dialog.h"
#include "widgets/dialogs/place_dialog.h"
#include "widgets/dialogs/program_dialog.h"
#include "widgets/dialogs/record_dialog.h"

namespace seamwright {
namespace {

class Dialogs : public testing::Test {
  protected:
    std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("seamwright_dialogs_" + std::to_string(::getpid()));
    std::unique_ptr<Studio> studio;

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
        QApplication::setActiveWindow(&studio->window());
        QApplication::processEvents();
    }
    ~Dialogs() override {
        studio.reset();
        std::filesystem::remove_all(folder);
    }
    MainWindow& window() { return studio->window(); }
    template <class T>
    T* opened(const char* action, const char* name) {
        window().findChild<QAction*>(action)->trigger();
        QApplication::processEvents();
        auto* dialog = dynamic_cast<T*>(window().findChild<QDialog*>(name));
        EXPECT_TRUE(dialog && dialog->isVisible()) << name;
        return dialog;
    }
    // The door's bead as taught, in the robot's base.
    QString bead() {
        ApplicationPath path;
        const Pose& base_from_workobject = studio->desk().project().part.base_from_workobject;
        for (const Eigen::Vector3d& p : door_bead_path()) {
            Pose at = base_from_workobject;
            at.translation() = base_from_workobject * p;
            path.points.push_back({at, {}});
        }
        const auto file = folder / "bead.csv";
        std::ofstream(file) << path_csv(path, PathNotation::kuka);
        return QString::fromStdString(file.string());
    }
    static QString word(QDialog& dialog, const char* label) {
        return dialog.findChild<QLabel*>(QString::fromLatin1(label))->text();
    }
};

TEST_F(Dialogs, APathIsCorrectedByARunShownAndWritten) {
    DeskPerson me(window());
    Desk& desk = studio->desk();
    ASSERT_TRUE(desk.is_open());
    auto* dialog = opened<PathDialog>("corrected_path", "path_dialog");
    ASSERT_TRUE(dialog);
    auto* write = dialog->findChild<QPushButton*>("path_write");
    EXPECT_FALSE(write->isEnabled());
    dialog->take_file(bead());
    EXPECT_TRUE(word(*dialog, "path_verdict").contains("measure a part first"));
    EXPECT_FALSE(dialog->write_into(QString::fromStdString(folder.string()))) << "nothing that may be run";

    ASSERT_TRUE(me.wait([&] { return desk.station().connected; }));
    ASSERT_TRUE(desk.place_simulated_part(make_pose(rotation_exp({0.001, -0.002, 0.001}), {3, -2, 1}), 0, 0));
    desk.worker().connect_devices();
    QTest::qWait(300);
    ASSERT_TRUE(me.wait([&] { return desk.station().connected && !desk.worker().busy(); }));
    window().findChild<QAction*>("measure_now")->trigger();
    ASSERT_TRUE(QTest::qWaitFor([&] { return desk.runs() && !desk.runs()->empty(); }, 3 * kPatienceMs));
    QApplication::processEvents();

    // The run is in the list, and the path moves as the door does.
    const auto* runs = dialog->findChild<QComboBox*>("path_run");
    ASSERT_TRUE(me.wait([&] { return runs->count() == 1; }));
    EXPECT_TRUE(write->isEnabled()) << word(*dialog, "path_verdict").toStdString();
    EXPECT_TRUE(word(*dialog, "path_verdict").contains("moved by up to"))
        << word(*dialog, "path_verdict").toStdString();
    EXPECT_EQ(dialog->findChild<QTableWidget*>("path_regions")->rowCount(),
              static_cast<int>(desk.project().regions.size()));
    const auto out = folder / "krc";
    const auto written = dialog->write_into(QString::fromStdString(out.string()));
    ASSERT_TRUE(written) << written.error().sentence();
    const auto taught = read_path_csv(folder / "bead.csv", PathNotation::kuka),
               moved = read_path_csv(out / "seamwright_path.csv", PathNotation::kuka);
    ASSERT_TRUE(taught && moved);
    ASSERT_EQ(moved->points.size(), taught->points.size());
    const Pose& base_from_workobject = desk.project().part.base_from_workobject;
    const Pose truth = make_pose(rotation_exp({0.001, -0.002, 0.001}), {3, -2, 1});
    for (std::size_t i = 0; i < taught->points.size(); ++i) {
        const Eigen::Vector3d on_door =
            base_from_workobject.inverse() * taught->points[i].frame_from_tool.translation();
        EXPECT_LT((base_from_workobject * (truth * on_door) - moved->points[i].frame_from_tool.translation())
                      .norm(),
                  0.3)
            << i;
    }
    // On the screen, with the scene in view.
    window().findChild<QAction*>("show_dock_scene")->trigger();
    window()
        .findChild<QDialog*>("path_dialog")
        ->grab()
        .save(QString(SEAMWRIGHT_SCREENS) + "/dialog_path.png");
    me.picture("path_in_scene");

    // The notation is not the table's: a sentence, and nothing to write.
    dialog->findChild<QComboBox*>("path_notation")->setCurrentText("abb");
    EXPECT_FALSE(write->isEnabled());
    EXPECT_FALSE(word(*dialog, "path_verdict").isEmpty());
    dialog->findChild<QComboBox*>("path_notation")->setCurrentText("kuka");
    EXPECT_TRUE(write->isEnabled());
    EXPECT_EQ(opened<PathDialog>("corrected_path", "path_dialog"), dialog) << "one of a kind";
    dialog->close();
    EXPECT_TRUE(me.wait([&] { return !window().findChild<QDialog*>("path_dialog"); }));
}

TEST_F(Dialogs, TheControllersProgramIsWrittenForTheProjectOnTheScreen) {
    Desk& desk = studio->desk();
    auto* dialog = opened<ProgramDialog>("robot_program", "program_dialog");
    ASSERT_TRUE(dialog);
    auto* moves = dialog->findChild<QTableWidget*>("program_moves");
    auto* write = dialog->findChild<QPushButton*>("program_write");
    const auto enabled = std::count_if(desk.project().spots.begin(), desk.project().spots.end(),
                                       [](const Spot& s) { return s.enabled; });
    EXPECT_EQ(moves->rowCount(), enabled);
    for (const char* brand : {"kuka", "abb", "ur"}) {
        dialog->findChild<QComboBox*>("program_brand")->setCurrentText(brand);
        ASSERT_TRUE(write->isEnabled()) << word(*dialog, "program_verdict").toStdString();
        const auto files = dialog->write_into(QString::fromStdString((folder / brand).string()));
        ASSERT_TRUE(files) << files.error().sentence();
        EXPECT_FALSE(files->empty());
        for (const auto& file : *files) EXPECT_GT(std::filesystem::file_size(file), 0u) << file;
    }
    // An edit that is not saved is in it.
    ASSERT_TRUE(desk.set_spot_enabled(desk.project().spots.front().id, false));
    QApplication::processEvents();
    EXPECT_EQ(moves->rowCount(), enabled - 1);
    for (const Spot& spot : std::vector<Spot>(desk.project().spots))
        (void)desk.set_spot_enabled(spot.id, false);
    QApplication::processEvents();
    EXPECT_FALSE(write->isEnabled()) << "no spot, no program";
    EXPECT_FALSE(word(*dialog, "program_verdict").isEmpty());
    dialog->grab().save(QString(SEAMWRIGHT_SCREENS) + "/dialog_program.png");
}

// The second type's files would take the place of the first one's on the controller: both say so.
TEST_F(Dialogs, TwoPartTypesWhoseProgramsHaveTheSameFilesAreNamed) {
    Desk& desk = studio->desk();
    auto project = add_part_type(desk.project(), {"left", "", 1});
    ASSERT_TRUE(project) << project.error().sentence();
    const auto file = folder / "types.seam";
    const auto made = clone_part_type(*project, "left", {"right", "", 2});
    ASSERT_TRUE(made) << made.error().sentence();
    ASSERT_TRUE(ProjectFile::create(file, *made));
    ASSERT_TRUE(studio->open(QString::fromStdString(file.string())));
    auto* dialog = opened<ProgramDialog>("robot_program", "program_dialog");
    ASSERT_TRUE(dialog);
    auto* type = dialog->findChild<QComboBox*>("program_type");
    ASSERT_EQ(type->count(), 2);
    for (const auto& [one, other] : {std::pair("left", "right"), std::pair("right", "left")})
        for (const char* brand : {"kuka", "abb", "ur"}) {
            type->setCurrentText(one);
            dialog->findChild<QComboBox*>("program_brand")->setCurrentText(brand);
            const QString said = word(*dialog, "program_verdict");
            EXPECT_TRUE(said.contains(QString("part type %1 have the same names").arg(other)))
                << brand << ": " << said.toStdString();
            EXPECT_TRUE(dialog->findChild<QPushButton*>("program_write")->isEnabled());
        }
    dialog->grab().save(QString(SEAMWRIGHT_SCREENS) + "/dialog_program_types.png");
}

// From the STEP file to spots in the project, with the mouse on the edge in the picture.
TEST_F(Dialogs, SpotsAreProposedAlongAnEdgeOfTheDrawingAndTaken) {
    DeskPerson me(window());
    Desk& desk = studio->desk();
    const auto step = folder / "door.step";
    std::ofstream(step) << door_step().value();
    auto* dialog = opened<PlaceDialog>("spots_from_drawing", "place_dialog");
    ASSERT_TRUE(dialog);
    auto* edges = dialog->findChild<QComboBox*>("place_edge");
    auto* propose = dialog->findChild<QPushButton*>("place_propose");
    auto* take = dialog->findChild<QPushButton*>("place_take");
    EXPECT_FALSE(propose->isEnabled());
    EXPECT_FALSE(take->isEnabled());

    // What is no drawing is a sentence.
    std::ofstream(folder / "none.step") << "no drawing";
    dialog->take_file(QString::fromStdString((folder / "none.step").string()));
    ASSERT_TRUE(me.wait([&] { return !dialog->working(); }));
    EXPECT_FALSE(word(*dialog, "place_verdict").isEmpty());
    EXPECT_FALSE(propose->isEnabled());

    dialog->take_file(QString::fromStdString(step.string()));
    ASSERT_TRUE(QTest::qWaitFor([&] { return !dialog->working() && edges->count() > 0; }, 3 * kPatienceMs))
        << word(*dialog, "place_verdict").toStdString();
    const Drawing drawing = read_drawing(step).value();
    EXPECT_EQ(edges->count(), static_cast<int>(drawing.edges.size()));
    const DrawingEdge* bead = nullptr;
    for (const DrawingEdge& e : drawing.edges)
        if (!bead && e.fold_deg > 60 && !e.convex && e.length_mm > 300) bead = &e;
    ASSERT_TRUE(bead);

    // The edge lights up under the pointer, and a click takes it.
    window().findChild<QAction*>("show_dock_scene")->trigger();
    QApplication::processEvents();
    auto* scene = window().findChild<SceneView*>("scene_view");
    ASSERT_TRUE(scene);
    if (scene->has_opengl()) {
        QWidget* canvas = scene->focusProxy();
        ASSERT_TRUE(canvas);
        const QPointF at = scene->to_screen(bead->points[bead->points.size() / 2].point_mm);
        const auto off_px = [&](const DrawingEdge& e) {  // of the drawn line, sampled every few px
            double nearest = 1e9;
            for (const DrawingPoint& p : e.points) {
                const QPointF d = scene->to_screen(p.point_mm) - at;
                nearest = std::min(nearest, std::hypot(d.x(), d.y()));
            }
            return nearest;
        };
        const auto elsewhere = std::find_if(drawing.edges.begin(), drawing.edges.end(),
                                            [&](const DrawingEdge& e) { return off_px(e) > 40; });
        ASSERT_NE(elsewhere, drawing.edges.end());
        dialog->choose_edge(QString::fromStdString(elsewhere->id));
        const QPoint there = canvas->mapFrom(scene, at.toPoint());
        ASSERT_TRUE(canvas->rect().contains(there));
        // The window of the spots may lie over the picture: the events go to the canvas itself.
        EXPECT_TRUE(canvas->hasMouseTracking());
        const auto hover = [&](const QPointF& pos) {
            QMouseEvent move(QEvent::MouseMove, pos, canvas->mapToGlobal(pos), Qt::NoButton, Qt::NoButton,
                             {});
            QApplication::sendEvent(canvas, &move);
        };
        hover({3, 3});
        const QImage dark = scene->picture().copy();
        hover(there);
        EXPECT_NE(scene->picture(), dark) << "nothing lights up under the pointer";
        QTest::mouseClick(canvas, Qt::LeftButton, {}, there);
        const std::string picked = edges->currentData().toString().toStdString();
        EXPECT_NE(picked, elsewhere->id) << "the click took nothing";
        EXPECT_LT(off_px(*find_edge(drawing, picked)), 15) << picked;
        QTest::mouseClick(canvas, Qt::LeftButton, {}, QPoint(3, 3));
        EXPECT_EQ(edges->currentData().toString().toStdString(), picked) << "there is no edge there";
    }
    dialog->choose_edge(QString::fromStdString(bead->id));
    ASSERT_EQ(edges->currentData().toString().toStdString(), bead->id);

    // Cancelled, then proposed with what is wanted out of reach, then enough.
    dialog->findChild<QSpinBox*>("place_fewest")->setValue(4);
    dialog->findChild<QSpinBox*>("place_most")->setValue(4);
    dialog->findChild<NumberBox*>("place_wanted")->setValue(0.001);
    dialog->propose();
    EXPECT_TRUE(dialog->working());
    dialog->findChild<QPushButton*>("place_cancel")->click();
    ASSERT_TRUE(QTest::qWaitFor([&] { return !dialog->working(); }, 3 * kPatienceMs));
    EXPECT_TRUE(word(*dialog, "place_verdict").contains("cancel", Qt::CaseInsensitive))
        << word(*dialog, "place_verdict").toStdString();
    dialog->findChild<NumberBox*>("place_beyond")->setValue(250);
    dialog->propose();
    ASSERT_TRUE(QTest::qWaitFor([&] { return !dialog->working(); }, 6 * kPatienceMs));
    EXPECT_TRUE(word(*dialog, "place_verdict").contains("Not enough"))
        << word(*dialog, "place_verdict").toStdString();
    EXPECT_FALSE(take->isEnabled()) << "what is not enough is not taken";
    dialog->findChild<NumberBox*>("place_wanted")->setValue(2);
    EXPECT_EQ(dialog->findChild<QTableWidget*>("place_spots")->rowCount(), 0) << "of another question";
    dialog->propose();
    ASSERT_TRUE(QTest::qWaitFor([&] { return !dialog->working(); }, 6 * kPatienceMs));
    ASSERT_TRUE(take->isEnabled()) << word(*dialog, "place_verdict").toStdString();
    EXPECT_EQ(dialog->findChild<QTableWidget*>("place_spots")->rowCount(), 4);
    // A spot is moved along the edge, by its ghost and by steps, and the forecast follows.
    auto* table = dialog->findChild<QTableWidget*>("place_spots");
    auto *back = dialog->findChild<QPushButton*>("place_back"),
         *on = dialog->findChild<QPushButton*>("place_on");
    EXPECT_FALSE(on->isEnabled()) << "none is chosen";
    table->setCurrentCell(1, 0);
    ASSERT_TRUE(on->isEnabled());
    const auto row = [&] {
        const int r = table->currentRow();
        return table->item(r, 0)->text() + " " + table->item(r, 1)->text();
    };
    const QString proposed = row(), said = word(*dialog, "place_verdict");
    on->click();
    EXPECT_NE(row(), proposed);
    EXPECT_EQ(row().section(' ', 0, 0), proposed.section(' ', 0, 0)) << "the same spot stays chosen";
    EXPECT_NE(word(*dialog, "place_verdict"), said);
    back->click();
    EXPECT_EQ(row(), proposed);
    EXPECT_EQ(word(*dialog, "place_verdict"), said);
    if (scene->has_opengl()) {
        QWidget* canvas = scene->focusProxy();
        const auto send = [&](QEvent::Type type, const QPointF& at, Qt::MouseButtons held) {
            QMouseEvent e(type, at, canvas->mapToGlobal(at), Qt::LeftButton, held, {});
            QApplication::sendEvent(canvas, &e);
        };
        const auto chain = tangent_chain(drawing, bead->id);
        const double arc = table->item(1, 1)->text().toDouble();
        const auto at = [&](double along) {
            return canvas->mapFrom(scene, scene->to_screen(chain->at(along).point_mm));
        };
        const double to = arc + (arc > chain->length_mm() / 2 ? -60 : 60);
        const QImage camera = scene->picture().copy();
        send(QEvent::MouseButtonPress, at(arc), Qt::LeftButton);
        send(QEvent::MouseMove, (at(arc) + at(to)) / 2, Qt::LeftButton);
        send(QEvent::MouseMove, at(to), Qt::LeftButton);
        send(QEvent::MouseButtonRelease, at(to), Qt::NoButton);
        EXPECT_NEAR(row().section(' ', 1).toDouble(), to, 30) << "the ghost did not follow the pointer";
        EXPECT_NE(scene->picture(), camera);
        EXPECT_EQ(edges->currentData().toString().toStdString(), bead->id) << "the press chose an edge";
    }
    QApplication::processEvents();
    dialog->grab().save(QString(SEAMWRIGHT_SCREENS) + "/dialog_place.png");
    me.picture("spots_from_drawing");

    const auto before = desk.project().spots.size();
    take->click();
    EXPECT_EQ(desk.project().spots.size(), before + 4) << word(*dialog, "place_verdict").toStdString();
    EXPECT_EQ(desk.project().spots.back().reference_state, ReferenceState::from_drawing);
    EXPECT_FALSE(take->isEnabled());
    desk.undo_stack().undo();
    EXPECT_EQ(desk.project().spots.size(), before) << "one step of undo";

    // On the part each is confirmed by one click.
    desk.undo_stack().redo();
    ASSERT_EQ(desk.project().spots.size(), before + 4);
    dialog->close();
    me.step(3);
    ASSERT_TRUE(me.wait([&] { return desk.station().connected && !desk.worker().busy(); }));
    for (std::size_t i = before; i < before + 4; ++i) {
        desk.selection().select_spot(desk.project().spots[i].id);
        QApplication::processEvents();
        me.click("head_deed");
        ASSERT_TRUE(me.wait([&] { return !desk.worker().busy(); }));
        EXPECT_TRUE(me.wait([&] {
            return desk.project().spots[i].reference_state == ReferenceState::measured;
        })) << desk.project().spots[i].id
            << ": " << me.text_of("head_state").toStdString();
    }
}

// Two sheets that come together to 3 mm in the middle: the plot, the stretch by its spots, and the nozzle that fits once it
// is smaller; nothing is measured again for that.
TEST_F(Dialogs, AGapIsDrivenAlongJudgedAndWritten) {
    DeskPerson me(window());
    Desk& desk = studio->desk();
    const auto project = simulated_gap_project({{"seed", 3}}, default_gap_stations(), folder / "sheets.ply");
    ASSERT_TRUE(project) << project.error().sentence();
    ASSERT_TRUE(desk.create(folder / "gap.seam", *project));
    QApplication::processEvents();
    auto* dialog = opened<GapDialog>("gap_check", "gap_dialog");
    ASSERT_TRUE(dialog);
    auto* write = dialog->findChild<QPushButton*>("gap_write");
    auto* stretches = dialog->findChild<QTableWidget*>("gap_stretches");
    EXPECT_FALSE(write->isEnabled());
    EXPECT_FALSE(dialog->write(QString::fromStdString((folder / "none.csv").string())));
    EXPECT_EQ(dialog->findChild<QLineEdit*>("gap_spots")->text(), "S1, S2, S3, S4");

    // What cannot be driven is a sentence in the window.
    dialog->findChild<QLineEdit*>("gap_spots")->setText("S1, S9");
    dialog->drive();
    ASSERT_TRUE(me.wait([&] { return word(*dialog, "gap_verdict").contains("not measured"); }))
        << word(*dialog, "gap_verdict").toStdString();

    dialog->findChild<QLineEdit*>("gap_spots")->setText("S1, S2,S3 ,S4");
    dialog->findChild<NumberBox*>("gap_step")->setValue(4);
    desk.worker().connect_devices();
    ASSERT_TRUE(me.wait([&] { return desk.station().connected && !desk.worker().busy(); }));
    dialog->drive();
    ASSERT_TRUE(QTest::qWaitFor([&] { return write->isEnabled(); }, 3 * kPatienceMs))
        << word(*dialog, "gap_verdict").toStdString();
    EXPECT_TRUE(word(*dialog, "gap_verdict").contains("does not pass"))
        << word(*dialog, "gap_verdict").toStdString();
    ASSERT_GT(stretches->rowCount(), 0);
    EXPECT_TRUE(stretches->item(0, 0)->text().contains("S")) << stretches->item(0, 0)->text().toStdString();
    QApplication::processEvents();
    dialog->grab().save(QString(SEAMWRIGHT_SCREENS) + "/dialog_gap.png");

    const int before = stretches->rowCount();
    dialog->findChild<NumberBox*>("gap_nozzle")->setValue(0.5);
    dialog->findChild<NumberBox*>("gap_clearance")->setValue(0.1);
    EXPECT_LT(stretches->rowCount(), before);
    dialog->findChild<NumberBox*>("gap_nozzle")->setValue(50);
    EXPECT_TRUE(word(*dialog, "gap_verdict").contains("does not pass"));

    const auto csv = folder / "gap.csv", html = folder / "gap.html";
    ASSERT_TRUE(dialog->write(QString::fromStdString(csv.string())));
    ASSERT_TRUE(dialog->write(QString::fromStdString(html.string())));
    EXPECT_GT(std::filesystem::file_size(csv), 200u);
    EXPECT_GT(std::filesystem::file_size(html), 2000u);
    EXPECT_FALSE(dialog->write(QString::fromStdString((folder / "no" / "such" / "folder.csv").string())));
}

// A session with a run in it: what the file holds is what the devices delivered, and the gap check reads such files.
TEST_F(Dialogs, ASessionIsRecordedWhileOneWorks) {
    DeskPerson me(window());
    Desk& desk = studio->desk();
    auto* dialog = opened<RecordDialog>("record_session", "record_dialog");
    ASSERT_TRUE(dialog);
    const auto file = folder / "session.seam";
    ASSERT_TRUE(me.wait([&] { return desk.station().connected && !desk.worker().busy(); }));
    std::ofstream(folder / "there.seam") << "not to be lost";
    EXPECT_FALSE(dialog->start(QString::fromStdString((folder / "there.seam").string())));
    ASSERT_TRUE(dialog->start(QString::fromStdString(file.string())));
    EXPECT_FALSE(dialog->start(QString::fromStdString((folder / "second.seam").string()))) << "one at a time";
    auto* sources = dialog->findChild<QTableWidget*>("record_sources");
    ASSERT_TRUE(QTest::qWaitFor(
        [&] { return sources->rowCount() > 0 && sources->item(0, 1)->text().toInt() > 0; }, 3 * kPatienceMs));
    window().findChild<QAction*>("measure_now")->trigger();
    ASSERT_TRUE(QTest::qWaitFor([&] { return desk.runs() && !desk.runs()->empty(); }, 3 * kPatienceMs));
    dialog->grab().save(QString(SEAMWRIGHT_SCREENS) + "/dialog_record.png");
    dialog->stop();
    EXPECT_TRUE(word(*dialog, "record_verdict").contains("session.seam"));
    auto reader = CaptureReader::open(file);
    ASSERT_TRUE(reader) << reader.error().sentence();
    EXPECT_EQ(reader->end(), "stopped");
    EXPECT_GE(reader->sources().size(), 2u) << "sensor and robot";
    // The devices are there again, without the recorder.
    ASSERT_TRUE(me.wait([&] { return desk.station().connected && !desk.worker().busy(); }));
    const auto size = std::filesystem::file_size(file);
    QTest::qWait(500);
    EXPECT_EQ(std::filesystem::file_size(file), size);
}

}  // namespace
}  // namespace seamwright
