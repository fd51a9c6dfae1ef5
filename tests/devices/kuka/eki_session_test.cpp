// Whose connection is the robot's: a robot made by hand, byte by byte, and others that connect beside it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <thread>

#include "devices/kuka/eki.h"
#include "devices/kuka/eki_telegram.h"
#include "devices/net/socket.h"
#include "devices/silence.h"

namespace seamwright {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using namespace std::chrono_literals;

// A controller of that serial number, which answers every command while it is well.
class HandMadeRobot {
  public:
    HandMadeRobot(std::uint16_t port, const std::string& serial)
        : connection_(*TcpConnection::connect("127.0.0.1", port, Timeout(1000))) {
        say({.kind = "hello", .name = serial, .part = "#KR", .text = "KSS 8.6"});
        thread_ = std::jthread([this](const std::stop_token& stop) { talk(stop); });
    }
    std::atomic<bool> answers = true;
    std::atomic<int> writes = 0;
    void say(const EkiTelegram& telegram) { send(write_eki("Robot", telegram)); }
    void send(const std::string& text) { EXPECT_TRUE(connection_.send(bytes_of(text), Timeout(500))); }

  private:
    void talk(const std::stop_token& stop) {
        EkiSplitter commands("Sensor");
        while (!stop.stop_requested()) {
            std::array<char, 4096> buffer;
            const auto got = connection_.receive_some(std::as_writable_bytes(std::span(buffer)), Timeout(5));
            if (!got && !is_silence(got.error())) return;
            if (got && !commands.add({buffer.data(), *got})) return;
            for (std::string document; commands.next(document);) {
                const auto command = parse_eki_command(document);
                if (!command) return;
                writes += command->kind == "write";
                if (answers) say({.kind = "answer", .id = command->id, .name = command->name, .mode = "#EX"});
            }
        }
    }
    TcpConnection connection_;
    std::jthread thread_;
};

class EkiSession : public testing::Test {
  protected:
    void SetUp() override {
        auto opened = open_kuka_eki({{"port", port}, {"timeout_ms", 400}}, session);
        ASSERT_TRUE(opened) << opened.error().sentence();
        link = std::move(*opened);
    }
    Expected<RobotIdentity> identity() {
        auto robot = link->identity();
        for (int i = 0; i < 20 && !robot; ++i) robot = link->identity();
        return robot;
    }
    const std::uint16_t port = TcpListener::listen("127.0.0.1", 0)->port();
    DeviceSession session;
    std::unique_ptr<RobotLink> link;
};

TEST_F(EkiSession, WhoSaysNothingOrNonsenseCostsTheRobotNothing) {
    HandMadeRobot robot(port, "KRC-1");
    ASSERT_EQ(identity()->serial, "KRC-1");
    ASSERT_TRUE(link->start_measuring({}));
    auto silent = TcpConnection::connect("127.0.0.1", port, Timeout(500));
    auto babbling = TcpConnection::connect("127.0.0.1", port, Timeout(500));
    ASSERT_TRUE(silent && babbling);
    ASSERT_TRUE(babbling->send(bytes_of("<Robot>nonsense</Robot>"), Timeout(500)));
    for (int k = 1; k <= 60; ++k) {  // over the time that a newcomer has for its hello
        robot.say({.kind = "trigger", .id = k, .name = "S" + std::to_string(k)});
        const auto trigger = link->wait_trigger(1s);
        ASSERT_TRUE(trigger) << trigger.error().sentence();
        EXPECT_EQ(trigger->spot_id, "S" + std::to_string(k));
        EXPECT_TRUE(link->mode());
        std::this_thread::sleep_for(10ms);
    }
    const auto notices = link->take_notices();
    ASSERT_EQ(notices.size(), 1U);
    EXPECT_THAT(notices[0], HasSubstr("2 connections of an unknown peer were refused"));
    EXPECT_TRUE(link->write_frame("BASE_left", Pose::Identity()));
    EXPECT_EQ(robot.writes, 1);
}

TEST_F(EkiSession, NonsenseBeforeTheRobotDoesNotKeepItOut) {
    auto silent = TcpConnection::connect("127.0.0.1", port, Timeout(500));
    ASSERT_TRUE(silent);
    EXPECT_TRUE(is_silence(link->identity().error()));
    HandMadeRobot robot(port, "KRC-1");
    EXPECT_EQ(identity()->serial, "KRC-1");
}

TEST_F(EkiSession, ASecondRobotIsRefusedWhileTheFirstAnswers) {
    HandMadeRobot first(port, "KRC-1");
    ASSERT_EQ(identity()->serial, "KRC-1");
    HandMadeRobot second(port, "KRC-2");
    for (int i = 0; i < 20; ++i) {
        EXPECT_TRUE(link->mode());
        std::this_thread::sleep_for(5ms);
    }
    EXPECT_EQ(link->identity()->serial, "KRC-1");
    EXPECT_THAT(link->take_notices(),
                ElementsAre(HasSubstr("a second robot was refused, KRC-2 at 127.0.0.1:")));
    EXPECT_TRUE(link->write_frame("BASE_left", Pose::Identity()));
    EXPECT_EQ(first.writes, 1);
    EXPECT_EQ(second.writes, 0);
}

TEST_F(EkiSession, ARobotThatAnswersNoMoreIsTakenOverAndTold) {
    HandMadeRobot hung(port, "KRC-1");
    ASSERT_EQ(identity()->serial, "KRC-1");
    hung.answers = false;  // switched off without a word
    HandMadeRobot again(port, "KRC-1");
    Expected<RobotMode> mode = link->mode();
    for (int i = 0; i < 20 && !mode; ++i) mode = link->mode();
    ASSERT_TRUE(mode) << mode.error().sentence();
    EXPECT_TRUE(link->write_frame("BASE_left", Pose::Identity())) << "the same robot as before";
    EXPECT_EQ(again.writes, 1);
    // Where the link's own question found it silent there was nothing left to take over.
    for (const Text& notice : link->take_notices())
        EXPECT_THAT(notice, HasSubstr("has taken over from KRC-1"));
}

TEST_F(EkiSession, ACallOfAnOutageIsAsOldAsTheOutage) {
    std::optional<HandMadeRobot> robot;
    robot.emplace(port, "KRC-1");
    ASSERT_EQ(identity()->serial, "KRC-1");
    EXPECT_TRUE(is_silence(link->wait_start(20ms).error()));
    const std::int64_t before = std::chrono::steady_clock::now().time_since_epoch() / 1ns;
    robot->say({.kind = "start", .part = "CAR-1"});
    auto start = link->wait_start(1s);
    ASSERT_TRUE(start) << start.error().sentence();
    EXPECT_LE(start->not_before_ns, start->host_time_ns);
    EXPECT_GT(start->not_before_ns, before - 1000000000) << "heard a moment ago without it";
    EXPECT_TRUE(is_silence(link->wait_start(20ms).error()));
    robot.reset();
    const std::int64_t lost = std::chrono::steady_clock::now().time_since_epoch() / 1ns;
    EXPECT_FALSE(link->wait_start(20ms));
    std::this_thread::sleep_for(300ms);
    const auto away = link->wait_start(20ms);
    ASSERT_FALSE(away);
    EXPECT_FALSE(is_silence(away.error())) << "no robot is no silent line: " << away.error().sentence();
    robot.emplace(port, "KRC-1");
    robot->say({.kind = "start", .part = "CAR-2"});
    start = link->wait_start(1s);
    for (int i = 0; i < 20 && !start; ++i) start = link->wait_start(200ms);
    ASSERT_TRUE(start) << start.error().sentence();
    EXPECT_EQ(start->part_id, "CAR-2");
    EXPECT_LE(start->not_before_ns, lost);
}

TEST_F(EkiSession, ABrokenOffTelegramEndsTheWaitAndTheMeasuring) {
    HandMadeRobot robot(port, "KRC-1");
    ASSERT_EQ(identity()->serial, "KRC-1");
    ASSERT_TRUE(link->start_measuring({}));
    const std::string whole = write_eki("Robot", {.kind = "trigger", .id = 1, .name = "S1"});
    robot.send(whole.substr(0, whole.size() / 2));
    auto trigger = link->wait_trigger(200ms);
    for (int i = 0; i < 5 && !trigger && is_silence(trigger.error()); ++i)
        trigger = link->wait_trigger(200ms);
    ASSERT_FALSE(trigger);
    EXPECT_FALSE(is_silence(trigger.error())) << trigger.error().sentence();
    HandMadeRobot again(port, "KRC-1");
    trigger = link->wait_trigger(1s);
    ASSERT_FALSE(trigger);
    EXPECT_THAT(trigger.error().sentence(), HasSubstr("lost while the part was measured"));
}

// Cut where the wait for it ends, and whole well before an answer would be late.
TEST_F(EkiSession, ATelegramThatTheNetworkCutsIsTaken) {
    HandMadeRobot robot(port, "KRC-1");
    ASSERT_EQ(identity()->serial, "KRC-1");
    ASSERT_TRUE(link->start_measuring({}));
    for (int number = 1; number <= 5; ++number) {
        const std::string name = "S" + std::to_string(number);
        const std::string whole = write_eki("Robot", {.kind = "trigger", .id = number, .name = name});
        robot.send(whole.substr(0, whole.size() / 2));
        std::jthread later([&] {
            std::this_thread::sleep_for(60ms);
            robot.send(whole.substr(whole.size() / 2));
        });
        auto trigger = link->wait_trigger(20ms);
        for (int i = 0; i < 20 && !trigger && is_silence(trigger.error()); ++i)
            trigger = link->wait_trigger(20ms);
        ASSERT_TRUE(trigger) << trigger.error().sentence();
        EXPECT_EQ(trigger->spot_id, name);
    }
}

}  // namespace
}  // namespace seamwright
