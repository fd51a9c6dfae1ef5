// The RSI driver before a simulated controller over UDP, and before a hand-made robot for lost, repeated and
// exchanged telegrams.

#include "devices/kuka/rsi.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstdio>
#include <thread>
#include <tuple>

#include "core/geometry/notation.h"
#include "devices/controllers/kuka/rsi_controller.h"
#include "devices/exchange/pose_json.h"
#include "devices/kuka/rsi_telegram.h"
#include "devices/net/socket.h"
#include "rsi_robot.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using testing::HasSubstr;

std::uint16_t free_port() {
    return UdpSocket::bind("127.0.0.1", 0)->port();
}
const Pose kTaught = make_pose(rotation_exp({0, 0, 0.3}), {900, -200, 600});
const Pose kDisplaced = make_pose(rotation_exp({0.004, -0.002, 0.005}), {0.8, -0.6, 0.5});

nlohmann::json link_settings(std::uint16_t port) {
    return {{"port", port},
            {"frames", {{"PATH", {{"base_from_frame", pose_json(kTaught)}}}}},
            {"speed_mm_s", 50},
            {"speed_deg_s", 10},
            {"acceleration_mm_s2", 500},
            {"acceleration_deg_s2", 100},
            {"max_late", 60},
            {"timeout_ms", 400},
            {"confirm_timeout_ms", 4000},
            {"session_gap_ms", 500}};
}

// B about the taught frame, so that the offset there is small.
Pose written() {
    return make_pose(kDisplaced.linear() * kTaught.linear(),
                     kTaught.translation() + kDisplaced.translation());
}

struct Pair {
    std::unique_ptr<RobotLink> link;
    std::unique_ptr<SimulatedController> controller;
    SimulatedRsi& robot() { return static_cast<SimulatedRsi&>(*controller); }
    CyclicLink& cyclic() { return static_cast<CyclicLink&>(*link); }
};

Pair open_pair(nlohmann::json more_link = {}, nlohmann::json more_robot = {}) {
    const std::uint16_t port = free_port();
    nlohmann::json settings = link_settings(port),
                   robot = {{"port", port}, {"restart_ms", 300}, {"application", false}};
    if (!more_link.is_null()) settings.update(more_link);
    if (!more_robot.is_null()) robot.update(more_robot);
    DeviceSession session;
    Pair pair;
    auto link = open_kuka_rsi(settings, session, nullptr);
    EXPECT_TRUE(link) << link.error().sentence();
    auto controller = start_kuka_rsi(nullptr, robot, nullptr);
    EXPECT_TRUE(controller) << controller.error().sentence();
    pair.link = std::move(*link);
    pair.controller = std::move(*controller);
    return pair;
}

void expect_on_displaced_path(const SimulatedRsi::Sample& s, const Pose& b, double tolerance_mm) {
    const Pose wanted = b * s.programmed;
    EXPECT_LT((s.corrected.translation() - wanted.translation()).norm(), tolerance_mm);
    EXPECT_LT(deg_from_rad(angle_rad(s.corrected, wanted)), 1e-5);
}

class RsiReference : public testing::TestWithParam<const char*> {};

