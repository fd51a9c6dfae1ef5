// A capture through the driver "replay".

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/registry.h"
#include "devices/silence.h"
#include "devices/simulated/cell.h"
#include "tests/devices/capture/capture_frames.h"

namespace seamwright {
namespace {

using namespace capture_test;
using namespace std::chrono_literals;
using nlohmann::json;
using ::testing::HasSubstr;
using Clock = std::chrono::steady_clock;

std::unique_ptr<ProfileSource> play(const std::filesystem::path& path, DeviceSession& session, json more) {
    more["file"] = path.string();
    auto sensor = open_sensor("replay", more, session);
    EXPECT_TRUE(sensor) << sensor.error().sentence();
    if (!sensor) return nullptr;
    EXPECT_TRUE((*sensor)->start());
    return std::move(*sensor);
}

TEST(CaptureReplay, AsFastAsItGoesEveryBitComesBack) {
    const auto path = make_capture("replay.seam", 300, true);
    DeviceSession session;
    const auto a = play(path, session, {{"source", "A"}, {"speed", 0}, {"recorded_host_time", true}});
    const auto b = play(path, session, {{"source", "B"}, {"speed", 0}});
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->identity(), (SensorIdentity{"replay", "maker", "model A", "1"}));
    Frame frame;
    for (std::uint64_t n = 0; n < 300; ++n) {
        fill(frame, n);
        const auto got = a->wait_next(1000ms);
        ASSERT_TRUE(got) << got.error().sentence();
        expect_same(**got, frame);
        EXPECT_EQ((*got)->host_time_ns, frame.host_time_ns);
        EXPECT_EQ(a->latest()->sequence, n);
        fill(frame, n + 1000);
        const auto other = b->wait_next(1000ms);
        ASSERT_TRUE(other);
        expect_same(**other, frame);
        EXPECT_NE((*other)->host_time_ns, frame.host_time_ns);  // it arrived at this moment
    }
    const auto end = a->wait_next(10ms);
    ASSERT_FALSE(end);
    EXPECT_EQ(end.error().what, kEndOfRecording);
    EXPECT_EQ(a->counters().completed, 200u);
    EXPECT_EQ(a->counters().damaged, 100u);
}

TEST(CaptureReplay, KeepsTheRecordedTimingAtAnySpeed) {
    const auto path = make_capture("timing.seam", 61);  // a frame a millisecond
    for (const double speed : {0.25, 0.5}) {
        DeviceSession session;
        const auto a = play(path, session, {{"speed", speed}});
        ASSERT_TRUE(a);
        const auto begin = Clock::now();
        std::int64_t first_ns = 0;
        for (int n = 0; n <= 60; ++n) {
            const auto got = a->wait_next(5000ms);
            ASSERT_TRUE(got);
            if (n == 0) first_ns = (*got)->host_time_ns;
            // Never early; late as much as the machine is busy.
            EXPECT_GE(static_cast<double>((*got)->host_time_ns - first_ns), (n / speed - 20) * 1e6);
        }
        const double ms = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
        EXPECT_GE(ms, 60 / speed - 1);
        EXPECT_LT(ms, 60 / speed + 3000);
    }
    DeviceSession session;
    const auto a = play(path, session, {{"speed", 0.001}});  // the second frame comes in a second
    ASSERT_TRUE(a->wait_next(2000ms));
    const auto silent = a->wait_next(30ms);
    ASSERT_FALSE(silent);
    EXPECT_TRUE(is_silence(silent.error())) << silent.error().sentence();
}

TEST(CaptureReplay, StepLoopAndFrom) {
    const auto path = make_capture("step.seam", 20);
    {
        DeviceSession session;
        const auto a = play(path, session, {{"step", true}, {"speed", 0}});
        ASSERT_TRUE(a);
        for (std::uint64_t n = 0; n < 3; ++n) {
            const auto silent = a->wait_next(5ms);
            ASSERT_FALSE(silent);
            EXPECT_TRUE(is_silence(silent.error()));
            ASSERT_TRUE(a->trigger(""));
            const auto got = a->wait_next(1000ms);
            ASSERT_TRUE(got);
            EXPECT_EQ((*got)->sequence, n);
        }
        ASSERT_TRUE(a->trigger("S2"));  // frames 10
        EXPECT_EQ((*a->wait_next(1000ms))->sequence, 10u);
        const auto unknown = a->trigger("S9");
        ASSERT_FALSE(unknown);
        EXPECT_THAT(unknown.error().sentence(), HasSubstr("no spot \"S9\""));
    }
    {
        DeviceSession session;
        const auto a = play(path, session, {{"loop", true}, {"speed", 0}, {"from", 18}});
        ASSERT_TRUE(a);
        for (const std::uint64_t n : {18u, 19u, 0u, 1u}) EXPECT_EQ((*a->wait_next(1000ms))->sequence, n);
    }
}

TEST(CaptureReplay, WrongSettingsAreNamed) {
    const auto path = make_capture("settings.seam", 5, true);
    const auto refused = [&](json more, const std::string& words) {
        DeviceSession session;
        more["file"] = path.string();
        const auto sensor = open_sensor("replay", more, session);
        ASSERT_FALSE(sensor) << words;
        EXPECT_THAT(sensor.error().sentence(), HasSubstr(words));
    };
    refused(json::object(), "several sensors");
    refused({{"source", "C"}}, "known are A, B");
    refused({{"source", "A"}, {"sped", 1}}, "sped");
    refused({{"source", "A"}, {"speed", -1}}, "settings.speed");
    refused({{"source", "A"}, {"from", 5}}, "has 5 frames only");
    refused({{"source", "A"}, {"from", 0.5}}, "settings.from");
    refused({{"source", "A"}, {"buffers", 1}}, "settings.buffers");
    DeviceSession session;
    const auto a = play(path, session, {{"source", "A"}, {"speed", 0}});
    json other = {{"file", path.string()}, {"source", "B"}, {"speed", 1}};
    const auto disagree = open_sensor("replay", other, session);
    ASSERT_FALSE(disagree);
    EXPECT_THAT(disagree.error().sentence(), HasSubstr("disagree"));
    other = {{"file", path.string()}, {"source", "A"}, {"speed", 0}};
    EXPECT_FALSE(open_sensor("replay", other, session));  // played already
    const auto robot = open_robot("replay", {{"file", path.string()}, {"speed", 0}}, session);
    ASSERT_FALSE(robot);
    EXPECT_THAT(robot.error().sentence(), HasSubstr("the capture has no robot"));
}

TEST(CaptureReplay, ACameraFrameWithoutImageIsTheStrongestStripe) {
    const auto path = fresh_path("candidates.seam");
    auto recorder = Recorder::create(path);
    const auto cam = (*recorder)->add_sensor("cam", {});
    Frame frame;
    frame.pixels.resize(64);
    frame.image = {frame.pixels.data(), 8, 8, 8, 8};
    ProfileCandidates k;
    k.lines = 3;
    k.per_line = 2;
    k.count = {2, 0, 1};
    k.x_mm = {1, 2, 0, 0, 5, 0};
    k.z_mm = {11, 12, 0, 0, 15, 0};
    k.intensity = {9, 8, 0, 0, 7, 0};
    (*recorder)->frame(*cam, frame, &k);
    ASSERT_TRUE((*recorder)->finish());
    DeviceSession session;
    const auto sensor = play(path, session, {{"speed", 0}});
    const auto got = sensor->wait_next(1000ms);
    ASSERT_TRUE(got);
    EXPECT_TRUE((*got)->image.empty());
    ASSERT_EQ((*got)->profile.size(), 3u);
    EXPECT_EQ((*got)->profile.x_mm[0], 1);
    EXPECT_TRUE(std::isnan((*got)->profile.z_mm[1]));
    EXPECT_EQ((*got)->profile.z_mm[2], 15);
}

// A session of robot and camera, recorded while it ran, gives the same again.
TEST(CaptureReplay, ASessionOfRobotAndCameraComesBack) {
    json settings = {{"scene", "triangle"}, {"optics", {{"width", 160}, {"height", 128}}}};
    auto cell = SimulatedCell::open(settings);
    ASSERT_TRUE(cell);
    const auto path = fresh_path("robot.seam");
    RecorderOptions options;
    options.images = true;
    auto made = Recorder::create(path, options);
    ASSERT_TRUE(made);
    std::shared_ptr<Recorder> recorder = std::move(*made);
    std::vector<std::vector<std::byte>> pixels;
    std::vector<Pose> poses;
    std::vector<MeasuringMove> moves;
    for (const char* spot : {"L1", "L2", "L1"}) {
        MeasuringMove move;
        move.spot_id = spot;
        move.trigger = (*cell)->settings().base_from_target *
                       make_pose(Eigen::Matrix3d::Identity(), {static_cast<double>(moves.size()), 0, 15}) *
                       (*cell)->flange_from_sensor().inverse();
        move.entry = move.exit = move.trigger;
        move.entry.translation().y() -= 20;
        move.exit.translation().y() += 20;
        moves.push_back(move);
    }
    {
        auto plain_sensor = make_simulated_sensor(*cell);
        auto plain_robot = make_simulated_robot(*cell);
        const auto s = recorder->add_sensor("cam", plain_sensor->identity());
        const auto r = recorder->add_robot("R1", *plain_robot->identity());
        ASSERT_TRUE(s && r);
        const auto sensor = record_sensor(std::move(plain_sensor), recorder, *s);
        const auto robot = record_robot(std::move(plain_robot), recorder, *r);
        ASSERT_TRUE(sensor->start());
        ASSERT_TRUE(robot->mode());
        ASSERT_TRUE(robot->start_measuring(moves));
        for (std::size_t i = 0; i < moves.size(); ++i) {
            const auto trigger = robot->wait_trigger(1000ms);
            ASSERT_TRUE(trigger);
            poses.push_back(*trigger->base_from_flange);
            const auto frame = sensor->wait_next(2000ms);
            ASSERT_TRUE(frame);
            pixels.push_back((*frame)->pixels);
        }
        ASSERT_TRUE(robot->base_from_flange());
        sensor->stop();
        ASSERT_TRUE(recorder->finish());
    }
    const auto open = [&](DeviceSession& session) {
        auto robot = open_robot("replay", {{"file", path.string()}, {"speed", 0}}, session);
        EXPECT_TRUE(robot) << robot.error().sentence();
        return std::move(*robot);
    };
    {  // as it was
        DeviceSession session;
        const auto sensor = play(path, session, {{"speed", 0}});
        const auto robot = open(session);
        EXPECT_EQ(robot->identity()->serial, "SIM-1");
        EXPECT_EQ(*robot->mode(), RobotMode::automatic);
        for (std::size_t i = 0; i < moves.size(); ++i) {
            const auto trigger = robot->wait_trigger(1000ms);
            ASSERT_TRUE(trigger) << trigger.error().sentence();
            EXPECT_EQ(trigger->spot_id, moves[i].spot_id);
            EXPECT_EQ(trigger->base_from_flange->matrix(), poses[i].matrix());
            EXPECT_EQ(robot->base_from_flange()->matrix(), poses[i].matrix());
            const auto frame = sensor->wait_next(1000ms);
            ASSERT_TRUE(frame);
            EXPECT_EQ((*frame)->spot_id, moves[i].spot_id);
            EXPECT_EQ((*frame)->pixels, pixels[i]);
            EXPECT_EQ((*frame)->image.pixels, (*frame)->pixels.data());
        }
        const auto end = robot->wait_trigger(1000ms);
        ASSERT_FALSE(end);
        EXPECT_EQ(end.error().what, kEndOfRecording);
    }
    {  // as a measuring program asks for it: each spot's own frame, in the program's order
        DeviceSession session;
        const auto sensor = play(path, session, {{"speed", 0}});
        const auto robot = open(session);
        ASSERT_TRUE(robot->start_measuring({moves[1], moves[0], moves[2]}));
        for (const std::size_t i : {1u, 0u, 2u}) {
            const auto trigger = robot->wait_trigger(1000ms);
            ASSERT_TRUE(trigger);
            EXPECT_EQ(trigger->base_from_flange->matrix(), poses[i].matrix());
            ASSERT_TRUE(sensor->trigger(trigger->spot_id));  // the same exposure, not a further one
            const auto frame = sensor->wait_next(1000ms);
            ASSERT_TRUE(frame);
            EXPECT_EQ((*frame)->pixels, pixels[i]);
        }
        EXPECT_FALSE(robot->wait_trigger(10ms));
        const auto again = robot->start_measuring({moves[1]});
        ASSERT_FALSE(again);
        EXPECT_EQ(again.error().what, kEndOfRecording);
        EXPECT_FALSE(robot->write_frame("f", Pose::Identity()));
    }
}

}  // namespace
}  // namespace seamwright
