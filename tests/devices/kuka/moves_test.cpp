// Moves by command: a robot that was told to stop, or did, must not drive what has been told as failed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <mutex>
#include <thread>

#include "devices/controllers/kuka/controller.h"
#include "devices/kuka/eki.h"
#include "devices/kuka/eki_telegram.h"
#include "devices/kuka/kvp.h"
#include "devices/kuka/kvp_message.h"
#include "devices/net/socket.h"
#include "devices/simulated/cell.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using testing::HasSubstr;

// KUKAVARPROXY by hand: variables that are read and written. `on_move` comes with every SW_MOVE TRUE.
class Variables {
  public:
    std::function<void(std::map<std::string, std::string>&)> on_move = [](auto&) {};
    int moves = 0;

    explicit Variables(std::map<std::string, std::string> more = {}) {
        values_ = {{"$STOPMESS", "FALSE"},
                   {"$MODE_OP", "#T1"},
                   {"$PERI_RDY", "TRUE"},
                   {"$PRO_STATE1", "#P_ACTIVE"},
                   {"$PRO_NAME1[]", "\"SEAMWRIGHT\""},
                   {"$IPO_MODE_C", "#BASE"},
                   {"$BASE_C", kZero},
                   {"$TOOL_C", kZero},
                   {"$POS_ACT", kZero},
                   {"$KR_SERIALNO", "1"},
                   {"$TRAFONAME[]", "\"#KR\""},
                   {"SW_MOVE", "FALSE"},
                   {"SW_MOVE_TO", kZero},
                   {"SW_MOVE_NO", "0"}};
        for (const auto& [name, value] : more) values_[name] = value;
        server_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
    }
    std::unique_ptr<RobotLink> link() {
        DeviceSession session;
        return *open_kuka_kvp({{"port", listener_.port()}, {"timeout_ms", 200}}, session);
    }
    std::string value(const std::string& name) {
        const std::lock_guard lock(mutex_);
        return values_[name];
    }

  private:
    static constexpr const char* kZero = "{X 0.0,Y 0.0,Z 0.0,A 0.0,B 0.0,C 0.0}";
    void serve(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            auto client = listener_.accept(Timeout(20));
            std::string stream;
            std::array<char, 4096> buffer;
            while (client && !stop.stop_requested()) {
                const auto got = client->receive_some(std::as_writable_bytes(std::span(buffer)), Timeout(20));
                if (!got && got.error().code != ErrorCode::silence) break;
                if (got) stream.append(buffer.data(), *got);
                for (;;) {
                    auto request = take_kvp_request(stream);
                    if (!request || !*request) break;
                    (void)client->send(bytes_of(kvp_bytes(answer_to(**request))), Timeout(200));
                }
            }
        }
    }
    KvpAnswer answer_to(const KvpRequest& r) {
        const std::lock_guard lock(mutex_);
        const auto known = values_.find(r.name);
        if (known == values_.end() || (r.write && r.value == refused)) return {r.id, r.write, r.value, false};
        if (r.write) known->second = r.value;
        if (r.write && r.name == "SW_MOVE" && r.value == "TRUE") {
            ++moves;
            on_move(values_);
        }
        return {r.id, r.write, known->second, true};
    }
    std::mutex mutex_;
    std::map<std::string, std::string> values_;
    TcpListener listener_ = TcpListener::listen("127.0.0.1", 0).value();
    std::jthread server_;

  public:
    std::string refused = "none";
};

const Pose kGoal = make_pose(Eigen::Matrix3d::Identity(), {0, 0, 10});

TEST(KvpMove, IsSentOnlyToAProgramThatDrivesIt) {
    for (const auto& [name, value] : {std::pair{"$PRO_STATE1", "#P_STOP"},
                                      {"$PRO_NAME1[]", "\"BODYCELL\""},
                                      {"$PERI_RDY", "FALSE"},
                                      {"$MODE_OP", "#AUT"}}) {
        Variables robot(std::map<std::string, std::string>{{name, value}});
        EXPECT_THAT(robot.link()->move_to(kGoal).error().sentence(),
                    HasSubstr("T1 with the program SEAMWRIGHT"));
        EXPECT_EQ(robot.moves, 0) << name;
    }
}

