// Car after car on the exact cell, with devices that come and go.

#include "projects/station/watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/projects/fake_cell.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Watching : public testing::Test {
  protected:
    void SetUp() override {
        cell->workobject_from_movedworkobject = make_pose(rotation_exp({0.006, -0.004, 0.009}), {3, -4, 2.5});
        station.reset();
        auto file = ProjectFile::create(folder / "cell.seam", cell->project, true);
        ASSERT_TRUE(file) << file.error().sentence();
        station.emplace(std::move(*file), cell->project);
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        sensors["A"] = std::make_unique<FakeSensor>(*cell);
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        robots["R1"] = std::make_unique<FakeRobot>(*cell);
        station->connect(std::move(sensors), std::move(robots));
        options.push = true;
        options.retry_first = std::chrono::milliseconds(1);
        options.retry_longest = std::chrono::milliseconds(4);
        options.tell = [this](const WatchEvent& e) {
            if (!std::holds_alternative<watched::SpotDone>(e.happening))
                told.push_back(fmt::format("{} {}", to_string(e.level), name_of(e.happening)));
            texts += e.text.english() + "\n";
        };
    }
    // Called when the part before is through.
    void part(const std::string& id) {
        cell->starts.push_back(StartSignal{id, now_ns()});
        cell->starts.push_back(device_error(ErrorCode::silence, kNoAnswer));
    }
    static std::int64_t now_ns() {
        return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
    }

    TemporaryFolder folder;
    std::unique_ptr<FakeCell> cell = make_fake_cell();
    std::optional<Station> station;
    WatchOptions options;
    std::vector<std::string> told;
    std::string texts;
};

TEST_F(Watching, PartAfterPart) {
    for (const char* id : {"CAR-1", "CAR-2", ""}) part(id);
    options.parts = 3;
    auto counts = watch(*station, options);
    ASSERT_TRUE(counts) << counts.error().sentence();
    EXPECT_EQ(counts->corrected, 3);
    EXPECT_THAT(told, ElementsAre("info start", "info run", "info start", "info run", "info start",
                                  "info run", "info stopped"));
    EXPECT_THAT(cell->verdicts, testing::Each(PartVerdict::corrected));
    const auto runs = station->file().runs();
    ASSERT_EQ(runs->size(), 3u);
    EXPECT_EQ(runs->at(1).part_id, "CAR-2");
    EXPECT_EQ(runs->at(2).part_id, "run 3");
}

TEST_F(Watching, RefusedPeersAreToldWhileWaiting) {
    cell->notices = {"1 connections of an unknown peer were refused, the last of 10.0.0.9:4711"};
    part("CAR-1");
    options.parts = 1;
    ASSERT_TRUE(watch(*station, options));
    EXPECT_THAT(told, ElementsAre("warning robot", "info start", "info run", "info stopped"));
    EXPECT_THAT(texts,
                HasSubstr("robot R1: 1 connections of an unknown peer were refused, the last of 10.0.0.9"));
}

TEST_F(Watching, SurvivesALostRobotAndTellsItOnce) {
    for (int i = 0; i < 4; ++i)
        cell->starts.push_back(device_error(ErrorCode::disconnected, kDisconnected, "127.0.0.1:7000"));
    part("CAR-1");
    options.parts = 1;
    auto counts = watch(*station, options);
    ASSERT_TRUE(counts) << counts.error().sentence();
    EXPECT_EQ(counts->lost, 1);
    EXPECT_EQ(counts->corrected, 1);
    EXPECT_THAT(told, ElementsAre("alarm lost", "info back", "info start", "info run", "info stopped"));
    EXPECT_THAT(texts,
                HasSubstr("robot R1 is lost: 127.0.0.1:7000: the connection was closed by the other side"));
    const auto events = station->file().events();
    EXPECT_EQ(std::count_if(events->begin(), events->end(),
                            [](const EventRecord& e) { return e.kind == EventKind::alarm; }),
              1);
}

