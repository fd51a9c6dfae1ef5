// The link before controllers of other kinds than today's: an old protocol, a network that breaks and joins
// packages, registers that belong to somebody else.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "devices/controllers/ur/controller.h"
#include "devices/net/socket.h"
#include "devices/simulated/cell.h"
#include "devices/ur/dashboard.h"
#include "devices/ur/module.h"
#include "devices/ur/program.h"
#include "devices/ur/rtde.h"
#include "devices/ur/rtde_message.h"
#include "tests/devices/temporary_folder.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

std::shared_ptr<SimulatedCell> cell() {
    static const auto shared =
        SimulatedCell::open(
            {{"optics", {{"width", 64}, {"height", 64}}},
             {"robot", {{"frames", {{"left", {{"xyz", {900, -450, 500}}, {"abc", {12, -4, 3}}}}}}}}})
            .value();
    return shared;
}

std::vector<MeasuringMove> program(int spots) {
    std::vector<MeasuringMove> moves;
    for (int i = 1; i <= spots; ++i) {
        MeasuringMove m;
        m.spot_id = "S" + std::to_string(i);
        m.entry = m.trigger = m.exit =
            make_pose(rotation_exp({0.1 * i, 0.2, -0.3}), {800.0 + 10 * i, -200, 600});
        m.exit.translation().y() += 20;
        moves.push_back(m);
    }
    return moves;
}

std::unique_ptr<RobotLink> link_to(std::uint16_t port,
                                   const nlohmann::json& more = nlohmann::json::object()) {
    nlohmann::json settings = {{"port", port}, {"timeout_ms", 1000}, {"retry_ms", 1}};
    settings.update(more);
    DeviceSession session;
    auto link = open_ur_rtde(settings, session);
    EXPECT_TRUE(link) << link.error().sentence();
    return std::move(*link);
}

std::unique_ptr<SimulatedController> controller(nlohmann::json settings, std::uint16_t dashboard = 0) {
    settings["port"] = 0;
    settings["dashboard_port"] = dashboard != 0 ? dashboard : TcpListener::listen("127.0.0.1", 0)->port();
    cell()->set_mode(RobotMode::automatic);
    cell()->store_program(program(5));
    auto started = start_ur_rtde_controller(cell(), settings);
    EXPECT_TRUE(started) << started.error().sentence();
    return std::move(*started);
}

// A folder of script files in which no robot program measures.
std::string scripts_without_measuring() {
    static const TemporaryFolder folder;
    ProgramRequest request;
    request.frames = {{"left", "left", Pose::Identity()}};
    folder.write("seamwright.script", write_ur_program(request).value().front().text);
    folder.write("application.script", "while True:\n  sync()\nend\n");
    return folder.path().string();
}

TEST(UrRtde, OldControllersSpeakVersionOneAndTellNoOffset) {
    auto robot = controller({{"protocol_version", 1}, {"tells_tcp_offset", false}, {"cb3", true}});
    auto link = link_to(robot->port());
    // No dashboard question is asked for what RTDE tells itself.
    cell()->move_to(program(5)[0].trigger);
    auto at = link->base_from_flange();
    ASSERT_TRUE(at) << at.error().sentence();
    EXPECT_LT(distance_mm(*at, program(5)[0].trigger), 1e-6);
    auto frame = link->read_frame("left");
    EXPECT_TRUE(frame) << frame.error().sentence();
}

// Dashboard server of Universal Robots ("Dashboard Server, port 29999"): a greeting, then a line for a line; "get robot model"
// and "get serial number" are known from PolyScope 3.12 and 5.6 on.
TEST(UrRtde, AControllerThatDoesNotKnowItsSerialNumberHasNone) {
    auto listener = TcpListener::listen("127.0.0.1", 0);
    ASSERT_TRUE(listener);
    for (const bool knows : {false, true}) {
        std::jthread dashboard([&](const std::stop_token& stop) {
            auto client = listener->accept(Timeout(5000));
            if (!client) return;
            (void)client->send(bytes_of("Connected: Universal Robots Dashboard Server\n"), Timeout(500));
            std::string heard(200, '\0');
            while (!stop.stop_requested()) {
                const auto got = client->receive_some(std::as_writable_bytes(std::span(heard)), Timeout(10));
                if (!got && !is_silence(got.error())) return;
                if (!got) continue;
                const std::string question = heard.substr(0, *got - 1);
                const std::string answer = !knows ? "could not understand: '" + question + "'"
                                           : question == "get robot model" ? "UR5"
                                                                           : "20173500042";
                (void)client->send(bytes_of(answer + "\n"), Timeout(500));
            }
        });
        DeviceSession session;
        auto link = open_ur_rtde({{"dashboard_port", listener->port()}, {"timeout_ms", 2000}}, session);
        ASSERT_TRUE(link) << link.error().sentence();
        const auto robot = (*link)->identity();
        ASSERT_TRUE(robot) << robot.error().sentence();
        EXPECT_EQ(robot->brand, "Universal Robots");
        EXPECT_EQ(robot->model, knows ? "UR5" : "");
        EXPECT_EQ(robot->serial, knows ? "20173500042" : "");
    }
}

