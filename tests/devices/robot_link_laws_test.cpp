// What every robot driver owes, whatever its protocol: each is put before its simulated controller over real
// sockets, and every fault of the controller must be told, must leave no frame released, and must be over
// when it is over.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "devices/net/socket.h"
#include "devices/registry.h"
#include "devices/silence.h"
#include "devices/simulated/cell.h"
#include "tests/devices/relay.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
using testing::HasSubstr;
using testing::MatchesRegex;

std::uint16_t free_port() {
    return TcpListener::listen("127.0.0.1", 0)->port();
}

// How the two ends of a brand are opened on one port.
struct Brand {
    std::string name;
    bool robot_is_client = false;
    std::string frame;                                                   // a name that its frames can have
    RobotMode external = RobotMode::external, fault = RobotMode::fault;  // how the brand tells these modes
    double trigger_mm = 1e-3;  // between the programmed trigger and what is reported, along the travel
    // Further settings of the controller: for all tests, with an application that never begins; and those
    // with which it begins as soon as it may. Null: none yet.
    nlohmann::json controller = nlohmann::json::object(), begins = nullptr;
    std::string serial = "KRC-4711";  // as the brand tells it
    bool hears_of_loss = true;        // the protocol tells the controller that the link is gone
};
void PrintTo(const Brand& brand, std::ostream* out) {
    *out << brand.name;
}
const std::vector<Brand> kBrands = {
    {"kuka-eki",
     true,
     "BASE_left",
     RobotMode::external,
     RobotMode::stopped,
     1e-3,
     {{"time_scale", 4}, {"application_wait_ms", 3600000}},
     {{"time_scale", 4}, {"application_wait_ms", 0}},
     "4711"},
    {"kuka-kvp",
     false,
     "BASE_left",
     RobotMode::external,
     RobotMode::stopped,
     1e-3,
     {{"time_scale", 4}, {"application_wait_ms", 3600000}},
     {{"time_scale", 4}, {"application_wait_ms", 0}},
     "4711",
     false},
    {"abb-rapid",
     false,
     "BASE_left",
     RobotMode::automatic,
     RobotMode::fault,
     1e-3,
     {{"time_scale", 4}, {"application_wait_ms", 3600000}},
     {{"time_scale", 4}, {"application_wait_ms", 0}}},
    // Fires in the cycle that passes the trigger: 2 ms at four times the speed.
    {"ur-rtde",
     false,
     "BASE_left",
     RobotMode::external,
     RobotMode::fault,
     1.0,
     {{"time_scale", 4}, {"application_wait_ms", 3600000}},
     {{"time_scale", 4}, {"application_wait_ms", 0}}}};

std::vector<MeasuringMove> program() {
    std::vector<MeasuringMove> moves;
    for (int i = 1; i <= 4; ++i) {
        MeasuringMove m;
        m.spot_id = "S" + std::to_string(i);
        m.trigger = make_pose(rotation_exp({0.1 * i, 0.2, -0.3}), {800.0 + 10 * i, -200, 600});
        m.entry = m.exit = m.trigger;
        m.entry.translation().y() -= 20;
        m.exit.translation().y() += 20;
        moves.push_back(m);
    }
    return moves;
}

// One cell for all: opening it is the slow part.
std::shared_ptr<SimulatedCell> cell_of(const Brand& brand) {
    nlohmann::json frame = {{"xyz", {900, -450, 500}}, {"abc", {12, -4, 3}}};
    static std::map<std::string, std::shared_ptr<SimulatedCell>> cells;
    auto& cell = cells[brand.frame];
    if (!cell)
        cell = SimulatedCell::open({{"serial", "KRC-4711"},
                                    {"optics", {{"width", 64}, {"height", 64}}},
                                    {"robot", {{"mode", "external"}, {"frames", {{brand.frame, frame}}}}}})
                   .value();
    return cell;
}

