#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>

#include "devices/exchange/pose_json.h"
#include "projects/calibrate/methods/example/target_views.h"
#include "projects/calibrate/session/answer.h"
#include "session_case.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

TEST_F(Session, SphereFromFirstCaptureToUse) {
    CalibrationSession s = open();
    EXPECT_EQ(s.stage(), SessionStage::prepare);
    capture(s, 5);
    EXPECT_EQ(s.stage(), SessionStage::capture);
    EXPECT_FALSE(s.solve()) << "five are too few";
    capture(s, 6);
    EXPECT_EQ(s.stage(), SessionStage::solve);
    solve(s);
    ASSERT_TRUE(s.solution());
    EXPECT_EQ(s.solution()->document["status"], "ok");
    EXPECT_EQ(s.stage(), SessionStage::verify) << "not used before a pose kept back has judged it";
    // Two more that are never solved with.
    capture(s, 2);
    ASSERT_TRUE(s.set_verification("P12", true));
    ASSERT_TRUE(s.set_verification("P13", true));
    EXPECT_EQ(s.solution(), nullptr);
    solve(s);
    const Verification v = s.verification();
    EXPECT_EQ(v.poses, 2);
    EXPECT_TRUE(v.confirmed) << v.worst_mm << " mm, limit " << v.limit_mm;
    EXPECT_EQ(s.stage(), SessionStage::use);

    Project project_now;
    project_now.sensors = {sensor()};
    RobotSetup robot;
    robot.id = "R1";
    project_now.robots = {robot};
    project_now.calibrations = {truth()};
    project_now.sensors[0].calibration_id = project_now.calibrations[0].id;
    const auto all = calibrations_of_session(s, project_now);
    ASSERT_TRUE(all) << all.error().sentence();
    ASSERT_EQ(all->size(), 1U);
    const Calibration* c = &all->front();
    EXPECT_TRUE(c->model);
    const CalibrationDifference d = difference(*c, truth());
    EXPECT_GT(d.points, 60);
    EXPECT_LT(d.largest_mm, 0.15) << "against the cell's own mounting";
    EXPECT_GT(d.largest_mm, 0);
    // A camera that was exchanged since is not the one that was calibrated.
    CalibrationCapture other = *s.state().captures.front().taken;
    other.sensor_serial = "SN 1";
    other.id = s.free_id();
    ASSERT_TRUE(s.add(other, false));
    solve(s);
    project_now.sensors[0].identity.serial = "SN 2";
    const auto exchanged = calibrations_of_session(s, project_now);
    ASSERT_FALSE(exchanged);
    EXPECT_NE(exchanged.error().sentence().find("sensor A is number SN 2 now"), std::string::npos)
        << exchanged.error().sentence();
    EXPECT_EQ(open().state().captures.back().taken->sensor_serial, "SN 1") << "kept on disk";
    project_now.sensors[0].identity.serial = "SN 1";
    EXPECT_TRUE(calibrations_of_session(s, project_now));
    project_now.robots[0].identity.serial = "KR 2";
    EXPECT_TRUE(calibrations_of_session(s, project_now)) << "nobody knows with which it was captured";
    project_now.sensors[0].identity.serial = "SN 2";
    ASSERT_TRUE(s.leave_out(other.id, true));
    solve(s);
    EXPECT_TRUE(calibrations_of_session(s, project_now));
    ASSERT_TRUE(s.set_used_as({c->id}));
    EXPECT_EQ(open().used_as(), std::vector<std::string>{c->id});
    // Kept beside when the next one begins.
    ASSERT_TRUE(s.begin_anew());
    EXPECT_TRUE(open().state().captures.empty());
    int kept = 0;
    for (const auto& entry : fs::directory_iterator(CalibrationSession::folder_of(project)))
        kept += fs::exists(entry.path() / "result.json");
    EXPECT_EQ(kept, 1);
}

