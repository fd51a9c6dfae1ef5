// A client that speaks as Universal Robots' own client library and the RTDE guide do, byte by byte and with
// none of the driver's code: negotiation, controller's version, recipes at a frequency, inputs, start, pause.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <thread>

#include "devices/controllers/ur/controller.h"
#include "devices/controllers/ur/script/kinematics.h"
#include "devices/net/socket.h"
#include "devices/simulated/cell.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
using testing::HasSubstr;
using testing::StartsWith;

std::uint16_t client_free_port() {
    return TcpListener::listen("127.0.0.1", 0)->port();
}

std::shared_ptr<SimulatedCell> client_cell() {
    static const auto shared = SimulatedCell::open({{"serial", "20225500001"},
                                                    {"optics", {{"width", 64}, {"height", 64}}},
                                                    {"robot", {{"mode", "external"}}}})
                                   .value();
    return shared;
}

struct Robot {
    std::uint16_t dashboard = client_free_port();
    std::unique_ptr<SimulatedController> controller;
    explicit Robot(nlohmann::json settings = nlohmann::json::object()) {
        client_cell()->set_mode(RobotMode::external);
        settings["port"] = 0;
        settings["dashboard_port"] = dashboard;
        auto started = start_ur_rtde_controller(client_cell(), settings);
        EXPECT_TRUE(started) << started.error().sentence();
        controller = std::move(*started);
    }
};

struct Message {
    char type = 0;
    std::string payload;
};

std::string be(std::uint64_t v, int bytes) {
    std::string out;
    for (int i = bytes - 1; i >= 0; --i) out.push_back(static_cast<char>(v >> (8 * i) & 0xff));
    return out;
}
std::uint64_t from_be(std::string_view s) {
    std::uint64_t v = 0;
    for (const char c : s) v = v << 8 | static_cast<unsigned char>(c);
    return v;
}
double real_at(std::string_view s, std::size_t at) {
    return std::bit_cast<double>(from_be(s.substr(at, 8)));
}

class Client {
  public:
    explicit Client(std::uint16_t port)
        : connection_(TcpConnection::connect("127.0.0.1", port, Timeout(1000)).value()) {}

    void send(char type, const std::string& payload = {}) {
        const std::string bytes = be(3 + payload.size(), 2) + type + payload;
        ASSERT_TRUE(connection_.send(bytes_of(bytes), Timeout(1000)));
    }
    // The next message; type 0 when none came in time or the other side closed.
    Message receive(Timeout timeout = Timeout(2000)) {
        const auto until = Clock::now() + timeout;
        for (;;) {
            if (buffer_.size() >= 3) {
                const std::size_t size = from_be(std::string_view(buffer_).substr(0, 2));
                if (buffer_.size() >= size) {
                    Message m{buffer_[2], buffer_.substr(3, size - 3)};
                    buffer_.erase(0, size);
                    return m;
                }
            }
            std::array<char, 4096> piece;
            const auto left = std::chrono::ceil<Timeout>(until - Clock::now());
            if (left.count() <= 0) return {};
            const auto got = connection_.receive_some(std::as_writable_bytes(std::span(piece)), left);
            if (!got) return {};
            buffer_.append(piece.data(), *got);
        }
    }
    Message ask(char type, const std::string& payload = {}) {
        send(type, payload);
        for (;;) {
            Message m = receive();
            if (m.type == type || m.type == 0) return m;
        }
    }
    bool version(int v) {
        return ask('V', be(static_cast<std::uint64_t>(v), 2)).payload == std::string(1, '\1');
    }
    std::string outputs(double frequency, const std::string& names) {
        return ask('O', be(std::bit_cast<std::uint64_t>(frequency), 8) + names).payload;
    }

  private:
    TcpConnection connection_;
    std::string buffer_;
};

