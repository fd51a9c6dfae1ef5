// Servoing on the simulated gripper, whose truth the test can look into: the sensitivity is what the places' geometry
// says, the panel comes to where the body wants it, and whatever fails leaves the frame as it was.

#include "projects/panel/panel_servo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stop_token>

#include "devices/simulated/gripper_cell.h"
#include "projects/panel/panel_measure.h"
#include "projects/panel/panel_profiles.h"
#include "projects/panel/panel_sensitivity.h"
#include "projects/proof/replay.h"
#include "projects/reuse/exchange.h"
#include "projects/reuse/simulated_truth.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

struct ServoBench {
    TemporaryFolder folder;
    Project project =
        simulated_panel_project(
            {{"seed", 4}, {"robot", {{"repeatability_mm", 0.005}, {"repeatability_deg", 0.0002}}}})
            .value();
    std::shared_ptr<GripperCell> cell = GripperCell::open(project.robots[0].settings).value();
    Station station;

    ServoBench() : station(ProjectFile::create(folder / "panel.seam", project).value(), project) {
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        for (const SensorSetup& s : project.sensors) sensors[s.id] = make_gripper_sensor(cell, s.id);
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        robots["R1"] = make_gripper_robot(cell);
        station.connect(std::move(sensors), std::move(robots));
        TeachOptions options;
        options.repeats = 3;
        keep(teach_panel(station, project.panel_jobs[0], options).value());
    }
    void keep(const PanelJob& job) {
        project = station.project();
        project.panel_jobs[0] = job;
        ASSERT_TRUE(station.edit(project));
    }
    void displace() {
        PartState panel, body;
        panel.workobject_from_movedworkobject =
            make_pose(rotation_exp({0.001, -0.0008, 0.0015}), {0.6, -0.5, 1});
        body.workobject_from_movedworkobject =
            make_pose(rotation_exp({-0.0008, 0.0005, -0.001}), {-0.4, 0.3, 2});
        cell->set_parts(panel, body);
    }
    RunOptions pushing() const {
        RunOptions options;
        options.part_id = "car";
        options.push = true;
        return options;
    }
    Pose frame() const { return cell->read_frame("panel").value(); }
    double off_mm() const {
        const Pose relation = cell->relation(*cell->true_flange());
        double worst = 0;
        for (const GripperPlace& place : default_gripper_places()) {
            const Eigen::Vector3d p = place.gripper_from_place.translation();
            const Eigen::Vector3d off = place.gripper_from_place.linear().transpose() * (relation * p - p);
            worst = std::max({worst, std::abs(off.x()), std::abs(off.z())});
        }
        return worst;
    }
};

