// The deeds with a window of their own, on the demo project: the path corrected by a run, the controller's program.

#include <gtest/gtest.h>

#include <QAction>
#include <fstream>

#include "app/studio/studio.h"
#include "devices/exchange/tables/path_csv.h"
#include "devices/simulated/scene/door.h"
#include "tests/app/studio/person.h"
#include "widgets/dialogs/path_dialog.h"
#include "widgets/dialogs/program_dialog.h"

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

}  // namespace
}  // namespace seamwright