TEST(UrOfficialClient, ConnectsAsTheLibraryDoes) {
    Robot robot;
    Client client(robot.controller->port());
    EXPECT_FALSE(client.version(3));
    ASSERT_TRUE(client.version(2));
    const Message version = client.ask('v');
    ASSERT_EQ(version.payload.size(), 16U);
    EXPECT_EQ(from_be(version.payload.substr(0, 4)), 5U) << "an e-Series: 500 Hz are allowed";
    const std::string types = client.outputs(
        500,
        "timestamp,actual_q,target_q,actual_TCP_pose,robot_mode,safety_mode,runtime_state,speed_scaling,"
        "output_int_register_24,output_double_register_24,output_bit_register_64,actual_digital_output_bits,"
        "joint_mode,actual_tool_accelerometer,robot_status_bits,safety_status_bits,target_speed_fraction,"
        "actual_current,input_int_register_25");
    EXPECT_EQ(types,
              std::string(1, '\1') +
                  "DOUBLE,VECTOR6D,VECTOR6D,VECTOR6D,INT32,INT32,UINT32,DOUBLE,INT32,DOUBLE,BOOL,UINT64,"
                  "VECTOR6INT32,VECTOR3D,UINT32,UINT32,DOUBLE,VECTOR6D,INT32");
    const Message inputs =
        client.ask('I',
                   "input_int_register_40,input_double_register_40,speed_slider_mask,"
                   "speed_slider_fraction,standard_digital_output_mask,standard_digital_output");
    EXPECT_EQ(inputs.payload.substr(1), "INT32,DOUBLE,UINT32,DOUBLE,UINT8,UINT8");
    EXPECT_NE(inputs.payload[0], '\0');
    ASSERT_EQ(client.ask('S').payload, std::string(1, '\1'));
    // The library waits until the controller has been up for 40 s, or for 1000 packages.
    const Message data = client.receive();
    ASSERT_EQ(data.type, 'U');
    const std::size_t size = 1 + 8 + 3 * 48 + 4 + 4 + 4 + 8 + 4 + 8 + 1 + 8 + 24 + 24 + 4 + 4 + 8 + 48 + 4;
    ASSERT_EQ(data.payload.size(), size);
    EXPECT_EQ(data.payload[0], types[0]);
    EXPECT_GT(real_at(data.payload, 1), 40);
    EXPECT_EQ(from_be(data.payload.substr(153, 4)), 7U);      // running
    EXPECT_EQ(from_be(data.payload.substr(153 + 8, 4)), 2U);  // playing
    ASSERT_EQ(client.ask('P').payload, std::string(1, '\1'));
    while (client.receive(Timeout(100)).type != 0) continue;
    EXPECT_EQ(client.receive(Timeout(100)).type, 0) << "paused";
}

TEST(UrOfficialClient, EveryRecipeHasItsOwnFrequency) {
    Robot robot;
    for (const double hz : {10.0, 125.0, 500.0}) {
        Client client(robot.controller->port());
        ASSERT_TRUE(client.version(2));
        ASSERT_EQ(client.outputs(hz, "timestamp").substr(1), "DOUBLE");
        ASSERT_EQ(client.ask('S').payload, std::string(1, '\1'));
        std::vector<double> times;
        const auto until = Clock::now() + std::chrono::seconds(1);
        while (Clock::now() < until)
            if (const Message m = client.receive(Timeout(300)); m.type == 'U')
                times.push_back(real_at(m.payload, 1));
        ASSERT_GE(times.size(), 5U);
        // By the controller's own clock, so that a busy machine that leaves packages out says nothing.
        double step = 1e9;
        for (std::size_t i = 1; i < times.size(); ++i) step = std::min(step, times[i] - times[i - 1]);
        EXPECT_GE(step, 0.5 / hz);
        EXPECT_LE(static_cast<double>(times.size()), 1.3 * hz + 2);
    }
}

