#pragma once
// A guided calibration at the real window: a project in a simulated cell, its page, captures, and a studio of its own that is
// killed.

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <QProcess>
#include <cstdlib>
#include <fstream>

#include "app/studio/studio.h"
#include "devices/simulated/cell.h"
#include "projects/reuse/simulated_truth.h"
#include "tests/app/studio/person.h"

namespace seamwright {

// Of the environment: the studio that captures until it is killed works there, by this method.
inline constexpr const char *kGuidedFolder = "SEAMWRIGHT_GUIDED_FOLDER",
                            *kGuidedMethod = "SEAMWRIGHT_GUIDED_METHOD";

class Guided : public testing::Test {
  protected:
    std::filesystem::path folder =
        std::getenv(kGuidedFolder)
            ? std::filesystem::path(std::getenv(kGuidedFolder))
            : std::filesystem::temp_directory_path() / ("seamwright_guided_" + std::to_string(::getpid()));
    std::filesystem::path file = folder / "cell.seam";
    nlohmann::json settings = {{"seed", 5}};
    void SetUp() override {
        std::filesystem::create_directories(folder);
        QApplication::setAttribute(Qt::AA_DontUseNativeDialogs);
    }
    void TearDown() override {
        if (!std::getenv(kGuidedFolder)) std::filesystem::remove_all(folder);
    }

    // Simulated sensors on their robot, with the calibration that the cell has by construction in use.
    void make_project(const std::vector<std::string>& ids = {"A"}) const {
        Project p;
        p.name = "Guided";
        SensorSetup sensor;
        sensor.driver = "simulated";
        sensor.settings = settings;
        const auto cell = SimulatedCell::open(settings).value();
        sensor.identity = make_simulated_sensor(cell)->identity();
        RobotSetup robot;
        robot.identity = make_simulated_robot(cell)->identity().value();
        robot.id = "R1";
        robot.driver = "simulated";
        robot.settings = settings;
        p.robots = {robot};
        for (const std::string& id : ids) {
            sensor.id = id;
            p.calibrations.push_back(simulated_truth(sensor, robot).value());
            if (p.sensors.size() > 0) p.calibrations.back().id += " " + id;
            p.sensors.push_back(sensor);
            p.sensors.back().calibration_id = p.calibrations.back().id;
        }
        ASSERT_TRUE(ProjectFile::create(file, p));
    }
    StudioOptions options() const {
        StudioOptions o;
        o.file = QString::fromStdString(file.string());
        o.language = "en";
        o.theme = "light";
        o.settings = QString::fromStdString((folder / "settings.ini").string());
        o.data = QString::fromStdString(folder.string());
        return o;
    }
    static void go_to_page(const DeskPerson& me, Desk& desk, const QString& method) {
        if (!desk.station().connected) {
            me.step(1);
            me.click("connect");
        }
        ASSERT_TRUE(me.wait([&] { return desk.station().connected; }));
        me.step(2);
        me.click("begin_" + method);
    }
    static int captures(const DeskPerson& me) {
        auto* table = me.find<QTableWidget>("captures");
        return table ? table->rowCount() : -1;
    }
    // To the proposed pose, then the button, until the list has grown.
    static void capture(const DeskPerson& me, Desk& desk, const QString& button = "calibration_capture") {
        const int before = captures(me);
        me.click("calibration_go");
        ASSERT_TRUE(me.wait([&] { return !desk.worker().busy(); }));
        me.click(button);
        // A board is looked for behind the solving of those before it.
        ASSERT_TRUE(QTest::qWaitFor([&] { return captures(me) == before + 1; }, 3 * kPatienceMs))
            << window_text(me);
    }
    static std::string window_text(const DeskPerson& me) {
        auto* said = me.window().findChild<QLabel*>("calibration_said");
        return said ? said->text().toStdString() : std::string();
    }
    static bool solved(const DeskPerson& me, MainWindow& window) {
        return me.wait([&] {
            auto* cancel = window.findChild<QPushButton*>("calibration_cancel");
            return cancel && !cancel->isVisible() && me.text_of("calibration_verdict") != "not solved yet";
        });
    }
    // The studio as a process of its own captures until it has so many, and is then killed.
    void capture_until_killed(const QString& method, int poses) const {
        QProcess child;
        auto environment = QProcessEnvironment::systemEnvironment();
        environment.insert(kGuidedFolder, QString::fromStdString(folder.string()));
        environment.insert(kGuidedMethod, method);
        child.setProcessEnvironment(environment);
        child.start(
            QCoreApplication::applicationFilePath(),
            {"--gtest_filter=Guided.DISABLED_CapturesUntilKilled", "--gtest_also_run_disabled_tests"});
        ASSERT_TRUE(child.waitForStarted());
        const auto count = [&] {
            int n = 0;
            std::ifstream(folder / "count") >> n;
            return n;
        };
        ASSERT_TRUE(QTest::qWaitFor([&] { return count() >= poses || child.state() == QProcess::NotRunning; },
                                    6 * kPatienceMs));
        ASSERT_EQ(child.state(), QProcess::Running) << child.readAll().toStdString();
        ::kill(static_cast<pid_t>(child.processId()), SIGKILL);
        ASSERT_TRUE(child.waitForFinished());
    }
    // The line of the list with the largest number in this column.
    static int worst_row(const QTableWidget& table, int column) {
        int worst = 0;
        for (int r = 0; r < table.rowCount(); ++r)
            if (table.item(r, column)->text().toDouble() > table.item(worst, column)->text().toDouble())
                worst = r;
        return worst;
    }
    // The tick box of a line, by keyboard.
    static void press_space(const DeskPerson& me, QTableWidget* table, int row) {
        me.look_at(table);
        table->scrollToItem(table->item(row, 0));
        table->setCurrentCell(row, 0);
        table->setFocus();
        QTest::keyClick(table, Qt::Key_Space);
    }
};

}  // namespace seamwright
