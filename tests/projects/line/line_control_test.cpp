// A line beside a watched station: the exact cell, a Modbus server, a broker that is not there, and a PLC that is a thread
// with a socket.

#include "projects/line/line_control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "devices/net/socket.h"
#include "projects/reuse/part_type_edits.h"
#include "tests/devices/line/wait.h"
#include "tests/projects/fake_cell.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

// Reads and writes single words by functions 3 and 6.
class Plc {
  public:
    explicit Plc(int port)
        : wire_(TcpConnection::connect("127.0.0.1", static_cast<std::uint16_t>(port), 2s).value()) {}
    int read(int address) { return ask(3, address, 1, 11, 9); }
    int read32(int address) {
        return static_cast<int>(static_cast<std::uint32_t>(read(address)) << 16 |
                                static_cast<std::uint32_t>(read(address + 1)));
    }
    void write(int address, int value) { EXPECT_EQ(ask(6, address, value, 12, 10), value); }

  private:
    int ask(int function, int address, int value, std::size_t length, std::size_t at) {
        const auto low = [](int v) { return static_cast<std::byte>(v & 0xff); };
        const std::array<std::byte, 12> request{
            std::byte{0}, std::byte{1},  std::byte{0},      std::byte{0}, std::byte{0},    std::byte{6},
            std::byte{1}, low(function), low(address >> 8), low(address), low(value >> 8), low(value)};
        std::vector<std::byte> answer(length);
        if (!wire_.send(request, 2s) || !wire_.receive_exactly(answer, 2s)) return -1;
        return std::to_integer<int>(answer[at]) << 8 | std::to_integer<int>(answer[at + 1]);
    }
    TcpConnection wire_;
};

class LineWatched : public testing::Test {
  protected:
    void watch_with(std::vector<LineSetup> line, std::int64_t parts) {
        cell->workobject_from_movedworkobject = make_pose(rotation_exp({0.006, -0.004, 0.009}), {3, -4, 2.5});
        cell->project.line = std::move(line);
        auto file = ProjectFile::create(folder / "cell.seam", cell->project, true);
        ASSERT_TRUE(file) << file.error().sentence();
        station.emplace(std::move(*file), cell->project);
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        sensors["A"] = std::make_unique<FakeSensor>(*cell);
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        robots["R1"] = std::make_unique<FakeRobot>(*cell);
        station->connect(std::move(sensors), std::move(robots));
        auto opened = LineControl::open(station->project());
        ASSERT_TRUE(opened) << opened.error().sentence();
        control.emplace(std::move(*opened));
        const std::string described = control->described().front();
        port = std::stoi(described.substr(described.rfind(' ') + 1));
        options.push = true;
        options.parts = parts;
        options.cancel = stop.get_token();
        options.line = control->watch_line();
        options.tell = [this](const WatchEvent& e) {
            control->take(e);
            texts += e.text.english() + "\n";
        };
        // As the watching tells where it connects the station itself.
        control->take(
            {utc_now(), WatchLevel::info, watched::Connected{}, "connected", WatchState::waiting, {}});
        options.alive = [this] { control->alive(); };
    }
    static LineSetup server(const nlohmann::json& more = nlohmann::json::object(),
                            std::vector<int> types = {}) {
        nlohmann::json settings = {{"port", 0}, {"start", "line"}};
        settings.update(more);
        return {"plc", "modbus-server", true, settings, std::move(types)};
    }

    TemporaryFolder folder;
    std::unique_ptr<FakeCell> cell = make_fake_cell();
    std::optional<Station> station;
    std::optional<LineControl> control;
    WatchOptions options;
    std::stop_source stop;
    int port = 0;
    std::string texts;
};

