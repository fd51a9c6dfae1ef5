// Guided calibrations at the real window, by mouse and keyboard: the sphere from the first capture to the
// calibration in use, with a bad pose and a kill in between; the board from a folder of images.

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <QProcess>
#include <cstdlib>
#include <fstream>
#include <random>

#include "app/studio/studio.h"
#include "devices/exchange/pose_json.h"
#include "devices/simulated/cell.h"
#include "projects/calibrate/session/answer.h"
#include "projects/calibrate/session/capture.h"
#include "projects/calibrate/session/guide.h"
#include "projects/reuse/simulated_truth.h"
#include "tests/app/studio/person.h"
#include "widgets/calibrate/target_view.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char *kFolder = "SEAMWRIGHT_GUIDED_FOLDER", *kMethod = "SEAMWRIGHT_GUIDED_METHOD";

class Guided : public testing::Test {
  protected:
    fs::path folder = std::getenv(kFolder)
                          ? fs::path(std::getenv(kFolder))
                          : fs::temp_directory_path() / ("seamwright_guided_" + std::to_string(::getpid()));
    fs::path file = folder / "cell.seam";
    json settings = {{"seed", 5}};
    void SetUp() override {
        fs::create_directories(folder);
        QApplication::setAttribute(Qt::AA_DontUseNativeDialogs);
    }
    void TearDown() override {
        if (!std::getenv(kFolder)) fs::remove_all(folder);
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
        environment.insert(kFolder, QString::fromStdString(folder.string()));
        environment.insert(kMethod, method);
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
    // A pose that somebody typed wrong: the profile is of another place than the pose says.
    fs::path wrong_pose(const CalibrationSession& s) const {
        CellSettings cell_settings = parse_cell_settings(settings).value();
        cell_settings.scene = Scene::sphere;
        auto cell = SimulatedCell::open(cell_settings).value();
        Pose at = next_pose(s, cell->flange_from_sensor())->base_from_flange;
        Frame frame;
        cell->render(at, 4711, frame);
        Calibration base;
        base.model = cell->sensor_model();
        SensorSetup sensor;
        sensor.id = "A";
        auto taken = capture_shot(s.method(), s.state().settings, sensor, &base, frame, nullptr, at).value();
        at.translation() += Eigen::Vector3d(2, -3, 1);
        taken.capture.entry["base_from_flange"] = pose_json(at);
        taken.capture.entry["id"] = "typed";
        const fs::path path = folder / "typed.json";
        std::ofstream(path) << json{{"radius_mm", 25}, {"observations", {taken.capture.entry}}};
        return path;
    }
};

// Run by the next test as a process of its own, which is then killed.
TEST_F(Guided, DISABLED_CapturesUntilKilled) {
    Studio studio(*qApp, options());
    studio.window().resize(1280, 800);
    studio.window().show();
    DeskPerson me(studio.window());
    go_to_page(me, studio.desk(), std::getenv(kMethod));
    me.click("calibration_set_target");
    for (int i = 0; i < 100; ++i) {
        capture(me, studio.desk());
        if (HasFailure()) return;
        std::ofstream(folder / "count") << captures(me) << std::endl;
    }
}

TEST_F(Guided, SphereWithABadPoseAndAKillInBetween) {
    make_project();
    capture_until_killed("tcp-sphere", 4);
    ASSERT_FALSE(HasFailure());
    Studio studio(*qApp, options());
    MainWindow& window = studio.window();
    window.resize(1280, 800);
    window.show();
    DeskPerson me(window);
    Desk& desk = studio.desk();  // looked at, never worked
    me.step(2);
    EXPECT_EQ(me.find<QPushButton>("begin_tcp-sphere")->text(), "Go on");
    go_to_page(me, desk, "tcp-sphere");
    ASSERT_GE(captures(me), 4) << "what was captured before the kill is there";
    me.click("calibration_set_target");
    for (int i = captures(me); i < 11; ++i) {
        capture(me, desk);
        ASSERT_FALSE(HasFailure());
    }
    me.picture("guided_1_captures");

    // The bad pose: seen in the list, left out by its tick, and the solution is good again.
    const auto session =
        CalibrationSession::open(file, MethodId("tcp-sphere"), SensorId("A"), RobotId("R1")).value();
    me.answer_file_dialog(QString::fromStdString(wrong_pose(session).string()));
    me.click("calibration_load");
    ASSERT_TRUE(me.wait([&] { return captures(me) == 12; })) << me.text_of("calibration_said").toStdString();
    ASSERT_TRUE(solved(me, window));
    me.picture("guided_2_bad_pose");
    auto* table = me.find<QTableWidget>("captures");
    const int worst = worst_row(*table, 1);
    EXPECT_EQ(table->item(worst, 0)->text(), "typed");
    EXPECT_TRUE(table->item(worst, 4)->text() == "contradicts the others" ||
                table->item(worst, 4)->text() == "stands out")
        << table->item(worst, 4)->text().toStdString();
    const double bad_mm = table->item(worst, 1)->text().toDouble();
    press_space(me, table, worst);
    ASSERT_TRUE(me.wait([&] { return table->item(worst, 4)->text() == "left out"; }));
    ASSERT_TRUE(solved(me, window));
    const QString verdict = me.text_of("calibration_verdict");
    EXPECT_TRUE(verdict == "good" || verdict == "usable") << me.text_of("calibration_reason").toStdString();
    EXPECT_GT(table->item(worst, 1)->text().toDouble(), 0.9 * bad_mm) << "its residual is still shown";
    me.picture("guided_3_left_out");

    // Undo brings it back, redo leaves it out again.
    me.click("calibration_undo");
    ASSERT_TRUE(me.wait([&] { return table->item(worst, 0)->checkState() == Qt::Checked; }));
    me.click("calibration_redo");
    ASSERT_TRUE(me.wait([&] { return table->item(worst, 0)->checkState() == Qt::Unchecked; }));
    ASSERT_TRUE(solved(me, window));

    // Not before it is verified.
    EXPECT_FALSE(me.find<QPushButton>("calibration_use")->isEnabled());
    capture(me, desk, "calibration_verify");
    ASSERT_TRUE(solved(me, window));
    EXPECT_TRUE(me.text_of("calibration_verified").startsWith("confirmed"))
        << me.text_of("calibration_verified").toStdString();
    EXPECT_TRUE(me.text_of("calibration_compared").contains("simulated-truth"));
    me.picture("guided_4_verified");
    me.click("calibration_use");
    ASSERT_EQ(desk.project().calibrations.size(), 2U);
    const Calibration& made = desk.project().calibrations.back();
    EXPECT_EQ(desk.project().sensors.at(0).calibration_id, made.id);
    EXPECT_EQ(made.method, "tcp-sphere");
    EXPECT_LT(difference(made, desk.project().calibrations.front()).largest_mm, 0.5)
        << "over the whole field; three sigma in its middle are 0.2";
    EXPECT_TRUE(made.result.contains("verification"));
    me.picture("guided_5_used");
    // One step back in the project's own undo list: the calibration before is in use again.
    me.shortcut(Qt::Key_Z);
    EXPECT_EQ(desk.project().sensors.at(0).calibration_id, "simulated-truth");
    EXPECT_EQ(desk.project().calibrations.size(), 1U);
    EXPECT_TRUE(me.wait([&] { return me.find<QPushButton>("calibration_use")->isEnabled(); }));
}

// One press sends the robot from view to view until the calibration can be used; stopped in between, the next press goes on.
TEST_F(Guided, AllCapturesByOnePress) {
    make_project();
    Studio studio(*qApp, options());
    MainWindow& window = studio.window();
    window.resize(1280, 800);
    window.show();
    DeskPerson me(window);
    Desk& desk = studio.desk();
    go_to_page(me, desk, "tcp-sphere");
    const int since = me.clicks();
    me.click("calibration_set_target");
    me.click("calibration_all");
    ASSERT_TRUE(me.wait([&] { return captures(me) >= 3; })) << window_text(me);
    me.picture("guided_series");
    me.click("calibration_cancel");
    ASSERT_TRUE(me.wait([&] { return !desk.worker().busy(); }));
    QTest::qWait(500);
    const int stopped = captures(me);
    QTest::qWait(1500);
    EXPECT_EQ(captures(me), stopped) << "nothing goes on by itself";
    me.click("calibration_all");
    auto* use = me.find<QPushButton>("calibration_use");
    ASSERT_TRUE(QTest::qWaitFor([&] { return use->isEnabled(); }, 6 * kPatienceMs)) << window_text(me);
    const CalibrationMethod& method = *find_method("tcp-sphere");
    EXPECT_EQ(captures(me), method.advised + 1) << "one is kept back";
    EXPECT_TRUE(me.text_of("calibration_verified").startsWith("confirmed"))
        << me.text_of("calibration_verified").toStdString();
    me.click("calibration_use");
    EXPECT_EQ(desk.project().sensors.at(0).calibration_id, desk.project().calibrations.back().id);
    EXPECT_EQ(me.clicks() - since, 5) << "two of them to stop and to go on";
}

// Every method that captures a picture live: from the first capture over a kill and a bad pose to the stored
// calibration. `column`: of the list, where the bad pose stands out.
struct LiveMethod {
    const char* id;
    int poses, column;
    bool used;
};
class GuidedLive : public Guided, public testing::WithParamInterface<LiveMethod> {
  protected:
    // The session's newest capture once more, with its pose mistyped, or taken over an edge of the plate.
    fs::path bad_entry(const CalibrationSession& s) const {
        json data = s.state().settings, entry = s.state().captures.back().taken->entry;
        if (entry.contains("points")) {  // whose places rest on the pose already
            for (json& p : entry["points"]) p["world"][1] = p["world"][1].get<double>() + 8;
            entry["id"] = "typed";
        } else if (entry.contains("base_from_flange")) {
            Pose pose = parse_pose(entry["base_from_flange"], "base_from_flange").value();
            pose.translation() += Eigen::Vector3d(6, -9, 3);
            entry["base_from_flange"] = pose_json(pose);
            entry["id"] = "typed";
        } else if (entry.is_object()) {
            entry["pixel"][1] = entry["pixel"][1].get<double>() + 12;  // on the flank beside the apex
            entry["id"] = "typed";
        } else {
            for (std::size_t i = entry.size() / 2; i < entry.size(); ++i)
                entry[i][1] = entry[i][1].get<double>() + 25;
        }
        data[s.method().entries] = json::array({entry});
        const fs::path path = folder / "bad.json";
        std::ofstream(path) << data;
        return path;
    }
};

TEST_P(GuidedLive, FromTheFirstCaptureToTheStoredCalibration) {
    const auto [method, poses, column, used] = GetParam();
    make_project();
    capture_until_killed(method, 3);
    ASSERT_FALSE(HasFailure());
    Studio studio(*qApp, options());
    MainWindow& window = studio.window();
    window.resize(1280, 800);
    window.show();
    DeskPerson me(window);
    Desk& desk = studio.desk();
    me.step(2);
    EXPECT_EQ(me.find<QPushButton>(QString("begin_") + method)->text(), "Go on");
    go_to_page(me, desk, method);
    ASSERT_GE(captures(me), 3) << "what was captured before the kill is there";
    me.click("calibration_set_target");
    for (int i = captures(me); i < poses; ++i) {
        capture(me, desk);
        ASSERT_FALSE(HasFailure());
    }
    ASSERT_TRUE(solved(me, window));

    // One more, which comes back from a file with its pose mistyped.
    capture(me, desk);
    ASSERT_FALSE(HasFailure());
    const auto session =
        CalibrationSession::open(file, MethodId(method), SensorId("A"), RobotId("R1")).value();
    me.find<QTableWidget>("captures")->setCurrentCell(poses, 0);
    me.click("calibration_remove");
    ASSERT_TRUE(me.wait([&] { return captures(me) == poses; }));
    me.answer_file_dialog(QString::fromStdString(bad_entry(session).string()));
    me.click("calibration_load");
    ASSERT_TRUE(me.wait([&] { return captures(me) == poses + 1; }))
        << me.text_of("calibration_said").toStdString();
    ASSERT_TRUE(solved(me, window));
    me.picture(QString("guided_%1_bad").arg(method));
    auto* table = me.find<QTableWidget>("captures");
    const int worst = worst_row(*table, column);
    EXPECT_EQ(worst, poses);
    EXPECT_TRUE(table->item(worst, 4)->text() == "contradicts the others" ||
                table->item(worst, 4)->text() == "stands out")
        << table->item(worst, 4)->text().toStdString();
    press_space(me, table, worst);
    ASSERT_TRUE(me.wait([&] { return table->item(worst, 4)->text() == "left out"; }));
    ASSERT_TRUE(solved(me, window));

    EXPECT_FALSE(me.find<QPushButton>(used ? "calibration_use" : "calibration_keep")->isEnabled());
    capture(me, desk, "calibration_verify");
    ASSERT_TRUE(solved(me, window));
    me.picture(QString("guided_%1").arg(method));
    const QString verdict = me.text_of("calibration_verdict");
    EXPECT_TRUE(verdict == "good" || verdict == "usable") << me.text_of("calibration_reason").toStdString();
    EXPECT_TRUE(me.text_of("calibration_verified").startsWith("confirmed"))
        << me.text_of("calibration_verified").toStdString();
    me.click(used ? "calibration_use" : "calibration_keep");
    ASSERT_EQ(desk.project().calibrations.size(), 2U) << window_text(me);
    const Calibration& made = desk.project().calibrations.back();
    EXPECT_EQ(made.method, method);
    EXPECT_EQ(desk.project().sensors.at(0).calibration_id == made.id, used);
    if (used) {
        EXPECT_LT(difference(made, desk.project().calibrations.front()).largest_mm, 1.0)
            << "over the whole field";
    }
    me.click("calibration_back");
}
INSTANTIATE_TEST_SUITE_P(Methods, GuidedLive,
                         testing::Values(LiveMethod{"stripe-camera", 10, 1, true},
                                         LiveMethod{"hand-eye", 8, 1, true}, LiveMethod{"lens", 9, 3, false},
                                         LiveMethod{"laser-plane", 10, 3, true},
                                         LiveMethod{"lut", 23, 1, true}, LiveMethod{"plate", 6, 1, false}),
                         [](const auto& one) {
                             std::string name = one.param.id;
                             std::erase(name, '-');
                             return name;
                         });

// The plate found by the page before, then one shot of it: the place on the flange of both sensors, which are
// one head of the simulated cell.
TEST_F(Guided, StaticOneShotOfAPlateFoundBefore) {
    make_project({"A", "B"});
    Studio studio(*qApp, options());
    studio.window().resize(1280, 800);
    studio.window().show();
    DeskPerson me(studio.window());
    Desk& desk = studio.desk();
    go_to_page(me, desk, "static");
    me.click("calibration_set_target");
    me.click("calibration_go");
    ASSERT_TRUE(me.wait([&] { return !desk.worker().busy(); }));
    me.click("calibration_capture");
    ASSERT_TRUE(me.wait([&] { return window_text(me).find("where the plate stands") != std::string::npos; }))
        << window_text(me);
    me.click("calibration_back");

    go_to_page(me, desk, "plate");
    me.click("calibration_set_target");
    for (int i = 0; i < 4; ++i) {
        capture(me, desk);
        ASSERT_FALSE(HasFailure());
    }
    ASSERT_TRUE(solved(me, studio.window()));
    capture(me, desk, "calibration_verify");
    ASSERT_FALSE(HasFailure());
    ASSERT_TRUE(solved(me, studio.window()));
    me.click("calibration_keep");
    ASSERT_EQ(desk.project().calibrations.size(), 3U) << window_text(me);
    me.click("calibration_back");

    go_to_page(me, desk, "static");
    me.click("calibration_set_target");
    me.click("calibration_go");
    ASSERT_TRUE(me.wait([&] { return !desk.worker().busy(); }));
    me.click("calibration_capture");
    ASSERT_TRUE(QTest::qWaitFor([&] { return captures(me) == 2; }, 3 * kPatienceMs)) << window_text(me);
    ASSERT_TRUE(solved(me, studio.window()));
    me.picture("guided_static_live");
    me.click("calibration_use");
    ASSERT_EQ(desk.project().calibrations.size(), 5U) << window_text(me);
    for (std::size_t k = 0; k < 2; ++k) {
        const Calibration& made = desk.project().calibrations.at(3 + k);
        EXPECT_EQ(desk.project().sensors.at(k).calibration_id, made.id);
        EXPECT_LT(difference(made, desk.project().calibrations.at(k)).largest_mm, 1.0)
            << "over the whole field";
    }
}

// Every page in German on the small and the large screen, dark: what is to be done next is on it without
// scrolling sideways.
TEST_F(Guided, EveryPageFitsTheScreenInGerman) {
    make_project();
    StudioOptions german = options();
    german.language = "de";
    german.theme = "dark";
    Studio studio(*qApp, german);
    MainWindow& window = studio.window();
    window.resize(1280, 800);
    window.show();
    DeskPerson me(window);
    Desk& desk = studio.desk();
    for (const CalibrationMethod& method : calibration_methods()) {
        if (!method.guided) continue;
        if (method.id == "drift") continue;  // needs a calibration made with the sphere
        const QString id = QString::fromStdString(method.id);
        go_to_page(me, desk, id);
        const bool files = method.capture == CaptureKind::files;
        const bool looks =
            !files && method.capture != CaptureKind::touch;  // the nozzle is brought there by hand
        if (looks) {
            me.click("calibration_set_target");
            me.click("calibration_go");
        }
        ASSERT_TRUE(me.wait([&] { return !desk.worker().busy(); }));
        if (looks && method.id != "static") {  // which asks for the plate's place first
            EXPECT_TRUE(me.wait([&] { return me.find<TargetView>("target_view")->seen(); })) << method.id;
        }
        for (const QSize size : {QSize(1280, 800), QSize(1920, 1080)}) {
            window.resize(size);
            QTest::qWait(300);
            if (!files) me.look_at(me.find<QPushButton>("calibration_capture"));
            for (auto* area : window.findChildren<QScrollArea*>())
                if (area->isVisible() && area->isAncestorOf(me.find<QLabel>("guided_title"))) {
                    EXPECT_LE(area->widget()->minimumSizeHint().width(), area->viewport()->width())
                        << method.id;
                }
            me.picture(QString("guided_page_%1_%2").arg(id).arg(size.width()));
        }
        window.resize(1280, 800);
        me.click("calibration_back");
    }
}

// The calibration in use is checked with the sphere it was made with: it holds; after a blow to the sensor it
// does not, and the page says by how much.
class GuidedDrift : public Guided, public testing::WithParamInterface<bool> {
  protected:
    // The calibration in use, as the sphere's page leaves it: it knows where the sphere stands. `struck`:
    // what the file says of the sensor's place is no longer where it is.
    void make_checked_project(bool struck) const {
        make_project();
        auto opened = ProjectFile::open(file);
        ASSERT_TRUE(opened) << opened.error().sentence();
        Project p = opened->load().value();
        Calibration& c = p.calibrations.at(0);
        const CellSettings cell = parse_cell_settings(settings).value();
        const Eigen::Vector3d centre = cell.base_from_target.translation();
        c.result["centre_base_mm"] = {centre.x(), centre.y(), centre.z()};
        c.result["radius_mm"] = cell.sphere_radius_mm;
        if (struck) c.flange_from_sensor.translation() += Eigen::Vector3d(0.8, -0.5, 0.4);
        ASSERT_TRUE(opened->save(p));
    }
};

TEST_P(GuidedDrift, OnTheSimulatedCell) {
    make_checked_project(GetParam());
    ASSERT_FALSE(HasFailure());
    Studio studio(*qApp, options());
    studio.window().resize(1280, 800);
    studio.window().show();
    DeskPerson me(studio.window());
    go_to_page(me, studio.desk(), "drift");
    me.click("calibration_set_target");
    for (int i = 0; i < 4; ++i) {
        capture(me, studio.desk());
        ASSERT_FALSE(HasFailure());
    }
    ASSERT_TRUE(solved(me, studio.window()));
    me.picture(GetParam() ? "guided_drift_struck" : "guided_drift");
    const auto session =
        CalibrationSession::open(file, MethodId("drift"), SensorId("A"), RobotId("R1")).value();
    ASSERT_TRUE(session.solution());
    EXPECT_EQ(session.solution()->document.value("status", ""), GetParam() ? "drifted" : "holds")
        << me.text_of("calibration_reason").toStdString();
    if (GetParam()) {
        EXPECT_NEAR(session.solution()->document["change_mm"].get<double>(), std::sqrt(0.64 + 0.25 + 0.16),
                    0.3);
    }
    me.click("calibration_back");
}
INSTANTIATE_TEST_SUITE_P(Blow, GuidedDrift, testing::Values(false, true),
                         [](const auto& one) { return one.param ? "struck" : "unharmed"; });

// Every method whose data are measured elsewhere, from its file to the stored calibration; one entry of each
// is wrong, is seen in the list and left out.
class GuidedFile : public Guided, public testing::WithParamInterface<const char*> {
  protected:
    json data(const std::string& method) const {
        const auto cell = SimulatedCell::open(settings).value();
        std::mt19937 random(11);
        std::normal_distribution<double> px(0, 0.05), mm(0, 0.02);
        json pairs = json::array(), points = json::array();
        for (int i = 0; i < 6; ++i)
            for (int k = 0; k < 6; ++k) {
                const Eigen::Vector2d xz(-40 + 16 * i, -25 + 10 * k);
                const auto pixel = cell->sensor_model().to_pixel(xz);
                if (!pixel) continue;
                const double off = pairs.size() == 14 ? 9 : 0;
                pairs.push_back({{"pixel", {pixel->x() + px(random) + off, pixel->y() + px(random)}},
                                 {"laser", {xz.x(), xz.y()}}});
            }
        const Pose world_from_plate = make_pose(rotation_exp({0.1, -0.2, 0.4}), {800, -300, 650});
        for (int i = 0; i < 8; ++i) {
            const Eigen::Vector3d on_plate(i % 4 * 90.0, i / 4 * 120.0, i % 2 * 15.0);
            const Eigen::Vector3d world =
                world_from_plate * on_plate +
                Eigen::Vector3d(mm(random) + (i == 5 ? 4 : 0), mm(random), mm(random));
            points.push_back({{"plate", {on_plate.x(), on_plate.y(), on_plate.z()}},
                              {"world", {world.x(), world.y(), world.z()}}});
        }
        if (method == "nozzle") {
            json touches = find_method("nozzle")->example();
            const auto pose = parse_pose(touches["touches"][4]["base_from_flange"], "").value();
            touches["touches"][4]["base_from_flange"] =
                pose_json(make_pose(pose.linear(), pose.translation() + Eigen::Vector3d(2, 1, 2)));
            return touches;
        }
        if (method == "laser-plane") return {{"pairs", pairs}};
        if (method == "lut")
            return {{"size", {cell->settings().optics.width, cell->settings().optics.height}},
                    {"pairs", pairs}};
        if (method == "plate") return {{"points", points}};
        const auto link = [](const Pose& pose) {
            return json{{"pose", pose_json(pose)}, {"sigma_mm", 0.01}, {"sigma_deg", 0.002}};
        };
        const Pose plate_from_camera = make_pose(rotation_exp({3.0, 0.2, 0.1}), {30, 20, 310});
        const Pose camera_from_laser = cell->sensor_model().camera_from_laser;
        // The reference is the flange: A's chain ends where the cell has its sensor, B's 50 mm beside.
        const Pose world_from_laser = world_from_plate * plate_from_camera * camera_from_laser;
        const auto chain = [&](const char* id, const Pose& plate) {
            return json{{"id", id},
                        {"world_from_plate", link(plate)},
                        {"plate_from_camera", link(plate_from_camera)},
                        {"camera_from_laser", link(camera_from_laser)}};
        };
        const Pose beside = make_pose(Eigen::Matrix3d::Identity(), {0, kBesideMm, 0});
        return {{"reference_from_world", link(cell->flange_from_sensor() * world_from_laser.inverse())},
                {"sensors",
                 {chain("A", world_from_plate),
                  chain("B", world_from_laser * beside * world_from_laser.inverse() * world_from_plate)}}};
    }
    static constexpr double kBesideMm = 50;
    // Every sensor of the gripper at once: told before, stored and in use together, taken back together.
    static void use_all_of_a_shot(const DeskPerson& me, MainWindow& window, Desk& desk) {
        auto* table = me.find<QTableWidget>("captures");
        EXPECT_TRUE(
            me.text_of("calibration_stands").contains("static-3 for sensor A, static-4 for sensor B."));
        for (const char* id : {"sensor A: three sigma", "sensor B: three sigma"})
            EXPECT_TRUE(me.text_of("calibration_reason").contains(id)) << id;
        for (const char* against : {"Sensor A: Against calibration simulated-truth,",
                                    "Sensor B: Against calibration simulated-truth B,"})
            EXPECT_TRUE(me.text_of("calibration_compared").contains(against)) << against;
        EXPECT_EQ(me.find<QPushButton>("calibration_use")->text(), "Use these calibrations");
        // Without its tick a sensor is left out.
        press_space(me, table, 1);
        ASSERT_TRUE(me.wait([&] { return table->item(1, 4)->text() == "left out"; }));
        ASSERT_TRUE(solved(me, window));
        EXPECT_FALSE(me.text_of("calibration_stands").contains("sensor B"));
        press_space(me, table, 1);
        ASSERT_TRUE(me.wait([&] { return table->item(1, 4)->text() != "left out"; }));
        ASSERT_TRUE(solved(me, window));
        me.click("calibration_use");
        ASSERT_EQ(desk.project().calibrations.size(), 4U) << window_text(me);
        for (std::size_t i = 0; i < 2; ++i) {
            const Calibration& made = desk.project().calibrations.at(2 + i);
            EXPECT_EQ(desk.project().sensors.at(i).calibration_id, made.id);
            EXPECT_EQ(made.sensor_id, desk.project().sensors.at(i).id);
            EXPECT_NEAR(difference(made, desk.project().calibrations.at(i)).shift_mm, i == 0 ? 0 : kBesideMm,
                        1e-3);
        }
        EXPECT_EQ(me.text_of("calibration_used"), "Stored in the project as static-3, static-4.");
        me.picture("guided_static_used");
        me.shortcut(Qt::Key_Z);
        EXPECT_EQ(desk.project().calibrations.size(), 2U);
        for (const SensorSetup& sensor : desk.project().sensors)
            EXPECT_TRUE(sensor.calibration_id.starts_with("simulated-truth")) << sensor.id;
    }
};

TEST_P(GuidedFile, FromItsFile) {
    const std::string method = GetParam();
    make_project(method == "static" ? std::vector<std::string>{"A", "B"} : std::vector<std::string>{"A"});
    const fs::path path = folder / (method + ".json");
    std::ofstream(path) << data(method);
    Studio studio(*qApp, options());
    MainWindow& window = studio.window();
    window.resize(1280, 800);
    window.show();
    DeskPerson me(window);
    Desk& desk = studio.desk();
    me.step(2);
    me.click("begin_" + QString::fromStdString(method));
    me.answer_file_dialog(QString::fromStdString(path.string()));
    me.click("calibration_load");
    ASSERT_TRUE(me.wait([&] { return captures(me) > 0; })) << me.text_of("calibration_said").toStdString();
    ASSERT_TRUE(solved(me, window));
    auto* table = me.find<QTableWidget>("captures");
    if (method != "static") {
        const QString wrong = method == "plate" ? "5" : method == "nozzle" ? "T5" : "14";
        int row = -1;
        for (int r = 0; r < table->rowCount(); ++r)
            if (table->item(r, 0)->text() == wrong) row = r;
        ASSERT_GE(row, 0);
        EXPECT_EQ(table->item(row, 4)->text(), "contradicts the others");
        press_space(me, table, row);
        ASSERT_TRUE(me.wait([&] { return table->item(row, 4)->text() == "left out"; }));
        ASSERT_TRUE(solved(me, window));
        EXPECT_FALSE(me.find<QPushButton>("calibration_keep")->isEnabled()) << "not verified yet";
        table->setCurrentCell(row == 0 ? 1 : row - 1, 0);
        me.click("calibration_mark");
        ASSERT_TRUE(solved(me, window));
        EXPECT_TRUE(me.text_of("calibration_verified").startsWith("confirmed"))
            << me.text_of("calibration_verified").toStdString();
    }
    me.picture("guided_" + QString::fromStdString(method));
    if (method == "static") return use_all_of_a_shot(me, window, desk);
    const bool use = find_method(method)->use == AnswerUse::sensor;
    me.click(use ? "calibration_use" : "calibration_keep");
    ASSERT_EQ(desk.project().calibrations.size(), 2U) << me.text_of("calibration_said").toStdString();
    const Calibration& made = desk.project().calibrations.back();
    EXPECT_EQ(made.method, method);
    EXPECT_EQ(made.nozzle.has_value(), method == "nozzle");
    if (use) {
        EXPECT_EQ(desk.project().sensors.at(0).calibration_id, made.id);
        const CalibrationDifference d = difference(made, desk.project().calibrations.front());
        EXPECT_GT(d.points, 20);
        EXPECT_LT(d.largest_mm, 0.5);
    }
}
INSTANTIATE_TEST_SUITE_P(Methods, GuidedFile,
                         testing::Values("laser-plane", "lut", "plate", "static", "nozzle"),
                         [](const auto& one) {
                             std::string name = one.param;
                             std::erase(name, '-');
                             return name;
                         });

// The folder of a real cell through the page: the command line's answer.
TEST_F(Guided, BoardFromAFolderOfImages) {
    const char* given = std::getenv("SEAMWRIGHT_DATA");
    const fs::path images = fs::path(given ? given : SEAMWRIGHT_SHARED_DATA) / "etna" / "calib2";
    if (!fs::exists(images)) GTEST_SKIP() << "skipped: no real data";
    make_project();
    {
        Studio studio(*qApp, options());
        MainWindow& window = studio.window();
        window.resize(1280, 800);
        window.show();
        DeskPerson me(window);
        me.step(2);
        me.click("begin_stripe-camera");
        me.answer_file_dialog(QString::fromStdString(images.string()));
        me.click("calibration_load_folder");
        ASSERT_TRUE(QTest::qWaitFor([&] { return captures(me) > 0; }, 120000))
            << me.text_of("calibration_said").toStdString();
        for (int patience = 0; patience < 6 && me.text_of("calibration_verdict") == "not solved yet";
             ++patience)
            (void)solved(me, window);
        me.picture("guided_folder");
    }
    const CalibrationMethod& method = *find_method("stripe-camera");
    const auto command_line = solve_calibration(
        method, *method.data_of_images({images.string(), {.counts = "7x6", .pitch_mm = 10}, {}}), {});
    ASSERT_TRUE(command_line);
    const auto session =
        CalibrationSession::open(file, MethodId("stripe-camera"), SensorId("A"), RobotId("R1")).value();
    ASSERT_TRUE(session.solution());
    const json &found = session.solution()->document, &expected = command_line->document;
    EXPECT_EQ(session.state().captures.size(), expected["images"].get<std::size_t>());
    EXPECT_EQ(found["verdict"], expected["verdict"]);
    for (std::size_t i = 0; i < expected["parameters"].size(); ++i) {
        const double value = expected["parameters"][i]["value"];
        EXPECT_NEAR(found["parameters"][i]["value"].get<double>(), value,
                    1e-9 * std::max(1.0, std::abs(value)))
            << expected["parameters"][i]["name"];
    }
    EXPECT_NEAR(found["on_plane_share"].get<double>(), expected["on_plane_share"].get<double>(), 1e-12);
}

}  // namespace
}  // namespace seamwright
