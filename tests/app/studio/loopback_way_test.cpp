// The commissioning once more where nothing is simulated in the studio: a GigE Vision camera and a KUKA controller by
// EthernetKRL, another process behind real protocols. From an empty project over the search of the camera, the form of
// the robot, a calibration on a board, spots, a region to a pushed part, by mouse and keyboard, in German.

#include <gtest/gtest.h>
#include <unistd.h>

#include <QCheckBox>
#include <QListWidget>
#include <QMenu>
#include <QProcess>
#include <nlohmann/json.hpp>

#include "app/studio/studio.h"
#include "devices/exchange/pose_json.h"
#include "devices/net/socket.h"
#include "projects/calibrate/session/answer.h"
#include "projects/calibrate/session/guide.h"
#include "projects/reuse/simulated_truth.h"
#include "tests/app/studio/commissioning.h"
#include "tests/app/studio/screen_audit.h"

namespace seamwright {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// `seamwright sim-cell` in a process of its own: what a person does beside the robot is a line to it.
class CellBeside {
  public:
    bool start(const json& settings, const fs::path& folder, int port) {
        const fs::path file = folder / "cell.json";
        std::ofstream(file) << settings;
        process_.start(SEAMWRIGHT_PROGRAM,
                       {"sim-cell", QString::fromStdString(file.string()), "--camera", "free", "--controller",
                        QString("kuka-eki:%1").arg(port), "--time-scale", "40"});
        return process_.waitForStarted() && !answer().is_null();
    }
    ~CellBeside() {
        process_.write("stop\n");
        process_.waitForFinished();
    }
    json say(const std::string& line) {
        process_.write((line + "\n").c_str());
        const json said = answer();
        EXPECT_TRUE(said.value("ok", false)) << line << ": " << said.dump();
        return said;
    }

