// Guided calibrations whose data come from files: measured elsewhere, or a folder of images.

#include <random>

#include "devices/exchange/pose_json.h"
#include "projects/calibrate/session/answer.h"
#include "projects/calibrate/session/capture.h"
#include "tests/app/studio/guided.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

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