TEST(UrOfficialClient, SeveralClientsAndWhoOwnsAnInput) {
    Robot robot;
    Client first(robot.controller->port());
    ASSERT_TRUE(first.version(2));
    ASSERT_NE(first.ask('I', "input_int_register_30,input_int_register_31").payload[0], '\0');
    Client second(robot.controller->port());
    ASSERT_TRUE(second.version(2)) << "a second client is served beside the first";
    EXPECT_EQ(second.ask('I', "input_int_register_31,input_int_register_32").payload,
              std::string(1, '\0') + "IN_USE,INT32");
    EXPECT_EQ(second.ask('I', "input_int_register_48").payload, std::string(1, '\0') + "NOT_FOUND");
    EXPECT_EQ(second.ask('I', "input_int_register_20").payload, std::string(1, '\0') + "IN_USE")
        << "the field bus";
    EXPECT_EQ(second.outputs(125, "timestamp,no_such"), std::string(1, '\0') + "DOUBLE,NOT_FOUND");
    // Two recipes of one client, and what is written is told back.
    const std::string a = second.ask('I', "input_int_register_32").payload,
                      b = second.ask('I', "input_double_register_33").payload;
    EXPECT_NE(a[0], b[0]) << "each has its own number";
    ASSERT_EQ(second.outputs(125, "input_int_register_32,input_double_register_33").substr(1),
              "INT32,DOUBLE");
    ASSERT_EQ(second.ask('S').payload, std::string(1, '\1'));
    second.send('U', a.substr(0, 1) + be(4711, 4));
    second.send('U', b.substr(0, 1) + be(std::bit_cast<std::uint64_t>(-1.5), 8));
    Message m;
    for (int i = 0; i < 300; ++i) {
        m = second.receive();
        if (m.type == 'U' && from_be(m.payload.substr(1, 4)) == 4711 && real_at(m.payload, 5) == -1.5) break;
    }
    EXPECT_EQ(from_be(m.payload.substr(1, 4)), 4711U);
    EXPECT_EQ(real_at(m.payload, 5), -1.5);
    { Client gone = std::move(first); }
    bool free = false;
    for (int i = 0; i < 100 && !free; ++i) {
        free = second.ask('I', "input_int_register_31").payload[0] != '\0';
        if (!free) std::this_thread::sleep_for(Timeout(20));
    }
    EXPECT_TRUE(free) << "the inputs of a client that went are free";
}

TEST(UrOfficialClient, ProtocolOneHasNoNumbersAndNoFrequency) {
    Robot robot({{"cb3", true}, {"protocol_version", 1}});
    Client client(robot.controller->port());
    EXPECT_FALSE(client.version(2));
    ASSERT_TRUE(client.version(1));
    EXPECT_EQ(from_be(client.ask('v').payload.substr(0, 4)), 3U);
    EXPECT_EQ(client.ask('O', "timestamp,robot_mode").payload, "DOUBLE,INT32");
    ASSERT_EQ(client.ask('S').payload, std::string(1, '\1'));
    const Message m = client.receive();
    EXPECT_EQ(m.type, 'U');
    EXPECT_EQ(m.payload.size(), 12U);
}

TEST(UrOfficialClient, WhatIsNoRtdeIsToldAndPutOut) {
    Robot robot;
    Client client(robot.controller->port());
    ASSERT_TRUE(client.version(2));
    client.send('U', std::string(1, '\x09') + be(1, 4));
    const Message text = client.receive();
    ASSERT_EQ(text.type, 'M');
    const auto length = static_cast<std::size_t>(static_cast<unsigned char>(text.payload[0]));
    EXPECT_THAT(text.payload.substr(1, length), HasSubstr("no input recipe"));
    EXPECT_EQ(text.payload.substr(2 + length, 9), "URControl");
    EXPECT_EQ(text.payload.back(), '\1');
    EXPECT_EQ(client.receive(Timeout(500)).type, 0);
}