TEST_P(RsiReference, TheCorrectedPathIsTheDisplacedPath) {
    // A displacement about the base's origin far away: the offset varies along the path.
    Pair pair = open_pair({{"reference", GetParam()}}, {{"reference", GetParam()}});
    ASSERT_TRUE(pair.link->identity());
    EXPECT_EQ(pair.link->identity()->brand, "KUKA");
    ASSERT_TRUE(pair.link->read_frame("PATH"));
    ASSERT_TRUE(pair.link->write_frame("PATH", written()));
    EXPECT_LT(distance_mm(*pair.link->read_frame("PATH"), written()), 1e-12);
    std::this_thread::sleep_for(milliseconds(30));
    for (const double x : pair.robot().newest().correction) EXPECT_EQ(x, 0) << "staged only";
    const auto confirmed = pair.link->confirm(PartVerdict::corrected, "");
    ASSERT_TRUE(confirmed) << confirmed.error().sentence();
    EXPECT_TRUE(pair.robot().released());
    const Pose b = written() * kTaught.inverse();
    std::this_thread::sleep_for(milliseconds(60));
    // A machine that pauses loses an answer, and the robot then keeps the last; in time it is exact.
    auto best = pair.robot().newest();
    for (const auto& s : pair.robot().history())
        if (distance_mm(s.corrected, b * s.programmed) < distance_mm(best.corrected, b * best.programmed))
            best = s;
    expect_on_displaced_path(best, b, 1e-5);
    EXPECT_LT(distance_mm(pair.robot().newest().corrected, b * pair.robot().newest().programmed), 5e-2);
    const auto flange = pair.link->base_from_flange();
    ASSERT_TRUE(flange);
    ASSERT_TRUE(pair.link->confirm(PartVerdict::refused, ""));
    std::this_thread::sleep_for(milliseconds(60));
    EXPECT_FALSE(pair.robot().released());
    for (const double x : pair.robot().newest().correction) EXPECT_EQ(x, 0);
    // Nothing that was in force ever left the limits.
    for (const auto& s : pair.robot().history())
        EXPECT_LE(Eigen::Vector3d(s.correction[0], s.correction[1], s.correction[2]).norm(), 10);
    EXPECT_EQ(pair.robot().stops(), 0u);
    EXPECT_GT(pair.cyclic().server().counters().answers, 20u);
}
INSTANTIATE_TEST_SUITE_P(Both, RsiReference, testing::Values("base", "tool"));

TEST(Rsi, RelativeIncrementsAddUpToTheCorrection) {
    Pair pair = open_pair({{"mode", "relative"}, {"cycle_ms", 12}},
                          {{"mode", "relative"}, {"cycle_ms", 12}, {"speed_mm_s", 0}});
    ASSERT_TRUE(pair.link->write_frame("PATH", written()));
    auto confirmed = pair.link->confirm(PartVerdict::corrected, "");
    ASSERT_TRUE(confirmed) << confirmed.error().sentence();
    std::this_thread::sleep_for(milliseconds(30));
    expect_on_displaced_path(pair.robot().newest(), written() * kTaught.inverse(), 1e-6);
}

TEST(Rsi, RefusesBeyondTheLimitsInWords) {
    Pair pair = open_pair({{"max_translation_mm", 2}, {"max_rotation_deg", 0.5}});
    Pose far = kTaught, turned = kTaught;
    far.translation().x() += 2.5;
    turned.linear() = rotation_exp({0, 0, rad_from_deg(0.6)}) * turned.linear();
    EXPECT_THAT(pair.link->write_frame("PATH", far).error().what,
                HasSubstr("2.500 mm is beyond the limit of 2.000"));
    EXPECT_THAT(pair.link->write_frame("PATH", turned).error().what, HasSubstr("0.6000 degrees is beyond"));
    EXPECT_FALSE(pair.link->write_frame("OTHER", kTaught));
    EXPECT_FALSE(pair.link->start_measuring({}));
}

TEST(Rsi, SettingsAreStrict) {
    DeviceSession session;
    for (const nlohmann::json& wrong :
         {nlohmann::json{{"prot", 1}}, nlohmann::json{{"port", 70000}}, nlohmann::json{{"mode", "sum"}},
          nlohmann::json{{"mode", "relative"}, {"reference", "tool"}}, nlohmann::json{{"decimals", 20}},
          nlohmann::json{{"sen_type", "a<b"}}, nlohmann::json{{"listen", 3}}, nlohmann::json{{"cycle_ms", 0}},
          nlohmann::json{{"measuring", {{"driver", "kuka-rsi"}}}},
          nlohmann::json{{"frames", {{"A", {{"pose", 1}}}}}}}) {
        EXPECT_FALSE(open_kuka_rsi(wrong, session, nullptr)) << wrong.dump();
    }
}