  private:
    json answer() {
        while (!process_.canReadLine())
            if (!process_.waitForReadyRead(kPatienceMs)) {
                ADD_FAILURE() << "the cell says nothing: " << process_.readAllStandardError().toStdString();
                return nullptr;
            }
        return json::parse(process_.readLine().toStdString(), nullptr, false);
    }
    QProcess process_;
};

TEST(LoopbackWay, FromAnEmptyProjectToAPushedPart) {
    const fs::path folder = fs::temp_directory_path() / ("seamwright_loopback_" + std::to_string(::getpid()));
    fs::create_directories(folder);
    QApplication::setAttribute(Qt::AA_DontUseNativeDialogs);
    const int port = TcpListener::listen("127.0.0.1", 0)->port();
    const std::string serial = "LOOP-" + std::to_string(::getpid());  // other tests serve cameras too
    const json settings = {
        {"seed", 11},
        {"serial", serial},
        {"buffers", 64},
        {"robot", {{"frames", {{"BASE_Region1", pose_json(default_cell_settings().base_from_workobject)}}}}}};
    const auto drawn =
        SimulatedCell::open(settings).value();  // where door and board stand, as a person sees them
    CellBeside cell;
    ASSERT_TRUE(cell.start(settings, folder, port));
    cell.say("mode manual_reduced");

    StudioOptions options;
    options.language = "de";
    options.theme = "light";
    options.settings = QString::fromStdString((folder / "settings.ini").string());
    options.data = QString::fromStdString((folder / "").string());
    {
        Studio studio(*qApp, options);
        MainWindow& window = studio.window();
        window.resize(1280, 800);
        window.show();
        Desk& desk = studio.desk();  // looked at, never worked
        ASSERT_TRUE(come_up(desk)) << "the demo's cell is there at once";
        FreezeWatch watch(10);
        DeskPerson me(window, &watch);
        me.examines([&] { return audit::cut_off(window); });
        const QString file = QString::fromStdString((folder / "door.seam").string());
        me.answer_file_dialog(file);
        me.shortcut(Qt::Key_N);
        ASSERT_TRUE(me.wait([&] { return desk.path() == file.toStdString(); }));

        std::vector<Chapter> chapters;
        int since = me.clicks();
        const auto chapter = [&](const char* name, int most) {
            chapters.push_back({name, me.clicks() - since, most});
            since = me.clicks();
        };

        // The camera is found on the wire, and is live.
        me.click("search_cameras");
        ASSERT_TRUE(me.wait([&] { return window.findChild<QMenu*>("cameras"); }));
        auto* found = window.findChild<QMenu*>("cameras");
        me.picture("loopback_01_cameras");
        if (!found->actions().front()->isEnabled())
            GTEST_SKIP() << "this computer answers no broadcast on loopback";
        QAction* mine = nullptr;
        for (QAction* camera : found->actions())
            if (camera->text().contains(QString::fromStdString(serial))) mine = camera;
        ASSERT_TRUE(mine);
        me.clicked_too();
        QTest::mouseClick(found, Qt::LeftButton, {}, found->actionGeometry(mine).center());
        ASSERT_EQ(desk.project().sensors.size(), 1U);
        me.click("connect");
        const std::string sensor = desk.project().sensors[0].id;
        ASSERT_TRUE(me.wait([&] {
            const auto live = desk.live().latest(sensor);
            return live && live->frame && !live->frame->image.empty();
        })) << desk.station().trouble;
        chapter("the camera found, live", 4);
        me.picture("loopback_02_live");
        // It is wired to the robot's output.
        auto* wired = me.find<QCheckBox>("setting_hardware_trigger");
        ASSERT_TRUE(wired);
        me.look_at(wired);
        wired->setFocus();
        QTest::keyClick(wired, Qt::Key_Space);
        me.clicked_too();
        me.click("apply_device");

        // The robot by its driver's form.
        me.click("add_robot");
        me.choose("driver", "kuka-eki");
        auto* setting = me.find<QLineEdit>("setting_port");
        ASSERT_TRUE(setting);
        me.write(setting, QString::number(port));
        QTest::qWait(2500);  // the camera's state comes every second: what was typed stays
        EXPECT_EQ(setting->text(), QString::number(port));
        me.picture("loopback_03_form");
        me.click("apply_device");
        me.click("connect");
        ASSERT_TRUE(me.wait([&] {
            return desk.station().connected && desk.station().robots.size() == 1 &&
                   desk.station().robots[0].base_from_flange;
        })) << desk.station().trouble;
        chapter("the trigger wired, the robot by its form", 8);
        me.picture("loopback_03_robot");
        me.write_pose("workobject", drawn->base_from_workobject());

        // Board, robot jogged to where the camera sees it, and one press for all captures.
        const CalibrationMethod& method = *find_method("stripe-camera");
        cell.say("scene plate");
        cell.say("flange " + pose_json(simulated_start(method, settings)->base_from_flange).dump());
        since = me.clicks();
        me.step(2);
        me.click("begin_stripe-camera");
        me.write_pose("calibration_nominal", drawn->flange_from_sensor());  // as the drawing has it
        me.click("calibration_all");
        // The first one is where the robot stands; before it moves the desk asks who is beside it.
        auto* consent = window.findChild<QCheckBox*>("jog_consent");
        ASSERT_TRUE(me.wait([&] { return consent->isVisible(); }))
            << me.text_of("calibration_said").toStdString();
        me.look_at(consent);
        consent->setFocus();
        QTest::keyClick(consent, Qt::Key_Space);
        me.clicked_too();
        me.picture("loopback_04_consent");
        me.click("calibration_all");
        auto* use = me.find<QPushButton>("calibration_use");
        ASSERT_TRUE(QTest::qWaitFor([&] { return use->isEnabled(); }, 9 * kPatienceMs))
            << me.text_of("calibration_said").toStdString() << me.text_of("calibration_reason").toStdString();
        me.picture("loopback_05_solved");
        me.click("calibration_use");
        ASSERT_EQ(desk.project().calibrations.size(), 1U);
        chapter("a calibration", 12);
        const Calibration& made = desk.project().calibrations[0];
        Calibration truth;
        truth.model = drawn->sensor_model();
        truth.flange_from_sensor = drawn->flange_from_sensor();
        const CalibrationDifference d = difference(made, truth);
        std::printf(
            "calibration against the truth: up to %.3f mm, mean %.3f mm, shift %.3f mm, turn %.3f deg\n",
            d.largest_mm, d.mean_mm, d.shift_mm, d.turn_deg);
        EXPECT_LT(d.largest_mm, 1.0);
        me.click("calibration_back");
        cell.say("scene part");

        // Spots: height at three corners, and the sides.
        const auto doors = default_door_spots();
        Teacher teacher(me, desk, *drawn);
        std::set<std::size_t> taken;
        for (const std::size_t i : {2UL, 6UL, 11UL}) {
            teacher.add(doors[i], i != 6);
            if (testing::Test::HasFatalFailure()) return;
            taken.insert(i);
        }
        chapters.push_back({"a spot by its contour's end", teacher.clicks(false), 4});
        chapters.push_back({"a spot by a template", teacher.clicks(true), 7});
        me.step(5);
        since = me.clicks();
        me.click("add_region");
        teacher.group();
        chapter("a region of three spots", 4);
        if (testing::Test::HasFatalFailure()) return;
        teacher.follow_advice(taken);
        if (testing::Test::HasFatalFailure()) return;
        me.picture("loopback_06_region");
        me.shortcut(Qt::Key_S);
        ASSERT_TRUE(me.wait([&] { return !desk.modified(); }));

        // Its program is loaded on the controller, and the next part stands there.
        cell.say("project " + file.toStdString());
        cell.say("mode external");
        const Pose displaced = make_pose(rotation_exp({0.002, -0.001, 0.003}), {3.5, -2.25, 1.125});
        cell.say("part " + json{{"displacement", pose_json(displaced)}}.dump());
        me.step(8);
        me.write(me.find<QLineEdit>("part_id"), "CAR-1");
        since = me.clicks();
        teacher.push("loopback_07_confirm");
        if (testing::Test::HasFatalFailure()) return;
        chapter("measured and pushed", 2);
        QTest::qWait(100);
        me.picture("loopback_08_pushed");
        const auto runs = desk.runs().value();
        ASSERT_FALSE(runs.empty());
        const RunRecord run = desk.run(runs.front().number).value();
        EXPECT_EQ(run.status, RunStatus::ok) << run.message;
        ASSERT_TRUE(run.regions.at(0).push.read_back);
        // What the controller holds now is the frame moved as the part was.
        const json state = cell.say("state");
        const Pose frame = parse_pose(state["frames"]["BASE_Region1"], "frame").value();
        EXPECT_LT(distance_mm(frame, run.regions[0].base_from_frame), 0.01);
        const Pose moved = drawn->base_from_workobject().inverse() * frame;
        // Where the bead is laid, the frame is as the part is: three sigma are required to be below 0.3 mm.
        double worst = 0;
        for (const std::size_t i : taken) {
            const Eigen::Vector3d at = doors[i].workobject_from_sensor.translation();
            worst = std::max(worst, (moved * at - displaced * at).norm());
        }
        std::printf("pushed: %.3f mm beside the part at worst\n", worst);
        EXPECT_LT(worst, 0.3);
        print(chapters, watch.freezes());
        ASSERT_TRUE(me.wait([&] { return !desk.worker().busy(); }));
        window.close();
    }
    fs::remove_all(folder);
}

}  // namespace
}  // namespace seamwright
