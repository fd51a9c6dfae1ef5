// The studio on a German desktop, where "1.5" is written "1,5", connected to each brand's cell over its real
// protocol: the robot's pose and frames are the cell's, and a part is measured and pushed. No word is cut, and
// whatever the devices take their time for, the window does not stand still.

#include <gtest/gtest.h>
#include <unistd.h>

#include <QLabel>
#include <QLineEdit>
#include <QTableWidget>
#include <clocale>
#include <cstdlib>
#include <filesystem>

#include "app/studio/studio.h"
#include "tests/app/studio/person.h"
#include "tests/app/studio/screen_audit.h"
#include "tests/projects/sample_project.h"
#include "tests/projects/served_cell.h"

namespace seamwright {
namespace {

// Made here, since a bare machine has none; before the QApplication takes the desktop's locale.
class GermanDesktop {
  public:
    GermanDesktop() {
        const std::string made = (folder_ / "de_DE.UTF-8").string();
        if (std::system(("localedef -i de_DE -f UTF-8 '" + made + "' > /dev/null 2>&1").c_str()) != 0)
            return;  // then the test says what is missing
        setenv("LOCPATH", folder_.string().c_str(), 1);
        setenv("LC_ALL", "de_DE.UTF-8", 1);
    }
    ~GermanDesktop() { std::filesystem::remove_all(folder_); }

