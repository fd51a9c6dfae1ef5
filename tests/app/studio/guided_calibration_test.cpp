// Guided calibrations at the real window, by mouse and keyboard: the sphere from the first capture to the
// calibration in use, with a bad pose and a kill in between; one shot of a plate; the check after a blow; every page.

#include "devices/exchange/pose_json.h"
#include "projects/calibrate/session/answer.h"
#include "projects/calibrate/session/capture.h"
#include "projects/calibrate/session/guide.h"
#include "tests/app/studio/guided.h"
#include "widgets/calibrate/target_view.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Run by capture_until_killed() as a process of its own.
TEST_F(Guided, DISABLED_CapturesUntilKilled) {
    Studio studio(*qApp, options());
    studio.window().resize(1280, 800);
    studio.window().show();
    DeskPerson me(studio.window());
    go_to_page(me, studio.desk(), std::getenv(kGuidedMethod));
    me.click("calibration_set_target");
    for (int i = 0; i < 100; ++i) {
        capture(me, studio.desk());
        if (HasFailure()) return;
        std::ofstream(folder / "count") << captures(me) << std::endl;
    }
}

// A pose that somebody typed wrong: the profile is of another place than the pose says.
fs::path wrong_pose(const CalibrationSession& s, const json& settings, const fs::path& folder) {
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
    me.answer_file_dialog(QString::fromStdString(wrong_pose(session, settings, folder).string()));
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
}  // namespace
}  // namespace seamwright
