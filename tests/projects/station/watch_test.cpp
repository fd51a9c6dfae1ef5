// Car after car on the exact cell, with devices that come and go.

#include "projects/station/watch.h"

#include <fmt/chrono.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ctime>

#include "projects/measure/nozzle.h"
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

// Nor one whose camera was unplugged while no part came: nobody calls, and it is not ready until the camera is back.
TEST_F(Watching, IsNotReadyWhileASensorIsGoneAndNoPartComes) {
    options.ask_sensors = std::chrono::milliseconds(1);
    std::vector<std::string> states;
    options.tell = [&](const WatchEvent& e) {
        if (std::holds_alternative<watched::SpotDone>(e.happening)) return;
        states.push_back(fmt::format("{} {}", name_of(e.happening), to_string(e.state)));
        texts += e.text.english() + "\n";
        if (const auto* lost = std::get_if<watched::Lost>(&e.happening)) {
            EXPECT_EQ(lost->device, "sensor A");
            EXPECT_EQ(lost->code, ErrorCode::disconnected);
        }
        if (std::holds_alternative<watched::Back>(e.happening)) part("CAR-1");
    };
    std::stop_source stop;
    options.cancel = stop.get_token();
    int waits = 0;
    options.alive = [&] {
        if (++waits == 20) cell->gone_sensor = true;
        if (waits == 60) cell->gone_sensor = false;
        if (waits == 5000) stop.request_stop();  // nobody has noticed
    };
    options.parts = 1;
    const auto counts = watch(*station, options);
    ASSERT_TRUE(counts);
    EXPECT_EQ(counts->lost, 1) << "one outage";
    EXPECT_EQ(counts->corrected, 1);
    EXPECT_THAT(states, ElementsAre("lost lost", "back waiting", "start measuring", "run waiting",
                                    "stopped stopped"));
    EXPECT_THAT(texts, HasSubstr("sensor A is lost: sensor A: the connection was closed by the other side"));
    const auto events = station->file().events();
    ASSERT_TRUE(events);
    EXPECT_TRUE(std::any_of(events->begin(), events->end(),
                            [](const EventRecord& e) { return e.kind == EventKind::alarm; }));
}

// Who calls meanwhile is told at once.
TEST_F(Watching, ACallWhileASensorIsGoneIsAnswered) {
    options.ask_sensors = std::chrono::milliseconds(1);
    cell->gone_sensor = true;
    std::stop_source stop;
    options.cancel = stop.get_token();
    int waits = 0;
    options.alive = [&] {
        if (++waits == 5000) stop.request_stop();  // nobody has noticed
    };
    options.tell = [&](const WatchEvent& e) {
        if (std::holds_alternative<watched::Lost>(e.happening)) part("CAR-1");
        if (std::holds_alternative<watched::RunDone>(e.happening)) cell->gone_sensor = false;
        if (std::holds_alternative<watched::Back>(e.happening)) part("CAR-2");
    };
    options.parts = 2;
    const auto counts = watch(*station, options);
    ASSERT_TRUE(counts);
    EXPECT_EQ(counts->failed, 1);
    EXPECT_EQ(counts->corrected, 1);
    EXPECT_THAT(cell->verdicts, ElementsAre(PartVerdict::failed, PartVerdict::corrected));
}

// The robot waits in front of a part that failed before its program went: refused once all answer, it calls again.
TEST_F(Watching, ARobotThatWasLeftInFrontOfAFailedPartIsLetCallAgain) {
    cell->dead_sensor = true;
    options.call_again_first = std::chrono::milliseconds(50);
    int done = 0;
    options.tell = [&](const WatchEvent& e) {
        if (!std::holds_alternative<watched::RunDone>(e.happening)) return;
        if (++done == 2) cell->dead_sensor = false;
    };
    cell->on_refused = [&] { part("CAR-1"); };  // as the robot programs do
    part("CAR-1");
    part("CAR-1");
    options.parts = 3;
    const auto counts = watch(*station, options);
    ASSERT_TRUE(counts);
    EXPECT_EQ(counts->failed, 2);
    EXPECT_EQ(counts->corrected, 1);
    EXPECT_THAT(cell->verdicts, ElementsAre(PartVerdict::failed, PartVerdict::failed, PartVerdict::refused,
                                            PartVerdict::corrected));
}

// What was measured in part has brought its robot to the end of its program: nothing is said to it a second time.
TEST_F(Watching, ARobotThatWentIsNotAskedToCallAgain) {
    cell->silent_sensor_at = "S3";
    options.call_again_first = std::chrono::milliseconds(1);
    part("CAR-1");
    std::stop_source stop;
    options.cancel = stop.get_token();
    int waits = 0;
    options.alive = [&] {
        if (!cell->verdicts.empty() && ++waits == 20) stop.request_stop();
    };
    ASSERT_TRUE(watch(*station, options));
    EXPECT_THAT(cell->verdicts, ElementsAre(PartVerdict::failed));
}

