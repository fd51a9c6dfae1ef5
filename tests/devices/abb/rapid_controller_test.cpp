// The driver against the delivered RAPID, executed: permission, calls, parts in a row.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "devices/abb/program.h"
#include "devices/abb/rapid.h"
#include "devices/abb/rapid_message.h"
#include "devices/controllers/abb/controller.h"
#include "devices/silence.h"
#include "devices/simulated/cell.h"

namespace seamwright {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

std::vector<MeasuringMove> spots(int count, bool with_via = false) {
    std::vector<MeasuringMove> moves;
    for (int i = 0; i < count; ++i) {
        MeasuringMove m;
        m.spot_id = "S" + std::to_string(i + 1);
        m.trigger = make_pose(rotation_exp({0.1 * i, 0.2, -0.3}), {800.0 + 10 * i, -200.123, 600});
        m.entry = m.exit = m.trigger;
        m.entry.translation().y() -= 15;
        m.exit.translation().y() += 15;
        m.stop_at_trigger = i == 2;
        if (with_via) {
            m.via = {m.entry};
            m.via[0].translation().z() += 40;
        }
        moves.push_back(m);
    }
    return moves;
}

// A folder of programs of its own, gone afterwards.
struct ProgramFolder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("abb-programs-" + std::to_string(::getpid()));
    ProgramFolder() { std::filesystem::create_directories(path); }
    ~ProgramFolder() { std::filesystem::remove_all(path); }
};

class AbbController : public testing::Test {
  protected:
    std::shared_ptr<SimulatedCell> cell = *SimulatedCell::open(
        {{"optics", {{"width", 64}, {"height", 64}}},
         {"robot", {{"frames", {{"BASE_left", {{"xyz", {700, -200, 550}}, {"abc", {5, 0, 0}}}}}}}}});
    std::unique_ptr<AbbRapidController> controller;
    std::unique_ptr<RobotLink> link;
    std::vector<MeasuringMove> program = spots(3);

    void start(nlohmann::json settings = nlohmann::json::object()) {
        cell->store_program(program);
        settings["time_scale"] = 3;
        auto started = start_abb_rapid_controller(cell, settings);
        ASSERT_TRUE(started) << started.error().sentence();
        controller = std::move(*started);
        connect();
    }
    void connect() {
        DeviceSession session;
        link = *open_abb_rapid({{"port", controller->port()}, {"timeout_ms", 1000}, {"backoff_ms", 10}},
                               session);
    }
    void TearDown() override {
        link.reset();
        if (!controller) return;
        for (const std::string& message : controller->messages())
            EXPECT_THAT(message, testing::Not(HasSubstr("the task stands")));
    }
    Expected<void> start_measuring() {
        Expected<void> started = device_error("not tried");
        for (int i = 0; i < 50 && !started; ++i) {
            started = link->start_measuring(program);
            if (!started) std::this_thread::sleep_for(milliseconds(50));
        }
        return started;
    }
    int triggers_to_the_end() {
        int count = 0;
        for (;; ++count) {
            auto trigger = link->wait_trigger(milliseconds(5000));
            if (!trigger) {
                EXPECT_EQ(trigger.error().what, "the measuring program has ended");
                return count;
            }
            const MeasuringMove& move = program[static_cast<std::size_t>(count)];
            EXPECT_EQ(trigger->spot_id, move.spot_id);
            EXPECT_LT(distance_mm(*trigger->base_from_flange, move.trigger), 1e-3) << "the programmed point";
        }
    }
    bool becomes(Permission wanted, int ms = 3000) {
        for (int i = 0; i < ms / 10; ++i) {
            auto now = link->permission();
            if (now && *now == wanted) return true;
            std::this_thread::sleep_for(milliseconds(10));
        }
        return false;
    }
    bool eventually(const std::function<bool()>& yes, int ms = 3000) {
        for (int i = 0; i < ms / 5; ++i) {
            if (yes()) return true;
            std::this_thread::sleep_for(milliseconds(5));
        }
        return false;
    }
    const Pose corrected = make_pose(rotation_exp({0, 0, 0.1}), {701.5, -199, 551});
};

