// EGM path correction: known bytes, path coordinates by an independent way, the driver before a simulated
// controller.

#include "devices/abb/egm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <limits>
#include <random>
#include <thread>

#include "devices/abb/egm_message.h"
#include "devices/controllers/abb/egm_controller.h"
#include "devices/exchange/pose_json.h"
#include "devices/net/socket.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using testing::HasSubstr;

// Wire bytes put together by hand from the field numbers of ABB's egm.proto, without any protobuf code.
std::string varint(std::uint64_t v) {
    std::string s;
    do {
        s += static_cast<char>((v & 0x7f) | (v > 0x7f ? 0x80 : 0));
        v >>= 7;
    } while (v);
    return s;
}
std::string number(int field, std::uint64_t v) {
    return varint(static_cast<std::uint64_t>(field) << 3) + varint(v);
}
std::string real(int field, double v) {
    std::string s = varint(static_cast<std::uint64_t>(field) << 3 | 1);
    char raw[8];
    std::memcpy(raw, &v, 8);  // little endian, as this machine
    return s + std::string(raw, 8);
}
std::string message(int field, const std::string& body) {
    return varint(static_cast<std::uint64_t>(field) << 3 | 2) + varint(body.size()) + body;
}
std::string pose(double x, double y, double z) {
    return message(1, real(1, x) + real(2, y) + real(3, z)) +
           message(2, real(1, 0) + real(2, 1) + real(3, 0) + real(4, 0)) +
           message(3, real(1, 180) + real(2, 0) + real(3, 0));  // Euler too, as controllers send it
}
// All that RobotWare 7 sends, fields that we do not know included.
std::string robot_bytes(std::uint32_t seqno, int type = 2) {
    std::string joints;
    for (int i = 0; i < 6; ++i) joints += real(1, i);
    const std::string clock = number(1, 1700000000) + number(2, 500000);
    return message(1, number(1, seqno) + number(2, 123456) + number(3, static_cast<std::uint64_t>(type))) +
           message(2, message(1, joints) + message(2, pose(900.5, -200, 600)) + message(3, "") +
                          message(4, clock)) +
           message(3, message(1, joints) + message(2, pose(901, -200, 600)) + message(4, clock)) +
           message(4, number(1, 1)) + message(5, number(1, 3)) + number(6, 1) + message(7, real(1, 0)) +
           message(8, number(1, 2)) + message(9, number(1, 0)) + real(10, 12.5) + number(11, 4);
}

TEST(EgmMessage, ReadsABytesPutTogetherFromTheFieldNumbers) {
    const auto s = parse_egm_robot(bytes_of(robot_bytes(77)));
    ASSERT_TRUE(s) << s.error().sentence();
    EXPECT_EQ(s->seqno, 77u);
    EXPECT_EQ(s->tm_ms, 123456u);
    EXPECT_TRUE(s->motors_on && s->rapid_running && s->usable);
    EXPECT_EQ(s->mci, EgmMci::running);
    ASSERT_TRUE(s->planned && s->measured);
    EXPECT_EQ(s->planned->translation(), Eigen::Vector3d(901, -200, 600));
    EXPECT_EQ(s->measured->translation(), Eigen::Vector3d(900.5, -200, 600));
    EXPECT_LT((s->planned->linear().col(2) - Eigen::Vector3d(0, 0, -1)).norm(), 1e-12);
}

TEST(EgmMessage, WritesTheBytesOfTheFieldNumbers) {
    std::array<std::byte, 256> buffer;
    const auto bytes = write_egm_path_correction(buffer, {5, 1000, 1, {0, 1.5, -2}});
    const std::string wanted = message(1, number(1, 5) + number(2, 1000) + number(3, 4)) +
                               message(2, message(1, real(1, 0) + real(2, 1.5) + real(3, -2)) + number(2, 1));
    EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), wanted);
    EXPECT_TRUE(write_egm_path_correction(std::span(buffer).first(10), {}).empty());
}

