// One start gives the whole robot: the measuring controller of the brand on the same cell, and the cyclic
// correction beside it; one link measures by the one and corrects by the other.

#include <gtest/gtest.h>

#include <thread>

#include "devices/abb/egm.h"
#include "devices/controllers/abb/egm_controller.h"
#include "devices/controllers/kuka/rsi_controller.h"
#include "devices/exchange/pose_json.h"
#include "devices/kuka/rsi.h"
#include "devices/net/socket.h"
#include "devices/registry.h"
#include "devices/simulated/cell.h"

namespace seamwright {
namespace {

using std::chrono::milliseconds;

struct Brand {
    const char *cyclic, *measuring;
    bool robot_is_client;
    double way_mm = 20;  // from entry to spot and on to exit
};
void PrintTo(const Brand& b, std::ostream* out) {
    *out << b.cyclic << " with " << b.measuring << (b.way_mm > 0 ? "" : ", standing at its spot");
}

class WholeRobot : public testing::TestWithParam<Brand> {};

TEST_P(WholeRobot, MeasuresByOneDriverAndCorrectsByTheOther) {
    auto cell = SimulatedCell::open({{"serial", "R-1"}, {"optics", {{"width", 64}, {"height", 64}}}});
    ASSERT_TRUE(cell) << cell.error().sentence();
    MeasuringMove move;
    move.spot_id = "S1";
    move.trigger = make_pose(rotation_exp({0.1, 0.2, -0.3}), {800, -200, 600});
    move.entry = move.exit = move.trigger;
    move.entry.translation().y() -= GetParam().way_mm;
    move.exit.translation().y() += GetParam().way_mm;
    (*cell)->store_program({move});
    const std::uint16_t port = UdpSocket::bind("127.0.0.1", 0)->port();
    const std::uint16_t tcp = TcpListener::listen("127.0.0.1", 0)->port();
    const Pose taught = make_pose(Eigen::Matrix3d::Identity(), {900, -200, 600});
    const nlohmann::json measuring = {{"driver", GetParam().measuring}, {"settings", {{"port", tcp}}}};
    DeviceSession session;
    std::unique_ptr<SimulatedController> controller;
    std::unique_ptr<RobotLink> link;
    const auto start = [&] {
        auto started = start_controller(GetParam().cyclic, *cell, {{"port", port}, {"measuring", measuring}});
        ASSERT_TRUE(started) << started.error().sentence();
        controller = std::move(*started);
    };
    const auto open = [&] {
        auto opened = open_robot(GetParam().cyclic,
                                 {{"port", port},
                                  {"max_late", 100},
                                  {"frames", {{"PATH", {{"base_from_frame", pose_json(taught)}}}}},
                                  {"measuring", measuring}},
                                 session);
        ASSERT_TRUE(opened) << opened.error().sentence();
        link = std::move(*opened);
    };
    if (GetParam().robot_is_client) {
        open();
        start();
    } else {
        start();
        open();
    }
    ASSERT_TRUE(link && controller);
    auto identity = link->identity();
    for (int i = 0; i < 50 && !identity; ++i) identity = link->identity();
    ASSERT_TRUE(identity) << identity.error().sentence();
    EXPECT_EQ(identity->driver, GetParam().measuring);
    ASSERT_TRUE(link->mode());
    // As soon as the robot's program waits for it.
    const auto start_measuring = [&] {
        auto begun = link->start_measuring({move});
        for (int i = 0; i < 100 && !begun; ++i) {
            std::this_thread::sleep_for(milliseconds(50));
            begun = link->start_measuring({move});
        }
        return begun;
    };
    auto started = start_measuring();
    ASSERT_TRUE(started) << started.error().sentence();
    auto trigger = link->wait_trigger(milliseconds(2000));
    ASSERT_TRUE(trigger) << trigger.error().sentence();
    EXPECT_EQ(trigger->spot_id, "S1");
    Pose moved = taught;
    moved.translation() += Eigen::Vector3d(0.3, -0.2, 0.4);
    ASSERT_TRUE(link->write_frame("PATH", moved));
    auto confirmed = link->confirm(PartVerdict::corrected, "part 1");
    ASSERT_TRUE(confirmed) << confirmed.error().sentence();
    SimulatedController* beside = GetParam().robot_is_client
                                      ? static_cast<SimulatedRsi&>(*controller).measuring()
                                      : static_cast<SimulatedEgm&>(*controller).measuring();
    ASSERT_NE(beside, nullptr);
    // The permission is there as long as nobody takes it back, of both controllers.
    for (int i = 0; i < 100 && !controller->released(); ++i) std::this_thread::sleep_for(milliseconds(2));
    EXPECT_TRUE(controller->released()) << "told with the next cycles";
    std::this_thread::sleep_for(milliseconds(100));
    EXPECT_TRUE(controller->released());
    const auto permission = link->permission();
    ASSERT_TRUE(permission) << permission.error().sentence();
    EXPECT_TRUE(*permission == Permission::given || *permission == Permission::running);
    EXPECT_EQ(beside->verdict(), PartVerdict::corrected);
    // The next part starts without a correction.
    auto again = start_measuring();
    ASSERT_TRUE(again) << again.error().sentence();
    EXPECT_FALSE(beside->released());
    const CyclicServer::State state = static_cast<CyclicLink&>(*link).server().state();
    EXPECT_TRUE(state.zero || state.silent) << "a robot that stopped its path asks no more";
}
INSTANTIATE_TEST_SUITE_P(Brands, WholeRobot,
                         testing::Values(Brand{"kuka-rsi", "kuka-eki", true},
                                         Brand{"kuka-rsi", "kuka-eki", true, 0},
                                         Brand{"abb-egm", "abb-rapid", false}));

}  // namespace
}  // namespace seamwright