TEST_F(AbbController, WholePartsAreMeasuredReleasedAndRun) {
    start();
    for (int part = 1; part <= 3; ++part) {
        SCOPED_TRACE(part);
        const std::string id = "CAR-" + std::to_string(part);
        controller->press_start(PartId(id));
        auto call = link->wait_start(milliseconds(5000));
        ASSERT_TRUE(call) << call.error().sentence();
        EXPECT_EQ(call->part_id, id);
        auto started = start_measuring();
        ASSERT_TRUE(started) << started.error().sentence();
        EXPECT_EQ(link->permission(), Permission::none);
        EXPECT_EQ(triggers_to_the_end(), 3);
        ASSERT_TRUE(link->write_frame("BASE_left", corrected));
        EXPECT_FALSE(controller->released());
        ASSERT_TRUE(link->confirm(PartVerdict::corrected, "fits"));
        EXPECT_TRUE(becomes(Permission::taken)) << "the application waits for it";
        EXPECT_TRUE(controller->released());
        EXPECT_LT(distance_mm(*cell->read_frame("BASE_left"), corrected), 1e-3);
        EXPECT_TRUE(eventually([&] { return controller->number("T_ROB1", "simBeads") == part; }))
            << "the bead is laid";
    }
}

// However close behind the last part the next one is called for.
TEST_F(AbbController, ACallIsNeverLost) {
    program = spots(1);
    start();
    ASSERT_TRUE(start_measuring());
    for (int part = 1; part <= 12; ++part) {
        SCOPED_TRACE(part);
        // The line calls while the program ends, just before, or just after: the application sees it at once.
        std::thread line([&] {
            eventually([&] { return controller->number("T_ROB1", "swFired") == 1; });
            std::this_thread::sleep_for(milliseconds(part * 7));
            controller->press_start(PartId("CAR-" + std::to_string(part)));
        });
        EXPECT_EQ(triggers_to_the_end(), 1);
        EXPECT_TRUE(link->confirm(PartVerdict::refused, "next"));
        line.join();
        auto call = link->wait_start(milliseconds(5000));
        ASSERT_TRUE(call) << call.error().sentence();
        EXPECT_EQ(call->part_id, "CAR-" + std::to_string(part));
        EXPECT_FALSE(link->wait_start(milliseconds(20))) << "told once";
        auto started = link->start_measuring(program);
        ASSERT_TRUE(started) << "who calls waits: " << started.error().sentence();
    }
}

// What the application asks for at the end of SW_Measure is told after that end, never before.
TEST_F(AbbController, TheEndIsToldBeforeTheNextCall) {
    program = spots(1);
    start({{"application_wait_ms", 0}});
    ASSERT_TRUE(start_measuring());
    // The application is told that the part is refused and another one waits, before the program has ended.
    ASSERT_TRUE(link->confirm(PartVerdict::refused, ""));
    controller->press_start(PartId("CAR-2"));
    auto trigger = link->wait_trigger(milliseconds(5000));
    ASSERT_TRUE(trigger) << trigger.error().sentence();
    auto end = link->wait_trigger(milliseconds(5000));
    ASSERT_FALSE(end);
    EXPECT_EQ(end.error().what, "the measuring program has ended");
    auto call = link->wait_start(milliseconds(2000));
    ASSERT_TRUE(call) << call.error().sentence();
    EXPECT_EQ(call->part_id, "CAR-2");
}

TEST_F(AbbController, ACallDuringAnOutageIsToldWhenTheLinkIsBackWhileTheRobotWaits) {
    start();
    ASSERT_TRUE(link->mode());
    link.reset();
    controller->press_start(PartId("CAR-7"));
    std::this_thread::sleep_for(milliseconds(300));
    connect();
    auto call = link->wait_start(milliseconds(5000));
    ASSERT_TRUE(call) << call.error().sentence();
    EXPECT_EQ(call->part_id, "CAR-7");
    // Lost again before it was measured: told again.
    link.reset();
    connect();
    call = link->wait_start(milliseconds(5000));
    ASSERT_TRUE(call) << call.error().sentence();
    ASSERT_TRUE(start_measuring());
    EXPECT_FALSE(link->wait_start(milliseconds(100)));
    triggers_to_the_end();
}

TEST_F(AbbController, MeasuringIsRefusedWhileNoProgramWaits) {
    start();
    ASSERT_TRUE(start_measuring());
    triggers_to_the_end();
    // The application has the permission and lays its bead.
    ASSERT_TRUE(link->confirm(PartVerdict::corrected, ""));
    ASSERT_TRUE(becomes(Permission::taken));
    EXPECT_FALSE(link->confirm(PartVerdict::failed, "")) << "it cannot be taken back any more";
    EXPECT_TRUE(controller->released());
    auto refused = link->start_measuring(program);
    if (!refused) {
        EXPECT_THAT(refused.error().sentence(), HasSubstr("no program of the robot waits in SW_Measure"));
    }
    ASSERT_TRUE(refused || start_measuring()) << "after the bead it waits again";
    EXPECT_FALSE(controller->released()) << "the next part";
    triggers_to_the_end();
}