TEST(EgmMessage, RefusesWhatIsNoneAndNeverThrows) {
    EXPECT_FALSE(parse_egm_robot({}));
    EXPECT_FALSE(parse_egm_robot(bytes_of(robot_bytes(1, 3))));
    EXPECT_FALSE(parse_egm_robot(bytes_of(std::string(9000, 'x'))));
    EXPECT_FALSE(parse_egm_robot(bytes_of(message(1, number(2, 1)))));
    EXPECT_FALSE(parse_egm_path_correction(bytes_of(robot_bytes(1))));
    const std::string half =
        message(1, number(1, 1)) + message(3, message(2, message(1, real(1, 1)) + message(2, "")));
    EXPECT_FALSE(parse_egm_robot(bytes_of(half)));
    for (const double x :
         {1e9, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        const auto s =
            parse_egm_robot(bytes_of(message(1, number(1, 1)) + message(3, message(2, pose(x, 0, 0)))));
        ASSERT_TRUE(s);
        EXPECT_FALSE(s->usable);
        EXPECT_FALSE(s->planned);
    }
    std::mt19937 random(5);
    const std::string whole = robot_bytes(9);
    for (std::size_t cut = 0; cut < whole.size(); ++cut)
        (void)parse_egm_robot(bytes_of(whole.substr(0, cut)));
    for (int i = 0; i < 20000; ++i) {
        std::string changed = whole;
        for (int k = 0; k < 3; ++k) changed[random() % changed.size()] = static_cast<char>(random() % 256);
        (void)parse_egm_robot(bytes_of(changed));
    }
}

// The same axes by Gram-Schmidt: what is left of the tool's z across the travel is -z of the path or z.
TEST(EgmPath, AxesAreThoseOfTheManual) {
    // Torch down, travel along +x: y = (0, 0, -1) x (1, 0, 0) = (0, -1, 0), z = x x y = (0, 0, -1).
    const auto known = reference_from_path({10, 0, 0}, {0, 0, -1});
    ASSERT_TRUE(known);
    EXPECT_EQ(known->col(1), Eigen::Vector3d(0, -1, 0));
    EXPECT_EQ(known->col(2), Eigen::Vector3d(0, 0, -1));
    std::mt19937 random(11);
    std::uniform_real_distribution<double> u(-1, 1);
    for (int i = 0; i < 1000; ++i) {
        const Eigen::Vector3d travel(u(random), u(random), u(random)), tool(u(random), u(random), u(random));
        const auto path = reference_from_path(travel, tool.normalized());
        if (!path) continue;
        const Eigen::Vector3d x = travel.normalized();
        const Eigen::Vector3d z = (tool - x * x.dot(tool)).normalized();
        EXPECT_LT((path->col(0) - x).norm(), 1e-9);
        EXPECT_LT((path->col(2) - z).norm(), 1e-9);
        EXPECT_NEAR(path->determinant(), 1, 1e-9);
    }
    EXPECT_FALSE(reference_from_path({0, 0, 1}, {0, 0, -1}));
    EXPECT_FALSE(reference_from_path({0, 0, 0}, {0, 0, -1}));
}

const Pose kEgmTaught = make_pose(rotation_exp({0, 0, 0.3}), {900, -200, 600});
Pose egm_written() {
    return make_pose(rotation_exp({0.002, -0.001, 0.003}) * kEgmTaught.linear(),
                     kEgmTaught.translation() + Eigen::Vector3d(0.8, -0.6, 0.5));
}

struct EgmPair {
    std::unique_ptr<RobotLink> link;
    std::unique_ptr<SimulatedController> controller;
    SimulatedEgm& robot() { return static_cast<SimulatedEgm&>(*controller); }
    const CyclicServer& server() { return static_cast<CyclicLink&>(*link).server(); }
};

EgmPair open_egm(const nlohmann::json& more_robot,
                 const nlohmann::json& more_link = nlohmann::json::object()) {
    const std::uint16_t port = UdpSocket::bind("127.0.0.1", 0)->port();
    nlohmann::json settings = {{"port", port},
                               {"frames", {{"PATH", {{"base_from_frame", pose_json(kEgmTaught)}}}}},
                               {"speed_mm_s", 50},
                               {"speed_deg_s", 10},
                               {"acceleration_mm_s2", 500},
                               {"acceleration_deg_s2", 100},
                               {"max_late", 60},
                               {"timeout_ms", 400},
                               {"confirm_timeout_ms", 4000},
                               {"session_gap_ms", 500}};
    settings.update(more_link);
    nlohmann::json robot = {{"port", port}, {"restart_ms", 400}, {"slow_ms", 60}, {"application", false}};
    robot.update(more_robot);
    DeviceSession session;
    EgmPair pair;
    auto link = open_abb_egm(settings, session, nullptr);
    EXPECT_TRUE(link) << link.error().sentence();
    auto controller = start_abb_egm(nullptr, robot, nullptr);
    EXPECT_TRUE(controller) << controller.error().sentence();
    pair.link = std::move(*link);
    pair.controller = std::move(*controller);
    return pair;
}

class EgmOnPath : public testing::TestWithParam<bool> {};

TEST_P(EgmOnPath, ThePathIsShiftedAcrossItself) {
    EgmPair pair = open_egm({{"straight", GetParam()}});
    ASSERT_TRUE(pair.link->write_frame("PATH", egm_written()));
    const auto confirmed = pair.link->confirm(PartVerdict::corrected, "");
    ASSERT_TRUE(confirmed) << confirmed.error().sentence();
    EXPECT_TRUE(pair.controller->released());
    std::this_thread::sleep_for(milliseconds(50));
    const auto s = pair.robot().newest();
    const Pose b = egm_written() * kEgmTaught.inverse();
    const Eigen::Vector3d p = s.programmed.translation();
    Eigen::Vector3d wanted = b * p - p;
    wanted -= s.travel * s.travel.dot(wanted);
    // A machine that pauses loses an answer, and the simulated robot then keeps the last: a cycle's
    // difference.
    EXPECT_LT((s.corrected.translation() - p - wanted).norm(), GetParam() ? 2e-2 : 3e-2);
    // Most cycles are answered in time, and there the shift is exact.
    double best = 1;
    for (const auto& h : pair.robot().history()) {
        Eigen::Vector3d w = b * h.programmed.translation() - h.programmed.translation();
        w -= h.travel * h.travel.dot(w);
        best = std::min(best, (h.corrected.translation() - h.programmed.translation() - w).norm());
        EXPECT_EQ(h.told_mm.x(), 0) << "x is not corrected";
    }
    EXPECT_LT(best, GetParam() ? 1e-6 : 1e-4);
    ASSERT_TRUE(pair.link->confirm(PartVerdict::refused, ""));
    const auto deadline = Clock::now() + milliseconds(1000);
    // The robot stops, and EGM leads its correction out.
    while ((pair.controller->released() || !pair.robot().newest().told_mm.isZero(0)) &&
           Clock::now() < deadline)
        std::this_thread::sleep_for(milliseconds(5));
    EXPECT_FALSE(pair.controller->released());
    EXPECT_TRUE(pair.robot().newest().told_mm.isZero(0));
}
INSTANTIATE_TEST_SUITE_P(LineAndCircle, EgmOnPath, testing::Bool());

TEST(Egm, ATurnIsRefusedAsEgmCannotMakeIt) {
    EgmPair pair = open_egm(nlohmann::json::object());
    Pose turned = kEgmTaught;
    turned.linear() = rotation_exp({0, 0, rad_from_deg(0.6)}) * turned.linear();
    const auto refused = pair.link->write_frame("PATH", turned);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().what, HasSubstr("0.6000 degrees is beyond the limit of 0.5000"));
}

