// The Modbus server before mbpoll, which knows nothing of it, and before strangers' bytes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <regex>

#include "devices/line/modbus_station.h"
#include "devices/net/socket.h"
#include "tests/devices/line/wait.h"

namespace seamwright {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

std::string bytes(std::initializer_list<int> list) {
    std::string text;
    for (const int b : list) text += static_cast<char>(b);
    return text;
}

// A request: transaction 1, unit 1.
std::string frame(const std::string& pdu) {
    return bytes({0, 1, 0, 0, 0, static_cast<int>(pdu.size()) + 1, 1}) + pdu;
}

class ModbusServer : public testing::Test {
  protected:
    void serve(nlohmann::json settings = nlohmann::json::object()) {
        settings["port"] = 0;
        auto opened = open_line("modbus-server", settings, "door");
        ASSERT_TRUE(opened) << opened.error().sentence();
        link = std::move(*opened);
    }
    TcpConnection connect() const {
        return TcpConnection::connect("127.0.0.1", static_cast<std::uint16_t>(link->port()), 2s).value();
    }
    // What comes back, "" where the server closed.
    static std::string ask(TcpConnection& c, const std::string& request, Timeout patience = 3s) {
        if (!c.send(bytes_of(request), 1s)) return "";
        std::array<std::byte, 512> answer{};
        const auto n = c.receive_some(answer, patience);
        return n ? std::string(reinterpret_cast<const char*>(answer.data()), *n) : "";
    }
    std::string ask(const std::string& request, Timeout patience = 3s) const {
        TcpConnection c = connect();
        return ask(c, request, patience);
    }
    // The exception's number; 0: none.
    int exception(const std::string& pdu) const {
        const std::string answer = ask(frame(pdu));
        if (answer.size() != 9 ||
            static_cast<unsigned char>(answer[7]) != (static_cast<unsigned char>(pdu[0]) | 0x80))
            return 0;
        return answer[8];
    }
    Said mbpoll(const std::string& arguments, const std::string& values = "") const {
        return shell(std::string(MBPOLL) + " -m tcp -0 -1 -a 1 -p " + std::to_string(link->port()) + " " +
                     arguments + " 127.0.0.1 " + values);
    }
    std::map<int, long long> read(const std::string& arguments) const {
        const Said said = mbpoll(arguments);
        EXPECT_EQ(said.exit_code, 0) << said.text;
        std::map<int, long long> words;
        const std::regex line(R"(\[(\d+)\]:\s+(-?\d+))");
        for (std::sregex_iterator it(said.text.begin(), said.text.end(), line), end; it != end; ++it)
            words[std::stoi((*it)[1])] = std::stoll((*it)[2]);
        return words;
    }