TEST_F(AbbController, ALostLinkTakesBackWhatIsNotTaken) {
    start({{"application_wait_ms", 600000}});
    ASSERT_TRUE(start_measuring());
    triggers_to_the_end();
    ASSERT_TRUE(link->write_frame("BASE_left", corrected));
    ASSERT_TRUE(link->confirm(PartVerdict::corrected, ""));
    EXPECT_EQ(link->permission(), Permission::given);
    EXPECT_TRUE(controller->released());
    EXPECT_FALSE(controller->taken());
    link.reset();
    EXPECT_TRUE(eventually([&] { return !controller->released(); }, 2000));
    connect();
    EXPECT_TRUE(becomes(Permission::none));
}

// Nobody closes anything: the computer is gone.
TEST_F(AbbController, ADeadComputerLosesThePermissionToo) {
    start({{"application_wait_ms", 600000}});
    ASSERT_TRUE(start_measuring());
    triggers_to_the_end();
    ASSERT_TRUE(link->confirm(PartVerdict::corrected, ""));
    EXPECT_TRUE(controller->released());
    const auto begun = std::chrono::steady_clock::now();
    EXPECT_TRUE(eventually([&] { return !controller->released(); }, 8000));
    EXPECT_GT(std::chrono::steady_clock::now() - begun, milliseconds(3500));
}

TEST_F(AbbController, AWaitingLinkKeepsThePermission) {
    start({{"application_wait_ms", 600000}});
    ASSERT_TRUE(start_measuring());
    triggers_to_the_end();
    ASSERT_TRUE(link->confirm(PartVerdict::corrected, ""));
    EXPECT_FALSE(link->wait_start(milliseconds(6000)));
    EXPECT_TRUE(controller->released());
    EXPECT_EQ(link->permission(), Permission::given);
}

// The frames of a verdict are used up, and those of a lost connection gone: none lets the old ones be run.
TEST_F(AbbController, AVerdictWithoutItsFramesIsRefused) {
    start({{"application_wait_ms", 600000}});
    for (const bool reconnects : {false, true}) {
        SCOPED_TRACE(reconnects);
        ASSERT_TRUE(start_measuring());
        triggers_to_the_end();
        ASSERT_TRUE(link->write_frame("BASE_left", corrected));
        if (reconnects) {
            controller->set_fault(ControllerFault::disconnect);
            EXPECT_FALSE(link->permission());
            controller->set_fault(ControllerFault::none);
            for (int i = 0; i < 200 && !link->mode(); ++i) std::this_thread::sleep_for(milliseconds(10));
        } else {
            ASSERT_TRUE(link->confirm(PartVerdict::corrected, ""));
            EXPECT_LT(distance_mm(*link->read_frame("BASE_left"), corrected), 1e-3);
        }
        const auto again = link->confirm(PartVerdict::corrected, "");
        ASSERT_FALSE(again);
        EXPECT_THAT(again.error().sentence(), HasSubstr("frames that were written are gone"));
        EXPECT_EQ(link->permission(), Permission::none);
        EXPECT_FALSE(controller->released());
    }
    ASSERT_TRUE(start_measuring());
    triggers_to_the_end();
    ASSERT_TRUE(link->write_frame("BASE_left", corrected));
    EXPECT_TRUE(link->confirm(PartVerdict::corrected, "")) << "measured again";
}

TEST_F(AbbController, ALostLinkLeavesWhatIsTaken) {
    start();
    ASSERT_TRUE(start_measuring());
    triggers_to_the_end();
    ASSERT_TRUE(link->write_frame("BASE_left", corrected));
    ASSERT_TRUE(link->confirm(PartVerdict::corrected, ""));
    ASSERT_TRUE(becomes(Permission::taken));
    link.reset();
    std::this_thread::sleep_for(milliseconds(1500));
    EXPECT_TRUE(controller->released());
    EXPECT_TRUE(controller->taken());
    connect();
    EXPECT_EQ(link->permission(), Permission::taken);
    EXPECT_LT(distance_mm(*cell->read_frame("BASE_left"), corrected), 1e-3);
}

