// The capture file and the recorder.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <zlib.h>

#include <array>
#include <fstream>
#include <random>

#include "devices/silence.h"
#include "tests/devices/capture/capture_frames.h"

namespace seamwright {
namespace {

using namespace capture_test;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

TEST(Capture, EveryBitComesBack) {
    const auto path = make_capture("bits.seam", 500, true);
    auto reader = CaptureReader::open(path);
    ASSERT_TRUE(reader) << reader.error().sentence();
    ASSERT_EQ(reader->sources().size(), 2u);
    const CaptureSource* a = reader->find("A", SourceKind::sensor);
    const CaptureSource* b = reader->find("B", SourceKind::sensor);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->model, "model A");
    EXPECT_EQ(b->serial, "2");
    EXPECT_EQ(reader->end(), "stopped");
    EXPECT_FALSE(reader->finished_utc().empty());
    EXPECT_EQ(reader->frames(a->id), 500u);
    Frame frame;
    for (std::uint64_t n = 0; n < 500; ++n) {
        fill(frame, n);
        auto c = reader->frame(a->id, n);
        ASSERT_TRUE(c) << c.error().sentence();
        expect_same(**c, frame);
        EXPECT_EQ((*c)->host_time_ns, frame.host_time_ns);
    }
    fill(frame, 1250);  // not in order
    auto c = reader->frame(b->id, 250);
    ASSERT_TRUE(c);
    expect_same(**c, frame);
    EXPECT_FALSE(reader->frame(a->id, 500));
    const auto spots = reader->spots(a->id);
    ASSERT_TRUE(spots);
    ASSERT_EQ(spots->size(), 100u);
    EXPECT_EQ((*spots)[7], (std::pair<std::uint64_t, std::string>(35, "S1")));
    EXPECT_TRUE(reader->check().empty());
    EXPECT_EQ(seam_file_kind(path), SeamFile::capture);
    // A second recording may not take the name of the first.
    const auto again = Recorder::create(path);
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().kind, ErrorKind::file);
}

