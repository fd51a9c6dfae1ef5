// Online correction end to end: spots, gate, push, and the running path, with simulated controllers in their real
// cycle over UDP. What is judged is what the controller had in force, cycle by cycle in its own count.

#include "projects/ahead/follow.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>

#include "cut_sensor.h"
#include "lossy_wire.h"
#include "projects/ahead/simulated_seam.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

PartState displaced(double bend_mm) {
    PartState part;
    part.bend = {bend_mm, bend_mm / 4};
    const Eigen::Vector3d middle(500, 375, 0);
    const Eigen::Matrix3d turn = rotation_exp({0, 0, 0.003});
    part.workobject_from_movedworkobject =
        make_pose(turn, middle - turn * middle + Eigen::Vector3d(1.2, -0.8, 0.9));
    return part;
}

// Of this test alone.
std::filesystem::path file_named(const std::string& name) {
    return std::filesystem::path(testing::TempDir()) / (std::to_string(::getpid()) + name);
}

struct Seam {
    ~Seam() {
        cell.reset();
        for (const char* ending : {"", "-wal", "-shm"})
            std::filesystem::remove(file_named("seam.seam") += ending);
    }
    std::shared_ptr<SensorFaults> faults = std::make_shared<SensorFaults>();
    std::unique_ptr<SimulatedSeam> cell;
    FollowOptions follow;
};

std::unique_ptr<Seam> seam_of(SimulatedSeamOptions options) {
    auto seam = std::make_unique<Seam>();
    options.length_mm = 160;
    // A machine that is busy elsewhere answers late more often than a plant's.
    options.link = {{"max_late", 1000}};
    options.controller = {{"late_limit", 500}};
    options.sensor = [faults = seam->faults](const std::shared_ptr<SimulatedCell>& cell) {
        return std::make_unique<CutSensor>(cell, faults);
    };
    auto made = SimulatedSeam::make(options, file_named("seam.seam"));
    EXPECT_TRUE(made) << made.error().sentence();
    if (!made) return nullptr;
    seam->cell = std::move(*made);
    seam->follow = seam->cell->follow();
    // A machine that pauses for a second loses no contour; the sensor is 60 mm ahead.
    seam->follow.line.most_gap_mm = 40;
    seam->follow.frame_timeout = std::chrono::milliseconds(30000);
    return seam;
}

// The correction in force never changes by more than a cycle allows, whatever happens. RSI_OFF is not ours: there the
// robot stands, at the end of its path or stopped, and its program ends the correction.
void expect_no_step(const SimulatedSeam& seam, double speed_mm_s, double cycle_s) {
    const auto history = seam.history();
    double largest = 0;
    for (std::size_t i = 1; i < history.size(); ++i) {
        const double moved = distance_mm(history[i].programmed, history[i - 1].programmed);
        const Eigen::Vector3d now = history[i].corrected.translation() - history[i].programmed.translation();
        const Eigen::Vector3d before =
            history[i - 1].corrected.translation() - history[i - 1].programmed.translation();
        const bool begins_anew = moved > 20, off = moved < 1e-3 && now.isZero(1e-12);
        if (!begins_anew && !off) largest = std::max(largest, (now - before).norm());
    }
    EXPECT_LE(largest, speed_mm_s * cycle_s * 1.001);
    EXPECT_GT(largest, 0) << "there was a correction at all";
}

// What was added to the frame shrank from cycle to cycle, until the program ended it with the stopped path.
void expect_ramp_out(const SimulatedSeam& seam, const Pose& base_from_moved) {
    std::vector<double> added;
    for (const SeamSample& s : seam.history())
        if (distance_mm(s.corrected, s.programmed) > 1e-9)
            added.push_back(
                (s.corrected.translation() - base_from_moved * s.programmed.translation()).norm());
    ASSERT_GT(added.size(), 20u);
    // Of two in a row one may be the same: an answer was late.
    for (std::size_t i = added.size() - 5; i < added.size(); ++i) EXPECT_LE(added[i], added[i - 1] + 1e-9);
    EXPECT_LT(added.back(), added[added.size() - 20] - 0.02);
}

