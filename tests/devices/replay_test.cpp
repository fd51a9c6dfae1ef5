#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <thread>

#include "devices/exchange/files.h"
#include "devices/exchange/image_file.h"
#include "devices/exchange/pose_json.h"
#include "devices/exchange/tables/profile_csv.h"
#include "devices/registry.h"
#include "devices/replay/recording.h"
#include "tests/devices/real_data.h"
#include "tests/devices/temporary_folder.h"

namespace seamwright {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

struct Cell {
    DeviceSession session;
    std::unique_ptr<ProfileSource> sensor;
    std::unique_ptr<RobotLink> robot;
};

json settings_of(const TemporaryFolder& folder, json more = json::object()) {
    more["folder"] = folder.path().string();
    return more;
}

Expected<Cell> open_cell(const json& sensor_settings, const json& robot_settings) {
    Cell cell;
    auto sensor = open_sensor("replay", sensor_settings, cell.session);
    if (!sensor) return tl::unexpected(sensor.error());
    auto robot = open_robot("replay", robot_settings, cell.session);
    if (!robot) return tl::unexpected(robot.error());
    cell.sensor = std::move(*sensor);
    cell.robot = std::move(*robot);
    return cell;
}

std::string profile_text(double z) {
    Profile p;
    for (int i = 0; i < 5; ++i) {
        p.x_mm.push_back(i);
        p.z_mm.push_back(z);
    }
    return profile_csv(p);
}

Pose pose_of(int i) {
    return make_pose(rotation_exp({0.01 * i, 0.2, 0}), {1000.0 + i, 10, -5});
}

void write_image(const TemporaryFolder& folder, const std::string& name, int width, int height,
                 int depth = 8) {
    std::vector<std::byte> pixels(static_cast<std::size_t>(width * height * (depth > 8 ? 2 : 1)));
    for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::byte>((i * 7) % 13);
    const StripeImage image{pixels.data(), width, height,
                            static_cast<std::size_t>(width * (depth > 8 ? 2 : 1)), depth};
    ASSERT_TRUE(write_image_file(folder.path() / name, image));
}

TEST(Replay, NaturalOrder) {
    EXPECT_TRUE(natural_less("frame2.png", "frame10.png"));
    EXPECT_FALSE(natural_less("frame10.png", "frame2.png"));
    EXPECT_TRUE(natural_less("a", "b"));
    EXPECT_TRUE(natural_less("a1b2", "a1b10"));
    EXPECT_FALSE(natural_less("x007", "x007"));
    EXPECT_TRUE(natural_less("x007", "x7") != natural_less("x7", "x007"));
    EXPECT_TRUE(natural_less("99999999999999999999998", "99999999999999999999999"));
}

TEST(Replay, ProfilesWithPosesInOrderThenTheEnd) {
    const TemporaryFolder folder;
    for (int i : {1, 2, 10, 9}) {
        folder.write("profile" + std::to_string(i) + ".csv", profile_text(i));
        folder.write("pose" + std::to_string(i) + ".json",
                     json({{"base_from_flange", pose_json(pose_of(i))}}).dump());
    }
    auto cell = open_cell(settings_of(folder), settings_of(folder));
    ASSERT_TRUE(cell) << cell.error().sentence();
    EXPECT_FALSE(cell->sensor->wait_next(1ms)) << "not started";
    ASSERT_TRUE(cell->sensor->start());
    EXPECT_EQ(cell->sensor->latest(), nullptr);
    std::uint64_t sequence = 0;
    for (int i : {1, 2, 9, 10}) {
        const auto frame = cell->sensor->wait_next(1s);
        ASSERT_TRUE(frame) << frame.error().sentence();
        EXPECT_EQ((*frame)->status, FrameStatus::ok);
        EXPECT_EQ((*frame)->spot_id, "profile" + std::to_string(i));
        EXPECT_EQ((*frame)->profile.z_mm[0], i);
        EXPECT_EQ((*frame)->sequence, sequence++);
        ASSERT_TRUE((*frame)->base_from_flange);
        EXPECT_LT(distance_mm(*(*frame)->base_from_flange, pose_of(i)), 1e-9);
        EXPECT_EQ(cell->sensor->latest(), *frame);
    }
    const auto end = cell->sensor->wait_next(1s);
    ASSERT_FALSE(end);
    EXPECT_EQ(end.error().what, kEndOfRecording);
    EXPECT_EQ(cell->sensor->counters().completed, 4U);
}

TEST(Replay, RobotDrivesTheSensorInTheOrderOfItsMoves) {
    const TemporaryFolder folder;
    std::string manifest = "file,spot_id,pose_file\r\n";
    for (int part = 0; part < 2; ++part) {
        for (const char* spot : {"S1", "S2", "S3"}) {
            const std::string name = std::string(spot) + "_" + std::to_string(part);
            folder.write(name + ".csv", profile_text(part * 10 + spot[1] - '0'));
            folder.write("p/" + name + ".txt", "((1, 0, 0), (0, 0, 0, 1))");
            manifest += name + ".csv," + spot + ",p/" + name + ".txt\r\n";
        }
    }
    folder.write("frames.csv", manifest);
    auto cell = open_cell(settings_of(folder), settings_of(folder));
    ASSERT_TRUE(cell) << cell.error().sentence();
    ASSERT_TRUE(cell->sensor->start());
    EXPECT_FALSE(cell->robot->base_from_flange());
    std::vector<MeasuringMove> moves(3);
    moves[0].spot_id = "S3";
    moves[1].spot_id = "S1";
    moves[2].spot_id = "S2";
    for (int part = 0; part < 2; ++part) {
        ASSERT_TRUE(cell->robot->start_measuring(moves));
        for (const auto& move : moves) {
            EXPECT_FALSE(cell->sensor->wait_next(1ms)) << "nothing fired yet";
            const auto event = cell->robot->wait_trigger(1s);
            ASSERT_TRUE(event) << event.error().sentence();
            EXPECT_EQ(event->spot_id, move.spot_id);
            ASSERT_TRUE(event->base_from_flange);
            EXPECT_EQ(event->base_from_flange->translation().x(), 1000);
            ASSERT_TRUE(cell->sensor->trigger(event->spot_id)) << "the same exposure, not a second one";
            const auto frame = cell->sensor->wait_next(1s);
            ASSERT_TRUE(frame) << frame.error().sentence();
            EXPECT_EQ((*frame)->spot_id, move.spot_id);
            EXPECT_EQ((*frame)->profile.z_mm[0], part * 10 + move.spot_id[1] - '0');
        }
        EXPECT_FALSE(cell->robot->wait_trigger(1ms));
    }
    EXPECT_THAT(cell->robot->start_measuring(moves).error().what, HasSubstr(kEndOfRecording));
    moves[0].spot_id = "S9";
    EXPECT_THAT(cell->robot->start_measuring(moves).error().what, HasSubstr("S9"));
}

TEST(Replay, LoopAndSoftwareTrigger) {
    const TemporaryFolder folder;
    folder.write("a.csv", profile_text(1));
    folder.write("b.csv", profile_text(2));
    auto cell = open_cell(settings_of(folder, {{"loop", true}}), settings_of(folder, {{"loop", true}}));
    ASSERT_TRUE(cell);
    ASSERT_TRUE(cell->sensor->start());
    for (const char* id : {"b", "a", "b", "b"}) {
        ASSERT_TRUE(cell->sensor->trigger(id));
        const auto frame = cell->sensor->wait_next(1s);
        ASSERT_TRUE(frame);
        EXPECT_EQ((*frame)->spot_id, id);
        EXPECT_FALSE((*frame)->base_from_flange);
    }
    EXPECT_FALSE(cell->sensor->trigger("c"));
    EXPECT_FALSE(open_cell(settings_of(folder, {{"loop", true}}), settings_of(folder))) << "they disagree";
}

TEST(Replay, FramesAreWrittenOnlyWhenAllowed) {
    const TemporaryFolder folder;
    folder.write("a.csv", profile_text(1));
    const Pose frame = pose_of(3);
    auto strict =
        open_cell(settings_of(folder), settings_of(folder, {{"frames", {{"left", pose_json(frame)}}}}));
    ASSERT_TRUE(strict) << strict.error().sentence();
    EXPECT_TRUE(strict->robot->read_frame("left")->isApprox(frame));
    EXPECT_FALSE(strict->robot->read_frame("right"));
    EXPECT_EQ(strict->robot->write_frame("left", Pose::Identity()).error().kind, ErrorKind::device);
    EXPECT_TRUE(strict->robot->read_frame("left")->isApprox(frame));
    EXPECT_FALSE(strict->robot->move_to(frame));
    auto open = open_cell(settings_of(folder), settings_of(folder, {{"accept_frames", true}}));
    ASSERT_TRUE(open);
    ASSERT_TRUE(open->robot->write_frame("left", frame));
    EXPECT_TRUE(open->robot->read_frame("left")->isApprox(frame));
}

TEST(Replay, ImagesAndTheirFaults) {
    const TemporaryFolder folder;
    write_image(folder, "frame0001.png", 40, 30);
    write_image(folder, "frame0002.png", 41, 30);
    folder.write("frame0003.png", "no image at all");
    folder.write("frame0004.png", "");
    write_image(folder, "frame0005.png", 40, 30, 16);
    write_image(folder, "frame0006.png", 40, 30);
    const auto bytes = *read_text_file(folder.path() / "frame0001.png");
    folder.write("frame0007.png", std::string_view(bytes).substr(0, bytes.size() / 2));
    auto cell = open_cell(settings_of(folder), settings_of(folder));
    ASSERT_TRUE(cell) << cell.error().sentence();
    ASSERT_TRUE(cell->sensor->start());
    for (const bool good : {true, false, false, false, false, true, false}) {
        const auto frame = cell->sensor->wait_next(1s);
        ASSERT_TRUE(frame);
        EXPECT_EQ((*frame)->status, good ? FrameStatus::ok : FrameStatus::corrupt) << (*frame)->spot_id;
        EXPECT_EQ((*frame)->image.empty(), !good) << (*frame)->spot_id;
        if (good) {
            EXPECT_EQ((*frame)->image.width, 40);
            EXPECT_EQ((*frame)->image.pixels[41], static_cast<std::byte>(41 * 7 % 13));
        }
    }
    EXPECT_EQ(cell->sensor->counters().completed, 2U);
    EXPECT_EQ(cell->sensor->counters().damaged, 5U);
}

TEST(Replay, HostileProfilesAreCorruptFrames) {
    const TemporaryFolder folder;
    folder.write("1.csv", "x_mm;z_mm\n1;two\n");
    folder.write("2.csv", "");
    folder.write("3.csv", profile_text(3));
    std::filesystem::create_directories(folder.path() / "4.csv");
    std::filesystem::create_symlink("/nonexistent", folder.path() / "5.csv");
    auto cell = open_cell(settings_of(folder), settings_of(folder));
    ASSERT_TRUE(cell) << cell.error().sentence();
    ASSERT_TRUE(cell->sensor->start());
    for (const bool good : {false, false, true}) {
        const auto frame = cell->sensor->wait_next(1s);
        ASSERT_TRUE(frame);
        EXPECT_EQ((*frame)->status == FrameStatus::ok, good);
        EXPECT_EQ((*frame)->profile.size() > 0, good);
    }
    EXPECT_FALSE(cell->sensor->wait_next(1s));
}

TEST(Replay, HostileFoldersAreRefused) {
    const auto error = [](const TemporaryFolder& folder, const json& more = json::object()) {
        DeviceSession session;
        const auto sensor = open_sensor("replay", settings_of(folder, more), session);
        return sensor ? "accepted" : sensor.error().sentence();
    };
    {
        const TemporaryFolder f;
        EXPECT_THAT(error(f), HasSubstr("no frames"));
        f.write("a.csv", profile_text(1));
        EXPECT_EQ(error(f), "accepted");
        EXPECT_THAT(error(f, {{"require_poses", true}}), HasSubstr("no pose"));
        EXPECT_THAT(error(f, {{"kind", "images"}}), HasSubstr("no frames"));
        EXPECT_THAT(error(f, {{"kind", 3}}), HasSubstr("settings.kind"));
        EXPECT_THAT(error(f, {{"kind", "movies"}}), HasSubstr("settings.kind"));
        EXPECT_THAT(error(f, {{"rate_hz", -1}}), HasSubstr("settings.rate_hz"));
        EXPECT_THAT(error(f, {{"bit_depth", 9}}), HasSubstr("settings.bit_depth"));
        EXPECT_THAT(error(f, {{"buffers", 1e9}}), HasSubstr("settings.buffers"));
        EXPECT_THAT(error(f, {{"lopp", true}}), HasSubstr("settings.lopp"));
        write_image(f, "b.png", 8, 8);
        EXPECT_THAT(error(f), HasSubstr("both"));
        EXPECT_EQ(error(f, {{"kind", "profiles"}}), "accepted");
        f.write("a.txt", "((1, 0, 0), (0, 0, 0, 1))");
        f.write("c.csv", profile_text(1));
        EXPECT_THAT(error(f, {{"kind", "profiles"}}), HasSubstr("c.csv: has no pose"));
        f.write("c.txt", "garbage");
        EXPECT_THAT(error(f, {{"kind", "profiles"}}), HasSubstr("c.txt"));
    }
    const auto manifest = [&](const char* name, const std::string& text) {
        const TemporaryFolder f;
        f.write("a.csv", profile_text(1));
        f.write(name, text);
        return std::string(error(f));
    };
    EXPECT_EQ(manifest("frames.csv", "file,spot_id\na.csv,S1\n"), "accepted");
    EXPECT_THAT(manifest("frames.csv", "a.csv,S1\n"), HasSubstr("header"));
    EXPECT_THAT(manifest("frames.csv", "file,spot_id\n../a.csv,S1\n"), HasSubstr("inside"));
    EXPECT_THAT(manifest("frames.csv", "file,spot_id\n/etc/a.csv,S1\n"), HasSubstr("inside"));
    EXPECT_THAT(manifest("frames.csv", "file,spot_id\na.csv\n"), HasSubstr("line 2"));
    EXPECT_THAT(manifest("frames.csv", "file,spot_id\na.csv,\n"), HasSubstr("spot_id"));
    EXPECT_THAT(manifest("frames.csv", "file,spot_id\na.exe,S1\n"), HasSubstr("neither"));
    EXPECT_THAT(manifest("frames.csv", "file,spot_id,pose_file\na.csv,S1,none.txt\n"), HasSubstr("none.txt"));
    EXPECT_THAT(manifest("frames.csv", ""), HasSubstr("no frames"));
    EXPECT_THAT(manifest("spots.json", R"({"frames":[{"file":"a.csv"}]})"), HasSubstr("frames[0].spot_id"));
    EXPECT_THAT(manifest("spots.json", R"([1,2])"), HasSubstr("spots.json"));
    EXPECT_THAT(manifest("spots.json", R"({"frames":{}})"), HasSubstr("array"));
    EXPECT_THAT(manifest("spots.json",
                         R"({"frames":[{"file":"a.csv","spot_id":"S","base_from_flange":{"xyz":[1]}}]})"),
                HasSubstr("frames[0].base_from_flange"));
    EXPECT_EQ(
        manifest(
            "spots.json",
            R"({"frames":[{"file":"a.csv","spot_id":"S","base_from_flange":{"xyz":[1,2,3],"abc":[0,0,0]}}]})"),
        "accepted");
    DeviceSession session;
    EXPECT_THAT(open_sensor("replay", json{{"folder", "/nonexistent/x"}}, session).error().sentence(),
                HasSubstr("does not exist"));
    EXPECT_THAT(open_sensor("replay", json::object(), session).error().sentence(),
                HasSubstr("settings.folder"));
    EXPECT_THAT(open_sensor("replay", json::array(), session).error().sentence(), HasSubstr("object"));
    EXPECT_THAT(open_sensor("nothing", json::object(), session).error().sentence(), HasSubstr("replay"));
    EXPECT_THAT(open_robot("nothing", json::object(), session).error().sentence(), HasSubstr("replay"));
}

TEST(Replay, FullBuffersLoseNoRecordedFrame) {
    const TemporaryFolder folder;
    for (int i = 0; i < 5; ++i) folder.write(std::to_string(i) + ".csv", profile_text(i));
    DeviceSession session;
    auto sensor = open_sensor("replay", settings_of(folder, {{"buffers", 2}}), session);
    ASSERT_TRUE(sensor);
    ASSERT_TRUE((*sensor)->start());
    std::vector<FramePtr> held;
    for (int i = 0; i < 2; ++i) held.push_back(*(*sensor)->wait_next(1s));
    EXPECT_FALSE((*sensor)->wait_next(1ms));
    EXPECT_EQ((*sensor)->counters().underrun, 1U);
    held.clear();  // the newest stays with latest()
    for (int i = 2; i < 5; ++i) {
        const auto frame = (*sensor)->wait_next(1s);
        ASSERT_TRUE(frame);
        EXPECT_EQ((*frame)->profile.z_mm[0], i);
    }
}

TEST(Replay, LatestWhileAnotherThreadReads) {
    const TemporaryFolder folder;
    for (int i = 0; i < 50; ++i) folder.write(std::to_string(i) + ".csv", profile_text(i));
    DeviceSession session;
    auto sensor = open_sensor("replay", settings_of(folder), session);
    ASSERT_TRUE(sensor);
    ASSERT_TRUE((*sensor)->start());
    std::atomic<bool> done = false;
    std::jthread screen([&] {
        std::uint64_t newest = 0;
        while (!done) {
            if (const FramePtr frame = (*sensor)->latest()) {
                EXPECT_GE(frame->sequence, newest);
                newest = frame->sequence;
            }
            std::this_thread::sleep_for(100us);
        }
    });
    int frames = 0;
    while ((*sensor)->wait_next(1s)) ++frames;
    done = true;
    EXPECT_EQ(frames, 50);
}

TEST(ImageFile, RoundTripsAndRefusals) {
    const TemporaryFolder folder;
    for (const int depth : {8, 16}) {
        for (const char* extension : {"png", "tiff", "pgm"}) {
            const std::string name = std::string("a.") + extension;
            write_image(folder, name, 33, 17, depth);
            Frame frame;
            ASSERT_TRUE(read_image_file(folder.path() / name, frame));
            EXPECT_EQ(frame.image.bit_depth, depth);
            EXPECT_EQ(frame.image.width, 33);
            EXPECT_EQ(frame.image.height, 17);
            for (std::size_t i = 0; i < frame.pixels.size(); ++i) {
                ASSERT_EQ(frame.pixels[i], static_cast<std::byte>((i * 7) % 13));
            }
            const auto twelve = read_image_file(folder.path() / name, frame, 12);
            ASSERT_EQ(static_cast<bool>(twelve), depth == 16)
                << name;  // values up to 12 + 256 * 12 fit 12 bit
            if (depth == 16) {
                EXPECT_EQ(frame.image.bit_depth, 12);
                EXPECT_FALSE(read_image_file(folder.path() / name, frame, 10)) << "values too large";
            }
            EXPECT_FALSE(read_image_file(folder.path() / name, frame, 7));
        }
    }
    Frame frame;
    EXPECT_FALSE(read_image_file(folder.path(), frame));
    EXPECT_FALSE(read_image_file(folder.path() / "none.png", frame));
    // A header that promises 4 billion pixels.
    EXPECT_FALSE(read_image_file(folder.write("huge.pgm", "P5\n65535 65535\n255\n"), frame));
    EXPECT_TRUE(frame.image.empty());
    EXPECT_FALSE(write_image_file(folder.path() / "a.xyz", StripeImage{}));
}

TEST(Replay, RealFramesAndPoses) {
    const auto data = real_data();
    if (data.empty()) GTEST_SKIP() << "skipped: no real data";
    DeviceSession session;
    auto sensor = open_sensor(
        "replay", json{{"folder", (data / "etna/root").string()}, {"require_poses", true}}, session);
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    ASSERT_TRUE((*sensor)->start());
    int count = 0;
    while (const auto frame = (*sensor)->wait_next(1s)) {
        EXPECT_EQ((*frame)->status, FrameStatus::ok);
        EXPECT_EQ((*frame)->image.width, 1280);
        EXPECT_EQ((*frame)->image.height, 1024);
        EXPECT_TRUE((*frame)->base_from_flange);
        ++count;
    }
    EXPECT_EQ(count, 8);
    const auto dots = list_recording(data / "robot_cal_tools/test_set_10x10/images", "", true);
    ASSERT_TRUE(dots) << dots.error().sentence();
    EXPECT_EQ(dots->size(), 15U);
}

}  // namespace
}  // namespace seamwright