TEST_F(LineWatched, ThePlcStartsPartsAndReadsWhatBecameOfThem) {
    watch_with({server(nlohmann::json::object(), {1, 2})}, 2);
    std::jthread line([&] {
        Plc plc(port);
        plc.write(1, 0);
        for (int n = 1; n <= 3; ++n) {
            EXPECT_TRUE(soon([&] { return plc.read(102) == 1; })) << "ready";
            plc.write(2, n == 2 ? 7 : 1);  // the second one is of a type that is none of this station's
            plc.write(5, 800 + n);
            plc.write(1, 1);
            EXPECT_TRUE(soon([&] { return plc.read(104) == 1; })) << "done";
            EXPECT_EQ(plc.read(103), 0);
            EXPECT_EQ(plc.read(109), 800 + n);
            if (n == 2) {
                EXPECT_EQ(plc.read(105), 8);
                EXPECT_EQ(plc.read(106), 32);
                EXPECT_EQ(plc.read(116), 0);
            } else {
                EXPECT_EQ(plc.read(105), 1) << "corrected";
                EXPECT_EQ(plc.read(106), 0);
                EXPECT_EQ(plc.read(121), 1);
                EXPECT_NEAR(plc.read32(122), 3000, 30);
                EXPECT_NEAR(plc.read32(124), -4000, 30);
                EXPECT_GT(plc.read32(134), 0) << "sigma";
            }
            plc.write(1, 0);
            EXPECT_TRUE(soon([&] { return plc.read(104) == 0 || n == 3; }));
        }
    });
    const auto counts = watch(*station, options);
    line.join();
    ASSERT_TRUE(counts) << counts.error().sentence();
    EXPECT_EQ(counts->corrected, 2);
    EXPECT_EQ(counts->missed, 1);
    EXPECT_THAT(texts, HasSubstr("its type 7 is none that is measured here"));
    const auto runs = station->file().runs();
    ASSERT_EQ(runs->size(), 2u);
    EXPECT_EQ(runs->at(0).part_id, "801");
    EXPECT_EQ(runs->at(1).part_id, "803");
}

// The number of the line's type is that of the project's.
TEST_F(LineWatched, ThePlcsTypeDecidesWhatIsMeasuredAndPushed) {
    Project& p = cell->project;
    p = *clone_part_type(*add_part_type(p, {"left", "", 1}), "left", {"right", "", 2});
    for (Spot& spot : p.spots) spot.reference_state = ReferenceState::measured;
    for (Region& region : p.regions)
        if (region.type_id == "right") region.base_from_frame.translation() += Eigen::Vector3d(0, 500, 0);
    watch_with({server(nlohmann::json::object(), {1, 2, 3})}, 2);
    const double left_mm = cell->frames.at("BASE_inner").translation().y();
    std::vector<std::pair<int, int>> done;  // result and alarm
    std::vector<double> y_mm;
    std::jthread line([&] {
        Plc plc(port);
        plc.write(1, 0);
        for (const int type :
             {1, 3, 0, 2}) {  // the station is set up for 3, the project does not know it; 0: not said
            EXPECT_TRUE(soon([&] { return plc.read(102) == 1; })) << "ready";
            plc.write(2, type);
            plc.write(5, 900 + type);
            plc.write(1, 1);
            EXPECT_TRUE(soon([&] { return plc.read(104) == 1; })) << "done";
            EXPECT_EQ(plc.read(107), type);
            done.emplace_back(plc.read(105), plc.read(106));
            y_mm.push_back(cell->frames.at("BASE_inner").translation().y());
            plc.write(1, 0);
            EXPECT_TRUE(soon([&] { return plc.read(104) == 0 || type == 2; }));
        }
    });
    const auto counts = watch(*station, options);
    line.join();
    ASSERT_TRUE(counts) << counts.error().sentence();
    EXPECT_EQ(counts->corrected, 2);
    EXPECT_EQ(counts->missed, 2);
    using Done = std::pair<int, int>;
    EXPECT_THAT(done, testing::ElementsAre(Done(1, 0), Done(8, 32), Done(8, 32), Done(1, 0)));
    ASSERT_EQ(y_mm.size(), 4u);
    EXPECT_NEAR(y_mm[0], left_mm, 25);
    EXPECT_EQ(y_mm[1], y_mm[0]);
    EXPECT_EQ(y_mm[2], y_mm[0]);
    EXPECT_NEAR(y_mm[3], left_mm + 500, 25);
    const auto runs = station->file().runs();
    ASSERT_EQ(runs->size(), 2u);
    EXPECT_EQ(runs->at(0).type_id, "left");
    EXPECT_EQ(runs->at(1).type_id, "right");
}