TEST_F(Session, BadPoseIsSpottedAndLeftOut) {
    CalibrationSession s = open();
    capture(s, 9, [](int i) { return i == 4; });  // the sphere was bumped, and put back
    solve(s);
    const auto rows = s.rows();
    ASSERT_EQ(rows.size(), 9U);
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (i != 4) {
            EXPECT_LT(rows[i].rms_mm, 0.5 * rows[4].rms_mm) << rows[i].id;
        }
    EXPECT_GT(rows[4].rms_mm, 0.3);
    ASSERT_TRUE(s.leave_out("P5", true));
    EXPECT_EQ(s.solution(), nullptr) << "a solution belongs to its marks";
    solve(s);
    EXPECT_TRUE(s.rows()[4].left_out);
    EXPECT_GT(s.rows()[4].rms_mm, 0.3) << "the residual of what is left out is still given";
    EXPECT_EQ(s.solution()->document["status"], "ok");
    // A bumped pose as verification refuses the use.
    ASSERT_TRUE(s.leave_out("P5", false));
    ASSERT_TRUE(s.set_verification("P5", true));
    solve(s);
    EXPECT_FALSE(s.verification().confirmed);
    EXPECT_GT(s.verification().worst_mm, s.verification().limit_mm);
    EXPECT_EQ(s.stage(), SessionStage::verify);
}

// Put aside and taken up again, with captures, marks, solution and what it is used as; and once more the other way.
TEST_F(Session, BeginningAnewCanBeTakenBack) {
    CalibrationSession s = open();
    capture(s, 7);
    ASSERT_TRUE(s.leave_out("P3", true));
    solve(s);
    ASSERT_TRUE(s.set_used_as({"sphere 1"}));
    const json data = s.data(), solved = s.solution()->document;
    auto parked = s.begin_anew();
    ASSERT_TRUE(parked) << parked.error().sentence();
    EXPECT_TRUE(fs::exists(*parked / "captures" / "P7.json"));
    capture(s, 2);
    const json newer = s.data();
    EXPECT_TRUE(s.exchange(*parked));
    EXPECT_EQ(s.data(), data);
    EXPECT_TRUE(s.state().captures[2].left_out);
    EXPECT_EQ(s.used_as(), std::vector<std::string>{"sphere 1"});
    ASSERT_TRUE(s.solution());
    EXPECT_EQ(s.solution()->document, solved);
    EXPECT_EQ(s.free_id(), "P8");
    EXPECT_EQ(open().data(), data) << "on disk too";
    EXPECT_TRUE(s.exchange(*parked));
    EXPECT_EQ(s.data(), newer);
    EXPECT_EQ(s.free_id(), "P3");
    // What is no longer there leaves this one as it is.
    fs::path gone = folder / "gone";
    EXPECT_FALSE(s.exchange(gone));
    EXPECT_EQ(open().data(), newer);
}

// The views are as many as the method advises, and one to keep back; each capture takes one off.
TEST_F(Session, PosesThatAreLeftAreCounted) {
    CalibrationSession s = open();
    const Pose mounting = truth().flange_from_sensor;
    EXPECT_TRUE(next_poses(s, mounting).empty());
    capture(s, 1);
    const std::size_t all = next_poses(s, mounting).size();
    EXPECT_GE(static_cast<int>(all), s.method().advised);
    capture(s, 4);
    EXPECT_EQ(next_poses(s, mounting).size(), all - 4);
    EXPECT_TRUE(next_poses(s, std::nullopt).empty());
}

// As many as are advised serve, though nobody has stated what the robot scatters.
TEST_F(Session, TheAdvisedPosesServe) {
    const CalibrationMethod& method = *find_method("tcp-sphere");
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        CellSettings settings = default_cell_settings();
        settings.scene = Scene::sphere;
        settings.seed = seed;
        const auto its = SimulatedCell::open(settings).value();
        Calibration base;
        base.model = its->sensor_model();
        json data = default_settings(method);
        json list = json::array();
        for (int i = 0; i < method.advised; ++i) {
            const Pose at = settings.base_from_target *
                            target_from_sensor(sphere_views()[static_cast<std::size_t>(i)]) *
                            its->flange_from_sensor().inverse();
            its->move_to(at);
            Frame frame;
            its->render(*its->true_flange(), 100 + static_cast<std::uint64_t>(i), frame);
            const auto taken = capture_shot(method, data, sensor(), &base, frame, nullptr, at);
            ASSERT_TRUE(taken) << taken.error().sentence();
            list.push_back(taken->capture.entry);
            list.back()["id"] = "P" + std::to_string(i + 1);
        }
        data["observations"] = std::move(list);
        const auto solved = solve_calibration(method, data, {});
        ASSERT_TRUE(solved) << solved.error().sentence();
        EXPECT_TRUE(serves(solved->verdict()))
            << "seed " << seed << ": " << solved->report.judgement.reason.english();
    }
}