// What the alarm says, fault by fault, with the correction in force when the fault begins.
struct Fault {
    ControllerFault fault;
    const char* says;
};
void PrintTo(const Fault& f, std::ostream* out) {
    *out << to_string(f.fault);
}
class RsiFault : public testing::TestWithParam<Fault> {};

TEST_P(RsiFault, IsToldLeavesNothingInForceAndEnds) {
    Pair pair = open_pair({{"max_late", 30}}, {{"late_limit", 40}, {"slow_ms", 60}});
    ASSERT_TRUE(pair.link->write_frame("PATH", written()));
    const bool refuses = GetParam().fault == ControllerFault::reject_write;
    if (refuses) pair.controller->set_fault(GetParam().fault);
    auto result = pair.link->confirm(PartVerdict::corrected, "");
    if (!refuses) {
        ASSERT_TRUE(result) << result.error().sentence();
        EXPECT_TRUE(pair.controller->released());
        pair.controller->set_fault(GetParam().fault);
        const auto patience = Clock::now() + milliseconds(3000);
        while (!pair.cyclic().server().alarm() && Clock::now() < patience)
            std::this_thread::sleep_for(milliseconds(5));
        result = pair.link->mode().map([](RobotMode) {});
    }
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().what, HasSubstr(GetParam().says));
    pair.controller->set_fault(ControllerFault::none);
    const auto deadline = Clock::now() + milliseconds(4000);
    Expected<RobotMode> mode = pair.link->mode();
    while (!mode && Clock::now() < deadline) mode = pair.link->mode();
    ASSERT_TRUE(mode) << mode.error().sentence();
    while (pair.controller->released() && Clock::now() < deadline)
        std::this_thread::sleep_for(milliseconds(10));
    EXPECT_FALSE(pair.controller->released());
    // And again.
    Expected<void> again;
    do again = pair.link->confirm(PartVerdict::corrected, "");
    while (!again && Clock::now() < deadline);
    ASSERT_TRUE(again) << again.error().sentence();
}
INSTANTIATE_TEST_SUITE_P(
    All, RsiFault,
    testing::Values(Fault{ControllerFault::silent, "fell silent under a correction"},
                    Fault{ControllerFault::slow, "late or lost"},
                    Fault{ControllerFault::wrong_answer, "repeats old cycle numbers"},
                    Fault{ControllerFault::half_message, "fell silent under a correction"},
                    Fault{ControllerFault::disconnect, "fell silent under a correction"},
                    Fault{ControllerFault::reject_write, "under a correction"},
                    Fault{ControllerFault::out_of_range, "a position that it cannot have"}));

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

TEST(RsiApplication, RunsOnceItIsReleasedAndIsTakenAtItsEnd) {
    Pair pair = open_pair({}, {{"application", true}, {"path_s", 0.4}, {"restart_ms", 800}});
    ASSERT_TRUE(pair.link->write_frame("PATH", written()));
    std::this_thread::sleep_for(milliseconds(60));
    const Pose stands = pair.robot().newest().programmed;
    const auto confirmed = pair.link->confirm(PartVerdict::corrected, "");
    ASSERT_TRUE(confirmed) << confirmed.error().sentence();
    EXPECT_LT(distance_mm(pair.robot().history().front().programmed, stands), 1e-9) << "it waits";
    bool ran = false;
    Expected<Permission> permission = Permission::none;
    const auto deadline = Clock::now() + milliseconds(8000);
    while (Clock::now() < deadline) {
        permission = pair.link->permission();
        ASSERT_TRUE(permission) << permission.error().sentence();
        ran = ran || *permission == Permission::running;
        if (*permission == Permission::taken) break;
        std::this_thread::sleep_for(milliseconds(5));
    }
    EXPECT_TRUE(ran);
    EXPECT_EQ(*permission, Permission::taken);
    pair.link.reset();
    std::this_thread::sleep_for(milliseconds(200));
    EXPECT_TRUE(pair.controller->released()) << "it is the application's";
    EXPECT_TRUE(pair.controller->taken());
}