// The robots' calls start nothing where the line does, and end nothing but a part that waits for its application.
TEST_F(LineWatched, ARobotsCallIsTakenNoteOfAlone) {
    const auto now = [] {
        return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
    };
    for (int i = 0; i < 3; ++i) cell->starts.push_back(StartSignal{"ROBOT", now()});
    watch_with({server()}, 0);
    std::jthread line([&] {
        std::this_thread::sleep_for(300ms);
        stop.request_stop();
    });
    const auto counts = watch(*station, options);
    ASSERT_TRUE(counts);
    EXPECT_EQ(counts->parts, 0);
    EXPECT_TRUE(cell->verdicts.empty());
}

TEST_F(LineWatched, TheLinesWordsGoWithTheRobotsCall) {
    watch_with({server({{"start", "robot"}}, {3})}, 1);
    Plc plc(port);
    plc.write(1, 1);  // of no meaning here
    plc.write(2, 4);
    plc.write(5, 815);
    const auto now = std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
    cell->starts.push_back(StartSignal{"", now});
    cell->starts.push_back(device_error(ErrorCode::silence, kNoAnswer));
    cell->starts.push_back(device_error(ErrorCode::silence, kNoAnswer));
    std::jthread line([&] {
        EXPECT_TRUE(soon([&] { return plc.read(105) == 8; })) << "type 4 is refused";
        plc.write(2, 3);
        while (!stop.stop_requested() && plc.read(105) != 1) std::this_thread::sleep_for(5ms);
    });
    options.tell = [this, tell = options.tell, now](const WatchEvent& e) {
        tell(e);
        // The robot calls again once it was told.
        if (std::holds_alternative<watched::Missed>(e.happening)) {
            std::this_thread::sleep_for(100ms);
            cell->starts.push_back(StartSignal{"", now + 1});
        }
    };
    const auto counts = watch(*station, options);
    stop.request_stop();
    ASSERT_TRUE(counts) << counts.error().sentence();
    EXPECT_EQ(counts->missed, 1);
    EXPECT_EQ(counts->corrected, 1);
    EXPECT_THAT(cell->verdicts, testing::ElementsAre(PartVerdict::refused, PartVerdict::corrected));
    EXPECT_EQ(station->file().runs()->at(0).part_id, "815");
}

// The line fell behind: what it still says is of the part before.
TEST_F(LineWatched, WhatTheLineSaysOfAnotherPartIsNotTaken) {
    watch_with({server({{"start", "robot"}})}, 3);
    Plc plc(port);
    plc.write(2, 0);
    plc.write(5, 815);
    const auto call = [&](const char* id) {
        cell->starts.push_back(StartSignal{
            id, std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1)});
        cell->starts.push_back(device_error(ErrorCode::silence, kNoAnswer));
    };
    std::vector<LinePart> parts;
    options.tell = [&, tell = options.tell](const WatchEvent& e) {
        tell(e);
        if (!std::holds_alternative<watched::RunDone>(e.happening)) return;
        parts.push_back(control->state().part);
        if (parts.size() == 1) call("815");
        if (parts.size() == 2) call("816");
    };
    call("A7");  // by another name than the line's: nothing to be told from that
    const auto counts = watch(*station, options);
    ASSERT_TRUE(counts) << counts.error().sentence();
    ASSERT_EQ(parts.size(), 3U);
    EXPECT_EQ(parts[0].number, 815U);
    EXPECT_EQ(parts[1].number, 815U);
    EXPECT_EQ(parts[2], LinePart{});
    EXPECT_EQ(station->file().runs()->at(2).part_id, "816");
    EXPECT_THAT(texts,
                HasSubstr("line: part 816: the line speaks of part 815, nothing of that is taken for it"));
}