TEST(UrOfficialClient, JointAnglesReachTheFlange) {
    const Pose wanted = make_pose(rotation_exp({2.9, 0.2, -0.1}), {600, -300, 400});
    client_cell()->move_to(wanted);
    Robot robot;
    Client client(robot.controller->port());
    ASSERT_TRUE(client.version(2));
    ASSERT_EQ(client.outputs(125, "actual_q,actual_TCP_pose").substr(1), "VECTOR6D,VECTOR6D");
    ASSERT_EQ(client.ask('S').payload, std::string(1, '\1'));
    Message m;
    for (int i = 0; i < 30; ++i) m = client.receive();
    urscript::Joints q{};
    for (std::size_t i = 0; i < 6; ++i) q[i] = real_at(m.payload, 1 + 8 * i);
    EXPECT_LT(distance_mm(urscript::base_from_flange(q), wanted), 0.01);
    EXPECT_LT(angle_rad(urscript::base_from_flange(q), wanted), 1e-5);
    EXPECT_NEAR(real_at(m.payload, 49), 0.6, 1e-6);
}

class Dashboard {
  public:
    explicit Dashboard(std::uint16_t port)
        : connection_(TcpConnection::connect("127.0.0.1", port, Timeout(1000)).value()) {}
    std::string line() {
        for (;;) {
            if (const auto end = buffer_.find('\n'); end != std::string::npos) {
                std::string text = buffer_.substr(0, end);
                buffer_.erase(0, end + 1);
                return text;
            }
            std::array<char, 500> piece;
            const auto got =
                connection_.receive_some(std::as_writable_bytes(std::span(piece)), Timeout(2000));
            if (!got) return "nothing";
            buffer_.append(piece.data(), *got);
        }
    }
    std::string ask(const std::string& question) {
        EXPECT_TRUE(connection_.send(bytes_of(question + "\n"), Timeout(1000)));
        return line();
    }

  private:
    TcpConnection connection_;
    std::string buffer_;
};

TEST(UrOfficialClient, TheDashboardAnswersInItsWords) {
    Robot robot;
    Dashboard one(robot.dashboard), two(robot.dashboard);
    EXPECT_EQ(one.line(), "Connected: Universal Robots Dashboard Server");
    EXPECT_EQ(two.line(), "Connected: Universal Robots Dashboard Server");
    const auto comes = [&](const std::string& question, const std::string& answer) {
        for (int i = 0; i < 100; ++i) {
            if (two.ask(question) == answer) return true;
            std::this_thread::sleep_for(Timeout(20));
        }
        return false;
    };
    EXPECT_TRUE(comes("programState", "PLAYING cell.urp"));
    EXPECT_EQ(one.ask("running"), "Program running: true");
    EXPECT_EQ(one.ask("robotmode"), "Robotmode: RUNNING");
    EXPECT_EQ(one.ask("safetystatus"), "Safetystatus: NORMAL");
    EXPECT_EQ(one.ask("get loaded program"), "Loaded program: /programs/cell.urp");
    EXPECT_EQ(one.ask("is in remote control"), "true");
    EXPECT_EQ(one.ask("get serial number"), "20225500001");
    EXPECT_EQ(one.ask("get robot model"), "UR10e");
    EXPECT_THAT(one.ask("PolyscopeVersion"), StartsWith("URSoftware 5.12"));
    EXPECT_THAT(one.ask("make coffee"), StartsWith("could not understand"));
    EXPECT_EQ(one.ask("stop"), "Stopped");
    EXPECT_TRUE(comes("programState", "STOPPED cell.urp"));
    EXPECT_EQ(one.ask("play"), "Starting program");
    EXPECT_TRUE(comes("programState", "PLAYING cell.urp"));
    EXPECT_EQ(one.ask("pause"), "Pausing program");
    EXPECT_TRUE(comes("programState", "PAUSED cell.urp"));
    client_cell()->set_mode(RobotMode::automatic);
    EXPECT_TRUE(comes("is in remote control", "false"));
    EXPECT_EQ(one.ask("stop"), "Failed to execute: stop");
    client_cell()->set_mode(RobotMode::stopped);
    EXPECT_TRUE(comes("safetystatus", "Safetystatus: PROTECTIVE_STOP"));
    EXPECT_EQ(one.ask("quit"), "Disconnected");
}

}  // namespace
}  // namespace seamwright