// Taken or taken back, never both: whoever comes first, again and again.
TEST_F(AbbController, TakingAndTakingBackAgree) {
    program = spots(1);
    start({{"application_wait_ms", 0}});
    int taken = 0, back = 0;
    for (int part = 0; part < 12; ++part) {
        auto started = start_measuring();
        ASSERT_TRUE(started) << started.error().sentence();
        triggers_to_the_end();
        const double beads = controller->number("T_ROB1", "simBeads").value();
        ASSERT_TRUE(link->confirm(PartVerdict::corrected, ""));
        std::this_thread::sleep_for(milliseconds(part % 6));
        const bool withdrawn = link->confirm(PartVerdict::refused, "too late?").has_value();
        const bool laid = eventually([&] { return controller->number("T_ROB1", "simBeads") > beads; },
                                     withdrawn ? 400 : 3000);
        EXPECT_EQ(laid, !withdrawn);
        (withdrawn ? back : taken)++;
    }
    EXPECT_EQ(taken + back, 12);
}

TEST_F(AbbController, TheWayGoesThroughTheViaPoints) {
    program = spots(2, true);
    start();
    double highest = 0;
    ASSERT_TRUE(start_measuring());
    EXPECT_TRUE(eventually(
        [&] {
            highest = std::max(highest, cell->reported_flange()->translation().z());
            return controller->number("T_ROB1", "swFired") == 2;
        },
        8000));
    EXPECT_GT(highest, 630) << "40 mm above the entry, as it is looked at every now and then";
    EXPECT_EQ(triggers_to_the_end(), 2);
}

TEST_F(AbbController, TeachingMovesAreServedInManualModeOnly) {
    start();
    const Pose far = make_pose(rotation_exp({0.4, 0.2, -0.3}), {900, -100, 650});
    auto refused = link->move_to(far);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().sentence(), HasSubstr("manual mode"));
    cell->set_mode(RobotMode::manual_reduced);
    ASSERT_TRUE(eventually([&] { return controller->number("T_ROB1", "swTeaching") == 1; }));
    auto moved = link->move_to(far);
    ASSERT_TRUE(moved) << moved.error().sentence();
    EXPECT_LT(distance_mm(*link->base_from_flange(), far), 1e-3);
    EXPECT_LT(angle_rad(*link->base_from_flange(), far), 1e-5);
    // Measuring by hand from there.
    ASSERT_TRUE(start_measuring());
    EXPECT_EQ(triggers_to_the_end(), 3);
}

// A robot that was stopped on its way ends that way when it is started again: no end of a later move.
TEST_F(AbbController, TheEndOfAnotherMoveIsNotTheEndOfThisOne) {
    start();
    cell->set_mode(RobotMode::manual_reduced);
    ASSERT_TRUE(eventually([&] { return controller->number("T_ROB1", "swTeaching") == 1; }));
    const Pose begin = link->base_from_flange().value();
    Pose first = begin, second = begin;
    first.translation().z() += 250;
    second.translation().z() += 240;
    std::jthread stops([&] {
        EXPECT_TRUE(eventually([&] { return distance_mm(*cell->reported_flange(), begin) > 30; }));
        cell->set_mode(RobotMode::stopped);
    });
    EXPECT_THAT(link->move_to(first).error().sentence(), HasSubstr("stopped"));
    stops.join();
    cell->set_mode(RobotMode::manual_reduced);
    std::this_thread::sleep_for(milliseconds(100));
    const auto moved = link->move_to(second);
    ASSERT_TRUE(moved) << moved.error().sentence();
    EXPECT_LT(distance_mm(*link->base_from_flange(), second), 1e-3);
}

// A way that takes longer than the time-out of an answer, with the move's own allowance next to nothing.
TEST_F(AbbController, AMoveHasTheTimeOfItsWay) {
    start();
    cell->set_mode(RobotMode::manual_reduced);
    ASSERT_TRUE(eventually([&] { return controller->number("T_ROB1", "swTeaching") == 1; }));
    DeviceSession session;
    link.reset();
    link = *open_abb_rapid({{"port", controller->port()}, {"timeout_ms", 300}, {"move_timeout_ms", 100}},
                           session);
    Pose far = spots(1)[0].entry;
    far.translation().x() += 400;
    auto moved = link->move_to(far);
    ASSERT_TRUE(moved) << moved.error().sentence();
}

