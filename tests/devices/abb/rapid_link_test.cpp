// The link against the simulated controller, over loopback, with every fault.

#include <gtest/gtest.h>

#include <array>
#include <thread>

#include "devices/abb/rapid.h"
#include "devices/abb/rapid_message.h"
#include "devices/controllers/abb/controller.h"
#include "devices/net/socket.h"
#include "devices/silence.h"
#include "devices/simulated/cell.h"

namespace seamwright {
namespace {

using Milliseconds = std::chrono::milliseconds;

std::shared_ptr<SimulatedCell> cell() {
    static const auto shared = [] {
        auto opened = SimulatedCell::open(nlohmann::json::parse(
            R"({"robot": {"frames": {"wobjDoor": {"xyz": [1000, 200, 300], "abc": [10, 20, 30]}}}})"));
        return opened ? *opened : nullptr;
    }();
    return shared;
}

std::vector<MeasuringMove> moves(int count = 3) {
    std::vector<MeasuringMove> result;
    for (int i = 0; i < count; ++i) {
        MeasuringMove move;
        move.spot_id = "S" + std::to_string(i + 1);
        move.trigger.translation() = Eigen::Vector3d(1000 + 50 * i, 10.25, 700);
        move.entry = move.exit = move.trigger;
        result.push_back(move);
    }
    return result;
}

class AbbRapid : public testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(cell());
        cell()->set_mode(RobotMode::automatic);
        cell()->store_program(moves());
        cell()->move_to(moves()[0].trigger);
        // The application stands before the permission: what is given can be seen.
        auto started = start_abb_rapid(cell(), {{"slow_ms", 300}, {"application_wait_ms", 600000}});
        ASSERT_TRUE(started) << started.error().sentence();
        controller = std::move(*started);
        link = open(300);
    }
    std::unique_ptr<RobotLink> open(int timeout_ms) {
        DeviceSession session;
        auto opened = open_abb_rapid(
            {{"port", controller->port()}, {"timeout_ms", timeout_ms}, {"backoff_ms", 10}}, session);
        EXPECT_TRUE(opened) << opened.error().sentence();
        return opened ? std::move(*opened) : nullptr;
    }
    // As soon as the robot's program waits for it.
    Expected<void> start_measuring() {
        Expected<void> started = device_error("not tried");
        for (int i = 0; i < 100 && !started; ++i) {
            started = link->start_measuring(moves());
            if (!started) std::this_thread::sleep_for(Milliseconds(50));
        }
        return started;
    }
    std::unique_ptr<SimulatedController> controller;
    std::unique_ptr<RobotLink> link;
};

Pose far_pose() {
    return make_pose(rotation_exp({0.3, -1.1, 2.2}), {4987.6543, -4999.9876, 4321.1234});
}

TEST_F(AbbRapid, TellsWhoItIsAndHowItStands) {
    const auto identity = link->identity();
    ASSERT_TRUE(identity) << identity.error().sentence();
    EXPECT_EQ(*identity, (RobotIdentity{"abb-rapid", "ABB", "IRB 6700 (simulated)", "SIM-1"}));
    for (const RobotMode mode : {RobotMode::automatic, RobotMode::manual_reduced, RobotMode::manual_full,
                                 RobotMode::stopped, RobotMode::fault}) {
        cell()->set_mode(mode);
        const auto told = link->mode();
        ASSERT_TRUE(told) << told.error().sentence();
        EXPECT_EQ(*told, mode);
    }
    const auto pose = link->base_from_flange();
    ASSERT_TRUE(pose) << pose.error().sentence();
    EXPECT_LT(distance_mm(*pose, moves()[0].trigger), 1e-3);
}

TEST_F(AbbRapid, AFrameFiveMetresAwaySurvivesSinglePrecision) {
    double worst_mm = 0, worst_rad = 0;
    for (int i = 0; i < 40; ++i) {
        Pose pose = far_pose();
        pose.translation() += Eigen::Vector3d(0.0137 * i, 0.0291 * i, -0.0173 * i);
        pose.linear() = pose.linear() * rotation_exp({0.013 * i, 0.07 * i, -0.05 * i});
        ASSERT_TRUE(link->write_frame("wobjDoor", pose));
        const auto back = link->read_frame("wobjDoor");
        ASSERT_TRUE(back) << back.error().sentence();
        worst_mm = std::max(worst_mm, distance_mm(*back, pose));
        worst_rad = std::max(worst_rad, angle_rad(*back, pose));
    }
    EXPECT_LT(worst_mm, 1e-3);
    EXPECT_GT(worst_mm, 0);  // single precision was there
    EXPECT_LT(deg_from_rad(worst_rad), 1e-4);
}