struct EgmFaultCase {
    ControllerFault fault;
    const char* says;
};
void PrintTo(const EgmFaultCase& f, std::ostream* out) {
    *out << to_string(f.fault);
}
class EgmFault : public testing::TestWithParam<EgmFaultCase> {};

TEST_P(EgmFault, IsToldLeavesNothingInForceAndEnds) {
    EgmPair pair = open_egm({{"late_limit", 40}});
    ASSERT_TRUE(pair.link->write_frame("PATH", egm_written()));
    const bool refuses = GetParam().fault == ControllerFault::reject_write;
    if (refuses) pair.controller->set_fault(GetParam().fault);
    auto result = pair.link->confirm(PartVerdict::corrected, "");
    if (!refuses) {
        ASSERT_TRUE(result) << result.error().sentence();
        pair.controller->set_fault(GetParam().fault);
        const auto patience = Clock::now() + milliseconds(3000);
        while (!pair.server().alarm() && Clock::now() < patience)
            std::this_thread::sleep_for(milliseconds(5));
        result = pair.link->mode().map([](RobotMode) {});
    }
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().what, HasSubstr(GetParam().says));
    pair.controller->set_fault(ControllerFault::none);
    const auto deadline = Clock::now() + milliseconds(5000);
    while (pair.controller->released() && Clock::now() < deadline)
        std::this_thread::sleep_for(milliseconds(10));
    EXPECT_FALSE(pair.controller->released());
    Expected<void> again;
    do again = pair.link->confirm(PartVerdict::corrected, "");
    while (!again && Clock::now() < deadline);
    ASSERT_TRUE(again) << again.error().sentence();
}
INSTANTIATE_TEST_SUITE_P(
    All, EgmFault,
    testing::Values(EgmFaultCase{ControllerFault::silent, "fell silent under a correction"},
                    EgmFaultCase{ControllerFault::slow, "late or lost"},
                    EgmFaultCase{ControllerFault::wrong_answer, "fell silent under a correction"},
                    EgmFaultCase{ControllerFault::half_message, "fell silent under a correction"},
                    EgmFaultCase{ControllerFault::disconnect, "fell silent under a correction"},
                    EgmFaultCase{ControllerFault::reject_write, "left the state"},
                    EgmFaultCase{ControllerFault::out_of_range, "a position that it cannot have"}));