TEST(UrRtde, TheToolIsTakenOffThePose) {
    auto robot = controller({{"tool", {{"xyz", {10, -20, 150}}, {"abc", {5, 12, -20}}}},
                             {"scripts", scripts_without_measuring()}});
    auto link = link_to(robot->port());
    cell()->move_to(program(2)[1].trigger);
    EXPECT_LT(distance_mm(*link->base_from_flange(), program(2)[1].trigger), 1e-6);
}

TEST(UrRtde, RegistersMayLieElsewhere) {
    auto robot = controller({{"first_register", 3}});
    EXPECT_TRUE(link_to(robot->port(), {{"first_register", 3}})->read_frame("left"));
    auto elsewhere = link_to(robot->port())->read_frame("left");
    ASSERT_FALSE(elsewhere);
    EXPECT_THAT(elsewhere.error().sentence(), HasSubstr("seamwright.script does not run"));
}

TEST(UrRtde, MovesWantTheTeachProgramAndTakeTheirTime) {
    auto robot = controller({});
    cell()->move_to(program(1)[0].trigger);
    // The time-out of an answer is shorter than the way: 100 mm at 0.1 m/s.
    auto link = link_to(robot->port(), {{"timeout_ms", 500}});
    EXPECT_THAT(link->move_to(program(1)[0].trigger).error().sentence(), HasSubstr("sw_teach()"));
    cell()->set_mode(RobotMode::manual_reduced);
    Pose far = program(1)[0].trigger;
    far.translation().y() += 100;
    Expected<void> moved = link->move_to(far);
    for (int i = 0; i < 50 && !moved; ++i) {  // until the other program runs
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        moved = link->move_to(far);
    }
    ASSERT_TRUE(moved) << moved.error().sentence();
    EXPECT_LT(distance_mm(*link->base_from_flange(), far), 1e-6);
}

// A program that was paused goes on where it was: it must find nothing to do that has been told as failed.
TEST(UrRtde, AMoveThatFailedIsNotDrivenWhenTheProgramGoesOn) {
    auto robot = controller({});
    const Pose start = program(1)[0].trigger;
    cell()->move_to(start);
    cell()->set_mode(RobotMode::manual_reduced);
    auto link = link_to(robot->port());
    Pose near = start, far = start;
    near.translation().y() += 1;
    far.translation().y() += 30;
    Expected<void> moved = link->move_to(near);
    for (int i = 0; i < 50 && !moved; ++i) {  // until the other program runs
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        moved = link->move_to(near);
    }
    ASSERT_TRUE(moved) << moved.error().sentence();
    cell()->set_mode(RobotMode::stopped);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_THAT(link->move_to(far).error().sentence(), HasSubstr("stopped or paused"));
    cell()->set_mode(RobotMode::manual_reduced);
    std::this_thread::sleep_for(std::chrono::milliseconds(1200));
    auto at = link->base_from_flange();
    ASSERT_TRUE(at) << at.error().sentence();
    EXPECT_LT(distance_mm(*at, near), 1e-6);
    moved = link->move_to(far);
    EXPECT_TRUE(moved) << moved.error().sentence();
}