TEST_F(AbbRapid, AFrameCountsOnlyAfterTheVerdict) {
    const Pose before = *cell()->read_frame("wobjDoor");
    ASSERT_TRUE(start_measuring());
    ASSERT_TRUE(link->write_frame("wobjDoor", far_pose()));
    EXPECT_LT(distance_mm(*cell()->read_frame("wobjDoor"), before), 1e-9);
    EXPECT_FALSE(controller->released());
    ASSERT_TRUE(link->confirm(PartVerdict::corrected, "fits"));
    EXPECT_TRUE(controller->released());
    EXPECT_LT(distance_mm(*cell()->read_frame("wobjDoor"), far_pose()), 1e-3);
    ASSERT_TRUE(link->write_frame("wobjDoor", before));
    EXPECT_FALSE(controller->released());
    ASSERT_TRUE(link->confirm(PartVerdict::refused, "over limit"));
    EXPECT_EQ(controller->verdict(), PartVerdict::refused);
    // The staged one went, and what was set for a permission that nobody took does not stand either.
    EXPECT_LT(distance_mm(*cell()->read_frame("wobjDoor"), before), 1e-3);
    ASSERT_TRUE(link->write_frame("wobjDoor", far_pose()));
    ASSERT_TRUE(link->confirm(PartVerdict::corrected, ""));
    EXPECT_LT(distance_mm(*cell()->read_frame("wobjDoor"), far_pose()), 1e-3);
    ASSERT_TRUE(link->write_frame("wobjDoor", before));
    ASSERT_TRUE(link->confirm(PartVerdict::corrected, ""));
    link.reset();
    for (int i = 0; i < 200 && controller->released(); ++i) std::this_thread::sleep_for(Milliseconds(10));
    EXPECT_FALSE(controller->released());
}

TEST_F(AbbRapid, StartAndTriggersComeInOrder) {
    const auto none = link->wait_start(Milliseconds(20));
    ASSERT_FALSE(none);
    EXPECT_TRUE(is_silence(none.error()));
    controller->press_start(PartId("car-7"));
    const auto start = link->wait_start(Milliseconds(2000));
    ASSERT_TRUE(start) << start.error().sentence();
    EXPECT_EQ(start->part_id, "car-7");
    ASSERT_TRUE(start_measuring());
    for (const MeasuringMove& move : moves()) {
        const auto trigger = link->wait_trigger(Milliseconds(2000));
        ASSERT_TRUE(trigger) << trigger.error().sentence();
        EXPECT_EQ(trigger->spot_id, move.spot_id);
        ASSERT_TRUE(trigger->base_from_flange);
        EXPECT_LT(distance_mm(*trigger->base_from_flange, move.trigger), 1e-3);
    }
    const auto end = link->wait_trigger(Milliseconds(2000));
    ASSERT_FALSE(end);
    EXPECT_EQ(end.error().what, "the measuring program has ended");
}

TEST_F(AbbRapid, AnotherProgramIsRefused) {
    const auto refused = link->start_measuring(moves(2));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().what,
              "the controller refuses MEASURE: another measuring program is loaded than the project's");
    auto other = moves();
    other[1].spot_id = "X";
    EXPECT_FALSE(link->start_measuring(other));
    EXPECT_TRUE(link->mode());  // the connection holds
    EXPECT_FALSE(link->read_frame("wobjUnknown"));
    EXPECT_FALSE(link->read_frame("two words"));
}

TEST_F(AbbRapid, MovesForTeaching) {
    cell()->set_mode(RobotMode::manual_reduced);
    Pose goal = moves()[0].trigger * make_pose(rotation_exp({0.1, 0.2, 0.3}), {30, 40, 50});
    Expected<void> moved = device_error("not tried");
    for (int i = 0; i < 100 && !moved; ++i) moved = link->move_to(goal);  // SW_Teach begins
    ASSERT_TRUE(moved) << moved.error().sentence();
    EXPECT_LT(distance_mm(*cell()->reported_flange(), goal), 1e-3);
}