TEST(Egm, ARobotThatStandsIsNotConfirmed) {
    EgmPair pair = open_egm({{"speed_mm_s", 0}}, {{"confirm_timeout_ms", 600}});
    ASSERT_TRUE(pair.link->write_frame("PATH", egm_written()));
    // A machine that pauses hears no robot at times and says that; it is never confirmed.
    const auto deadline = Clock::now() + milliseconds(10000);
    Expected<void> refused;
    do {
        refused = pair.link->confirm(PartVerdict::corrected, "");
        ASSERT_FALSE(refused);
    } while (refused.error().what.english().find("the robot stands") == std::string::npos &&
             Clock::now() < deadline);
    EXPECT_THAT(refused.error().what, HasSubstr("the robot stands"));
    EXPECT_FALSE(pair.controller->released());
}

TEST(Egm, ARobotGuidedByJointsIsNotConfirmed) {
    const std::uint16_t port = UdpSocket::bind("127.0.0.1", 0)->port();
    DeviceSession session;
    auto link =
        open_abb_egm({{"port", port}, {"frames", {{"PATH", {{"base_from_frame", pose_json(kEgmTaught)}}}}}},
                     session, nullptr);
    ASSERT_TRUE(link);
    UdpSocket robot = *UdpSocket::bind("127.0.0.1", 0);
    std::atomic<bool> stop = false;
    std::thread asking([&] {
        for (std::uint32_t n = 1; !stop; ++n) {
            const std::string joints = message(1, number(1, n) + number(2, 4 * n) + number(3, 2)) +
                                       message(4, number(1, 1)) + message(5, number(1, 3)) +
                                       message(8, number(1, 2));
            (void)robot.send_to(bytes_of(joints), {"127.0.0.1", port});
            std::this_thread::sleep_for(milliseconds(4));
        }
    });
    std::this_thread::sleep_for(milliseconds(50));
    ASSERT_TRUE((*link)->write_frame("PATH", egm_written()));
    const auto refused = (*link)->confirm(PartVerdict::corrected, "");
    stop = true;
    asking.join();
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().what, HasSubstr("carry no planned Cartesian pose"));
}