TEST(PanelServo, LearnsWhatTheGeometrySaysServesAndIsReplayed) {
    ServoBench bench;
    const Pose before = bench.frame();
    const auto learnt = learn_panel(bench.station, "panel", device_servoing(), {});
    ASSERT_TRUE(learnt) << learnt.error().sentence();
    ASSERT_TRUE(learnt->usable);
    EXPECT_LT(distance_mm(bench.frame(), before), 1e-6) << "the frame is as it was";
    EXPECT_EQ(learnt->run.panel->push.release, Release::withdrawn);
    const PanelSensitivity& s = *learnt->job.sensitivity;
    ASSERT_EQ(s.rows.size(), 2 * s.places.size());
    ASSERT_EQ(s.places.size(), default_gripper_places().size());
    // The panel goes with the gripper, the body stays: the gap closes by the motion along the place's x, from panel to
    // body, and the panel stands proud by that along its z.
    for (const GripperPlace& place : default_gripper_places()) {
        const auto at = static_cast<std::size_t>(std::find(s.places.begin(), s.places.end(), place.id) -
                                                 s.places.begin());
        ASSERT_LT(at, s.places.size());
        const Eigen::Matrix3d axes = place.gripper_from_place.linear();
        const Eigen::Vector3d p = place.gripper_from_place.translation();
        for (int k = 0; k < 6; ++k) {
            const Eigen::Vector3d motion = k < 3 ? Eigen::Vector3d(Eigen::Vector3d::Unit(k))
                                                 : Eigen::Vector3d(Eigen::Vector3d::Unit(k - 3).cross(p));
            const double tolerance = k < 3 ? 0.08 : 0.08 * 500;
            EXPECT_NEAR(s.rows[2 * at][static_cast<std::size_t>(k)], -axes.col(0).dot(motion), tolerance)
                << place.id << " gap " << k;
            EXPECT_NEAR(s.rows[2 * at + 1][static_cast<std::size_t>(k)], axes.col(2).dot(motion), tolerance)
                << place.id << " flush " << k;
        }
    }
    bench.keep(learnt->job);

    bench.displace();
    RunOptions dry;
    const auto foreseen = servo_panel(bench.station, "panel", device_servoing(), dry);
    ASSERT_TRUE(foreseen) << foreseen.error().sentence();
    EXPECT_EQ(foreseen->status, RunStatus::ok) << foreseen->message;
    EXPECT_TRUE(foreseen->panel->after.empty());
    EXPECT_LT(distance_mm(bench.frame(), before), 1e-6);

    const auto run = servo_panel(bench.station, "panel", device_servoing(), bench.pushing());
    ASSERT_TRUE(run) << run.error().sentence();
    EXPECT_EQ(run->status, RunStatus::ok) << run->message;
    const PanelServo& servo = *run->panel->servo;
    EXPECT_TRUE(servo.status == ServoingStatus::reached || servo.status == ServoingStatus::settled);
    EXPECT_GE(servo.moves.size(), 3u);
    EXPECT_LT(servo.moves.back().rms_mm, 0.2 * servo.moves.front().rms_mm);
    EXPECT_LT(bench.off_mm(), 0.3) << "the truth";
    const ServoComparison beside = compare_servo(*run->panel);
    EXPECT_EQ(beside.moves, static_cast<int>(servo.moves.size()) - 1);
    EXPECT_EQ(beside.after_rms_mm, servo.moves.back().rms_mm);
    EXPECT_LT(beside.single_rms_mm, 0.2)
        << "nothing is deformed, and the single step would leave noise alone";
    // The single step from the same measurement leads to the same place.
    EXPECT_LT(distance_mm(servo.motion, run->panel->fit->gripper_motion), 0.3);
    EXPECT_LT(deg_from_rad(angle_rad(servo.motion, run->panel->fit->gripper_motion)), 0.05);
    EXPECT_EQ(run->panel->push.release, Release::taken);
    EXPECT_LT(distance_mm(bench.frame(), run->panel->base_from_frame), 1e-3);

    // Every sensor's profiles as files, for `double-head` and whoever looks closer.
    const auto files =
        export_profiles(bench.station.file(), run->number, ProfileFormat::csv, bench.folder / "p");
    ASSERT_TRUE(files) << files.error().sentence();
    EXPECT_EQ(files->size(), 2 * 2 * bench.project.sensors.size()) << "profile and pose, before and after";
    EXPECT_TRUE(std::filesystem::exists(bench.folder / "p" / (bench.project.sensors[1].id + "_after.csv")));

    // Stored, read back and computed again to the last bit.
    const auto stored = bench.station.file().load_run(run->number);
    ASSERT_TRUE(stored);
    EXPECT_EQ(stored->panel->servo->moves.size(), servo.moves.size());
    const auto replayed = replay(bench.folder / "panel.seam", {});
    ASSERT_TRUE(replayed) << replayed.error().sentence();
    for (const auto& d : replayed->differences) ADD_FAILURE() << d.what.english() << d.text.english();
}