bool has_event(const RunRecord& run, EventKind kind, const std::string& words) {
    return std::any_of(run.events.begin(), run.events.end(), [&](const EventRecord& e) {
        return e.kind == kind && e.text.english().find(words) != std::string::npos;
    });
}

struct Robot {
    const char* driver;
    int cycle_ms;
    double speed_mm_s;  // of the correction, at most
};
void PrintTo(const Robot& r, std::ostream* out) {
    *out << r.driver << " every " << r.cycle_ms << " ms";
}

class Follow : public testing::TestWithParam<Robot> {};

TEST_P(Follow, ABendThatTheFrameCannotFollowIsFollowed) {
    SimulatedSeamOptions options;
    options.driver = GetParam().driver;
    options.cycle_ms = GetParam().cycle_ms;
    const auto seam = seam_of(options);
    ASSERT_TRUE(seam);
    seam->cell->cell().set_part(displaced(3));
    const auto followed = follow_run(seam->cell->station(), {}, seam->follow);
    ASSERT_TRUE(followed) << followed.error().sentence();
    ASSERT_EQ(followed->run.status, RunStatus::ok) << followed->run.message.english();
    const SeamErrors e = judge_seam(*seam->cell, followed->base_from_moved);
    const SteeringFigures& f = followed->figures;
    RecordProperty("without_worst_mm", std::to_string(e.without.worst_mm));
    RecordProperty("frame_worst_mm", std::to_string(e.frame.worst_mm));
    RecordProperty("online_worst_mm", std::to_string(e.online.worst_mm));
    std::printf("%s: worst without %.3f, frame %.3f, online %.3f mm (mean %.3f, 3 sigma %.3f), %d features\n",
                GetParam().driver, e.without.worst_mm, e.frame.worst_mm, e.online.worst_mm,
                e.online.error.mean, e.online.error.three_sigma, static_cast<int>(f.stored));
    EXPECT_GT(e.travelled_mm, 120);
    EXPECT_GT(e.without.worst_mm, 1);
    EXPECT_GT(e.frame.worst_mm, 0.25);
    EXPECT_LT(e.online.worst_mm, 0.12);
    EXPECT_LT(e.online.worst_mm, 0.4 * e.frame.worst_mm);
    EXPECT_GT(f.stored, 10u);
    EXPECT_GT(f.largest_mm, 0.2);
    EXPECT_FALSE(f.alarm);
    EXPECT_EQ(seam->cell->stops(), 0u);
    expect_no_step(*seam->cell, GetParam().speed_mm_s, 1e-3 * GetParam().cycle_ms);
    EXPECT_TRUE(has_event(followed->run, EventKind::note, "online correction by"));
    const auto stored = seam->cell->station().file().load_run(followed->run.number, false);
    ASSERT_TRUE(stored);
    EXPECT_TRUE(has_event(*stored, EventKind::note, "online correction by")) << "in the file";
}
INSTANTIATE_TEST_SUITE_P(Robots, Follow,
                         testing::Values(Robot{"kuka-rsi", 4, 20}, Robot{"kuka-rsi", 12, 20},
                                         Robot{"abb-egm", 4, 40}));

TEST(Follow, APartThatLiesAsTaughtIsLeftAlone) {
    const auto seam = seam_of({});
    ASSERT_TRUE(seam);
    const auto followed = follow_run(seam->cell->station(), {}, seam->follow);
    ASSERT_TRUE(followed) << followed.error().sentence();
    ASSERT_EQ(followed->run.status, RunStatus::ok) << followed->run.message.english();
    const SeamErrors e = judge_seam(*seam->cell, followed->base_from_moved);
    EXPECT_LT(e.online.worst_mm, 0.06);
    EXPECT_LT(followed->figures.largest_mm, 0.15);
}