// Where the robot is on its programmed path once nothing has moved for 200 ms; nothing within `most`.
std::optional<Pose> comes_to_stand(const SimulatedRsi& robot, milliseconds most) {
    Pose before = robot.newest().programmed;
    int still = 0;
    for (const auto until = Clock::now() + most; Clock::now() < until;) {
        std::this_thread::sleep_for(milliseconds(20));
        const Pose now = robot.newest().programmed;
        still = distance_mm(now, before) < 1e-9 ? still + 1 : 0;
        before = now;
        if (still == 10) return now;
    }
    return std::nullopt;
}

bool runs(CyclicLink& link, milliseconds most) {
    for (const auto until = Clock::now() + most; Clock::now() < until;) {
        const auto permission = link.permission();
        if (permission && *permission == Permission::running) return true;
        std::this_thread::sleep_for(milliseconds(2));
    }
    return false;
}

// How the permission goes while the path runs: the program ends, or the robot does what no robot should.
class RsiWithdrawn : public testing::TestWithParam<const char*> {};

TEST_P(RsiWithdrawn, StopsThePathWhichIsNeverTaken) {
    Pair pair = open_pair({{"max_late", 5}}, {{"application", true}, {"path_s", 1.5}, {"restart_ms", 700}});
    ASSERT_TRUE(pair.link->write_frame("PATH", written()));
    const auto confirmed = pair.link->confirm(PartVerdict::corrected, "");
    ASSERT_TRUE(confirmed) << confirmed.error().sentence();
    ASSERT_TRUE(runs(pair.cyclic(), milliseconds(1000)));
    const Pose begin = pair.robot().history().front().programmed;
    const std::string how = GetParam();
    if (how == "program ends") {
        pair.link.reset();
    } else if (how == "verdict") {
        ASSERT_TRUE(pair.link->confirm(PartVerdict::failed, ""));
    } else {
        pair.controller->set_fault(ControllerFault::out_of_range);  // an alarm of the corrector
        std::this_thread::sleep_for(milliseconds(40));
        pair.controller->set_fault(ControllerFault::none);
        EXPECT_FALSE(pair.link->permission());
    }
    const auto stands = comes_to_stand(pair.robot(), milliseconds(900));
    ASSERT_TRUE(stands) << "it ran on";
    EXPECT_GT(distance_mm(*stands, begin), 1) << "in the middle of the path";
    std::this_thread::sleep_for(milliseconds(800));
    EXPECT_FALSE(pair.controller->taken());
    EXPECT_FALSE(pair.controller->released());
    if (!pair.link) return;
    // The program that is started next begins at the beginning, and waits.
    const auto from_begin = [&] { return distance_mm(pair.robot().newest().programmed, begin); };
    for (const auto until = Clock::now() + milliseconds(4000); from_begin() > 1e-9 && Clock::now() < until;)
        std::this_thread::sleep_for(milliseconds(10));
    EXPECT_LT(from_begin(), 1e-9);
    EXPECT_TRUE(comes_to_stand(pair.robot(), milliseconds(1000)));
    ASSERT_FALSE(pair.robot().messages().empty());
    EXPECT_THAT(pair.robot().messages().front(), HasSubstr("the path was stopped"));
    Expected<void> next;
    for (const auto until = Clock::now() + milliseconds(4000); Clock::now() < until;) {
        next = pair.link->confirm(PartVerdict::corrected, "");
        if (next) break;
    }
    ASSERT_TRUE(next) << next.error().sentence();
    EXPECT_TRUE(runs(pair.cyclic(), milliseconds(1000)));
}
INSTANTIATE_TEST_SUITE_P(Ways, RsiWithdrawn, testing::Values("program ends", "verdict", "alarm"),
                         [](const auto& way) {
                             std::string name = way.param;
                             std::replace(name.begin(), name.end(), ' ', '_');
                             return name;
                         });

}  // namespace
}  // namespace seamwright
