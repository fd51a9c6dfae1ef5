#pragma once
// A calibration session in a folder of its own, its sensor and robot simulated.

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "devices/simulated/cell.h"
#include "projects/calibrate/session/capture.h"
#include "projects/calibrate/session/guide.h"
#include "projects/reuse/simulated_truth.h"

namespace seamwright {

class Session : public testing::Test {
  protected:
    std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("seamwright_session_" + std::to_string(::getpid()));
    std::filesystem::path project = folder / "door.seam";
    void SetUp() override {
        std::filesystem::remove_all(folder);
        std::filesystem::create_directories(folder);
    }
    void TearDown() override { std::filesystem::remove_all(folder); }

    // A sphere seen by the simulated sensor; `bump_mm` moves the sphere.
    std::shared_ptr<SimulatedCell> cell = make(0);
    static std::shared_ptr<SimulatedCell> make(double bump_mm) {
        CellSettings settings = default_cell_settings();
        settings.scene = Scene::sphere;
        settings.base_from_target.translation().x() += bump_mm;
        return SimulatedCell::open(settings).value();
    }
    SensorSetup sensor() const {
        SensorSetup s;
        s.id = "A";
        s.driver = "simulated";
        return s;
    }
    Calibration truth() const {
        RobotSetup robot;
        robot.id = "R1";
        robot.driver = "simulated";
        Calibration c = simulated_truth(sensor(), robot).value();
        return c;
    }
    CalibrationSession open(const std::string& method = "tcp-sphere") const {
        auto s = CalibrationSession::open(project, MethodId(method), SensorId("A"), RobotId("R1"));
        EXPECT_TRUE(s) << s.error().sentence();
        return *s;
    }
    static CalibrationCapture shoot(SimulatedCell& where, const CalibrationSession& s,
                                    const Calibration& base, const Pose& at, std::uint64_t seed) {
        Frame frame;
        where.render(at, seed, frame);
        SensorSetup a;
        a.id = "A";
        auto taken = capture_shot(s.method(), s.state().settings, a, &base, frame, nullptr, at);
        EXPECT_TRUE(taken) << taken.error().sentence();
        return taken ? taken->capture : CalibrationCapture{};
    }
    // As a person is led: to the start, then to every proposed pose.
    void capture(CalibrationSession& s, int count, const std::function<bool(int)>& bad = {}) {
        Calibration base = truth();
        const auto bumped = make(4);
        for (int i = 0; i < count; ++i) {
            Pose at = simulated_start(s.method(), nlohmann::json::object())->base_from_flange;
            if (const auto next = next_pose(s, base.flange_from_sensor)) at = next->base_from_flange;
            auto& where = bad && bad(i) ? *bumped : *cell;
            ASSERT_TRUE(s.add(shoot(where, s, base, at, static_cast<std::uint64_t>(100 + i))));
        }
    }
    void solve(CalibrationSession& s) const {
        const SessionState of = s.state();
        auto outcome = s.solve();
        ASSERT_TRUE(outcome) << outcome.error().sentence();
        ASSERT_TRUE(s.take(*outcome, of));
    }
};

}  // namespace seamwright