// The path stops, everything is led back to zero, the run says why, and the frames are as before.
void expect_led_back(Seam& seam, const Expected<FollowedRun>& followed, const std::string& why) {
    ASSERT_TRUE(followed) << followed.error().sentence();
    EXPECT_EQ(followed->run.status, RunStatus::alarm);
    EXPECT_THAT(followed->run.message.english(), HasSubstr(why));
    EXPECT_TRUE(has_event(followed->run, EventKind::alarm, why));
    EXPECT_EQ(followed->run.regions[0].push.status, PushStatus::restored);
    EXPECT_EQ(followed->run.regions[0].push.release, Release::withdrawn);
    const auto stored = seam.cell->station().file().load_run(followed->run.number, false);
    ASSERT_TRUE(stored);
    EXPECT_EQ(stored->status, RunStatus::alarm);
    EXPECT_LT(judge_seam(*seam.cell, followed->base_from_moved).travelled_mm, 155)
        << "stopped before its end";
    const auto link = dynamic_cast<SteeredLink*>(seam.cell->station().robot("R1"));
    ASSERT_TRUE(link);
    EXPECT_EQ(link->path_phase(), PathPhase::none);
    const auto history = seam.cell->history();
    EXPECT_LT(distance_mm(history.back().corrected, history.back().programmed), 1e-9);
}

TEST(Follow, AKilledSensorLeadsTheCorrectionBack) {
    const auto seam = seam_of({});
    ASSERT_TRUE(seam);
    seam->cell->cell().set_part(displaced(3));
    seam->faults->silent_after = 12;
    const auto followed = follow_run(seam->cell->station(), {}, seam->follow);
    expect_led_back(*seam, followed, "the sensor has found no contour for");
    expect_no_step(*seam->cell, 20, 0.004);
    expect_ramp_out(*seam->cell, followed->base_from_moved);
}

