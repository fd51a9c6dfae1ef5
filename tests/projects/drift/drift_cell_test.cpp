// The whole way on the simulated cell, rendered pictures and all: parts called one by one, a warm-up that begins after the
// learning, and a knock. Simulated: robot 0.01 mm and 0.001 degrees, jitter 0.2 mm at 100 mm/s, 640 x 512 pixels, seed 5.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/capture/capture.h"
#include "devices/exchange/pose_json.h"
#include "devices/host_time.h"
#include "devices/simulated/cell.h"
#include "devices/simulated/scene/door.h"
#include "projects/drift/drift_edits.h"
#include "projects/reuse/simulated_truth.h"
#include "projects/station/watch.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

constexpr int kLearnt = 40, kDriftFrom = 60, kBump = 100;

class DriftingCell : public testing::Test {
  protected:
    void SetUp() override {
        const nlohmann::json frame = pose_json(default_cell_settings().base_from_workobject);
        const auto shift = [](double x, double z) {
            return pose_json(make_pose(Eigen::Matrix3d::Identity(), {x, 0, z}));
        };
        auto opened = SimulatedCell::open({{"seed", 5},
                                           {"optics", {{"width", 640}, {"height", 512}}},
                                           {"drift",
                                            {{"sensor", shift(0.5, -0.4)},
                                             {"time_constant_parts", 15},
                                             {"from_part", kDriftFrom + 1},
                                             {"bump", shift(-0.9, 0.9)},
                                             {"bump_at_part", kBump + 1}}},
                                           {"robot",
                                            {{"repeatability_mm", 0.01},
                                             {"repeatability_deg", 0.001},
                                             {"trigger_jitter_mm", 0.2},
                                             {"frames", {{"path", frame}}}}}});
        ASSERT_TRUE(opened) << opened.error().sentence();
        cell = *opened;
        constexpr double kSigma_mm = 0.1;
        Project p = simulated_door_project(*cell, "all", kSigma_mm);
        p.name = "drifting door";
        p.calibrations.front().sensor_identity = make_simulated_sensor(cell)->identity();
        p.calibrations.front().robot_identity = *make_simulated_robot(cell)->identity();
        Spot w = p.spots.front();  // the part stands still: its first edge is as good as a bracket
        w.id = "W1";
        p.spots.push_back(w);
        ASSERT_TRUE(set_drift_watch(p, {.spot_ids = {"W1"}}));
        auto file = ProjectFile::create(folder / "cell.seam", p, true);
        ASSERT_TRUE(file) << file.error().sentence();
        station.emplace(std::move(*file), p);
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        sensors["A"] = make_simulated_sensor(cell);
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        robots["R1"] = make_simulated_robot(cell);
        station->connect(std::move(sensors), std::move(robots));
        const auto taught = station->run({});
        ASSERT_TRUE(taught) << taught.error().sentence();
        p = station->project();
        for (std::size_t i = 0; i < p.spots.size(); ++i) {
            ASSERT_EQ(taught->spots[i].status, SpotStatus::measured) << taught->spots[i].message.english();
            p.spots[i].reference_mm = taught->spots[i].measured_mm;
        }
        ASSERT_TRUE(station->edit(p));
        options.push = true;
        options.line.starts = true;
        options.line.call = [this] {
            return std::optional(StartSignal{"P" + std::to_string(cell->parts()), host_now_ns()});
        };
        options.tell = [this](const WatchEvent& e) {
            if (const auto* done = std::get_if<watched::RunDone>(&e.happening)) seen(e, *done);
        };
    }
    void seen(const WatchEvent& e, const watched::RunDone& done) {
        const auto parts = static_cast<int>(cell->parts());
        if (done.drift.change == DriftChange::drift && named_at == 0) named_at = parts;
        if (done.drift.stopped && stopped_at == 0) {
            stopped_at = parts;
            alarm = e.level == WatchLevel::alarm;
            said = e.text.english();
        }
        if (done.drift.stopped && done.record->status == RunStatus::ok) ++pushed_after;
        const auto& c = done.record->regions.front().correction;
        if (c && parts > 90 && parts <= kBump) {
            off_mm += c->displacement.workobject_from_movedworkobject.translation().norm() / 10;
            compensated += done.record->regions.front().drift->compensated;
        }
    }
    void until(int part) {
        options.parts = part - static_cast<int>(cell->parts());
        const auto counts = watch(*station, options);
        ASSERT_TRUE(counts) << counts.error().sentence();
    }
    void learn() {
        until(kLearnt);
        Project p = station->project();
        const auto learnt = learn_drift_watch(p, *station->file().drift_points(), 0, utc_now());
        ASSERT_TRUE(learnt) << learnt.error().sentence();
        ASSERT_TRUE(station->edit(p));
    }

    TemporaryFolder folder;
    std::shared_ptr<SimulatedCell> cell;
    std::optional<Station> station;
    WatchOptions options;
    int named_at = 0, stopped_at = 0, pushed_after = 0, compensated = 0;
    bool alarm = false;
    std::string said;
    double off_mm = 0;
};

TEST_F(DriftingCell, TheDriftIsNamedWithin20PartsAndTheBumpStopsAtOnce) {
    learn();
    until(kBump + 5);
    EXPECT_GT(named_at, kDriftFrom);
    EXPECT_LE(named_at, kDriftFrom + 20);
    EXPECT_EQ(stopped_at, kBump + 1) << said;
    EXPECT_TRUE(alarm);
    EXPECT_THAT(said, HasSubstr("the drift watch stopped production"));
    EXPECT_EQ(pushed_after, 0);
    EXPECT_EQ(compensated, 0);
    // A drift shared by all spots of a sensor is told from a displacement in part.
    EXPECT_GT(off_mm, 0.1) << "what the drift does to a correction that nobody compensates";
    RecordProperty("named_after_parts", named_at - kDriftFrom);
    RecordProperty("uncompensated_um", static_cast<int>(1000 * off_mm));

    cell->mend_bump();
    until(kBump + 7);
    EXPECT_EQ(pushed_after, 0) << "nobody has looked yet";
    Project p = station->project();
    ASSERT_TRUE(acknowledge_step(p, *station->file().drift_points(), "Ada", "bracket tightened", utc_now()));
    ASSERT_TRUE(station->edit(p));
    until(kBump + 9);
    EXPECT_FALSE(station->drift().stopped) << station->drift().text.english();
    EXPECT_EQ(station->file().runs()->back().status, RunStatus::ok);
}

TEST_F(DriftingCell, WhatIsCompensatedIsNoLongerInTheCorrection) {
    learn();
    Project p = station->project();
    ASSERT_TRUE(switch_compensation(p, *station->file().drift_points(), true, DriftOf::sensor, 1, utc_now()));
    ASSERT_TRUE(station->edit(p));
    until(kBump + 2);
    EXPECT_LE(named_at, kDriftFrom + 20);
    EXPECT_EQ(stopped_at, kBump + 1) << "a step is never compensated: " << said;
    EXPECT_EQ(pushed_after, 0);
    EXPECT_EQ(compensated, 10);
    EXPECT_LT(off_mm, 0.18) << "0.22 mm without";
    RecordProperty("compensated_um", static_cast<int>(1000 * off_mm));
    EXPECT_FALSE(
        station->file().load_run(station->file().runs()->back().number)->regions.front().drift->compensated);
}

}  // namespace
}  // namespace seamwright
