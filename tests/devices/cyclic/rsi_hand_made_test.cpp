// The RSI driver before a hand-made robot over UDP: lost, repeated and exchanged telegrams.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <thread>
#include <tuple>

#include "devices/kuka/rsi.h"
#include "devices/kuka/rsi_telegram.h"
#include "rsi_robot.h"
#include "rsi_settings.h"

namespace seamwright {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

// rsi_robot.h before the public driver, over UDP.
class HandMade : public testing::Test {
  protected:
    void open(nlohmann::json more = nlohmann::json::object()) {
        port_ = free_port();
        nlohmann::json settings = link_settings(port_);
        settings.update(
            {{"session_gap_ms", 400}, {"max_late", 1000}, {"speed_mm_s", 20}, {"speed_deg_s", 2}});
        settings.update(more);
        robot_.relative = settings.value("mode", "absolute") == "relative";
        robot_.hold_on = !robot_.relative;
        DeviceSession session;
        auto link = open_kuka_rsi(settings, session, nullptr);
        ASSERT_TRUE(link) << link.error().sentence();
        link_ = std::move(*link);
    }
    std::optional<RsiSen> send(const std::string& text, int wait_ms = 1000) {
        EXPECT_TRUE(socket_.send_to(bytes_of(text), {"127.0.0.1", port_}));
        std::array<std::byte, 2048> buffer;
        Endpoint from;
        const auto size = socket_.receive(buffer, from, Timeout(wait_ms));
        if (!size) return std::nullopt;
        auto sen = parse_rsi_sen(std::span(buffer).first(*size));
        EXPECT_TRUE(sen);
        return *sen;
    }
    // One cycle; `late`: the answer comes when the next telegram has gone out.
    bool cycle(bool late = false) {
        const auto before = robot_.in_force();
        const auto sen = send(robot_.send());
        const bool in_time = robot_.end_of_cycle(late ? std::nullopt : sen);
        steps_.add(before, robot_.in_force());
        return sen && in_time != late;
    }
    void cycles(int n) {
        while (n-- > 0) ASSERT_TRUE(cycle());
    }
    // Confirms beside a robot that goes on asking.
    Expected<void> confirm(const Pose& frame, PartVerdict verdict = PartVerdict::corrected) {
        if (auto ok = link_->write_frame("PATH", frame); !ok) return ok;
        std::atomic<bool> done = false;
        Expected<void> result;
        std::thread confirming([&] {
            result = link_->confirm(verdict, "");
            done = true;
        });
        while (!done) (void)cycle();
        confirming.join();
        return result;
    }
    const CyclicServer& server() { return static_cast<CyclicLink&>(*link_).server(); }

    std::uint16_t port_ = 0;
    UdpSocket socket_ = *UdpSocket::bind("127.0.0.1", 0);
    std::unique_ptr<RobotLink> link_;
    RsiRobot robot_;
    StepMeter steps_;
};
Pose raised(double mm) {
    Pose moved = kTaught;
    moved.translation().z() += mm;
    return moved;
}

TEST_F(HandMade, EchoesTheIpocAndNeverAnswersOldOnes) {
    open();
    cycles(3);
    const std::string repeated = robot_.send();
    ASSERT_TRUE(send(repeated));
    EXPECT_FALSE(send(repeated, 60)) << "repeated";
    robot_.set_ipoc(robot_.ipoc() - 12);
    EXPECT_FALSE(send(robot_.send(), 60)) << "exchanged";
    robot_.set_ipoc(robot_.ipoc() + 20);
    const auto sen = send(robot_.send());
    ASSERT_TRUE(sen);
    EXPECT_EQ(sen->ipoc, std::to_string(robot_.ipoc()));
    EXPECT_EQ(server().counters().out_of_order, 2u);
    EXPECT_EQ(server().counters().missed_cycles, 3u);
    // A stranger is not answered while the robot is there, another port of its machine included; rubbish
    // never.
    UdpSocket stranger = *UdpSocket::bind("127.0.0.1", 0);
    ASSERT_TRUE(stranger.send_to(bytes_of("<Rob><IPOC>2000</IPOC></Rob>"), {"127.0.0.1", port_}));
    ASSERT_TRUE(socket_.send_to(bytes_of("<Rob><IPOC>"), {"127.0.0.1", port_}));
    ASSERT_TRUE(socket_.send_to(bytes_of(std::string(20000, 'x')), {"127.0.0.1", port_}));
    cycles(3);
    EXPECT_EQ(server().counters().strangers, 1u);
    EXPECT_EQ(server().counters().bad, 2u);
    const auto notices = link_->take_notices();
    ASSERT_EQ(notices.size(), 1u);
    EXPECT_THAT(notices[0], HasSubstr(fmt::format("127.0.0.1:{}", stranger.port())));
}

TEST_F(HandMade, AnotherPortAfterSilenceIsATakeoverThatIsTold) {
    open({{"session_gap_ms", 60}});
    ASSERT_TRUE(link_);
    cycles(20);
    ASSERT_TRUE(confirm(raised(1)));
    const std::uint16_t before = socket_.port();
    std::this_thread::sleep_for(milliseconds(150));
    socket_ = *UdpSocket::bind("127.0.0.1", 0);
    robot_.rsi_on();
    robot_.set_ipoc(robot_.ipoc() + 148);
    steps_ = {};
    cycles(100);
    EXPECT_EQ(robot_.in_force()[2], 0) << "a new session holds nothing";
    EXPECT_THAT(link_->mode().error().what, HasSubstr("fell silent under a correction"));
    const auto notices = link_->take_notices();
    ASSERT_EQ(notices.size(), 1u);
    EXPECT_THAT(notices[0], HasSubstr(fmt::format("127.0.0.1:{}", before)));
    EXPECT_THAT(notices[0], HasSubstr("took its place"));
}

TEST_F(HandMade, NothingIsWrittenToAnotherRobotThanTheOneThatWasIdentified) {
    open({{"session_gap_ms", 60}});
    cycles(20);
    std::atomic<bool> done = false;
    std::thread asking([&] {
        EXPECT_TRUE(link_->identity());
        done = true;
    });
    while (!done) (void)cycle();
    asking.join();
    ASSERT_TRUE(link_->write_frame("PATH", raised(1)));
    std::this_thread::sleep_for(milliseconds(150));
    socket_ = *UdpSocket::bind("127.0.0.2", 0);
    robot_.rsi_on();
    cycles(5);
    const auto refused = link_->write_frame("PATH", raised(1));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().what, HasSubstr("is another one than at 127.0.0.1"));
}