// What is computed follows from where the places stand, which the simulation knows; what is learnt agrees, until somebody
// turns a sensor.
TEST(PanelServo, TheComputedSensitivityIsTheGeometrysAndFindsASensorThatWasTurned) {
    ServoBench bench;
    const auto rows = computed_sensitivity(bench.project, bench.project.panel_jobs[0]);
    ASSERT_TRUE(rows) << rows.error().sentence();
    const auto places = default_gripper_places();
    ASSERT_EQ(rows->size(), 2 * places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        const Eigen::Matrix3d axes = places[i].gripper_from_place.linear();
        const Eigen::Vector3d p = places[i].gripper_from_place.translation();
        for (int k = 0; k < 6; ++k) {
            const Eigen::Vector3d motion = k < 3 ? Eigen::Vector3d(Eigen::Vector3d::Unit(k))
                                                 : Eigen::Vector3d(Eigen::Vector3d::Unit(k - 3).cross(p));
            // The surface lies level within half a degree as measured; its edge within a few mm of the place.
            const double tolerance = k < 3 ? 0.01 : 6;
            EXPECT_NEAR((*rows)[2 * i][static_cast<std::size_t>(k)], -axes.col(0).dot(motion), tolerance);
            EXPECT_NEAR((*rows)[2 * i + 1][static_cast<std::size_t>(k)], axes.col(2).dot(motion), tolerance);
        }
    }
    EXPECT_FALSE(compare_sensitivity(bench.project, bench.project.panel_jobs[0])) << "nothing is learnt";
    const auto learnt = learn_panel(bench.station, "panel", device_servoing(), {});
    ASSERT_TRUE(learnt && learnt->usable);
    const auto beside = compare_sensitivity(bench.project, learnt->job);
    ASSERT_TRUE(beside) << beside.error().sentence();
    EXPECT_LT(beside->off_share, 0.1);

    Project turned = bench.project;
    for (Calibration& c : turned.calibrations)
        if (c.sensor_id == "H2") c.flange_from_sensor.linear() *= rotation_exp({0, 0, 1.5});
    const auto off = compare_sensitivity(turned, learnt->job);
    ASSERT_TRUE(off) << off.error().sentence();
    EXPECT_GT(off->off_share, kSensitivityShare);
    EXPECT_EQ(off->place, "P2");
}

TEST(PanelServo, TheHeadsProfilesLieOnOneAnotherInThePlacesFrame) {
    ServoBench bench;
    auto run = run_panel(bench.station, "panel", {});
    ASSERT_TRUE(run) << run.error().sentence();
    const auto stored = bench.station.file().load_run(run->number);
    ASSERT_TRUE(stored);
    const auto shown = with_profiles(bench.project, *stored);
    ASSERT_TRUE(shown) << shown.error().sentence();
    EXPECT_TRUE(shown->after.empty());
    ASSERT_EQ(shown->before.size(), default_gripper_places().size());
    for (const PlaceProfiles& p : shown->before) {
        EXPECT_EQ(p.heads.size(), p.place_id == "P1" || p.place_id == "P5" ? 2u : 1u) << p.place_id;
        EXPECT_GT(p.merged.size(), 100u) << p.place_id;
        // As taught, both sheets lie in the place's plane: whatever is more than a fold off the gap.
        for (const Profile& head : p.heads)
            for (std::size_t i = 0; i < head.size(); ++i)
                if (std::abs(head.x_mm[i]) > 8 && head.segment[i] != kOutlier) {
                    EXPECT_NEAR(head.z_mm[i], 0, 0.3) << p.place_id << " x " << head.x_mm[i];
                }
        EXPECT_NEAR(p.middle_mm.x(), 0, 0.3);
    }
}

TEST(PanelServo, AMoveThatTheGateRefusesTakesTheFirstFrameBack) {
    ServoBench bench;
    const auto learnt = learn_panel(bench.station, "panel", device_servoing(), {});
    ASSERT_TRUE(learnt && learnt->usable);
    PanelJob narrow = learnt->job;
    bench.displace();
    const Pose before = bench.frame();
    // Within the first move's reach, not within the whole way's.
    narrow.limits.translation_mm = 0.9 * 1.0;
    narrow.gap_tolerance_mm = narrow.flush_tolerance_mm = 5;
    bench.keep(narrow);
    const auto run = servo_panel(bench.station, "panel", device_servoing(), bench.pushing());
    ASSERT_TRUE(run) << run.error().sentence();
    EXPECT_EQ(run->status, RunStatus::refused) << run->message;
    EXPECT_FALSE(run->panel->refusals.empty());
    EXPECT_LT(distance_mm(bench.frame(), before), 1e-6);
}