TEST_F(Session, UndoBringsBackWhatWasRemoved) {
    CalibrationSession s = open();
    capture(s, 7);
    solve(s);
    const SessionState before = s.state();
    const json solved = s.solution()->document;
    ASSERT_TRUE(s.remove("P3"));
    EXPECT_EQ(s.state().captures.size(), 6U);
    EXPECT_FALSE(s.remove("P3"));
    ASSERT_TRUE(s.set_state(before));
    ASSERT_TRUE(s.solution());
    EXPECT_EQ(s.solution()->document, solved);
    // After removal no id comes a second time.
    ASSERT_TRUE(s.remove("P7"));
    EXPECT_EQ(open().free_id(), "P8");
}

// Killed at a random moment while it grows: everything that was reported as done is there.
TEST_F(Session, SurvivesAKill) {
    capture(*std::make_unique<CalibrationSession>(open()), 3);
    const json entry = open().state().captures.at(0).taken->entry;
    for (int trial = 0; trial < 6; ++trial) {
        int pipe_ends[2];
        ASSERT_EQ(::pipe(pipe_ends), 0);
        const pid_t child = ::fork();
        if (child == 0) {
            auto s = CalibrationSession::open(project, MethodId("tcp-sphere"), SensorId("A"), RobotId("R1"));
            for (int i = 0; s && i < 100000; ++i) {
                CalibrationCapture c;
                c.entry = entry;
                auto id = s->add(std::move(c));
                if (!id) ::_exit(2);
                if (i % 3 == 2 && !s->leave_out(*id, true)) ::_exit(3);
                const int n = std::stoi(id->substr(1));
                if (::write(pipe_ends[1], &n, sizeof n) != static_cast<ssize_t>(sizeof n)) ::_exit(4);
            }
            ::_exit(0);
        }
        ::close(pipe_ends[1]);
        int newest = 0, n = 0;
        for (int i = 0;
             i < 3 + 2 * trial && ::read(pipe_ends[0], &n, sizeof n) == static_cast<ssize_t>(sizeof n); ++i)
            newest = n;
        ::kill(child, SIGKILL);
        while (::read(pipe_ends[0], &n, sizeof n) == static_cast<ssize_t>(sizeof n)) newest = n;
        ::close(pipe_ends[0]);
        int status = 0;
        ::waitpid(child, &status, 0);
        ASSERT_TRUE(WIFSIGNALED(status)) << "the child must not have ended by itself";
        const CalibrationSession s = open();
        EXPECT_TRUE(s.notices().empty());
        ASSERT_FALSE(s.state().captures.empty());
        const std::string last = s.state().captures.back().taken->id;
        EXPECT_GE(std::stoi(last.substr(1)), newest);
        EXPECT_LE(std::stoi(last.substr(1)), newest + 1);
    }
}

TEST_F(Session, ResumesWithItsSolution) {
    {
        CalibrationSession s = open();
        capture(s, 8);
        ASSERT_TRUE(s.leave_out("P2", true));
        solve(s);
    }
    CalibrationSession s = open();
    ASSERT_TRUE(s.solution());
    EXPECT_EQ(s.rows().size(), 8U);
    EXPECT_TRUE(s.rows()[1].left_out);
    // Solved again from what is on disk: the same numbers.
    const auto again = s.solve();
    ASSERT_TRUE(again);
    EXPECT_EQ(again->document["flange_from_sensor"], s.solution()->document["flange_from_sensor"]);
    // A capture that a disk error damaged is named, the others stay.
    std::ofstream(s.folder() / "captures" / "P4.json") << "{";
    const CalibrationSession damaged = open();
    EXPECT_EQ(damaged.state().captures.size(), 7U);
    ASSERT_EQ(damaged.notices().size(), 1U);
    EXPECT_THAT(damaged.notices()[0], HasSubstr("P4"));
    EXPECT_EQ(damaged.solution(), nullptr);
    // Lists whose fields are of another type: refused, or read without what is wrong in them.
    const json list = json::parse(std::ifstream(s.folder() / "session.json"));
    const json fields = list.flatten();
    for (const auto& [pointer, value] : fields.items())
        for (const json& other : {json(7), json("x"), json(nullptr), json::array({1}), json::object()}) {
            json hostile = list;
            hostile[json::json_pointer(pointer)] = other;
            std::ofstream(s.folder() / "session.json") << hostile;
            EXPECT_NO_THROW(
                (void)CalibrationSession::open(project, MethodId("tcp-sphere"), SensorId("A"), RobotId("R1")))
                << pointer << " = " << other;
        }
    std::ofstream(s.folder() / "session.json") << "[1]";
    EXPECT_FALSE(CalibrationSession::open(project, MethodId("tcp-sphere"), SensorId("A"), RobotId("R1")));
    // Foreign files are refused with a sentence.
    std::ofstream(s.folder() / "session.json") << "{\"format\":\"something\"}";
    const auto refused =
        CalibrationSession::open(project, MethodId("tcp-sphere"), SensorId("A"), RobotId("R1"));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().sentence(), HasSubstr("no calibration session"));
}

