// The RSI driver before a simulated controller over UDP, and before a hand-made robot for lost, repeated and
// exchanged telegrams.

#include "devices/kuka/rsi.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "core/geometry/notation.h"
#include "devices/exchange/pose_json.h"
#include "devices/kuka/rsi_telegram.h"
#include "devices/net/socket.h"

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
    nlohmann::json settings = link_settings(port), robot = {{"port", port}, {"restart_ms", 300}};
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
    std::this_thread::sleep_for(milliseconds(30));
    expect_on_displaced_path(pair.robot().newest(), b, 1e-5);
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
    // A machine that pauses loses an increment, which is an alarm; then RSI must start anew.
    if (!confirmed && confirmed.error().what.find("increment was lost") != std::string::npos)
        GTEST_SKIP() << "the machine paused";
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

// A robot by hand.
class HandMade : public testing::Test {
  protected:
    void open(nlohmann::json more = nlohmann::json::object()) {
        port_ = free_port();
        nlohmann::json settings = link_settings(port_);
        settings.update({{"session_gap_ms", 1500}, {"max_late", 4}});
        settings.update(more);
        DeviceSession session;
        auto link = open_kuka_rsi(settings, session, nullptr);
        ASSERT_TRUE(link) << link.error().sentence();
        link_ = std::move(*link);
    }
    // The answer, or nothing within `wait`.
    std::optional<RsiSen> ask(std::uint64_t ipoc, std::uint64_t delay = 0, double x = 900,
                              int wait_ms = 1000) {
        const std::string text = fmt::format(
            "<Rob Type=\"KUKA\"><RSol X=\"{}\" Y=\"-200\" Z=\"600\" A=\"0\" B=\"0\" C=\"0\"/><Delay "
            "D=\"{}\"/>"
            "<IPOC>{}</IPOC></Rob>",
            x, delay, ipoc);
        EXPECT_TRUE(socket_.send_to(bytes_of(text), {"127.0.0.1", port_}));
        std::array<std::byte, 2048> buffer;
        Endpoint from;
        const auto size = socket_.receive(buffer, from, Timeout(wait_ms));
        if (!size) return std::nullopt;
        auto sen = parse_rsi_sen(std::span(buffer).first(*size));
        EXPECT_TRUE(sen);
        return *sen;
    }
    const CyclicServer& server() { return static_cast<CyclicLink&>(*link_).server(); }

    std::uint16_t port_ = 0;
    UdpSocket socket_ = *UdpSocket::bind("127.0.0.1", 0);
    std::unique_ptr<RobotLink> link_;
};

TEST_F(HandMade, EchoesTheIpocAndNeverAnswersOldOnes) {
    open();
    EXPECT_EQ(ask(1000)->ipoc, "1000");
    EXPECT_EQ(ask(1004)->ipoc, "1004");
    EXPECT_FALSE(ask(1004, 0, 900, 60)) << "repeated";
    EXPECT_FALSE(ask(1000, 0, 900, 60)) << "exchanged";
    EXPECT_EQ(ask(1020)->ipoc, "1020");
    EXPECT_EQ(server().counters().out_of_order, 2u);
    EXPECT_EQ(server().counters().missed_cycles, 3u);
    // A stranger is not answered while the robot is there; rubbish never.
    UdpSocket stranger = *UdpSocket::bind("127.0.0.1", 0);
    ASSERT_TRUE(stranger.send_to(bytes_of("<Rob><IPOC>2000</IPOC></Rob>"), {"127.0.0.1", port_}));
    ASSERT_TRUE(socket_.send_to(bytes_of("<Rob><IPOC>"), {"127.0.0.1", port_}));
    ASSERT_TRUE(socket_.send_to(bytes_of(std::string(20000, 'x')), {"127.0.0.1", port_}));
    EXPECT_EQ(ask(1024)->ipoc, "1024");
    EXPECT_EQ(server().counters().strangers, 1u);
    EXPECT_EQ(server().counters().bad, 2u);
}

TEST_F(HandMade, LostAnswersDoNotMakeTheCorrectionJumpAndTooManyWithdrawIt) {
    open({{"max_late", 6}});
    ASSERT_TRUE(ask(1000));
    Pose moved = kTaught;
    moved.translation().z() += 1;
    ASSERT_TRUE(link_->write_frame("PATH", moved));
    std::thread confirming([&] { (void)link_->confirm(PartVerdict::corrected, ""); });
    std::uint64_t ipoc = 1000;
    double last = 0;
    int since_up = -1;
    for (int i = 0; i < 20000 && since_up < 400; ++i) {
        if (since_up < 0 && std::abs(last - 1) < 1e-6 && server().state().steady > 5) {
            confirming.join();
            since_up = 0;
        }
        ipoc += since_up >= 0 && since_up % 90 == 50 ? 12 : 4;  // two cycles lost now and then
        const auto sen = ask(ipoc);
        ASSERT_TRUE(sen);
        const double z = sen->rkorr->xyzabc[2];
        ASSERT_LE(std::abs(z - last), 50 * 0.004 + 1e-6);
        if (since_up >= 0 && ++since_up == 200) {
            EXPECT_EQ(z, 1) << "four lost are borne";
        }
        last = z;
    }
    ASSERT_EQ(since_up, 400);
    EXPECT_EQ(last, 0) << "withdrawn";
    const auto told = link_->mode();
    ASSERT_FALSE(told);
    EXPECT_THAT(told.error().what, HasSubstr("late or lost"));
}

TEST_F(HandMade, ALostIncrementFreezesTheSum) {
    open({{"mode", "relative"}});
    ASSERT_TRUE(ask(1000));
    Pose moved = kTaught;
    moved.translation().z() += 5;
    ASSERT_TRUE(link_->write_frame("PATH", moved));
    Expected<void> confirmed;
    std::thread confirming([&] { confirmed = link_->confirm(PartVerdict::corrected, ""); });
    std::uint64_t ipoc = 1000;
    double sum = 0;
    while (sum < 0.5) {
        const auto sen = ask(ipoc += 4);
        ASSERT_TRUE(sen);
        sum += sen->rkorr->xyzabc[2];
    }
    for (int i = 0; i < 50; ++i) {
        const auto sen = ask(ipoc += 4, 1);  // one answer came too late
        ASSERT_TRUE(sen);
        for (const double x : sen->rkorr->xyzabc) EXPECT_EQ(x, 0);
    }
    confirming.join();
    ASSERT_FALSE(confirmed);
    EXPECT_THAT(confirmed.error().what, HasSubstr("increment was lost"));
}

TEST_F(HandMade, AJumpOfThePathIsAnAlarm) {
    open();
    ASSERT_TRUE(ask(1000));
    ASSERT_TRUE(link_->write_frame("PATH", written()));
    std::atomic<bool> done = false;
    std::thread confirming([&] {
        EXPECT_TRUE(link_->confirm(PartVerdict::corrected, ""));
        done = true;
    });
    std::uint64_t ipoc = 1000;
    while (!done) EXPECT_TRUE(ask(ipoc += 4));
    confirming.join();
    ASSERT_TRUE(ask(ipoc += 4, 0, 1500));
    const auto told = link_->read_frame("PATH");
    ASSERT_FALSE(told);
    EXPECT_THAT(told.error().what, HasSubstr("jumped"));
}

}  // namespace
}  // namespace seamwright