TEST(KvpMove, IsTakenBackWhenItFails) {
    Variables slow;  // never there
    EXPECT_THAT(slow.link()->move_to(kGoal).error().sentence(), HasSubstr("no answer in time"));
    EXPECT_EQ(slow.moves, 1);
    EXPECT_EQ(slow.value("SW_MOVE"), "FALSE");
    Variables stopped;
    stopped.on_move = [](auto& values) { values["$PRO_STATE1"] = "#P_STOP"; };
    EXPECT_THAT(stopped.link()->move_to(kGoal).error().sentence(), HasSubstr("stopped on its way"));
    EXPECT_EQ(stopped.value("SW_MOVE"), "FALSE");
    Variables refuses;  // the goal: the last one must not be driven to instead
    refuses.refused = krl_from_frame(kGoal);
    EXPECT_FALSE(refuses.link()->move_to(kGoal));
    EXPECT_EQ(refuses.moves, 0);
}

TEST(KvpMove, IsBelievedWhereTheRobotStands) {
    for (const double off_mm : {0.0, 0.4, 0.6, 500.0}) {
        Variables robot;
        robot.on_move = [&](auto& values) {
            Pose at = kGoal;
            at.translation().x() += off_mm;
            values["$POS_ACT"] = krl_from_frame(at);
            values["SW_MOVE"] = "FALSE";
        };
        const auto moved = robot.link()->move_to(kGoal);
        EXPECT_EQ(moved.has_value(), off_mm < 0.5) << off_mm;
        if (off_mm > 0.5) {
            EXPECT_THAT(moved.error().sentence(), HasSubstr("off the pose that it was sent to"));
        }
    }
}

class KukaMoves : public testing::TestWithParam<std::string> {};

// The first move is left on its way: its end is not that of the second.
TEST_P(KukaMoves, TheEndOfAnotherMoveIsNotTheEndOfThisOne) {
    static const auto cell =
        SimulatedCell::open({{"serial", "KRC-4711"}, {"optics", {{"width", 64}, {"height", 64}}}}).value();
    const bool eki = GetParam() == "kuka-eki";
    MeasuringMove spot;
    spot.spot_id = "S1";
    spot.entry = spot.trigger = spot.exit = make_pose(rotation_exp({0.1, 0.2, -0.3}), {800, -200, 600});
    cell->set_mode(RobotMode::manual_reduced);
    cell->store_program({spot});
    cell->move_to(spot.entry);
    Pose first = spot.entry, second = spot.entry;
    first.translation().z() += 150;
    second.translation().z() += 140;
    const std::uint16_t port = TcpListener::listen("127.0.0.1", 0)->port();
    const nlohmann::json settings = {{"port", port}};
    auto controller =
        (eki ? start_kuka_eki_controller(cell, settings) : start_kuka_kvp_controller(cell, settings)).value();
    std::this_thread::sleep_for(milliseconds(300));  // the program has been selected
    if (eki) {
        auto listener = TcpListener::listen("127.0.0.1", port).value();
        auto robot = listener.accept(Timeout(3000)).value();
        const std::string move = write_eki("Sensor", {.kind = "move", .id = 1, .pose = first});
        ASSERT_TRUE(robot.send(bytes_of(move), Timeout(500)));
        std::this_thread::sleep_for(milliseconds(200));
    } else {
        auto robot = TcpConnection::connect("127.0.0.1", port, Timeout(500)).value();
        const auto set = [&](const std::string& name, const std::string& value) {
            ASSERT_TRUE(robot.send(bytes_of(kvp_bytes(KvpRequest{1, true, name, value})), Timeout(500)));
            std::this_thread::sleep_for(milliseconds(100));
        };
        set("SW_MOVE_TO", krl_from_frame(first));
        set("SW_MOVE", "TRUE");
        set("SW_MOVE", "FALSE");
    }
    DeviceSession session;
    auto link =
        (eki ? open_kuka_eki({{"port", port}}, session) : open_kuka_kvp({{"port", port}}, session)).value();
    for (int i = 0; i < 200 && !link->mode(); ++i) std::this_thread::sleep_for(milliseconds(10));
    const auto before = link->base_from_flange();
    ASSERT_TRUE(before) << before.error().sentence();
    ASSERT_GT(distance_mm(*before, first), 20) << "on its way still";
    ASSERT_GT(distance_mm(*before, spot.entry), 1);
    const auto moved = link->move_to(second);
    ASSERT_TRUE(moved) << moved.error().sentence();
    EXPECT_LT(distance_mm(*link->base_from_flange(), second), 1e-2);
}

INSTANTIATE_TEST_SUITE_P(Drivers, KukaMoves, testing::Values("kuka-eki", "kuka-kvp"),
                         [](const auto& i) { return i.param == "kuka-eki" ? "eki" : "kvp"; });

}  // namespace
}  // namespace seamwright