TEST_F(Session, ProposesNothingThatWouldLoseTheTarget) {
    CalibrationSession s = open();
    EXPECT_FALSE(next_pose(s, truth().flange_from_sensor)) << "the first place is the person's";
    capture(s, 1);
    EXPECT_FALSE(next_pose(s, std::nullopt)) << "the mounting is not known";
    const auto next = next_pose(s, truth().flange_from_sensor);
    ASSERT_TRUE(next);
    EXPECT_GT(angle_rad(next->base_from_flange, *s.state().captures[0].taken->base_from_flange), 0.2);
    capture(s, 7);
    solve(s);
    EXPECT_TRUE(next_pose(s, std::nullopt)) << "solved: known by now";
}

TEST_F(Session, GoesWithItsProject) {
    {
        CalibrationSession s = open();
        capture(s, 2);
    }
    const fs::path other = folder / "other.seam";
    ASSERT_TRUE(CalibrationSession::copy_all(project, other));
    EXPECT_EQ(CalibrationSession::open(other, MethodId("tcp-sphere"), SensorId("A"), RobotId("R1"))
                  ->state()
                  .captures.size(),
              2U);
    EXPECT_EQ(open().state().captures.size(), 2U);
    // Another project in the file's place begins with none.
    ASSERT_TRUE(CalibrationSession::put_aside(other));
    EXPECT_FALSE(CalibrationSession::exists(other, MethodId("tcp-sphere"), SensorId("A")));
    ASSERT_TRUE(CalibrationSession::put_aside(other)) << "nothing to do is no error";
}

// Folders are called after sensors, whose names may make the same one.
TEST_F(Session, NobodysCapturesAreTakenForAnothers) {
    const auto of = [&](const char* sensor, const char* robot, const std::vector<std::string>& robots) {
        return CalibrationSession::open(project, MethodId("tcp-sphere"), SensorId(sensor), RobotId(robot),
                                        robots)
            .value();
    };
    const auto captures = [](const CalibrationSession& s) { return s.state().captures.size(); };
    const std::vector<std::string> both{"R1", "R2"};
    CalibrationSession first = of("Kopf ä", "R1", both);
    capture(first, 2);
    EXPECT_FALSE(CalibrationSession::exists(project, MethodId("tcp-sphere"), SensorId("Kopf ö")));
    CalibrationSession other = of("Kopf ö", "R1", both);
    EXPECT_EQ(captures(other), 0U) << "they are of the sensor Kopf ä";
    capture(other, 3);
    CalibrationSession robot = of("Kopf ä", "R2", both);
    EXPECT_EQ(captures(robot), 0U) << "they were taken on R1";
    capture(robot, 1);
    EXPECT_EQ(captures(of("Kopf ä", "R1", both)), 2U);
    EXPECT_EQ(captures(of("Kopf ö", "R1", both)), 3U);
    EXPECT_EQ(captures(of("Kopf ä", "R2", both)), 1U);
    EXPECT_EQ(captures(of("Kopf ö", "Q", {"Q"})), 3U) << "the robot was given another name";
}