struct FaultCase {
    ControllerFault fault;
    const char* alarm;  // of a write_frame
};
class AbbFault : public AbbRapid, public testing::WithParamInterface<FaultCase> {};

TEST_P(AbbFault, IsAlarmedNothingStaysReleasedAndItRecovers) {
    link = open(150);
    ASSERT_TRUE(start_measuring());
    while (link->wait_trigger(Milliseconds(1000))) {
    }
    ASSERT_TRUE(link->write_frame("wobjDoor", far_pose()));
    ASSERT_TRUE(link->confirm(PartVerdict::corrected, ""));
    ASSERT_TRUE(controller->released());
    ASSERT_TRUE(start_measuring());
    controller->set_fault(GetParam().fault);
    Error error;
    if (GetParam().fault == ControllerFault::out_of_range) {
        const auto pose = link->base_from_flange();
        ASSERT_FALSE(pose);
        error = pose.error();
        const auto mode = link->mode();
        ASSERT_FALSE(mode);
        EXPECT_NE(mode.error().what.english().find("a mode that does not exist: \"DREAM ON RUN\""),
                  std::string::npos);
    } else if (GetParam().fault == ControllerFault::reject_write) {
        ASSERT_TRUE(link->write_frame("wobjDoor", far_pose())) << "staged";
        const auto confirmed = link->confirm(PartVerdict::corrected, "");
        ASSERT_FALSE(confirmed);
        error = confirmed.error();
    } else {
        const auto written = link->write_frame("wobjDoor", far_pose());
        ASSERT_FALSE(written);
        error = written.error();
    }
    EXPECT_EQ(error.kind, ErrorKind::device);
    EXPECT_NE(error.sentence().find(GetParam().alarm), std::string::npos) << error.sentence();
    EXPECT_FALSE(controller->released());
    controller->set_fault(ControllerFault::none);
    Expected<void> written = device_error("not tried");
    for (int i = 0; i < 100 && !written; ++i) {
        written = link->write_frame("wobjDoor", far_pose());
        if (!written) std::this_thread::sleep_for(Milliseconds(10));
    }
    EXPECT_TRUE(written) << written.error().sentence();
    EXPECT_TRUE(link->confirm(PartVerdict::corrected, ""));
    EXPECT_TRUE(controller->released());
}

INSTANTIATE_TEST_SUITE_P(
    Every, AbbFault,
    testing::Values(FaultCase{ControllerFault::silent, "no answer in time"},
                    FaultCase{ControllerFault::slow, "no answer in time"},
                    FaultCase{ControllerFault::wrong_answer, "came to request"},
                    FaultCase{ControllerFault::half_message, "no answer in time"},
                    FaultCase{ControllerFault::disconnect, "the connection was closed by the other side"},
                    FaultCase{ControllerFault::reject_write,
                              "the controller refuses VERDICT: a work object cannot be set: "
                              "wobjDoor"},
                    FaultCase{ControllerFault::out_of_range, "no position of a robot"}),
    [](const auto& tested) { return std::string(to_string(tested.param.fault)); });

// What comes before MEASURE is answered belongs to the measuring before: a controller may see the call for a
// part before the end of the last one.
TEST(AbbRapidByHand, TheLastMeasuringsEndIsNotTheNewOnes) {
    auto listener = TcpListener::listen("127.0.0.1", 0);
    ASSERT_TRUE(listener) << listener.error().sentence();
    std::jthread controller([&] {
        auto client = listener->accept(Milliseconds(5000));
        ASSERT_TRUE(client) << client.error().sentence();
        const auto say = [&](const abb::Message& message) {
            const std::string bytes = abb::message_bytes(message);
            EXPECT_TRUE(client->send(std::as_bytes(std::span(bytes)), Milliseconds(1000)));
        };
        std::array<char, abb::kMessageBytes> bytes;
        ASSERT_TRUE(client->receive_exactly(std::as_writable_bytes(std::span(bytes)), Milliseconds(5000)));
        const auto asked = abb::parse_message(std::string_view(bytes.data(), bytes.size()), "test");
        ASSERT_TRUE(asked) << asked.error().sentence();
        abb::Message old{0, "TRIGGER", {"12", "12", "S12"}, {}, {}};
        abb::set_pose_lines(old, Pose::Identity());
        say(old);
        say({0, "END", {"12"}, {}, {}});
        say({asked->number, asked->word, {}, {}, {}});
        abb::Message fresh{0, "TRIGGER", {"1", "1", "S1"}, {}, {}};
        abb::set_pose_lines(fresh, Pose::Identity());
        say(fresh);
        say({0, "END", {"1"}, {}, {}});
    });
    DeviceSession session;
    auto link = open_abb_rapid({{"port", listener->port()}, {"timeout_ms", 2000}}, session);
    ASSERT_TRUE(link) << link.error().sentence();
    const auto started = (*link)->start_measuring(moves(1));
    ASSERT_TRUE(started) << started.error().sentence();
    const auto trigger = (*link)->wait_trigger(Milliseconds(2000));
    ASSERT_TRUE(trigger) << trigger.error().sentence();
    EXPECT_EQ(trigger->spot_id, "S1");
    const auto end = (*link)->wait_trigger(Milliseconds(2000));
    ASSERT_FALSE(end);
    EXPECT_EQ(end.error().what, "the measuring program has ended");
}

