#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <thread>

#include "devices/exchange/pose_json.h"
#include "devices/registry.h"
#include "devices/simulated/cell.h"

namespace seamwright {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

// A cell without the door's many triangles, for tests of robot and wiring.
std::shared_ptr<SimulatedCell> small_cell(json settings = json::object()) {
    settings["scene"] = "triangle";
    settings["optics"] = {{"width", 320}, {"height", 256}};
    auto cell = SimulatedCell::open(settings);
    EXPECT_TRUE(cell);
    return *cell;
}

MeasuringMove move_over(const SimulatedCell& cell, const std::string& spot, double speed = 100) {
    MeasuringMove move;
    move.spot_id = spot;
    const Pose at = cell.settings().base_from_target * make_pose(Eigen::Matrix3d::Identity(), {0, 0, 15});
    const auto flange = [&](double travel) {
        return at * make_pose(Eigen::Matrix3d::Identity(), {0, travel, 0}) *
               cell.flange_from_sensor().inverse();
    };
    move.entry = flange(-20);
    move.trigger = flange(0);
    move.exit = flange(20);
    move.speed_mm_s = speed;
    return move;
}

TEST(SimulatedCell, JitterAndRepeatabilityAreAsStated) {
    const auto cell = small_cell(
        {{"robot", {{"trigger_jitter_mm", 2}, {"repeatability_mm", 0.05}, {"repeatability_deg", 0.01}}}});
    const MeasuringMove move = move_over(*cell, "S", 50);
    const Eigen::Vector3d travel = (move.exit.translation() - move.entry.translation()).normalized();
    const Eigen::Vector3d across = travel.unitOrthogonal();
    constexpr int n = 4000;
    double jitter2 = 0, largest = 0, across2 = 0, turn2 = 0, mean = 0;
    for (int i = 0; i < n; ++i) {
        cell->start_moves({move});
        const auto event = cell->next_trigger();
        ASSERT_TRUE(event);
        EXPECT_TRUE(event->base_from_flange->isApprox(move.trigger))
            << "the controller reports where it was sent";
        const Vector6 off = difference(*cell->true_flange(), move.trigger);
        const double along = travel.dot(off.head<3>());
        mean += along / n;
        jitter2 += along * along / n;
        largest = std::max(largest, std::abs(along));
        across2 += std::pow(across.dot(off.head<3>()), 2) / n;
        turn2 += off.tail<3>().squaredNorm() / 3 / n;
    }
    // Half the speed halves the half width: 1 mm uniform, and the repeatability on top.
    EXPECT_NEAR(jitter2, 1.0 / 3 + 0.05 * 0.05, 0.02);
    EXPECT_NEAR(mean, 0, 0.04);
    EXPECT_LT(largest, 1 + 5 * 0.05);
    EXPECT_NEAR(std::sqrt(across2), 0.05, 0.003);
    EXPECT_NEAR(deg_from_rad(std::sqrt(turn2)), 0.01, 0.0006);
    MeasuringMove standing = move;
    standing.stop_at_trigger = true;
    for (int i = 0; i < 50; ++i) {
        cell->start_moves({standing});
        (void)cell->next_trigger();
        EXPECT_LT((cell->true_flange()->translation() - move.trigger.translation()).norm(), 0.05 * 6);
    }
}

TEST(SimulatedCell, SensorAndRobotWorkTogether) {
    DeviceSession session;
    const json settings = {{"scene", "triangle"},
                           {"optics", {{"width", 320}, {"height", 256}}},
                           {"buffers", 4},
                           {"robot", {{"frames", {{"top", {{"xyz", {1, 2, 3}}, {"abc", {0, 0, 0}}}}}}}}};
    auto sensor = open_sensor("simulated", settings, session);
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    auto robot = open_robot("simulated", settings, session);
    ASSERT_TRUE(robot) << robot.error().sentence();
    json other = settings;
    other["seed"] = 2;
    EXPECT_FALSE(open_robot("simulated", other, session)) << "two worlds in one session";
    const auto cell = *shared_cell(settings, session);

    EXPECT_EQ((*sensor)->identity().driver, "simulated");
    EXPECT_EQ((*robot)->identity()->serial, "SIM-1");
    EXPECT_EQ(*(*robot)->mode(), RobotMode::automatic);
    EXPECT_FALSE((*robot)->base_from_flange());
    EXPECT_FALSE((*sensor)->wait_next(1ms)) << "not started";
    EXPECT_FALSE((*sensor)->trigger("S1"));
    ASSERT_TRUE((*sensor)->start());
    EXPECT_FALSE((*sensor)->trigger("S1")) << "the robot stands nowhere";
    EXPECT_EQ((*sensor)->wait_next(5ms).error().kind, ErrorKind::device);
    EXPECT_EQ((*sensor)->latest(), nullptr);

    ASSERT_TRUE((*robot)->start_measuring({move_over(*cell, "S1"), move_over(*cell, "S2")}));
    for (const char* id : {"S1", "S2"}) {
        const auto event = (*robot)->wait_trigger(1s);
        ASSERT_TRUE(event);
        EXPECT_EQ(event->spot_id, id);
        if (id[1] == '2') {
            ASSERT_TRUE((*sensor)->trigger(id)) << "the same exposure, not a second one";
        }
        const auto frame = (*sensor)->wait_next(1s);
        ASSERT_TRUE(frame);
        EXPECT_EQ((*frame)->spot_id, id);
        EXPECT_EQ((*frame)->status, FrameStatus::ok);
        EXPECT_EQ((*frame)->image.width, 320);
        EXPECT_EQ((*sensor)->latest(), *frame);
        EXPECT_FALSE((*sensor)->wait_next(1ms));
    }
    EXPECT_FALSE((*robot)->wait_trigger(1ms)) << "the program has ended";

    // Teaching by software trigger.
    ASSERT_TRUE((*robot)->move_to(move_over(*cell, "").trigger));
    EXPECT_TRUE((*robot)->base_from_flange()->isApprox(move_over(*cell, "").trigger));
    ASSERT_TRUE((*sensor)->trigger("teach"));
    EXPECT_EQ((*(*sensor)->wait_next(1s))->spot_id, "teach");

    // More exposures than buffers: dropped and counted, the sequence shows the gap.
    for (int i = 0; i < 6; ++i) ASSERT_TRUE((*sensor)->trigger("burst" + std::to_string(i)));
    std::uint64_t last = 0;
    for (int i = 0; i < 4; ++i) last = (*(*sensor)->wait_next(1s))->sequence;
    EXPECT_EQ((*sensor)->counters().underrun, 2U);
    ASSERT_TRUE((*sensor)->trigger("after"));
    EXPECT_EQ((*(*sensor)->wait_next(1s))->sequence, last + 3);
    EXPECT_EQ((*sensor)->counters().completed, 8U);

    // Exposure and gain.
    EXPECT_EQ(*(*sensor)->get("exposure_us"), 1000);
    ASSERT_TRUE((*sensor)->set("exposure_us", 500));
    EXPECT_EQ(*(*sensor)->get("exposure_us"), 500);
    EXPECT_FALSE((*sensor)->set("exposure_us", -1));
    EXPECT_FALSE((*sensor)->set("exposure_us", std::nan("")));
    EXPECT_FALSE((*sensor)->set("colour", 1));
    EXPECT_FALSE((*sensor)->get("colour"));

    // Frames of the controller.
    EXPECT_EQ((*robot)->read_frame("top")->translation().y(), 2);
    const Pose moved = make_pose(rotation_exp({0, 0, 0.1}), {4, 5, 6});
    ASSERT_TRUE((*robot)->write_frame("top", moved));
    EXPECT_TRUE((*robot)->read_frame("top")->isApprox(moved));
    EXPECT_FALSE((*robot)->write_frame("bottom", moved));
    Pose broken = moved;
    broken.translation().x() = std::nan("");
    EXPECT_FALSE((*robot)->write_frame("top", broken));
    EXPECT_FALSE((*robot)->move_to(broken));
    cell->set_mode(RobotMode::stopped);
    EXPECT_FALSE((*robot)->start_measuring({}));
    (*sensor)->stop();
    EXPECT_FALSE((*sensor)->wait_next(1ms));
}

TEST(SimulatedCell, SameSeedSameRun) {
    const auto run = [](int seed) {
        const auto cell = small_cell({{"seed", seed}});
        auto sensor = make_simulated_sensor(cell);
        EXPECT_TRUE(sensor->start());
        cell->start_moves({move_over(*cell, "a"), move_over(*cell, "b")});
        std::vector<std::byte> bytes;
        while (cell->next_trigger()) {
            const auto frame = sensor->wait_next(1s);
            bytes.insert(bytes.end(), (*frame)->pixels.begin(), (*frame)->pixels.end());
        }
        return bytes;
    };
    const auto first = run(3);
    EXPECT_EQ(first, run(3));
    EXPECT_NE(first, run(4));
}

TEST(SimulatedCell, DamagedFramesAreMarkedAndCounted) {
    const auto cell = small_cell({{"damaged_probability", 0.25}});
    auto sensor = make_simulated_sensor(cell);
    ASSERT_TRUE(sensor->start());
    cell->move_to(move_over(*cell, "").trigger);
    int damaged = 0;
    for (int i = 0; i < 200; ++i) {
        ASSERT_TRUE(sensor->trigger(""));
        damaged += (*sensor->wait_next(1s))->status == FrameStatus::incomplete;
    }
    EXPECT_NEAR(damaged, 50, 25);
    EXPECT_EQ(sensor->counters().damaged, static_cast<std::uint64_t>(damaged));
    EXPECT_EQ(sensor->counters().completed, static_cast<std::uint64_t>(200 - damaged));
}

TEST(SimulatedCell, ScreenAndRunShareTheSensorAcrossThreads) {
    const auto cell = small_cell();
    auto sensor = make_simulated_sensor(cell);
    auto robot = make_simulated_robot(cell);
    ASSERT_TRUE(sensor->start());
    std::atomic<bool> done = false;
    std::jthread screen([&] {
        while (!done) {
            (void)sensor->latest();
            (void)sensor->counters();
            (void)cell->describe();
            std::this_thread::sleep_for(200us);
        }
    });
    std::jthread receiver([&] {
        for (int i = 0; i < 20;) {
            if (sensor->wait_next(100ms)) ++i;
        }
    });
    for (int i = 0; i < 20; ++i) {
        ASSERT_TRUE(robot->start_measuring({move_over(*cell, "S")}));
        ASSERT_TRUE(robot->wait_trigger(1s));
        while (sensor->counters().completed < static_cast<std::uint64_t>(i + 1))
            std::this_thread::sleep_for(100us);
        PartState part;
        part.workobject_from_movedworkobject.translation().x() = i;
        cell->set_part(part);
    }
    receiver.join();
    done = true;
    EXPECT_EQ(sensor->counters().completed, 20U);
}

TEST(SimulatedCell, DisplacedPointsFollowBendAndD) {
    const Pose d = make_pose(rotation_exp({0.01, -0.02, 0.005}), {5, -3, 2});
    const auto cell = SimulatedCell::open(json{{"part", {{"displacement", pose_json(d)}, {"bend_mm", 3.0}}},
                                               {"optics", {{"width", 128}, {"height", 128}}}});
    ASSERT_TRUE(cell);
    const auto box = (*cell)->part_mesh().box();
    const Eigen::Vector3d hinge(box.min().x(), 300, 0), latch(box.max().x(), 300, 0);
    EXPECT_LT(((*cell)->displaced(hinge) - d * hinge).norm(), 1e-9) << "fixed at the hinges";
    EXPECT_LT(((*cell)->displaced(latch) - d * (latch + Eigen::Vector3d(0, 0, 3))).norm(), 1e-9);
    const json said = (*cell)->describe();
    EXPECT_EQ(said["bend_mm"], 3.0);
    EXPECT_EQ(said["seed"], 1);
    EXPECT_TRUE(said["robot"].contains("trigger_jitter_half_width_mm_at_100_mm_s"));
}

TEST(SimulatedCell, TheBoardIsFoundWhereItStands) {
    const auto cell = SimulatedCell::open(json{{"scene", "plate"}, {"noise", {{"stray_probability", 0}}}});
    ASSERT_TRUE(cell);
    const Pose target_from_sensor = make_pose(rotation_exp({0.15, 0.1, 0.2}), {0, 0, 5});
    Frame frame;
    (*cell)->render(
        (*cell)->settings().base_from_target * target_from_sensor * (*cell)->flange_from_sensor().inverse(),
        1, frame);
    cv::Mat image(frame.image.height, frame.image.width, CV_8U, frame.pixels.data());
    cv::Mat stretched;
    image.convertTo(stretched, CV_8U, 3.0);
    std::vector<cv::Point2f> corners;
    ASSERT_TRUE(cv::findChessboardCornersSB(stretched, {7, 6}, corners));
    const SensorModel& model = (*cell)->sensor_model();
    const Pose camera_from_target = model.camera_from_laser * target_from_sensor.inverse();
    double sum = 0;
    for (const auto& c : corners) {
        double best = 1e9;
        for (int i = 0; i < 7; ++i) {
            for (int k = 0; k < 6; ++k) {
                const Eigen::Vector3d p(10 * (i - 3), 10 * (k - 2.5), 0);
                best = std::min(
                    best, (model.camera.project(camera_from_target * p) - Eigen::Vector2d(c.x, c.y)).norm());
            }
        }
        EXPECT_LT(best, 0.5);
        sum += best;
    }
    EXPECT_LT(sum / 42, 0.12) << "px";
}

TEST(SimulatedCell, SettingsAreRefusedByName) {
    const auto error = [](const json& settings) {
        const auto s = parse_cell_settings(settings);
        return s ? "accepted" : s.error().sentence();
    };
    EXPECT_EQ(error(json::object()), "accepted");
    EXPECT_THAT(error(json::array()), HasSubstr("object"));
    EXPECT_THAT(error({{"sed", 1}}), HasSubstr("settings.sed"));
    EXPECT_THAT(error({{"seed", 1.5}}), HasSubstr("whole number"));
    EXPECT_THAT(error({{"seed", -1}}), HasSubstr("settings.seed"));
    EXPECT_THAT(error({{"scene", "moon"}}), HasSubstr("moon"));
    EXPECT_THAT(error({{"scene", 1}}), HasSubstr("settings.scene"));
    EXPECT_THAT(error({{"optics", {{"width", 1e9}}}}), HasSubstr("settings.optics.width"));
    EXPECT_THAT(error({{"optics", {{"bit_depth", 9}}}}), HasSubstr("settings.optics.bit_depth"));
    EXPECT_THAT(error({{"optics", {{"widht", 100}}}}), HasSubstr("settings.optics.widht"));
    EXPECT_THAT(error({{"optics", 3}}), HasSubstr("settings.optics"));
    EXPECT_THAT(error({{"noise", {{"shot", 1}}}}), HasSubstr("settings.noise.shot"));
    EXPECT_THAT(error({{"part", {{"displacement", {{"xyz", {1, 2}}, {"abc", {0, 0, 0}}}}}}}),
                HasSubstr("settings.part.displacement.xyz"));
    EXPECT_THAT(error({{"robot", {{"mode", "flying"}}}}), HasSubstr("settings.robot.mode"));
    EXPECT_THAT(error({{"robot", {{"frames", {{"a", 1}}}}}}), HasSubstr("settings.robot.frames.a"));
    EXPECT_THAT(error({{"robot", {{"frames", {1, 2}}}}}), HasSubstr("settings.robot.frames"));
    EXPECT_THAT(error({{"board", {{"columns", 0}}}}), HasSubstr("settings.board.columns"));
    EXPECT_FALSE(SimulatedCell::open(json{{"mesh", "/nonexistent/part.stl"}}));
}

}  // namespace
}  // namespace seamwright