// A broker that is not there, a PLC that answers nobody: the parts take as long as without them.
TEST_F(LineWatched, WhoIsAwayDelaysNoPart) {
    const auto silent = TcpListener::listen("127.0.0.1", 0);
    std::uint16_t nobody = 0;
    {
        const auto gone = TcpListener::listen("127.0.0.1", 0);
        nobody = gone->port();
    }
    const auto parts = [&](std::vector<LineSetup> line) {
        station.reset();
        control.reset();
        line.insert(line.begin(), server({{"start", "robot"}}));
        watch_with(std::move(line), 10);
        const auto now = std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
        cell->starts.clear();
        for (int i = 0; i < 10; ++i) {
            cell->starts.push_back(StartSignal{"CAR", now});
            cell->starts.push_back(device_error(ErrorCode::silence, kNoAnswer));
        }
        const auto begun = std::chrono::steady_clock::now();
        const auto counts = watch(*station, options);
        EXPECT_TRUE(counts && counts->corrected == 10);
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    };
    const double alone = parts({});
    const double beside = parts({{"broker", "mqtt", true, {{"port", nobody}, {"reconnect_ms", 10}}, {}},
                                 {"other",
                                  "modbus-client",
                                  true,
                                  {{"address", "127.0.0.1"}, {"port", silent->port()}, {"timeout_ms", 5000}},
                                  {}}});
    RecordProperty("alone_ms", static_cast<int>(1000 * alone));
    RecordProperty("beside_ms", static_cast<int>(1000 * beside));
    EXPECT_LT(beside, alone + 3) << "ten parts waited for a time-out of 5 s";
    EXPECT_THAT(texts, HasSubstr("the broker at 127.0.0.1"));
}

TEST_F(LineWatched, TwoThatStartAreRefused) {
    Project project;
    project.name = "door";
    project.line = {server(), server()};
    project.line[1].id = "other";
    const auto opened = LineControl::open(project);
    ASSERT_FALSE(opened);
    EXPECT_THAT(opened.error().sentence(), HasSubstr("starts the parts, and so does"));
    project.line[1].enabled = false;
    EXPECT_TRUE(LineControl::open(project));
    project.line[0].settings["port"] = "no number";
    EXPECT_FALSE(LineControl::open(project));
    project.line.clear();
    EXPECT_TRUE(LineControl::open(project)->empty());
}

TEST(LineCodes, EveryStatusHasItsResultAndEveryNumberItsLine) {
    std::set<int> numbers;
    for (const LineCode& c : line_alarms()) EXPECT_TRUE(numbers.insert(c.number).second);
    for (const RunStatus status :
         {RunStatus::interrupted, RunStatus::pushed, RunStatus::ok, RunStatus::refused, RunStatus::not_taken,
          RunStatus::alarm, RunStatus::device, RunStatus::cancelled}) {
        RunRecord run;
        run.status = status;
        run.push = true;
        const LineResult result = line_result(run);
        EXPECT_EQ(result == LineResult::corrected, status == RunStatus::ok);
        EXPECT_TRUE(numbers.count(static_cast<int>(line_alarm(result))));
        run.push = false;
        EXPECT_NE(line_result(run), LineResult::corrected) << "nothing was written";
    }
    for (const ErrorCode code :
         {ErrorCode::none, ErrorCode::silence, ErrorCode::disconnected, ErrorCode::in_use})
        EXPECT_TRUE(numbers.count(static_cast<int>(line_alarm(code))));
}

}  // namespace
}  // namespace seamwright
