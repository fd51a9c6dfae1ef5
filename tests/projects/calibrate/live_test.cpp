#include "projects/calibrate/live.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "devices/registry.h"
#include "projects/calibrate/methods/example/target_views.h"
#include "projects/calibrate/session/guide.h"
#include "projects/measure/measure.h"
#include "tests/projects/door_project.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A simulated cell whose sensor is calibrated a little wrong, saved as a project.
class Live : public testing::Test {
  protected:
    fs::path folder = fs::temp_directory_path() / ("seamwright_live_" + std::to_string(::getpid()));
    fs::path path = folder / "door.seam";
    std::shared_ptr<SimulatedCell> cell;
    Pose truth = Pose::Identity();

    void SetUp() override {
        fs::remove_all(folder);
        fs::create_directories(folder);
        const nlohmann::json settings = cell_settings(Pose::Identity());
        cell = SimulatedCell::open(settings).value();
        truth = cell->flange_from_sensor();
        Project project = door_project(*cell, settings);
        project.calibrations[0].flange_from_sensor =
            truth * make_pose(rotation_exp({0.01, -0.01, 0.01}), {0.5, 0.4, -0.6});
        auto file = ProjectFile::create(path, project);
        ASSERT_TRUE(file) << file.error().sentence();
    }
    void TearDown() override { fs::remove_all(folder); }
    Station connected() const {
        auto station = Station::open(path).value();
        if (auto ok = station.connect(); !ok) ADD_FAILURE() << ok.error().sentence();
        return station;
    }
    static LiveCalibrationOptions options() {
        LiveCalibrationOptions o;
        o.sensor_id = "A";
        o.settings = {{"radius", 25}};
        o.use = true;
        return o;
    }
};

TEST_F(Live, ASimulatedRobotIsSentFromPoseToPoseAndTheAnswerIsUsed) {
    Station station = connected();
    const auto scene_before = station.sensor("A")->get("scene");
    const auto live = calibrate_live(station, *find_method("tcp-sphere"), options());
    ASSERT_TRUE(live) << live.error().sentence();
    EXPECT_TRUE(serves(live->solution.verdict())) << live->solution.report.judgement.reason.english();
    EXPECT_EQ(live->captures, find_method("tcp-sphere")->advised);
    EXPECT_TRUE(live->verification.confirmed);
    EXPECT_EQ(*station.sensor("A")->get("scene"), *scene_before) << "the cell is left as it was";
    // In the file, in use, and right within what it states.
    const Project stored = ProjectFile::open(path).value().load().value();
    const Calibration* used = calibration_of(stored, "A");
    ASSERT_TRUE(used);
    EXPECT_EQ(used->id, live->stored.at(0));
    EXPECT_EQ(used->method, "tcp-sphere");
    const Eigen::Vector3d off = used->flange_from_sensor.translation() - truth.translation();
    for (int i = 0; i < 3; ++i)
        EXPECT_LT(std::abs(off[i]), 4 * std::sqrt(used->covariance(i, i)) + 0.01) << i;
}

TEST_F(Live, WhatWasCapturedIsResumed) {
    std::stop_source stop;
    LiveCalibrationOptions o = options();
    o.cancel = stop.get_token();
    int taken = 0;
    o.said = [&](const Text&) {
        if (++taken == 4) stop.request_stop();
    };
    {
        Station station = connected();
        const auto cut = calibrate_live(station, *find_method("tcp-sphere"), o);
        ASSERT_FALSE(cut);
        EXPECT_THAT(cut.error().sentence(), HasSubstr("cancelled"));
    }
    Station station = connected();
    taken = 0;
    o = options();
    o.said = [&](const Text&) { ++taken; };
    const auto live = calibrate_live(station, *find_method("tcp-sphere"), o);
    ASSERT_TRUE(live) << live.error().sentence();
    EXPECT_EQ(taken, find_method("tcp-sphere")->advised + 1 - 4);
}

// A robot that somebody else moves: captured where it stands still, nothing on the way, nothing twice.
TEST_F(Live, ARobotThatIsJoggedIsWaitedFor) {
    Project project = ProjectFile::open(path).value().load().value();
    project.robots[0].driver = "kuka_eki";  // any that this program cannot move
    DeviceSession session;
    std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
    std::map<std::string, std::unique_ptr<RobotLink>> robots;
    sensors["A"] = open_sensor("simulated", project.sensors[0].settings, session).value();
    robots["R1"] = open_robot("simulated", project.sensors[0].settings, session).value();
    RobotLink* pendant = robots["R1"].get();
    const CalibrationMethod& sphere = *find_method("tcp-sphere");
    const Pose start = simulated_start(sphere, project.sensors[0].settings)->base_from_flange;
    ASSERT_TRUE(pendant->move_to(start));
    Station station(ProjectFile::open(path).value(), project);
    station.connect(std::move(sensors), std::move(robots));
    std::atomic<int> taken{0};
    LiveCalibrationOptions o = options();
    o.captures = 6;
    o.verification = 0;
    o.use = false;
    o.said = [&](const Text& text) {
        if (text.english().find("is taken") != std::string::npos) ++taken;
    };
    const Pose base_from_target = start * truth * target_from_sensor(sphere_views()[0]).inverse();
    std::jthread hand([&](const std::stop_token& stop) {
        for (int view = 1; view < 6 && !stop.stop_requested();) {
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            if (taken.load() < view) continue;
            const Pose to = base_from_target *
                            target_from_sensor(sphere_views()[static_cast<std::size_t>(view)]) *
                            truth.inverse();
            EXPECT_TRUE(pendant->move_to(to));
            ++view;
        }
    });
    const auto live = calibrate_live(station, sphere, o);
    ASSERT_TRUE(live) << live.error().sentence();
    EXPECT_EQ(live->captures, 6);
    EXPECT_TRUE(live->stored.empty()) << "no pose was kept back to verify with";

    o.captures = 7;  // nobody moves it any more
    o.patience = std::chrono::milliseconds(900);
    const auto waited = calibrate_live(station, sphere, o);
    ASSERT_FALSE(waited);
    EXPECT_THAT(waited.error().sentence(), HasSubstr("has not come to rest"));
}

TEST_F(Live, RefusesWhatItCannotDo) {
    Station station = connected();
    const auto said = [&](const char* method, const LiveCalibrationOptions& o) {
        const auto live = calibrate_live(station, *find_method(method), o);
        EXPECT_FALSE(live);
        return live ? std::string() : live.error().sentence();
    };
    EXPECT_THAT(said("stereo", options()), HasSubstr("from a file"));
    LiveCalibrationOptions o = options();
    o.sensor_id = "Z";
    EXPECT_THAT(said("tcp-sphere", o), HasSubstr("\"Z\""));
    o = options();
    o.robot_id = "R9";
    EXPECT_THAT(said("tcp-sphere", o), HasSubstr("R9"));
    o = options();
    o.settings = {{"radius", -3}};
    EXPECT_THAT(said("tcp-sphere", o), HasSubstr("radius"));
    o = options();
    o.settings.clear();
    EXPECT_THAT(said("static", o), HasSubstr("where the plate stands is not known"));
    station.disconnect();
    EXPECT_THAT(said("tcp-sphere", options()), HasSubstr("not connected"));
}

}  // namespace
}  // namespace seamwright