TEST(PanelServo, ASensitivityOfTheWrongSignStopsWhenTheDeviationsGrow) {
    ServoBench bench;
    auto learnt = learn_panel(bench.station, "panel", device_servoing(), {});
    ASSERT_TRUE(learnt && learnt->usable);
    for (auto& row : learnt->job.sensitivity->rows)
        for (double& v : row) v = -v;
    bench.keep(learnt->job);
    bench.displace();
    const Pose before = bench.frame();
    const auto run = servo_panel(bench.station, "panel", device_servoing(), bench.pushing());
    ASSERT_TRUE(run) << run.error().sentence();
    EXPECT_EQ(run->status, RunStatus::refused);
    EXPECT_EQ(run->panel->servo->status, ServoingStatus::diverged);
    EXPECT_THAT(run->message.english(), HasSubstr("grow"));
    EXPECT_LT(distance_mm(bench.frame(), before), 1e-6) << "taken back";
}

// After the first move: the panel out of the sensors' sight, or a person who has seen enough.
TEST(PanelServo, ALostPlaceAndAPersonsWordTakeTheFirstFrameBack) {
    for (const bool lost : {true, false}) {
        ServoBench bench;
        const auto learnt = learn_panel(bench.station, "panel", device_servoing(), {});
        ASSERT_TRUE(learnt && learnt->usable);
        bench.keep(learnt->job);
        bench.displace();
        const Pose before = bench.frame();
        std::stop_source stop;
        RunOptions options = bench.pushing();
        options.cancel = stop.get_token();
        options.progress = [&](const RunProgress& p) {
            if (p.text.english().find("move 1") == std::string::npos) return;
            if (!lost) stop.request_stop();
            PartState gone;
            gone.workobject_from_movedworkobject.translation().z() = 200;
            if (lost) bench.cell->set_parts(gone, {});
        };
        const auto run = servo_panel(bench.station, "panel", device_servoing(), options);
        ASSERT_TRUE(run) << run.error().sentence();
        EXPECT_EQ(run->status, lost ? RunStatus::device : RunStatus::cancelled) << run->message.english();
        EXPECT_EQ(run->panel->servo->moves.size(), 2u) << "as it came, and the first move";
        EXPECT_EQ(run->panel->push.status, PushStatus::restored);
        EXPECT_EQ(run->panel->push.release, Release::withdrawn);
        EXPECT_LT(distance_mm(bench.frame(), before), 1e-6);
        EXPECT_THAT(run->message.english(), HasSubstr(lost ? "was not measured" : "cancelled"));
    }
}

TEST(PanelServo, RefusesWhatCannotBeInvertedOrWasNotLearnt) {
    ServoBench bench;
    const auto refused = [&](const char* part) {
        const auto run = servo_panel(bench.station, "panel", device_servoing(), bench.pushing());
        ASSERT_FALSE(run);
        EXPECT_THAT(run.error().sentence(), HasSubstr(part));
    };
    refused("not learnt");
    EXPECT_FALSE(servo_panel(bench.station, "nobody", device_servoing(), {}));
    ServoingOptions far = device_servoing();
    far.step_mm = 50;
    EXPECT_THAT(learn_panel(bench.station, "panel", far, {}).error().sentence(), HasSubstr("50 mm"));
    // Two places see four values: six motions cannot follow from them.
    PanelJob few = bench.project.panel_jobs[0];
    for (std::size_t i = 0; i < few.places.size(); ++i) few.places[i].enabled = i < 2;
    bench.keep(few);
    const auto learnt = learn_panel(bench.station, "panel", device_servoing(), {});
    ASSERT_TRUE(learnt) << learnt.error().sentence();
    EXPECT_FALSE(learnt->usable);
    EXPECT_FALSE(learnt->job.sensitivity);
    // Of other places, and of numbers that are none.
    PanelSensitivity& made = few.sensitivity.emplace();
    made.places = {"P1"};
    bench.keep(few);
    refused("other places");
    made.places = {few.places[0].id, few.places[1].id};
    made.rows.assign(4, {1, 0, 0, 0, 0, 0});
    made.step_mm = 0.5, made.step_deg = 0.05;
    bench.keep(few);
    refused("cannot be inverted");
}

}  // namespace
}  // namespace seamwright