// Every message in two pieces with a pause between, while the link asks now and then whether the controller is alive.
TEST(AbbRapidByHand, AMessageThatTheNetworkCutsIsTaken) {
    constexpr int kTriggers = 15;
    auto listener = TcpListener::listen("127.0.0.1", 0);
    ASSERT_TRUE(listener) << listener.error().sentence();
    std::jthread controller([&] {
        auto client = listener->accept(Milliseconds(5000));
        ASSERT_TRUE(client) << client.error().sentence();
        std::array<char, abb::kMessageBytes> bytes;
        std::size_t got = 0;
        int told = 0;
        auto next = std::chrono::steady_clock::now();
        const auto say = [&](const abb::Message& message) {
            const std::string text = abb::message_bytes(message);
            const auto all = std::as_bytes(std::span(text));
            EXPECT_TRUE(client->send(all.first(100), Milliseconds(1000)));
            std::this_thread::sleep_for(Milliseconds(100));
            EXPECT_TRUE(client->send(all.subspan(100), Milliseconds(1000)));
        };
        while (told <= kTriggers) {
            auto some =
                client->receive_some(std::as_writable_bytes(std::span(bytes)).subspan(got), Milliseconds(10));
            if (!some && !is_silence(some.error())) return;
            if (some) got += *some;
            if (got == bytes.size()) {
                got = 0;
                const auto asked = abb::parse_message(std::string_view(bytes.data(), bytes.size()), "test");
                ASSERT_TRUE(asked) << asked.error().sentence();
                say({asked->number, asked->word, {}, {}, {}});
                if (asked->word == "MEASURE") told = 1;
            }
            if (told == 0 || std::chrono::steady_clock::now() < next) continue;
            next = std::chrono::steady_clock::now() + Milliseconds(70);
            const std::string number = std::to_string(told++);
            abb::Message trigger{0, "TRIGGER", {number, number, "S1"}, {}, {}};
            abb::set_pose_lines(trigger, Pose::Identity());
            say(trigger);
        }
    });
    DeviceSession session;
    auto link = open_abb_rapid({{"port", listener->port()}, {"timeout_ms", 2000}}, session);
    ASSERT_TRUE(link) << link.error().sentence();
    ASSERT_TRUE((*link)->start_measuring(moves(1)));
    for (int i = 0; i < kTriggers; ++i) {
        auto trigger = (*link)->wait_trigger(Milliseconds(30));
        for (int again = 0; again < 100 && !trigger && is_silence(trigger.error()); ++again)
            trigger = (*link)->wait_trigger(Milliseconds(30));
        ASSERT_TRUE(trigger) << i << ": " << trigger.error().sentence();
    }
}

TEST(AbbRapidSettings, AreChecked) {
    DeviceSession session;
    const auto unknown = open_abb_rapid({{"prot", 1025}}, session);
    ASSERT_FALSE(unknown);
    EXPECT_NE(unknown.error().sentence().find("prot"), std::string::npos);
    EXPECT_FALSE(open_abb_rapid({{"port", 70000}}, session));
    EXPECT_FALSE(open_abb_rapid({{"timeout_ms", 0}}, session));
    EXPECT_TRUE(open_abb_rapid(nlohmann::json::object(), session));
}

}  // namespace
}  // namespace seamwright