TEST_F(AbbController, HostileRequestsLeaveTheServerAlive) {
    start();
    ASSERT_TRUE(link->mode());
    link.reset();
    const std::string blanks(79, ' ');
    const auto line = [&](std::string text) { return (text + blanks).substr(0, 79) + "\n"; };
    for (const std::string& first :
         {"7 READ " + std::string(60, 'x'), std::string(70, 'W') + " X", std::string("7 WRITE BASE_left"),
          std::string("  "), std::string("7 MEASURE 3 " + std::string(60, 'y')), "1 " + std::string(70, 'Q'),
          std::string("5 VERDICT MAYBE")}) {
        auto client = TcpConnection::connect("127.0.0.1", controller->port(), milliseconds(1000));
        ASSERT_TRUE(client);
        ASSERT_TRUE(
            client->send(bytes_of(line(first) + line("nan 1e9 1e40") + line("0 0 0 0")), milliseconds(500)));
        std::byte answer[240];
        const auto got = client->receive_exactly(answer, milliseconds(1500));
        EXPECT_TRUE(got) << first;
        client->close();
    }
    {  // half a message, and the line falls
        auto client = TcpConnection::connect("127.0.0.1", controller->port(), milliseconds(1000));
        ASSERT_TRUE(client && client->send(bytes_of("7 MOD"), milliseconds(500)));
    }
    connect();
    EXPECT_TRUE(eventually([&] { return link->mode().has_value(); }, 5000));
    ASSERT_TRUE(start_measuring());
    EXPECT_EQ(triggers_to_the_end(), 3);
}

TEST_F(AbbController, ProgramsOfAFolderAreExecuted) {
    const ProgramFolder folder;
    ProgramRequest request;
    request.moves = program;
    request.frames = {{"left", "BASE_left", Pose::Identity()}};
    const auto port = TcpListener::listen("127.0.0.1", 0)->port();
    request.settings = {{"address", "127.0.0.1"}, {"port", port}};
    auto files = write_abb_program(request);
    ASSERT_TRUE(files) << files.error().sentence();
    for (const ProgramFile& f : *files) std::ofstream(folder.path / f.name) << f.text;
    start({{"port", port}, {"programs", folder.path.string()}});
    ASSERT_TRUE(start_measuring());
    EXPECT_EQ(triggers_to_the_end(), 3);
    // One of them broken: told with file and line.
    link.reset();
    controller.reset();
    std::ofstream(folder.path / "Plant.mod") << "MODULE Plant\nVAR robtarget to;\nENDMODULE\n";
    auto refused = start_abb_rapid_controller(cell, {{"port", port}, {"programs", folder.path.string()}});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().sentence(), HasSubstr("Plant.mod, line 2"));
}

// A path as `seamwright path` writes it, run by the interpreter along its points.
TEST_F(AbbController, AWrittenPathIsRunAlongItsPoints) {
    const ProgramFolder folder;
    ProgramRequest request;
    request.moves = program;
    const auto port = TcpListener::listen("127.0.0.1", 0)->port();
    request.settings = {{"address", "127.0.0.1"}, {"port", port}};
    auto files = *write_abb_program(request);
    PathProgramRequest path;
    path.name = "bead";
    path.comment = "door \"left\" \\ ; ENDMODULE";
    path.base_from_frame = make_pose(rotation_exp({0, 0, 0.5}), {700, -300, 500});
    for (int i = 0; i < 3; ++i)
        path.frame_from_tool.push_back(make_pose(rotation_exp({0.1 * i, 0, 0}), {20.0 * i, 5, 100}));
    const auto written = write_abb_path(path);
    ASSERT_TRUE(written) << written.error().sentence();
    files.insert(files.end(), written->begin(), written->end());
    files.push_back({"Plant.mod",
                     "MODULE Plant\nPERS num ran:=0;\nPERS tooldata "
                     "gun:=[TRUE,[[0,0,50],[1,0,0,0]],[3,[0,0,20],[1,0,0,0],0,0,0]];\n"
                     "PROC main()\nbead_run gun;\nran:=1;\nWHILE TRUE DO\nWaitTime "
                     "0.1;\nENDWHILE\nENDPROC\nENDMODULE\n"});
    for (const ProgramFile& f : files) std::ofstream(folder.path / f.name) << f.text;
    start({{"port", port}, {"programs", folder.path.string()}});
    ASSERT_TRUE(eventually([&] { return controller->number("T_ROB1", "ran") == 1; }, 15000));
    const Pose flange_from_tool = make_pose(Eigen::Matrix3d::Identity(), {0, 0, 50});
    const Pose end = path.base_from_frame * path.frame_from_tool.back() * flange_from_tool.inverse();
    EXPECT_LT(distance_mm(*cell->reported_flange(), end), 1e-2);
    EXPECT_LT(angle_rad(*cell->reported_flange(), end), 1e-5);
}

}  // namespace
}  // namespace seamwright