class RobotLaws : public testing::TestWithParam<Brand> {
  protected:
    static constexpr int kTimeoutMs = 400;
    void SetUp() override {
        cell->set_mode(RobotMode::external);
        cell->store_program(program());
        ASSERT_TRUE(cell->write_frame(GetParam().frame, taught));
        link_settings = {{"port", port}, {"timeout_ms", kTimeoutMs}};
        controller_settings = {{"port", port}, {"slow_ms", kTimeoutMs * 2}};
        controller_settings.update(GetParam().controller);
        if (GetParam().name == "ur-rtde")
            link_settings["dashboard_port"] = controller_settings["dashboard_port"] = free_port();
        const auto start = [&] {
            auto started = start_controller(GetParam().name, cell, controller_settings);
            ASSERT_TRUE(started) << started.error().sentence();
            controller = std::move(*started);
        };
        if (!GetParam().robot_is_client) start();
        auto opened = open_robot(GetParam().name, link_settings, session);
        ASSERT_TRUE(opened) << opened.error().sentence();
        link = std::move(*opened);
        if (GetParam().robot_is_client) start();
    }
    // Until the link answers again, as a watching runner would try.
    bool recovers() {
        for (const auto until = Clock::now() + std::chrono::seconds(10); Clock::now() < until;) {
            if (link->mode() && link->read_frame(GetParam().frame)) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        return false;
    }
    // As soon as the robot's program waits for it: the last one may not have come to its end.
    Expected<void> start_measuring() {
        auto started = link->start_measuring(program());
        for (int i = 0; i < 50 && !started; ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
            started = link->start_measuring(program());
        }
        return started;
    }
    void measure_all() {
        auto started = start_measuring();
        ASSERT_TRUE(started) << started.error().sentence();
        for (const MeasuringMove& move : program()) {
            auto trigger = link->wait_trigger(std::chrono::seconds(5));
            ASSERT_TRUE(trigger) << trigger.error().sentence();
            EXPECT_EQ(trigger->spot_id, move.spot_id);
            ASSERT_TRUE(trigger->base_from_flange);
            const Eigen::Vector3d along = (move.exit.translation() - move.entry.translation()).normalized();
            const Eigen::Vector3d off = trigger->base_from_flange->translation() - move.trigger.translation();
            EXPECT_LT(std::abs(off.dot(along)), GetParam().trigger_mm);
            EXPECT_LT((off - off.dot(along) * along).norm(), 1e-3);
            EXPECT_LT(angle_rad(*trigger->base_from_flange, move.trigger), 1e-5);
        }
    }
    const Pose taught = make_pose(rotation_exp({0.3, -0.2, 0.9}), {900, -450, 500});
    const Pose corrected = make_pose(rotation_exp({0.31, -0.19, 0.91}), {904.1234, -447.4321, 502.5});
    const std::uint16_t port = free_port();
    std::shared_ptr<SimulatedCell> cell = cell_of(GetParam());
    DeviceSession session;
    std::unique_ptr<RobotLink> link;
    std::unique_ptr<SimulatedController> controller;
    nlohmann::json controller_settings, link_settings;
};

TEST_P(RobotLaws, TellsWhoItIsAndHowItStands) {
    auto identity = link->identity();
    ASSERT_TRUE(identity) << identity.error().sentence();
    EXPECT_EQ(identity->driver, GetParam().name);
    EXPECT_EQ(identity->serial, GetParam().serial);
    EXPECT_FALSE(identity->brand.empty());
    EXPECT_EQ(link->mode(), GetParam().external);
    // The program that gives the position its tool and base has begun.
    for (const auto until = Clock::now() + std::chrono::seconds(5);
         Clock::now() < until && !link->base_from_flange();)
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    cell->set_mode(RobotMode::fault);
    EXPECT_EQ(link->mode(), GetParam().fault);
    // Moved by hand, as soon as the program that has just begun stands still.
    Expected<Pose> at = Pose::Identity();
    for (const auto until = Clock::now() + std::chrono::seconds(5); Clock::now() < until;) {
        cell->move_to(program()[2].trigger);
        at = link->base_from_flange();
        if (at && distance_mm(*at, program()[2].trigger) < 1e-3) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    ASSERT_TRUE(at) << at.error().sentence();
    EXPECT_LT(distance_mm(*at, program()[2].trigger), 1e-3);
}

TEST_P(RobotLaws, AFrameIsReadBackAsWrittenAndReleasedByTheVerdictAlone) {
    measure_all();
    EXPECT_FALSE(controller->released());
    auto written = link->write_frame(GetParam().frame, corrected);
    ASSERT_TRUE(written) << written.error().sentence();
    auto back = link->read_frame(GetParam().frame);
    ASSERT_TRUE(back) << back.error().sentence();
    EXPECT_LT(distance_mm(*back, corrected), 1e-3);
    EXPECT_LT(deg_from_rad(angle_rad(*back, corrected)), 1e-4);
    EXPECT_FALSE(controller->released()) << "written is not confirmed";
    ASSERT_TRUE(link->confirm(PartVerdict::corrected, "1 region corrected and pushed"));
    EXPECT_TRUE(controller->released());
    EXPECT_EQ(controller->verdict(), PartVerdict::corrected);
    ASSERT_TRUE(link->confirm(PartVerdict::failed, "taken back"));
    EXPECT_FALSE(controller->released());
    ASSERT_TRUE(link->write_frame(GetParam().frame, taught));
    auto stands = cell->read_frame(GetParam().frame);
    for (const auto until = Clock::now() + std::chrono::seconds(2);
         stands && distance_mm(*stands, taught) > 1e-3 && Clock::now() < until;
         stands = cell->read_frame(GetParam().frame))
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_TRUE(stands) << stands.error().sentence();
    EXPECT_LT(distance_mm(*stands, taught), 1e-3) << "the old frame is back on the controller itself";
    measure_all();
    ASSERT_TRUE(link->confirm(PartVerdict::corrected, ""));
    EXPECT_TRUE(controller->released());
    // A new part begins, or is asked for while the program is elsewhere and is refused.
    const auto begun = link->start_measuring(program());
    EXPECT_FALSE(controller->released()) << (begun ? "begun" : begun.error().sentence());
}

// However the network cuts the stream, it is the same stream.
TEST_P(RobotLaws, BrokenAndJoinedMessagesAreOne) {
    for (const std::size_t piece : {1UL, 13UL}) {
        SCOPED_TRACE(piece);
        link.reset();
        controller.reset();
        nlohmann::json far = controller_settings, near = link_settings;
        std::optional<Relay> relay;
        const auto start = [&] {
            if (GetParam().robot_is_client) {
                relay.emplace(port, piece);
                far["port"] = relay->port();
            }
            controller = std::move(start_controller(GetParam().name, cell, far).value());
            if (!GetParam().robot_is_client) {
                relay.emplace(port, piece);
                near["port"] = relay->port();
            }
        };
        if (!GetParam().robot_is_client) start();
        near["timeout_ms"] = 2000;
        link = std::move(open_robot(GetParam().name, near, session).value());
        if (GetParam().robot_is_client) start();
        ASSERT_TRUE(recovers());
        measure_all();
        ASSERT_TRUE(link->write_frame(GetParam().frame, corrected));
        auto back = link->read_frame(GetParam().frame);
        ASSERT_TRUE(back) << back.error().sentence();
        EXPECT_LT(distance_mm(*back, corrected), 1e-3);
        ASSERT_TRUE(link->confirm(PartVerdict::corrected, ""));
        EXPECT_TRUE(controller->released());
        link.reset();  // before the network that it uses
        controller.reset();
    }
}

TEST_P(RobotLaws, UnknownFrameIsRefusedByName) {
    for (const auto& error :
         {link->read_frame("NO_SUCH").error(), link->write_frame("NO_SUCH", corrected).error()})
        EXPECT_THAT(error.sentence(), HasSubstr("NO_SUCH"));
}

TEST_P(RobotLaws, TheLinesCallIsHeardOnce) {
    auto none = link->wait_start(std::chrono::milliseconds(50));
    ASSERT_FALSE(none);
    EXPECT_TRUE(is_silence(none.error())) << none.error().sentence();
    controller->press_start(PartId("CAR-0815"));
    auto start = link->wait_start(std::chrono::seconds(5));
    ASSERT_TRUE(start) << start.error().sentence();
    EXPECT_EQ(start->part_id, "CAR-0815");
    EXPECT_EQ(start->part_type, "") << "a program of a project without part types says none";
    none = link->wait_start(std::chrono::milliseconds(50));
    ASSERT_FALSE(none);
    EXPECT_TRUE(is_silence(none.error()));
    measure_all();
}

TEST_P(RobotLaws, TheTypeComesWithTheCall) {
    controller->press_start(PartId("CAR-0815"), PartTypeId("wagon_long-16-ch"));
    auto start = link->wait_start(std::chrono::seconds(5));
    ASSERT_TRUE(start) << start.error().sentence();
    EXPECT_EQ(start->part_id, "CAR-0815");
    EXPECT_EQ(start->part_type, "wagon_long-16-ch");
    measure_all();
}

// The robot waits at the part; whoever heard the call and died has not measured it.
TEST_P(RobotLaws, ACallThatWasNotServedIsMadeAgainToTheNextRunner) {
    ASSERT_TRUE(recovers());
    controller->press_start(PartId("CAR-0816"));
    auto heard = link->wait_start(std::chrono::seconds(5));
    ASSERT_TRUE(heard) << heard.error().sentence();
    link.reset();
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    link = std::move(open_robot(GetParam().name, link_settings, session).value());
    ASSERT_TRUE(recovers());
    auto again = link->wait_start(std::chrono::seconds(5));
    ASSERT_TRUE(again) << again.error().sentence();
    EXPECT_EQ(again->part_id, "CAR-0816");
    measure_all();
    const auto none = link->wait_start(std::chrono::milliseconds(300));
    EXPECT_FALSE(none) << "a part that was begun is not called for again";
}

TEST_P(RobotLaws, AnotherProgramThanTheProjectsIsRefused) {
    auto other = program();
    other[1].spot_id = "S9";
    auto started = link->start_measuring(other);
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error().kind, ErrorKind::device);
}

TEST_P(RobotLaws, AStoppedRobotDoesNotStart) {
    cell->set_mode(RobotMode::stopped);
    EXPECT_FALSE(link->start_measuring(program()));
}

TEST_P(RobotLaws, ALostControllerIsToldAndComesBack) {
    ASSERT_TRUE(recovers());
    controller.reset();
    for (int i = 0; i < 3; ++i) {
        const auto begun = Clock::now();
        auto frame = link->read_frame(GetParam().frame);
        ASSERT_FALSE(frame);
        EXPECT_EQ(frame.error().kind, ErrorKind::device);
        EXPECT_LT(Clock::now() - begun, std::chrono::seconds(3)) << "no call blocks longer than its time-out";
    }
    auto started = start_controller(GetParam().name, cell, controller_settings);
    ASSERT_TRUE(started) << started.error().sentence();
    controller = std::move(*started);
    EXPECT_TRUE(recovers());
    EXPECT_FALSE(controller->released());
}

TEST_P(RobotLaws, EveryFaultIsToldReleasesNothingAndPasses) {
    const std::map<ControllerFault, std::string> words = {
        {ControllerFault::silent, "no answer in time"},
        {ControllerFault::slow, "no answer in time"},
        {ControllerFault::wrong_answer, "answer"},
        {ControllerFault::half_message, "no answer in time"},
        {ControllerFault::disconnect, "closed by the other side"},
        {ControllerFault::reject_write, "refuses"},
        {ControllerFault::out_of_range, "no position of a robot"}};
    for (const ControllerFault fault : controller_faults()) {
        SCOPED_TRACE(std::string(to_string(fault)));
        ASSERT_TRUE(recovers());
        measure_all();
        controller->set_fault(fault);
        // As a push does: written, read back, confirmed.
        auto pushed = link->write_frame(GetParam().frame, corrected);
        if (pushed) {
            if (auto back = link->read_frame(GetParam().frame); !back)
                pushed = tl::unexpected(back.error());
            else
                pushed = link->confirm(PartVerdict::corrected, "");
        }
        ASSERT_FALSE(pushed) << "a push of that kind must not look done";
        const Error& error = pushed.error();
        EXPECT_EQ(error.kind, ErrorKind::device);
        EXPECT_THAT(error.sentence(), HasSubstr(words.at(fault)));
        EXPECT_THAT(error.sentence(), HasSubstr("127.0.0.1:")) << "says where";
        controller->set_fault(ControllerFault::none);
        ASSERT_TRUE(recovers()) << "when the fault is over";
        ASSERT_TRUE(link->confirm(PartVerdict::failed, ""));
        EXPECT_FALSE(controller->released());
        ASSERT_TRUE(link->write_frame(GetParam().frame, taught));
    }
}

// Whoever gave the permission and dies before the application took it has given nothing.
TEST_P(RobotLaws, ALostLinkTakesBackWhatTheApplicationHasNotTaken) {
    if (GetParam().begins.is_null()) GTEST_SKIP() << "its application cannot be held";
    measure_all();
    ASSERT_TRUE(link->write_frame(GetParam().frame, corrected));
    ASSERT_TRUE(link->confirm(PartVerdict::corrected, ""));
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    EXPECT_TRUE(controller->released()) << "it holds while the link lives, whether it is asked or not";
    EXPECT_EQ(link->permission(), Permission::given);
    if (!GetParam().hears_of_loss) return;
    link.reset();
    const auto until = Clock::now() + std::chrono::seconds(5);
    while (controller->released() && Clock::now() < until)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_FALSE(controller->released());
    EXPECT_FALSE(controller->taken());
}

TEST_P(RobotLaws, WhatTheApplicationHasTakenStays) {
    if (GetParam().begins.is_null()) GTEST_SKIP() << "its application cannot be held";
    link.reset();
    controller.reset();
    controller_settings.update(GetParam().begins);
    if (!GetParam().robot_is_client)
        controller = std::move(start_controller(GetParam().name, cell, controller_settings).value());
    link = std::move(open_robot(GetParam().name, link_settings, session).value());
    if (GetParam().robot_is_client)
        controller = std::move(start_controller(GetParam().name, cell, controller_settings).value());
    ASSERT_TRUE(recovers());
    measure_all();
    ASSERT_TRUE(link->write_frame(GetParam().frame, corrected));
    ASSERT_TRUE(link->confirm(PartVerdict::corrected, ""));
    Expected<Permission> now = link->permission();
    for (const auto until = Clock::now() + std::chrono::seconds(10);
         now && *now != Permission::taken && Clock::now() < until; now = link->permission()) {
        EXPECT_EQ(*now, Permission::given);
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ASSERT_TRUE(now) << now.error().sentence();
    EXPECT_EQ(*now, Permission::taken);
    link.reset();
    std::this_thread::sleep_for(std::chrono::milliseconds(2500));
    EXPECT_TRUE(controller->released()) << "the part's path runs to its end";
    EXPECT_TRUE(controller->taken());
}

INSTANTIATE_TEST_SUITE_P(Brands, RobotLaws, testing::ValuesIn(kBrands), [](const auto& brand) {
    std::string name = brand.param.name;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

TEST(RobotLawsTable, HoldsEveryControllerOfTheRegistry) {
    // These correct a running path and measure through another driver; what they owe, fault by fault, is in
    // tests/devices/cyclic.
    const std::vector<std::string_view> cyclic = {"kuka-rsi", "abb-egm"};
    for (const ControllerDriver& driver : controller_drivers()) {
        if (std::find(cyclic.begin(), cyclic.end(), driver.name) != cyclic.end()) continue;
        EXPECT_TRUE(std::any_of(kBrands.begin(), kBrands.end(), [&](const Brand& b) {
            return b.name == driver.name;
        })) << driver.name;
    }
}

}  // namespace
}  // namespace seamwright