TEST(UrRtde, AStoppedProgramIsToldAtOnce) {
    for (const char* how : {"fault", "stop", "restart"}) {
        SCOPED_TRACE(how);
        const std::uint16_t port = TcpListener::listen("127.0.0.1", 0)->port();
        auto robot = controller({}, port);
        cell()->set_mode(RobotMode::external);
        auto link = link_to(robot->port(), {{"dashboard_port", port}});
        ASSERT_TRUE(link->read_frame("left"));
        auto started = link->start_measuring(program(5));
        ASSERT_TRUE(started) << started.error().sentence();
        ASSERT_TRUE(link->wait_trigger(std::chrono::seconds(10)));
        if (how == std::string("fault")) {
            cell()->set_mode(RobotMode::fault);
        } else {
            ur::Dashboard pendant("127.0.0.1", port, Timeout(1000));
            EXPECT_EQ(pendant.ask("stop"), "Stopped");
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
            if (how == std::string("restart")) {
                EXPECT_EQ(pendant.ask("play"), "Starting program");
            }
        }
        const auto begun = std::chrono::steady_clock::now();
        Expected<TriggerEvent> event = link->wait_trigger(std::chrono::seconds(30));
        while (event) event = link->wait_trigger(std::chrono::seconds(30));
        EXPECT_EQ(event.error().kind, ErrorKind::device);
        EXPECT_FALSE(is_silence(event.error())) << event.error().sentence();
        EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(5));
    }
}

TEST(UrRtde, AStartWhileNoProgramWaitsIsRefused) {
    const std::uint16_t port = TcpListener::listen("127.0.0.1", 0)->port();
    auto robot = controller({{"scripts", scripts_without_measuring()}}, port);
    auto link = link_to(robot->port(), {{"dashboard_port", port}});
    auto started = link->start_measuring({});
    ASSERT_FALSE(started);
    EXPECT_THAT(started.error().sentence(), HasSubstr("no robot program waits in sw_measure()"));
}

TEST(UrRtde, ALinkThatIsNotAskedStaysAlive) {
    auto robot = controller({});
    auto link = link_to(robot->port());
    ASSERT_TRUE(link->read_frame("left"));
    ASSERT_TRUE(link->confirm(PartVerdict::corrected, ""));
    std::this_thread::sleep_for(std::chrono::seconds(3));
    EXPECT_NE(link->permission().value_or(Permission::none), Permission::none);
}

TEST(UrRtde, RegistersOfAnotherProgramAreRefusedByName) {
    auto listener = TcpListener::listen("127.0.0.1", 0).value();
    const std::uint16_t port = listener.port();
    std::jthread robot([&listener](const std::stop_token& stop) {
        auto client = listener.accept(Timeout(5000));
        std::string stream;
        std::array<char, 4096> buffer;
        while (client && !stop.stop_requested()) {
            const auto got = client->receive_some(std::as_writable_bytes(std::span(buffer)), Timeout(20));
            if (!got && !is_silence(got.error())) return;
            if (got) stream.append(buffer.data(), *got);
            auto package = rtde::take_package(stream);
            if (!package || !*package) continue;
            std::string answer(1, '\1');
            if ((*package)->type == rtde::Type::setup_outputs) {
                answer += "VECTOR6D,INT32,INT32,UINT32";
                for (int i = 0; i < ur::kOutputs; ++i) answer += ",INT32";
                for (int i = 0; i < 6; ++i) answer += ",DOUBLE";
                answer += ",VECTOR6D";
            }
            if ((*package)->type == rtde::Type::setup_inputs) {
                answer = std::string(1, '\0') + "INT32,IN_USE,INT32,INT32,INT32,INT32,INT32";
                for (int i = 0; i < 6; ++i) answer += ",DOUBLE";
            }
            (void)client->send(bytes_of(rtde::package_bytes({(*package)->type, answer})), Timeout(500));
        }
    });
    auto read = link_to(port)->read_frame("left");
    ASSERT_FALSE(read);
    EXPECT_THAT(read.error().sentence(), HasSubstr("another program already writes input_int_register_25"));
}

TEST(UrRtde, SettingsOutOfRangeAreRefused) {
    DeviceSession session;
    for (const char* text : {R"({"port": 0})", R"({"first_register": 37})", R"({"frequency_hz": "fast"})",
                             R"({"timeout_ms": 1.5})", R"({"prot": 1})"})
        EXPECT_FALSE(open_ur_rtde(nlohmann::json::parse(text), session)) << text;
}

}  // namespace
}  // namespace seamwright