TEST(Follow, ASensorThatSeesNoContourLeadsTheCorrectionBack) {
    SimulatedSeamOptions options;
    options.driver = "abb-egm";
    const auto seam = seam_of(options);
    ASSERT_TRUE(seam);
    seam->cell->cell().set_part(displaced(3));
    seam->faults->blind_after = 12;
    const auto followed = follow_run(seam->cell->station(), {}, seam->follow);
    ASSERT_TRUE(followed) << followed.error().sentence();
    EXPECT_EQ(followed->run.status, RunStatus::alarm);
    EXPECT_THAT(followed->run.message.english(), HasSubstr("the sensor has found no contour for"));
    EXPECT_GT(followed->figures.not_found, 0u);
    // EGM knows no release: the robot is not answered, keeps what it has until it stands, and leads it out itself.
    for (int i = 0; i < 2000 && seam->cell->stops() == 0; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_EQ(seam->cell->stops(), 1u);
    expect_no_step(*seam->cell, 40, 0.004);
}

TEST(Follow, APartThatMovedBeyondTheBoundAfterItWasMeasuredIsNotFollowed) {
    const auto seam = seam_of({});
    ASSERT_TRUE(seam);
    RunOptions run;
    run.confirm_push = [&](const RunRecord&) {
        PartState part;
        part.workobject_from_movedworkobject.translation() = Eigen::Vector3d(0, 4, 0);
        seam->cell->cell().set_part(part);
        return true;
    };
    const auto followed = follow_run(seam->cell->station(), run, seam->follow);
    expect_led_back(*seam, followed, "beyond the limit of 3.00 mm");
    EXPECT_EQ(followed->figures.largest_mm, 0) << "none of it was told";
}

TEST(Follow, StrayFeaturesAreNoContour) {
    const auto seam = seam_of({});
    ASSERT_TRUE(seam);
    seam->cell->cell().set_part(displaced(3));
    seam->faults->stray_every = 4;
    const auto followed = follow_run(seam->cell->station(), {}, seam->follow);
    ASSERT_TRUE(followed) << followed.error().sentence();
    ASSERT_EQ(followed->run.status, RunStatus::ok) << followed->run.message.english();
    EXPECT_GT(followed->figures.implausible, 0u);
    EXPECT_LT(judge_seam(*seam->cell, followed->base_from_moved).online.worst_mm, 0.15);
}

TEST(Follow, LostAndLatePacketsMakeNoStep) {
    for (const char* driver : {"kuka-rsi", "abb-egm"}) {
        std::unique_ptr<LossyWire> wire;
        SimulatedSeamOptions options;
        options.driver = driver;
        options.wire = [&](std::uint16_t port) {
            wire = std::make_unique<LossyWire>(port, 97, 71, 53, 6);
            return wire->port();
        };
        const auto seam = seam_of(options);
        ASSERT_TRUE(seam);
        seam->cell->cell().set_part(displaced(3));
        const auto followed = follow_run(seam->cell->station(), {}, seam->follow);
        ASSERT_TRUE(followed) << followed.error().sentence();
        EXPECT_EQ(followed->run.status, RunStatus::ok) << driver << followed->run.message.english();
        EXPECT_GT(wire->lost, 20);
        EXPECT_LT(judge_seam(*seam->cell, followed->base_from_moved).online.worst_mm, 0.2) << driver;
        expect_no_step(*seam->cell, std::string(driver) == "kuka-rsi" ? 20 : 40, 0.004);
        seam->cell.reset();
    }
}

TEST(Follow, RefusesBeforeAnythingMoves) {
    const auto seam = seam_of({});
    ASSERT_TRUE(seam);
    Station& station = seam->cell->station();
    const auto refusal = [&](auto change) {
        FollowOptions options = seam->follow;
        change(options);
        const auto runs = station.file().runs()->size();
        const auto refused = follow_run(station, {}, options);
        EXPECT_FALSE(refused);
        EXPECT_EQ(station.file().runs()->size(), runs);
        return refused ? std::string() : refused.error().sentence();
    };
    EXPECT_THAT(refusal([](FollowOptions& o) { o.region_id = "other"; }), HasSubstr("no region \"other\""));
    EXPECT_THAT(refusal([](FollowOptions& o) { o.spot_id = "S99"; }), HasSubstr("no spot \"S99\""));
    EXPECT_THAT(
        refusal([](FollowOptions& o) { o.guide_csv = "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n1,2,3,0,0,0\n"; }),
        HasSubstr("a guide needs two points"));
    EXPECT_THAT(refusal([](FollowOptions& o) { o.limit_mm = 0; }), HasSubstr("is none"));
    EXPECT_THAT(refusal([](FollowOptions& o) { o.limit_mm = 26; }), HasSubstr("is none"));
    EXPECT_THAT(refusal([](FollowOptions& o) { o.latency_ms = 1e9; }), HasSubstr("not plausible"));
    // Nobody has measured when a profile is taken.
    Project project = station.project();
    project.calibrations[0].method = "tcp-sphere";
    ASSERT_TRUE(station.edit(project));
    EXPECT_THAT(refusal([](FollowOptions&) {}), HasSubstr("is not proven"));
    // One that a person states will do; then the sensor is asked who it is.
    project.calibrations[0].sensor_identity.serial = "another";
    ASSERT_TRUE(station.edit(project));
    EXPECT_THAT(refusal([](FollowOptions& o) { o.latency_ms = 0; }),
                HasSubstr("is another one than was calibrated"));
    project.calibrations[0].verdict = Verdict::poor;
    ASSERT_TRUE(station.edit(project));
    EXPECT_THAT(refusal([](FollowOptions& o) { o.latency_ms = 0; }), HasSubstr("no calibration that serves"));
}

TEST(Follow, ThePartThatTheGateRefusesIsNotSteered) {
    const auto seam = seam_of({});
    ASSERT_TRUE(seam);
    PartState part;
    part.workobject_from_movedworkobject.translation() = Eigen::Vector3d(0, 2, 0);
    seam->cell->cell().set_part(part);
    Project project = seam->cell->station().project();
    project.regions[0].limits.translation_mm = 1;
    ASSERT_TRUE(seam->cell->station().edit(project));
    seam->follow.limit_mm = 1;
    const auto followed = follow_run(seam->cell->station(), {}, seam->follow);
    ASSERT_TRUE(followed) << followed.error().sentence();
    EXPECT_EQ(followed->run.status, RunStatus::refused);
    EXPECT_EQ(followed->figures.cycles, 0u);
    EXPECT_EQ(seam->faults->ahead, 0);
}

// A file of that name first, then what the project keeps: by name, the newest, and by hash.
TEST(Follow, TheGuideOfARunIsKeptInTheProjectAndFoundThere) {
    const auto seam = seam_of({});
    ASSERT_TRUE(seam);
    seam->follow.guide_name = "top.csv";
    const auto followed = follow_run(seam->cell->station(), {}, seam->follow);
    ASSERT_TRUE(followed) << followed.error().sentence();
    ASSERT_EQ(followed->run.status, RunStatus::ok) << followed->run.message.english();
    ASSERT_EQ(followed->guide_hash.size(), 64u);
    const ProjectFile& file = seam->cell->station().file();
    const auto stored = file.load_run(followed->run.number, false);
    ASSERT_TRUE(stored);
    EXPECT_TRUE(has_event(*stored, EventKind::note, followed->guide_hash)) << "the run names it";
    const auto kept = file.load_guide(followed->guide_hash);
    ASSERT_TRUE(kept) << kept.error().sentence();
    EXPECT_EQ(kept->csv, seam->follow.guide_csv) << "to the byte";
    EXPECT_TRUE(file.check().empty()) << "the chain knows it";

    // The same again is not kept twice; another of that name is the newer one.
    ProjectFile& writing = seam->cell->station().file();
    ASSERT_TRUE(writing.keep_guide("top.csv", seam->follow.guide_csv));
    EXPECT_EQ(file.guides()->size(), 1u);
    std::string longer = seam->follow.guide_csv;
    longer.append("0,0,100,0,0,0\n");
    ASSERT_TRUE(writing.keep_guide("top.csv", longer));
    EXPECT_EQ(find_guide(file, "top.csv")->csv, longer);
    EXPECT_EQ(find_guide(file, followed->guide_hash.substr(0, 8))->csv, seam->follow.guide_csv);
    EXPECT_FALSE(find_guide(file, followed->guide_hash.substr(0, 7))) << "too short to mean one";
    EXPECT_FALSE(find_guide(file, "other.csv"));
    EXPECT_FALSE(writing.keep_guide("empty", ""));
}

TEST(Follow, AGuideGoesThroughItsTable) {
    std::vector<GuidePoint> points;
    for (int i = 0; i < 60; ++i) {
        const double a = 0.02 * i;
        points.push_back({{150 * std::cos(a) + 1.0 / 3, 150 * std::sin(a), 7 * a}, {std::sin(a), 0.1, 1}});
    }
    const auto read = parse_guide(guide_csv(points), "guide");
    ASSERT_TRUE(read) << read.error().sentence();
    ASSERT_EQ(read->size(), points.size());
    const auto curve = GuideCurve::make(*read), before = GuideCurve::make(points);
    ASSERT_TRUE(curve && before);
    for (double s = 0; s < curve->length_mm(); s += 3) {
        EXPECT_LT((curve->at(s) - before->at(s)).norm(), 1e-9);
        EXPECT_LT((curve->directions(s) - before->directions(s)).norm(), 1e-4);
    }
    EXPECT_FALSE(parse_guide("x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n1,2,3,0,0,0\n", "guide"))
        << "one point is no guide";
}

}  // namespace
}  // namespace seamwright