TEST(Capture, ARepeatedXIsStoredOnce) {
    FrameBlock block;
    Frame frame;
    fill(frame, 1, 1000);
    ASSERT_TRUE(block.append(frame, nullptr, false));
    const std::size_t one = block.bytes();
    fill(frame, 2, 1000);
    ASSERT_TRUE(block.append(frame, nullptr, false));
    EXPECT_LT(block.bytes() - one, 13'000u);  // z and intensity, not x
    fill(frame, 7, 1000);                     // x differs
    ASSERT_TRUE(block.append(frame, nullptr, false));
    fill(frame, 8, 900);  // another length
    ASSERT_TRUE(block.append(frame, nullptr, false));
    std::vector<Capture> out;
    ASSERT_TRUE(unpack_frames(block.finish(), "test", out));
    ASSERT_EQ(out.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
        fill(frame, std::array<std::uint64_t, 4>{1, 2, 7, 8}[i], i == 3 ? 900 : 1000);
        expect_same(out[i], frame);
    }
}

TEST(Capture, ImagesWithPaddedRowsAndCandidates) {
    for (const bool compress : {false, true}) {
        RecorderOptions options;
        options.images = true;
        options.compress = compress;
        const auto path = fresh_path("images.seam");
        auto recorder = Recorder::create(path, options);
        ASSERT_TRUE(recorder);
        const auto a = (*recorder)->add_sensor("cam", {});
        ASSERT_TRUE(a);
        Frame frame;
        frame.pixels.resize(48 * 20);
        for (std::size_t i = 0; i < frame.pixels.size(); ++i)
            frame.pixels[i] = static_cast<std::byte>(i * 31 / 7);
        frame.image = {frame.pixels.data(), 20, 20, 48, 12};
        ProfileCandidates candidates;
        candidates.lines = 2;
        candidates.per_line = 2;
        candidates.count = {2, 0};
        candidates.x_mm = {1, 2, 0, 0};
        candidates.z_mm = {3, 4, 0, 0};
        candidates.intensity = {5, 6, 0, 0};
        for (int n = 0; n < 300; ++n) {
            frame.sequence = static_cast<std::uint64_t>(n);
            (*recorder)->frame(*a, frame, &candidates);
        }
        ASSERT_TRUE((*recorder)->finish());
        auto reader = CaptureReader::open(path);
        ASSERT_TRUE(reader);
        auto c = reader->frame(*a, 299);
        ASSERT_TRUE(c) << c.error().sentence();
        ASSERT_TRUE((*c)->image);
        EXPECT_EQ((*c)->image->width, 20);
        EXPECT_EQ((*c)->image->bit_depth, 12);
        ASSERT_EQ((*c)->image->pixels.size(), 800u);
        for (std::size_t y = 0; y < 20; ++y)
            EXPECT_EQ(std::memcmp((*c)->image->pixels.data() + y * 40, frame.pixels.data() + y * 48, 40), 0);
        EXPECT_EQ((*c)->candidates.z_mm[1], 4);
        EXPECT_TRUE(reader->check().empty());
        if (compress) {
            EXPECT_LT(fs::file_size(path), 250'000u);  // raw: 300 x 800 bytes and more
        }
    }
}

TEST(Capture, GapsAndDropsAreCountedApart) {
    const auto path = fresh_path("counts.seam");
    RecorderOptions options;
    options.images = true;
    options.queue_mib = 4;
    auto recorder = Recorder::create(path, options);
    ASSERT_TRUE(recorder);
    const auto a = (*recorder)->add_sensor("A", {});
    ASSERT_TRUE(a);
    EXPECT_FALSE((*recorder)->add_sensor("A", {}));  // the name is taken
    Frame frame;
    for (const std::uint64_t n : {0u, 1u, 5u, 6u, 9u}) {
        fill(frame, n);
        (*recorder)->frame(*a, frame);
    }
    frame.pixels.resize(5 << 20);  // more than may wait for the disk
    frame.image = {frame.pixels.data(), 5120, 1024, 5120, 8};
    frame.sequence = 10;
    (*recorder)->frame(*a, frame);
    const auto status = (*recorder)->finish();
    ASSERT_TRUE(status);
    const CaptureCounters& c = status->sources.at("A");
    EXPECT_EQ(c.frames, 5u);
    EXPECT_EQ(c.lost, 5u);
    EXPECT_EQ(c.dropped, 1u);
    EXPECT_EQ(c.damaged, 1u);  // sequence 5
    auto reader = CaptureReader::open(path);
    ASSERT_TRUE(reader);
    const CaptureCounters& stored = reader->sources()[0].counters;
    EXPECT_EQ(stored.frames, 5u);
    EXPECT_EQ(stored.lost, 5u);
    EXPECT_EQ(stored.dropped, 1u);
    EXPECT_EQ(stored.damaged, 1u);
}

TEST(Capture, WithoutRoomForMoreEveryFrameIsAccountedFor) {
    const auto path = fresh_path("burst.seam");
    RecorderOptions options;
    options.queue_mib = 4;
    auto recorder = Recorder::create(path, options);
    ASSERT_TRUE(recorder);
    const auto a = (*recorder)->add_sensor("A", {});
    Frame frame;
    fill(frame, 0, 2048);
    for (std::uint64_t n = 0; n < 3000; ++n) {
        frame.sequence = n;
        (*recorder)->frame(*a, frame);
    }
    const auto status = (*recorder)->finish();
    ASSERT_TRUE(status);
    const CaptureCounters& c = status->sources.at("A");
    EXPECT_EQ(c.frames + c.dropped, 3000u);
    EXPECT_GT(c.frames, 50u);
    auto reader = CaptureReader::open(path);
    ASSERT_TRUE(reader);
    EXPECT_EQ(reader->frames(*a), c.frames);
    EXPECT_EQ(reader->sources()[0].counters.dropped, c.dropped);
    EXPECT_TRUE(reader->check().empty());
}

TEST(Capture, AFullDiskEndsItAndKeepsWhatWasWritten) {
    const auto path = fresh_path("full.seam");
    RecorderOptions options;
    options.limit_bytes = 6 << 20;
    options.flush_ms = 10;
    auto recorder = Recorder::create(path, options);
    ASSERT_TRUE(recorder);
    const auto a = (*recorder)->add_sensor("A", {});
    Frame frame;
    std::uint64_t pushed = 0;
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!(*recorder)->status().failure && std::chrono::steady_clock::now() < until) {
        fill(frame, pushed++, 2048);
        (*recorder)->frame(*a, frame);
        if (pushed % 16 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    for (int i = 0; i < 10; ++i, ++pushed) (*recorder)->frame(*a, frame);
    const auto done = (*recorder)->finish();
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().kind, ErrorKind::file);
    EXPECT_THAT(done.error().sentence(), HasSubstr("the disk is full"));
    const CaptureCounters c = (*recorder)->status().sources.at("A");
    EXPECT_EQ(c.frames + c.dropped, pushed);
    auto reader = CaptureReader::open(path);
    ASSERT_TRUE(reader) << reader.error().sentence();
    EXPECT_GT(reader->frames(*a), 0u);
    EXPECT_EQ(reader->frames(*a), c.frames);
    EXPECT_TRUE(reader->finished_utc().empty());
    EXPECT_TRUE(reader->check().empty());
    EXPECT_LE(fs::file_size(path), options.limit_bytes);
}

TEST(Capture, KilledAtAnyInstantItOpensWithWhatWasCommitted) {
    std::mt19937 random(4);
    for (int round = 0; round < 4; ++round) {
        const auto path = fresh_path("killed.seam");
        const pid_t child = ::fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            RecorderOptions options;
            options.flush_ms = 10;
            auto recorder = Recorder::create(path, options);
            if (!recorder) ::_exit(1);
            const auto a = (*recorder)->add_sensor("A", {});
            Frame frame;
            for (std::uint64_t n = 0;; ++n) {
                fill(frame, n, 1024);
                (*recorder)->frame(*a, frame);
                if (n % 8 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(300 + random() % 150));
        ::kill(child, SIGKILL);
        int status = 0;
        ::waitpid(child, &status, 0);
        ASSERT_TRUE(WIFSIGNALED(status));
        auto reader = CaptureReader::open(path);
        ASSERT_TRUE(reader) << reader.error().sentence();
        EXPECT_TRUE(reader->finished_utc().empty());
        ASSERT_EQ(reader->sources().size(), 1u);
        const std::int64_t a = reader->sources()[0].id;
        ASSERT_GT(reader->frames(a), 0u);
        EXPECT_TRUE(reader->check().empty());
        Frame frame;
        fill(frame, reader->frames(a) - 1, 1024);
        auto last = reader->frame(a, reader->frames(a) - 1);
        ASSERT_TRUE(last);
        expect_same(**last, frame);
    }
}

void expect_refused(const fs::path& path, const std::string& words) {
    const auto reader = CaptureReader::open(path);
    ASSERT_FALSE(reader) << words;
    EXPECT_EQ(reader.error().kind, ErrorKind::file);
    EXPECT_THAT(reader.error().sentence(), HasSubstr(words));
}

void change(const fs::path& path, const std::string& sql) {
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(path.c_str(), &db), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(db, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(db);
    sqlite3_close(db);
}

TEST(Capture, WhatIsNoSoundCaptureIsRefusedInWords) {
    expect_refused(fresh_path("absent.seam"), "does not exist");
    const auto text = fresh_path("text.seam");
    std::ofstream(text)
        << "this is a text, long enough to be taken for a header of a database, which it is not at "
           "all, and it goes on for a while";
    expect_refused(text, "this is no capture");
    const auto empty = fresh_path("empty.seam");
    std::ofstream(empty).flush();
    expect_refused(empty, "the file is empty");
    const auto project = fresh_path("project.seam");
    change(project,
           "PRAGMA application_id = " + std::to_string(kProjectApplicationId) + "; CREATE TABLE t(a)");
    expect_refused(project, "this is a project, no recorded capture");
    const auto other = fresh_path("other.seam");
    change(other, "PRAGMA application_id = 17; CREATE TABLE t(a)");
    expect_refused(other, "another program's database");
    const auto newer = make_capture("newer.seam", 5);
    change(newer, "PRAGMA user_version = 99");
    expect_refused(newer, "has version 99");
    const auto planted = make_capture("planted.seam", 5);
    change(planted, "CREATE TRIGGER t AFTER INSERT ON blocks BEGIN DELETE FROM blocks; END");
    expect_refused(planted, "its tables are not those of a capture");
    const auto gap = make_capture("gap.seam", 5);
    change(gap, "UPDATE blocks SET first = 3");
    expect_refused(gap, "does not fit in");
    const auto cut = make_capture("cut.seam", 200);
    fs::resize_file(cut, fs::file_size(cut) - 1000);
    expect_refused(cut, "cut short");
    fs::resize_file(cut, fs::file_size(cut) - 40'000);
    expect_refused(cut, "damaged");
}

TEST(Capture, AFlippedBitIsFoundWhereItIs) {
    const auto path = make_capture("flipped.seam", 2000);
    // In the middle of the file lies a block's payload.
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    const auto at = static_cast<std::streamoff>(fs::file_size(path) / 2);
    file.seekg(at);
    const char byte = static_cast<char>(file.get() ^ 0x10);
    file.seekp(at);
    file.put(byte);
    file.close();
    auto reader = CaptureReader::open(path);
    ASSERT_TRUE(reader) << reader.error().sentence();
    const std::int64_t a = reader->sources()[0].id;
    std::size_t failed = 0;
    for (std::uint64_t n = 0; n < reader->frames(a); ++n)
        if (const auto frame = reader->frame(a, n); !frame) {
            ++failed;
            EXPECT_THAT(frame.error().sentence(), HasSubstr("damaged"));
        }
    EXPECT_GT(failed, 0u);
    EXPECT_LT(failed, 2000u);  // the other blocks are read
    EXPECT_FALSE(reader->check().empty());
}

TEST(Capture, BlocksThatLieAboutTheirSizesTakeNoMemory) {
    std::vector<Capture> out;
    FrameBlock block;
    Frame frame;
    fill(frame, 3);
    ASSERT_TRUE(block.append(frame, nullptr, true));
    const auto whole = block.finish();
    for (std::size_t cut = 0; cut < whole.size(); ++cut) {
        out.clear();
        EXPECT_FALSE(unpack_frames(whole.first(cut), "cut", out)) << cut;
    }
    // The same with a checksum that fits.
    for (std::size_t at = 16; at + 4 < whole.size(); at += 3) {
        std::vector<std::byte> forged(whole.begin(), whole.end());
        std::memset(forged.data() + at, 0xff, 4);
        const auto crc = static_cast<std::uint32_t>(crc32(
            0, reinterpret_cast<const Bytef*>(forged.data() + 16), static_cast<uInt>(forged.size() - 16)));
        std::memcpy(forged.data() + 12, &crc, 4);
        out.clear();
        (void)unpack_frames(forged, "forged", out);  // either way, without a crash
        EXPECT_LE(out.size(), 1u);
    }
}

// A sensor that delivers numbered frames as fast as they are asked for, or is silent, or fails.
class NumberedSensor final : public ProfileSource {
  public:
    explicit NumberedSensor(std::uint64_t frames) : frames_(frames), pool_(8) {}
    bool started = false, refuses = false, fails = false;
    std::atomic<int> failed = 0;
    SensorIdentity identity() const override { return {"test", "", "", ""}; }
    Expected<void> start() override {
        if (refuses) return device_error("it does not start", "sensor");
        started = true;
        return {};
    }
    void stop() override { started = false; }
    Expected<void> trigger(const std::string&) override { return {}; }
    Expected<FramePtr> wait_next(std::chrono::milliseconds timeout) override {
        if (fails) {
            ++failed;
            return device_error("the cable is out", "sensor");
        }
        if (next_ == frames_) {
            std::this_thread::sleep_for(timeout);
            return device_error(ErrorCode::silence, std::string(kNoAnswer) + ": no frame", "sensor");
        }
        FramePtr frame = pool_.acquire();
        fill(*frame, next_++);
        return frame;
    }
    FramePtr latest() const override { return nullptr; }
    SourceCounters counters() const override { return {}; }
    std::vector<ParameterInfo> parameters() const override { return {}; }
    Expected<double> get(const std::string&) const override { return 0.0; }
    Expected<void> set(const std::string&, double) override { return {}; }

  private:
    std::uint64_t frames_, next_ = 0;
    FramePool pool_;
};

TEST(RecordingSession, PumpsUntilStoppedWithinASecond) {
    const auto path = fresh_path("session.seam");
    auto made = Recorder::create(path);
    ASSERT_TRUE(made);
    std::shared_ptr<Recorder> recorder = std::move(*made);
    NumberedSensor a(400), b(0), c(0);
    c.fails = true;
    const auto sa = recorder->add_sensor("A", {}), sb = recorder->add_sensor("B", {}),
               sc = recorder->add_sensor("C", {});
    auto session = RecordingSession::start(
        recorder, {{*sa, &a, nullptr, 0}, {*sb, &b, nullptr, 0}, {*sc, &c, nullptr, 0}}, {});
    ASSERT_TRUE(session);
    EXPECT_TRUE(a.started && b.started);
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (((*session)->frames() < 400 || c.failed < 2) && std::chrono::steady_clock::now() < until)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const auto before = std::chrono::steady_clock::now();
    (*session)->stop();
    const auto status = recorder->finish();
    EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(1));
    ASSERT_TRUE(status);
    EXPECT_FALSE(a.started || b.started);
    EXPECT_EQ(status->sources.at("A").frames, 400u);
    auto reader = CaptureReader::open(path);
    ASSERT_TRUE(reader);
    Frame frame;
    fill(frame, 399);
    expect_same(**reader->frame(*sa, 399), frame);
    // What failed is told once.
    const auto events = reader->events(*sc);
    ASSERT_TRUE(events);
    ASSERT_EQ(events->size(), 1u);
    EXPECT_THAT((*events)[0].text, HasSubstr("the cable is out"));
}

TEST(RecordingSession, ASensorThatDoesNotStartEndsItAndStopsTheOthers) {
    auto made = Recorder::create(fresh_path("refused.seam"));
    std::shared_ptr<Recorder> recorder = std::move(*made);
    NumberedSensor a(0), b(0);
    b.refuses = true;
    const auto sa = recorder->add_sensor("A", {}), sb = recorder->add_sensor("B", {});
    const auto session =
        RecordingSession::start(recorder, {{*sa, &a, nullptr, 0}, {*sb, &b, nullptr, 0}}, {});
    ASSERT_FALSE(session);
    EXPECT_THAT(session.error().sentence(), HasSubstr("it does not start"));
    EXPECT_FALSE(a.started);
}

}  // namespace
}  // namespace seamwright