// EGM has no release. A path whose permission goes is not run on uncorrected: the robot keeps its correction
// until it stands, and its program raises.
class EgmWithdrawn : public testing::TestWithParam<const char*> {};

TEST_P(EgmWithdrawn, StopsThePathWhichIsNeverTaken) {
    EgmPair pair = open_egm({{"application", true},
                             {"path_s", 3},
                             {"late_limit", 50},
                             {"restart_ms", 1500},
                             {"speed_mm_s", 40},
                             {"straight", true}});
    ASSERT_TRUE(pair.link->write_frame("PATH", egm_written()));
    const auto confirmed = pair.link->confirm(PartVerdict::corrected, "");
    ASSERT_TRUE(confirmed) << confirmed.error().sentence();
    const auto patience = Clock::now() + milliseconds(1000);
    while (*pair.link->permission() != Permission::running && Clock::now() < patience)
        std::this_thread::sleep_for(milliseconds(5));
    ASSERT_EQ(*pair.link->permission(), Permission::running);
    const std::size_t then = pair.robot().history().size();
    const double whole = pair.robot().newest().told_mm.norm();
    ASSERT_GT(whole, 0.5);
    const std::string how = GetParam();
    if (how == "ends") {
        pair.link.reset();
    } else if (how == "verdict") {
        const auto failed = pair.link->confirm(PartVerdict::failed, "");
        EXPECT_TRUE(failed) << failed.error().sentence();
    } else {
        pair.controller->set_fault(ControllerFault::out_of_range);
        std::this_thread::sleep_for(milliseconds(40));
        pair.controller->set_fault(ControllerFault::none);
    }
    std::this_thread::sleep_for(milliseconds(700));
    EXPECT_EQ(pair.robot().stops(), 1u);
    EXPECT_FALSE(pair.controller->taken());
    EXPECT_FALSE(pair.controller->released());
    const auto history = pair.robot().history();
    for (std::size_t i = then + 1; i < history.size(); ++i) {
        const bool moves = distance_mm(history[i].programmed, history[i - 1].programmed) > 1e-9;
        ASSERT_TRUE(!moves || history[i].told_mm.norm() > 0.9 * whole) << "it ran on uncorrected";
    }
    EXPECT_LT(distance_mm(history.back().programmed, history[history.size() - 20].programmed), 1e-9);
    if (how != "verdict") return;
    EXPECT_EQ(*pair.link->permission(), Permission::none);
    Expected<void> next;
    for (const auto until = Clock::now() + milliseconds(4000); Clock::now() < until;) {
        next = pair.link->confirm(PartVerdict::corrected, "");
        if (next) break;
        std::this_thread::sleep_for(milliseconds(50));
    }
    EXPECT_TRUE(next) << next.error().sentence();
}
INSTANTIATE_TEST_SUITE_P(Ways, EgmWithdrawn, testing::Values("ends", "verdict", "alarm"),
                         [](const auto& way) { return std::string(way.param); });

TEST(Egm, ThePathIsTakenAtItsEnd) {
    EgmPair pair = open_egm({{"application", true}, {"path_s", 1}, {"restart_ms", 800}});
    ASSERT_TRUE(pair.link->write_frame("PATH", egm_written()));
    const auto confirmed = pair.link->confirm(PartVerdict::corrected, "");
    ASSERT_TRUE(confirmed) << confirmed.error().sentence();
    Expected<Permission> permission = Permission::none;
    bool ran = false;
    const auto deadline = Clock::now() + milliseconds(6000);
    while (Clock::now() < deadline) {
        permission = pair.link->permission();
        ASSERT_TRUE(permission) << permission.error().sentence();
        ran = ran || *permission == Permission::running;
        if (*permission == Permission::taken) break;
        std::this_thread::sleep_for(milliseconds(5));
    }
    EXPECT_TRUE(ran);
    EXPECT_EQ(*permission, Permission::taken);
    EXPECT_TRUE(pair.controller->taken());
}

}  // namespace
}  // namespace seamwright