// Recorded Delay D: a run length of late answers, while the IPOC goes on.
TEST_F(HandMade, RunsOfLateAnswersMakeNoStep) {
    const std::vector<std::pair<const char*, std::vector<int>>> recorded = {
        {"0 1 0 0 1 0", {1, 0, 0, 1, 0, 0, 0, 0}},
        {"0 1 2 0", {1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}},
        {"0 1 2 3 4 5 0 1 0", {1, 1, 1, 1, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}},
        {"0 1 .. 90 0", [] {
             std::vector<int> run(90, 1);
             run.resize(200, 0);
             return run;
         }()}};
    const double limit = 20 * 0.004;
    std::printf("RSI step limit %.3f mm: largest step per cycle\n%-20s %12s %12s %8s\n", limit, "Delay D",
                "absolute", "relative", "late");
    for (const auto& [name, pattern] : recorded) {
        double largest[2] = {};
        std::uint64_t late = 0;
        for (const bool relative : {false, true}) {
            link_.reset();
            robot_ = RsiRobot{};
            socket_ = *UdpSocket::bind("127.0.0.1", 0);
            open({{"mode", relative ? "relative" : "absolute"}});
            cycles(5);
            ASSERT_TRUE(link_->write_frame("PATH", raised(3)));
            std::atomic<bool> done = false;
            Expected<void> result;
            std::thread confirming([&] {
                result = link_->confirm(PartVerdict::corrected, "");
                done = true;
            });
            steps_ = {};
            // Up, there, and down again, with late answers all the way.
            for (int round = 0; round < 5 || !done; ++round)
                for (const int is_late : pattern) (void)cycle(is_late != 0);
            confirming.join();
            EXPECT_TRUE(result) << result.error().sentence();
            EXPECT_NEAR(robot_.in_force()[2], 3, 1e-6) << name;
            EXPECT_NEAR(server().state().held.mm.z(), robot_.in_force()[2], 1e-6) << name;
            std::atomic<bool> back = false;
            std::thread withdrawing([&] {
                EXPECT_TRUE(link_->confirm(PartVerdict::refused, ""));
                back = true;
            });
            while (!back)
                for (const int is_late : pattern) (void)cycle(is_late != 0);
            withdrawing.join();
            cycles(2);
            EXPECT_NEAR(robot_.in_force()[2], 0, 1e-9) << name;
            largest[relative] = steps_.mm;
            late += server().counters().late;
            EXPECT_LE(steps_.mm, limit) << name;
            EXPECT_EQ(server().counters().sessions, 1u) << name;
        }
        std::printf("%-20s %12.6f %12.6f %8lu\n", name, largest[0], largest[1],
                    static_cast<unsigned long>(late));
    }
}