  private:
    const std::filesystem::path folder_ = [] {
        auto path =
            std::filesystem::temp_directory_path() / ("seamwright_locale_" + std::to_string(::getpid()));
        std::filesystem::create_directories(path);
        return path;
    }();
};
const GermanDesktop desktop;

class GermanStudio : public testing::TestWithParam<std::string> {
  protected:
    void SetUp() override {
        std::setlocale(LC_ALL, "");  // as QApplication has done, and a test before may have undone
        if (std::string(std::localeconv()->decimal_point) != ",")
            GTEST_SKIP() << "no German locale: localedef or its sources are missing (package locales)";
        QApplication::setAttribute(Qt::AA_DontUseNativeDialogs);
        auto made = serve_cell({.driver = GetParam()}, folder / "cell.seam");
        ASSERT_TRUE(made) << made.error().sentence();
        served.emplace(std::move(*made));
        served->station.reset();  // the file and the devices are the studio's now
        StudioOptions o;
        o.file = QString::fromStdString((folder / "cell.seam").string());
        o.language = "de";
        o.theme = "light";
        o.settings = QString::fromStdString((folder / "settings.ini").string());
        o.data = QString::fromStdString((folder / "").string());
        studio = std::make_unique<Studio>(*qApp, o);
    }
    TemporaryFolder folder;
    std::optional<ServedCell> served;
    std::unique_ptr<Studio> studio;
};

TEST_P(GermanStudio, ReadsPoseAndFramesAndPushes) {
    constexpr double kStandstill_ms = 500;
    studio->window().resize(1280, 800);
    studio->window().show();
    FreezeWatch watch(100);
    DeskPerson me(studio->window(), &watch);
    me.examines([&] { return audit::cut_off(studio->window()); });
    Desk& desk = studio->desk();
    ASSERT_TRUE(desk.is_open());
    studio->window().show_step(Step::cell);
    me.click("connect");  // real devices are connected by a person
    ASSERT_TRUE(me.wait([&] { return desk.station().connected || !desk.station().trouble.empty(); }));
    ASSERT_TRUE(desk.station().connected) << desk.station().trouble;
    ASSERT_TRUE(me.wait([&] {
        const auto& robots = desk.station().robots;
        return !robots.empty() && (robots[0].base_from_flange || !robots[0].trouble.empty());
    }));
    const RobotState robot = desk.station().robots[0];
    EXPECT_EQ(robot.trouble, "");
    ASSERT_TRUE(robot.base_from_flange);
    EXPECT_LT(distance_mm(*robot.base_from_flange, *served->cell->reported_flange()), 0.01);
    EXPECT_LT(angle_rad(*robot.base_from_flange, *served->cell->reported_flange()), 1e-4);

    // The robot's settings are a form of its driver, filled with the project's.
    auto* devices = studio->window().findChild<QTableWidget*>("devices");
    ASSERT_TRUE(devices);
    devices->setCurrentCell(1, 0);
    auto* port = studio->window().findChild<QLineEdit*>("setting_port");
    ASSERT_TRUE(me.wait([&] { return port && port->isVisible(); }));
    me.look_at(port);
    EXPECT_EQ(port->text().toInt(), desk.project().robots.at(0).settings.at("port").get<int>());
    me.picture("cell_de_" + QString::fromStdString(GetParam()));

    const Pose frame = *served->cell->read_frame("path");
    served->cell->set_part({make_pose(rotation_exp({0.002, -0.001, 0.003}), {3.5, -2.25, 1.125}), {}});
    std::optional<Pose> before;
    std::shared_ptr<const RunRecord> run;
    QObject::connect(&desk.worker(), &StationWorker::confirm_push, &desk,
                     [&](const std::shared_ptr<const RunRecord>& judged) {
                         EXPECT_FALSE(served->controller().released()) << "before the person has said yes";
                         before = judged->regions.at(0).push.before;
                         desk.worker().answer_push(true);
                     });
    QObject::connect(&desk.worker(), &StationWorker::measured, &desk,
                     [&](const std::shared_ptr<const RunRecord>& done) { run = done; });
    desk.worker().measure("CAR-1", true, false);
    ASSERT_TRUE(me.wait([&] { return run != nullptr; }));
    EXPECT_EQ(run->status, RunStatus::ok) << run->message;
    ASSERT_TRUE(before);
    // The desk holds the link until the application runs, and says that it does.
    EXPECT_TRUE(served->controller().released());
    EXPECT_EQ(run->regions.at(0).push.release, Release::taken);
    studio->window().show_step(Step::run);
    const auto* regions = studio->window().findChild<QTableWidget*>("run_regions");
    ASSERT_TRUE(regions);
    ASSERT_TRUE(me.wait([&] { return regions->rowCount() == 1; }));
    EXPECT_TRUE(regions->item(0, 0)->text().contains("die Anwendung läuft im Frame"))
        << regions->item(0, 0)->text().toStdString();
    EXPECT_LT(distance_mm(*before, frame), 0.01);
    EXPECT_LT(angle_rad(*before, frame), 1e-4);
    ASSERT_TRUE(run->regions.at(0).push.read_back);
    EXPECT_LT(distance_mm(*run->regions[0].push.read_back, run->regions[0].base_from_frame), 0.01);
    QTest::qWait(300);
    me.picture("pushed_de_" + QString::fromStdString(GetParam()));
    // A comma taken for a point would be millimetres off; the rest is what the cell scatters.
    const RegionCorrection& c = *run->regions[0].correction;
    EXPECT_NEAR(c.displacement.workobject_from_movedworkobject.translation().x(), 3.5, 4 * c.sigma_xyz_mm.x())
        << c.message;
    EXPECT_LT(c.sigma_xyz_mm.x(), 0.5);
    EXPECT_EQ(std::string(std::localeconv()->decimal_point), ",") << "to the end";

    // What the gate refuses is said in the window's language, on the page and in the log, and again from the file.
    run.reset();
    served->cell->set_part({make_pose(Eigen::Matrix3d::Identity(), {60, 0, 0}), {}});
    desk.worker().measure("CAR-2", true, false);
    ASSERT_TRUE(me.wait([&] { return run != nullptr; }));
    ASSERT_EQ(run->status, RunStatus::refused) << run->message;
    studio->window().show_step(Step::run);
    QString said;
    ASSERT_TRUE(me.wait([&] {
        for (const QLabel* label : studio->window().findChildren<QLabel*>())
            if (label->isVisible() && label->text().startsWith("Sicherheitsprüfung lehnt ab"))
                said = label->text();
        return !said.isEmpty();
    }));
    const QString verdict = me.text_of("run_verdict");
    EXPECT_EQ(verdict.count("abgelehnt"), 1) << verdict.toStdString();
    QTest::qWait(300);  // until the page has found room for it
    me.picture("refused_de_" + QString::fromStdString(GetParam()));
    const auto stored = desk.run(run->number);
    ASSERT_TRUE(stored);
    ASSERT_FALSE(stored->regions.at(0).refusals.empty());
    for (const Text& reason : stored->regions[0].refusals) {
        EXPECT_TRUE(said.contains(QString::fromStdString(reason.in(Language::german)))) << said.toStdString();
        EXPECT_NE(reason.in(Language::german), reason.english());
        EXPECT_FALSE(said.contains(QString::fromStdString(reason.english()))) << said.toStdString();
    }
    for (const Freeze& f : watch.freezes()) {
        std::printf("stood still %.0f ms after %s\n", f.ms, f.during.toUtf8().constData());
        EXPECT_LT(f.ms, kStandstill_ms) << f.during.toStdString();
    }
}

INSTANTIATE_TEST_SUITE_P(Brands, GermanStudio,
                         testing::Values("kuka-eki", "kuka-kvp", "abb-rapid", "ur-rtde"),
                         [](const auto& brand) {
                             std::string name = brand.param;
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

}  // namespace
}  // namespace seamwright