// Captured twice without moving the robot: the second agrees with any answer, and verifies none.
TEST_F(Session, WhereTheRobotHasNotMovedNothingIsVerified) {
    CalibrationSession s = open();
    capture(s, 8);
    const Pose last = *s.state().captures.back().taken->base_from_flange;
    ASSERT_TRUE(s.add(shoot(*cell, s, truth(), last, 300), true));
    solve(s);
    Verification v = s.verification();
    EXPECT_EQ(v.poses, 0);
    EXPECT_FALSE(v.confirmed);
    ASSERT_EQ(v.repeats.size(), 1U);
    EXPECT_EQ(v.repeats[0], (std::pair<std::string, std::string>{"P9", "P8"}));
    EXPECT_EQ(s.stage(), SessionStage::verify);
    // Solved without the one that stands there, it judges.
    ASSERT_TRUE(s.leave_out("P8", true));
    solve(s);
    v = s.verification();
    EXPECT_EQ(v.poses, 1);
    EXPECT_TRUE(v.confirmed);
}

TEST_F(Session, SaysWhatIsNotSeen) {
    CalibrationSession s = open();
    const Calibration base = truth();
    Frame frame;
    Pose away = simulated_start(s.method(), json::object())->base_from_flange;
    away.translation().x() += 400;
    cell->render(away, 1, frame);
    const auto missed = capture_shot(s.method(), s.state().settings, sensor(), &base, frame, nullptr, away);
    ASSERT_FALSE(missed);
    EXPECT_THAT(missed.error().sentence(), testing::AnyOf(HasSubstr("no circle"), HasSubstr("no stripe")));
    const auto blind = capture_shot(s.method(), s.state().settings, sensor(), nullptr, frame, nullptr, away);
    ASSERT_FALSE(blind);
    EXPECT_THAT(blind.error().sentence(), HasSubstr("calibrate camera and laser plane first"));
}

// The images of a real cell, read once: the command line's numbers, and a frame left out without reading
// again.
TEST_F(Session, StripeCameraFilesGiveTheCommandLinesAnswer) {
    const char* given = std::getenv("SEAMWRIGHT_DATA");
    const fs::path images = fs::path(given ? given : SEAMWRIGHT_SHARED_DATA) / "etna" / "calib2";
    if (!fs::exists(images)) GTEST_SKIP() << "skipped: no real data";
    CalibrationSession s = open("stripe-camera");
    auto read = read_captures(s.method(), s.state().settings, nullptr, images, {}, {});
    ASSERT_TRUE(read) << read.error().sentence();
    for (CalibrationCapture& c : read->captures) ASSERT_TRUE(s.add(std::move(c)));
    solve(s);
    const auto command_line = solve_calibration(
        s.method(), *s.method().data_of_images({images.string(), {.counts = "7x6", .pitch_mm = 10}, {}}), {});
    ASSERT_TRUE(command_line);
    const auto numbers = [](const json& r) {
        std::vector<double> all;
        for (const json& p : r["parameters"])
            if (p["value"].is_number()) all.push_back(p["value"]);
        for (const char* key : {"on_plane_share", "plane_rms_mm", "reprojection_rms_px"})
            all.push_back(r[key]);
        all.push_back(r["laser_plane"]["distance_mm"]);
        all.push_back(r["hand_eye"]["target_spread_mm"]);
        return all;
    };
    const auto expected = numbers(command_line->document), found = numbers(s.solution()->document);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i)
        EXPECT_NEAR(found[i], expected[i], 1e-9 * std::max(1.0, std::abs(expected[i]))) << i;
    EXPECT_EQ(s.solution()->document["verdict"], command_line->document["verdict"]);

    // Resumed, with the images gone for all it knows: one left out.
    CalibrationSession resumed = open("stripe-camera");
    const std::string id = resumed.state().captures.at(2).taken->id;
    ASSERT_TRUE(resumed.leave_out(id, true));
    solve(resumed);
    const auto without = solve_calibration(
        s.method(), *s.method().data_of_images({images.string(), {.counts = "7x6", .pitch_mm = 10}, {id}}),
        {});
    ASSERT_TRUE(without);
    EXPECT_NEAR(resumed.solution()->document["camera"]["fx"].get<double>(),
                without->document["camera"]["fx"].get<double>(), 1e-6);
    const PoseRow row = resumed.rows().at(2);
    EXPECT_TRUE(row.left_out);
    EXPECT_LT(row.rms_px, 2) << "a good frame fits a solution that has not seen it";
    EXPECT_LT(row.deg, 1);
}

}  // namespace
}  // namespace seamwright