TEST_F(Watching, AVerdictThatDidNotArriveIsToldWhenTheRobotAnswers) {
    cell->silent_sensor_at = "S3";
    cell->deaf_to = PartVerdict::failed;
    options.call_again_first = std::chrono::milliseconds(20);
    std::stop_source stop;
    options.cancel = stop.get_token();
    int waits = 0;
    options.alive = [&] {
        if (cell->verdicts.size() == 3) cell->deaf_to.reset();
        if (cell->verdicts.size() > 3 && ++waits == 20) stop.request_stop();
    };
    part("CAR-1");
    ASSERT_TRUE(watch(*station, options));
    EXPECT_THAT(cell->verdicts, ElementsAre(PartVerdict::failed, PartVerdict::failed, PartVerdict::failed,
                                            PartVerdict::failed))
        << "until one arrives, and none after it";
    EXPECT_THAT(texts, HasSubstr("robot R1: told now how its part ended (failed)"));
}

// It has called anew meanwhile: what was to be said of the part before would be taken for this one's.
TEST_F(Watching, AVerdictThatDidNotArriveIsForgottenWithTheNextCall) {
    cell->silent_sensor_at = "S3";
    cell->deaf_to = PartVerdict::failed;
    options.call_again_first = std::chrono::milliseconds(1);
    options.parts = 2;
    options.tell = [&](const WatchEvent& e) {
        if (!std::holds_alternative<watched::RunDone>(e.happening)) return;
        if (!cell->silent_sensor_at.empty()) part("CAR-2");
        cell->silent_sensor_at.clear();
        cell->deaf_to.reset();
    };
    cell->starts.push_back(StartSignal{"CAR-1", now_ns()});  // and no silence, in which it would be told
    ASSERT_TRUE(watch(*station, options));
    EXPECT_THAT(cell->verdicts, ElementsAre(PartVerdict::failed, PartVerdict::corrected));
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

// Another program's edits: of an own connection.
void edit_file(const std::filesystem::path& path, const std::function<void(Project&)>& change) {
    auto file = ProjectFile::open(path);
    ASSERT_TRUE(file) << file.error().sentence();
    Project project = file->load().value();
    change(project);
    const auto saved = file->save(project);
    ASSERT_TRUE(saved) << saved.error().sentence();
}

TEST_F(Watching, ACollisionThatIsMarkedMeanwhileRefusesTheNextPart) {
    edit_file(folder / "cell.seam", [](Project& p) {
        const std::time_t yesterday = std::time(nullptr) - 24 * 3600;  // what is of this second is not older
        for (Calibration& c : p.calibrations)
            c.created_utc = fmt::format("{:%FT%TZ}", fmt::gmtime(yesterday));
        ASSERT_TRUE(mark_collision(p, "R1", {}));
    });
    part("CAR-1");
    options.parts = 1;
    auto counts = watch(*station, options);
    ASSERT_TRUE(counts) << counts.error().sentence();
    EXPECT_EQ(counts->refused, 1);
    EXPECT_EQ(cell->writes, 0);
    EXPECT_THAT(told, testing::Contains("warning project"));
    EXPECT_THAT(texts, HasSubstr("robots R1 was changed meanwhile by another program: from now on"));
    EXPECT_THAT(texts, HasSubstr("is older than the collision"));
    EXPECT_EQ(told.back(), "info stopped");
}

TEST_F(Watching, AnEditWhileAPartIsMeasuredRefusesItAndHoldsForTheNext) {
    cell->on_trigger = [&](const std::string&) {
        cell->on_trigger = nullptr;
        edit_file(folder / "cell.seam", [](Project& p) { p.regions[0].limits.translation_mm -= 0.5; });
    };
    for (const char* id : {"CAR-1", "CAR-2"}) part(id);
    options.parts = 2;
    const double limit_mm = cell->project.regions[0].limits.translation_mm;
    auto counts = watch(*station, options);
    ASSERT_TRUE(counts) << counts.error().sentence();
    EXPECT_THAT(cell->verdicts, ElementsAre(PartVerdict::refused, PartVerdict::corrected)) << texts;
    EXPECT_THAT(texts, HasSubstr("was changed meanwhile by another program: measure again"));
    EXPECT_EQ(station->project().regions[0].limits.translation_mm, limit_mm - 0.5);
}

// Devices that are others by then are connected anew.
TEST_F(Watching, EditedSettingsOfADeviceDisconnect) {
    edit_file(folder / "cell.seam", [](Project& p) { p.robots[0].settings["port"] = 7777; });
    const auto edits = station->follow_file();
    ASSERT_TRUE(edits) << edits.error().sentence();
    EXPECT_EQ(edits->size(), 1u);
    EXPECT_FALSE(station->connected());
    EXPECT_EQ(station->project().robots[0].settings["port"], 7777);
    EXPECT_TRUE(station->follow_file()->empty());
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