TEST_F(HandMade, SilenceWithAnIpocThatGoesOnLeavesTheRobotItsCorrectionAndLeadsItBack) {
    for (const bool relative : {false, true}) {
        link_.reset();
        robot_ = RsiRobot{};
        open({{"mode", relative ? "relative" : "absolute"}});
        cycles(5);
        ASSERT_TRUE(confirm(raised(3)));
        steps_ = {};
        std::this_thread::sleep_for(milliseconds(700));
        cycles(15);
        EXPECT_GT(robot_.in_force()[2], 0.5) << "on the way back";
        EXPECT_NEAR(server().state().held.mm.z(), robot_.in_force()[2], 0.08 + 1e-6);
        cycles(400);
        EXPECT_NEAR(robot_.in_force()[2], 0, 1e-9);
        EXPECT_LE(steps_.mm, 0.08);
        const auto told = link_->mode();
        ASSERT_FALSE(told);
        EXPECT_THAT(told.error().what, HasSubstr("fell silent"));
        EXPECT_EQ(*link_->permission(), Permission::none);
    }
}

TEST_F(HandMade, TooManyLostWithdraw) {
    open({{"max_late", 6}});
    cycles(5);
    ASSERT_TRUE(confirm(raised(1)));
    for (int i = 0; i < 4; ++i) ASSERT_TRUE(cycle(true));
    cycles(5);
    EXPECT_EQ(robot_.in_force()[2], 1) << "four are borne";
    for (int i = 0; i < 4; ++i) ASSERT_TRUE(cycle(true));
    cycles(400);
    EXPECT_EQ(robot_.in_force()[2], 0) << "withdrawn";
    EXPECT_LE(steps_.mm, 0.08);
    EXPECT_THAT(link_->mode().error().what, HasSubstr("late or lost"));
}

TEST_F(HandMade, AJumpOfThePathIsAnAlarm) {
    open();
    cycles(5);
    ASSERT_TRUE(confirm(raised(1)));
    robot_.programmed.translation().x() += 600;
    ASSERT_TRUE(cycle());
    const auto told = link_->read_frame("PATH");
    ASSERT_FALSE(told);
    EXPECT_THAT(told.error().what, HasSubstr("jumped"));
}

TEST_F(HandMade, WhatIsMissingIsNamed) {
    for (const auto& [rist, rsol, says] :
         {std::tuple{false, true, "RIst"}, std::tuple{true, false, "RSol"}}) {
        link_.reset();
        robot_ = RsiRobot{};
        robot_.with_rist = rist;
        robot_.with_rsol = rsol;
        open();
        cycles(5);
        const auto refused = confirm(raised(1));
        ASSERT_FALSE(refused);
        EXPECT_THAT(refused.error().what, HasSubstr(std::string("carry no ") + says));
        for (const double x : robot_.in_force()) EXPECT_EQ(x, 0);
    }
}

TEST_F(HandMade, ThePermissionGoesWithThePath) {
    open();
    cycles(5);
    EXPECT_EQ(*link_->permission(), Permission::none);
    ASSERT_TRUE(confirm(raised(1)));
    cycles(20);
    EXPECT_EQ(*link_->permission(), Permission::given);
    for (int i = 0; i < 100; ++i) {
        robot_.programmed.translation().y() += 0.4;
        ASSERT_TRUE(cycle());
    }
    EXPECT_EQ(*link_->permission(), Permission::running);
    // The path stands, RSI_OFF.
    cycles(10);
    EXPECT_EQ(*link_->permission(), Permission::running);
    std::this_thread::sleep_for(milliseconds(500));
    EXPECT_EQ(*link_->permission(), Permission::taken);
    // The next part: a new session, nothing told of the old one.
    robot_.rsi_on();
    robot_.set_ipoc(robot_.ipoc() + 500);
    steps_ = {};
    cycles(50);
    EXPECT_EQ(robot_.in_force()[2], 0);
    EXPECT_TRUE(link_->mode());
    ASSERT_TRUE(confirm(raised(2)));
    EXPECT_EQ(*link_->permission(), Permission::given);
    EXPECT_LE(steps_.mm, 0.08);
}

TEST_F(HandMade, AConnectionLostOnThePathTakesThePermissionBack) {
    open();
    cycles(5);
    ASSERT_TRUE(confirm(raised(1)));
    for (int i = 0; i < 50; ++i) {
        robot_.programmed.translation().y() += 0.4;
        ASSERT_TRUE(cycle());
    }
    ASSERT_EQ(*link_->permission(), Permission::running);
    std::this_thread::sleep_for(milliseconds(500));
    EXPECT_THAT(link_->permission().error().what, HasSubstr("fell silent under a correction"));
    EXPECT_EQ(*link_->permission(), Permission::none);
}

}  // namespace
}  // namespace seamwright