TEST_F(Watching, OfSeveralCallsThatWaitTheNewestIsMeasured) {
    for (const char* id : {"CAR-1", "CAR-2", "CAR-3"}) cell->starts.push_back(StartSignal{id, now_ns()});
    options.parts = 1;
    auto counts = watch(*station, options);
    ASSERT_TRUE(counts) << counts.error().sentence();
    EXPECT_EQ(counts->missed, 2);
    EXPECT_EQ(counts->corrected, 1);
    EXPECT_EQ(station->file().runs()->at(0).part_id, "CAR-3");
    EXPECT_THAT(cell->verdicts, ElementsAre(PartVerdict::corrected))
        << "one verdict for the part that stands there";
    EXPECT_THAT(told,
                ElementsAre("warning missed", "warning missed", "info start", "info run", "info stopped"));
    EXPECT_THAT(texts, HasSubstr("part CAR-1: a newer call came before it was measured"));
    const auto events = station->file().events();
    EXPECT_EQ(std::count_if(events->begin(), events->end(),
                            [](const EventRecord& e) {
                                return e.kind == EventKind::refusal && e.subject == "robot R1";
                            }),
              2);
}

TEST_F(Watching, ACallThatMayBeTooOldIsRefusedSoThatTheLineGoesOn) {
    using std::chrono::seconds;
    const auto ago = [](seconds s) { return now_ns() - std::chrono::nanoseconds(s).count(); };
    // Heard this moment, but for a minute nobody has heard the controller at all.
    cell->starts.push_back(StartSignal{"CAR-1", now_ns(), ago(seconds(60))});
    cell->starts.push_back(device_error(ErrorCode::silence, kNoAnswer));
    // Heard long ago: the station was busy.
    cell->starts.push_back(StartSignal{"CAR-2", ago(seconds(30))});
    cell->starts.push_back(device_error(ErrorCode::silence, kNoAnswer));
    // A short outage: the same part stands there.
    cell->starts.push_back(StartSignal{"CAR-3", now_ns(), ago(seconds(2))});
    options.parts = 1;
    auto counts = watch(*station, options);
    ASSERT_TRUE(counts) << counts.error().sentence();
    EXPECT_EQ(counts->missed, 2);
    EXPECT_EQ(counts->parts, 1);
    EXPECT_EQ(station->file().runs()->at(0).part_id, "CAR-3");
    EXPECT_THAT(cell->verdicts,
                ElementsAre(PartVerdict::refused, PartVerdict::refused, PartVerdict::corrected));
    EXPECT_THAT(texts, HasSubstr("part CAR-1: the call may be 60 s old, another part may stand there"));
    options.start_expiry = seconds(100);
    cell->starts.push_back(StartSignal{"CAR-4", now_ns(), ago(seconds(60))});
    counts = watch(*station, options);
    ASSERT_TRUE(counts);
    EXPECT_EQ(counts->missed, 0);
    EXPECT_EQ(counts->corrected, 1);
}

TEST_F(Watching, SurvivesALostSensor) {
    cell->silent_sensor_at = "S3";
    int visits = 0;
    cell->on_trigger = [&](const std::string& spot) {
        if (spot == "S3" && ++visits == 2) cell->silent_sensor_at.clear();
    };
    part("CAR-1");
    part("CAR-2");
    options.parts = 2;
    auto counts = watch(*station, options);
    ASSERT_TRUE(counts);
    EXPECT_EQ(counts->failed, 1);
    EXPECT_EQ(counts->corrected, 1);
    EXPECT_THAT(cell->verdicts, ElementsAre(PartVerdict::failed, PartVerdict::corrected));
    EXPECT_THAT(told, ElementsAre("info start", "alarm run", "info start", "info run", "info stopped"));
}