    std::unique_ptr<LineLink> link;
};

TEST_F(ModbusServer, AnotherProgramReadsTheTable) {
    serve();
    link->publish(told_part(70000));
    auto words = read("-r 100 -c 17 -t 4");
    EXPECT_EQ(words[100], 1);
    EXPECT_EQ(words[102], 1);
    EXPECT_EQ(words[104], 1);
    EXPECT_EQ(words[105], 1);
    EXPECT_EQ(words[116], 1);
    const auto input = read("-r 105 -c 1 -t 3");
    EXPECT_EQ(input.at(105), 1) << "input registers are the same";
    const auto numbers = read("-B -r 122 -c 12 -t 4:int");
    EXPECT_EQ(numbers.at(122), 1235);
    EXPECT_EQ(numbers.at(124), -2500);
    EXPECT_EQ(numbers.at(132), 180000);
    EXPECT_EQ(numbers.at(134), 11);
    EXPECT_EQ(read("-B -r 110 -c 1 -t 4:int").at(110), 70000);
    const auto beat = read("-r 101 -c 1 -t 4").at(101);
    EXPECT_TRUE(soon([&] { return read("-r 101 -c 1 -t 4").at(101) > beat; }));
}

TEST_F(ModbusServer, AnotherProgramCallsForAPart) {
    serve({{"start", "line"}});
    LineState state;
    state.ready = true;
    state.alarm = LineAlarm::none;
    link->publish(state);
    EXPECT_EQ(mbpoll("-r 1 -t 4", "0").exit_code, 0);
    EXPECT_EQ(read("-r 102 -c 3 -t 4"), (std::map<int, long long>{{102, 1}, {103, 0}, {104, 0}}));
    // Type 3, number 65538, name "CAR-1", one write; start after it.
    const Said wrote = mbpoll("-r 2 -t 4", "3 0 1 2 17217 21037 12544");
    EXPECT_EQ(wrote.exit_code, 0) << wrote.text;
    EXPECT_FALSE(link->take_call());
    EXPECT_EQ(mbpoll("-r 1 -t 4", "1").exit_code, 0);
    std::optional<LineCall> call;
    ASSERT_TRUE(soon([&] { return (call = link->take_call()).has_value(); }));
    EXPECT_EQ(call->part.type, 3);
    EXPECT_EQ(call->part.number, 65538u);
    EXPECT_EQ(call->part.name, "CAR-1");
    EXPECT_EQ(read("-r 103 -c 1 -t 4").at(103), 1);
    link->publish(told_part(1, state));
    EXPECT_EQ(read("-r 102 -c 3 -t 4"), (std::map<int, long long>{{102, 0}, {103, 0}, {104, 1}}));
    EXPECT_FALSE(link->given_up());
    EXPECT_EQ(mbpoll("-r 1 -t 4", "0").exit_code, 0);
    EXPECT_EQ(read("-r 102 -c 3 -t 4"), (std::map<int, long long>{{102, 1}, {103, 0}, {104, 0}}));
}

// The robot's call may follow at once.
TEST_F(ModbusServer, WhatIsAcknowledgedIsTaken) {
    serve({{"start", "robot"}});
    TcpConnection c = connect();
    for (int n = 1; n <= 2000; ++n) {
        const std::string write = frame(bytes({6, 0, 5, n >> 8, n & 0xff}));
        ASSERT_EQ(ask(c, write), write);
        ASSERT_EQ(link->take_announced().number, static_cast<unsigned>(n));
    }
}

TEST_F(ModbusServer, WhatIsNotAllowedGetsItsException) {
    serve();
    EXPECT_THAT(mbpoll("-r 100 -t 4", "1").text, HasSubstr("Illegal data address"));
    EXPECT_THAT(mbpoll("-r 632 -c 1 -t 4").text, HasSubstr("Illegal data address"));
    EXPECT_THAT(mbpoll("-r 0 -c 1 -t 0").text, HasSubstr("Illegal function"));
    EXPECT_EQ(exception(bytes({3, 2, 0x78, 0, 1})), 2) << "one beyond the last";
    EXPECT_EQ(exception(bytes({3, 2, 0x77, 0, 1})), 0);
    EXPECT_EQ(exception(bytes({3, 0xff, 0xff, 0, 1})), 2);
    EXPECT_EQ(exception(bytes({3, 0, 0, 0, 0})), 3);
    EXPECT_EQ(exception(bytes({3, 0, 0, 0, 126})), 3);
    EXPECT_EQ(exception(bytes({3, 0, 0})), 3);
    EXPECT_EQ(exception(bytes({6, 0, 22, 0, 1})), 2);
    EXPECT_EQ(exception(bytes({6, 0, 100, 0, 1})), 2);
    EXPECT_EQ(exception(bytes({6, 0, 1, 0})), 3);
    EXPECT_EQ(exception(bytes({16, 0, 21, 0, 2, 4, 0, 1, 0, 1})), 2) << "half in, half out writes nothing";
    EXPECT_EQ(read("-r 21 -c 1 -t 4").at(21), 0);
    EXPECT_EQ(exception(bytes({16, 0, 0, 0, 123, 246, 0, 1})), 3) << "claims more than it brings";
    EXPECT_EQ(exception(bytes({16, 0, 0, 0, 2, 3, 0, 1, 0})), 3);
    EXPECT_EQ(exception(bytes({16, 0, 0, 0, 0, 0})), 3);
    EXPECT_EQ(exception(bytes({16, 0, 0, 0, 1})), 3);
    for (const int function : {0, 1, 2, 5, 7, 8, 15, 17, 22, 23, 24, 43, 100})
        EXPECT_EQ(exception(bytes({function, 0, 0, 0, 1})), 1) << function;
    std::string other = frame(bytes({3, 0, 0, 0, 1}));
    other[6] = 9;
    EXPECT_EQ(ask(other).at(8), 11) << "another unit";
}

TEST_F(ModbusServer, StrangersDisturbNobody) {
    serve({{"connections", 4}});
    link->publish(told_part(5));
    const std::string good = frame(bytes({3, 0, 105, 0, 1}));
    TcpConnection plc = connect();
    ASSERT_EQ(ask(plc, good).size(), 11u);
    TcpConnection half = connect();  // half a frame, and then nothing
    ASSERT_TRUE(half.send(bytes_of(good.substr(0, 9)), 1s));
    EXPECT_EQ(ask(plc, good).at(10), 1);
    // In pieces it is a frame all the same.
    TcpConnection slow = connect();
    for (const char c : good.substr(0, 11)) {
        ASSERT_TRUE(slow.send(bytes_of(std::string(1, c)), 1s));
        std::this_thread::sleep_for(5ms);
    }
    EXPECT_EQ(ask(slow, good.substr(11)).size(), 11u);
    // Two in one packet are two answers.
    EXPECT_EQ(ask(slow, good + good).size() % 11, 0u);
    // No Modbus at all.
    EXPECT_EQ(ask("GET / HTTP/1.1\r\nHost: a\r\n\r\n"), "");
    EXPECT_EQ(ask(bytes({0, 1, 0, 0, 0xff, 0xff, 1, 3})), "") << "a length that is none";
    EXPECT_EQ(ask(bytes({0, 1, 0, 0, 0, 1, 1, 3})), "");
    EXPECT_EQ(ask(bytes({0, 1, 0, 0, 0, 0, 1, 3})), "");
    std::array<std::byte, 8> nothing{};
    EXPECT_FALSE(half.receive_some(nothing, 3s)) << "half a frame is closed";
    // More connections than there may be: the PLC, which asks, keeps its own.
    ASSERT_EQ(ask(plc, good).size(), 11u);
    std::vector<TcpConnection> silent;
    for (int i = 0; i < 20; ++i) {
        silent.push_back(connect());
        ASSERT_EQ(ask(plc, good).size(), 11u) << i;
    }
    // Somebody asks and never reads.
    TcpConnection deaf = connect();
    const std::string many = frame(bytes({3, 0, 100, 0, 125}));
    std::string flood;
    for (int i = 0; i < 1000; ++i) flood += many;
    for (int i = 0; i < 100; ++i)
        if (!deaf.send(bytes_of(flood), 100ms)) break;
    EXPECT_EQ(ask(plc, good).at(10), 1);
    link->publish(told_part(6));
    link.reset();  // and it goes at once, whoever holds the line
}

TEST_F(ModbusServer, ServesTheNamedPeerAlone) {
    serve({{"line_address", "127.0.0.2"}});
    EXPECT_EQ(ask(frame(bytes({3, 0, 100, 0, 1}))), "");
    std::vector<Text> notices;
    EXPECT_TRUE(soon([&] { return !(notices = link->take_notices()).empty(); }));
    EXPECT_THAT(notices.at(0).english(), HasSubstr("unknown peer was refused: 127.0.0.1"));
    const auto port = link->port();
    const auto taken = open_line("modbus-server", {{"port", port}}, "");
    ASSERT_FALSE(taken);
    EXPECT_EQ(taken.error().kind, ErrorKind::device);
}

// The station's thread never waits: not for a thousand strangers.
TEST_F(ModbusServer, TellingItTakesNoTime) {
    serve({{"connections", 64}});
    std::vector<TcpConnection> strangers;
    for (int i = 0; i < 64; ++i) strangers.push_back(connect());
    for (TcpConnection& c : strangers) (void)c.send(bytes_of(bytes({0, 1, 0, 0})), 1s);
    auto longest = 0ns;
    for (std::uint32_t i = 1; i <= 2000; ++i) {
        const LineState state = told_part(i);
        const auto begun = std::chrono::steady_clock::now();
        link->publish(state);
        (void)link->take_call();
        (void)link->take_notices();
        longest = std::max<std::chrono::nanoseconds>(longest, std::chrono::steady_clock::now() - begun);
    }
    RecordProperty("longest_us", static_cast<int>(longest / 1us));
    EXPECT_LT(longest, 1s) << "a wait for anybody would be longer";
}

}  // namespace
}  // namespace seamwright