// The line must not see a station ready for the next part whose camera is unplugged; its robot is answered all the same.
TEST_F(Watching, IsNotReadyWhileASensorIsDead) {
    cell->dead_sensor = true;
    std::vector<std::string> states;
    options.tell = [&](const WatchEvent& e) {
        if (std::holds_alternative<watched::SpotDone>(e.happening)) return;
        states.push_back(fmt::format("{} {}", name_of(e.happening), to_string(e.state)));
        texts += e.text.english() + "\n";
        if (states.size() == 5) cell->dead_sensor = false;
        if (std::holds_alternative<watched::Back>(e.happening)) part("CAR-3");
    };
    part("CAR-1");
    part("CAR-2");
    options.parts = 3;
    auto counts = watch(*station, options);
    ASSERT_TRUE(counts);
    EXPECT_EQ(counts->failed, 2);
    EXPECT_EQ(counts->corrected, 1);
    EXPECT_EQ(counts->lost, 1) << "one outage";
    EXPECT_THAT(cell->verdicts,
                ElementsAre(PartVerdict::failed, PartVerdict::failed, PartVerdict::corrected));
    EXPECT_THAT(states, ElementsAre("start measuring", "run lost", "lost lost", "start measuring", "run lost",
                                    "back waiting", "start measuring", "run waiting", "stopped stopped"));
    EXPECT_THAT(texts, HasSubstr("sensor A is lost: sensor A: the connection was closed by the other side"));
}

TEST_F(Watching, ARobotThatGoesWhileASensorIsDeadIsToldTooAndAllAreBackAtOnce) {
    cell->dead_sensor = true;
    part("CAR-1");
    for (int i = 0; i < 2; ++i)
        cell->starts.push_back(device_error(ErrorCode::disconnected, kDisconnected, "127.0.0.1:7000"));
    options.tell = [&, tell = options.tell](const WatchEvent& e) {
        tell(e);
        if (const auto* lost = std::get_if<watched::Lost>(&e.happening); lost && lost->device == "robot R1")
            cell->dead_sensor = false;
        if (std::holds_alternative<watched::Back>(e.happening)) part("CAR-2");
    };
    options.parts = 2;
    auto counts = watch(*station, options);
    ASSERT_TRUE(counts);
    EXPECT_EQ(counts->lost, 2);
    EXPECT_EQ(counts->corrected, 1);
    EXPECT_THAT(told, ElementsAre("info start", "alarm run", "alarm lost", "alarm lost", "info back",
                                  "info start", "info run", "info stopped"));
}

TEST_F(Watching, StopsInTheMiddleOfAPartAndTellsTheRobot) {
    std::stop_source stop;
    options.cancel = stop.get_token();
    cell->on_trigger = [&](const std::string& spot) {
        if (spot == "S4") stop.request_stop();
    };
    part("CAR-1");
    auto counts = watch(*station, options);
    ASSERT_TRUE(counts);
    EXPECT_EQ(counts->failed, 1);
    EXPECT_EQ(cell->writes, 0);
    EXPECT_THAT(cell->verdicts, ElementsAre(PartVerdict::failed));
    EXPECT_EQ(station->file().runs()->at(0).status, RunStatus::cancelled);
}

TEST_F(Watching, KeepsOnlySoManyRuns) {
    for (int i = 1; i <= 5; ++i) part("CAR-" + std::to_string(i));
    options.parts = 5;
    options.keep_runs = 2;
    ASSERT_TRUE(watch(*station, options));
    const auto runs = station->file().runs();
    ASSERT_EQ(runs->size(), 2u);
    EXPECT_EQ(runs->at(0).part_id, "CAR-4");
    EXPECT_EQ(runs->at(1).part_id, "CAR-5");
}

TEST_F(Watching, RobotWithoutStartSignalIsRefused) {
    cell->starts.push_back(usage_error("this robot has no start signal"));
    const auto counts = watch(*station, options);
    ASSERT_FALSE(counts);
    EXPECT_EQ(counts.error().kind, ErrorKind::usage);
}

TEST_F(Watching, WrongSettingsAreNotTriedAgain) {
    station->disconnect();  // the driver "fake" is in no registry
    const auto counts = watch(*station, options);
    ASSERT_FALSE(counts);
    EXPECT_THAT(counts.error().sentence(), HasSubstr("no sensor driver \"fake\""));
}

}  // namespace
}  // namespace seamwright
